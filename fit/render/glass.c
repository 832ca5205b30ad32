/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/glass.h"
#include "fit/render/frame.h"
#include "src/splitmix.h"
#include "src/vndf.h"

/* Nearer to the horizon than this a path ends. */
#define HORIZON 1e-6

enum {
	VERTICES_MAX = 200, /* of a path */
	VERTICES_SURE = 6   /* before its end is left to chance */
};

enum status glass_init(struct glass *glass, const struct ndf *ndf, enum gaf gaf, double n, bool multiple,
		       enum sampling sampling)
{
	struct sampler sampler;
	glass->multiple = multiple;
	glass->sampling = sampler_init_near(&sampler, ndf, sampling);
	const enum status status = dielectric_init(&glass->dielectric, ndf, gaf, n);
	if (status != STATUS_OK || !multiple)
		return status;
	return random_walk_init_dielectric(&glass->walk, ndf, n);
}

static double next_number(void *state)
{
	return splitmix_uniform(state);
}

/* A path's last vertex, seen from w. */
struct vertex {
	const struct glass *glass;
	struct vec3 normal;
	struct frame frame;
	struct vec3 w; /* in the frame */
	struct random_numbers numbers;
};

/* What the surface does to light from l, with the viewer's direction as the light's: between media each radiance counts by
 * the square of its index, which cancels on the way in and out. */
static double f_at(const struct vertex *at, struct vec3 l)
{
	double f[3];
	if (!at->glass->multiple)
		return dielectric_f(&at->glass->dielectric, at->w, l);
	random_walk_f(&at->glass->walk, at->w, l, 0, &at->numbers, f);
	return f[0];
}

/* A density by which samples of the light and of the surface are weighed against each other: with single scattering that of
 * the samples; more orders go everywhere. */
static double pdf_at(const struct vertex *at, struct vec3 l)
{
	const struct glass *glass = at->glass;
	return dielectric_pdf(&glass->dielectric, glass->sampling, at->w, l) + (glass->multiple ? 0.05 : 0);
}

static void add(const double light[3], double weight, double sum[3])
{
	for (int c = 0; c < 3; c++)
		sum[c] += weight * light[c];
}

/* Light that is sampled where it comes from. */
static void add_lights(const struct vertex *at, const struct environment *environment, enum estimator estimator,
		       double throughput, const double u[2], double sum[3])
{
	for (int i = 0; i < environment->n_lights; i++) {
		const struct vec3 l = frame_to(&at->frame, environment->light[i].to);
		if (l.z > 0)
			add(environment->light[i].irradiance, throughput * f_at(at, l) * l.z, sum);
	}
	if (!environment->map.rgb || estimator == ESTIMATE_SURFACE)
		return;
	const struct vec3 to = environment_sample(environment, u[0], u[1]), l = frame_to(&at->frame, to);
	const double f = l.z > 0 ? f_at(at, l) : 0;
	if (!(f > 0))
		return;
	const struct arriving light = environment_at(environment, to);
	add(light.rgb, throughput * f * l.z * estimator_weight(estimator, light.pdf, pdf_at(at, l)), sum);
}

/* Draws where the path goes on. Returns the weight, 0 at its end. */
static double go_on(const struct vertex *at, const double u[2], struct vec3 *to)
{
	if (at->glass->multiple) {
		const struct random_walk_exit out = random_walk_sample(&at->glass->walk, at->w, &at->numbers);
		*to = out.wo;
		return out.weight[0];
	}
	const double numbers[3] = {u[0], u[1], at->numbers.next(at->numbers.state)};
	const struct dielectric_sample out =
		dielectric_sample(&at->glass->dielectric, at->glass->sampling, at->w, numbers);
	*to = out.wo;
	return out.weight;
}

static void add_environment(const struct vertex *at, const struct environment *environment, enum estimator estimator,
			    struct vec3 l, double throughput, double sum[3])
{
	if (!environment->map.rgb || estimator == ESTIMATE_LIGHT)
		return;
	const struct arriving light = environment_at(environment, frame_from(&at->frame, l));
	const double pdf = pdf_at(at, l);
	if (pdf > 0)
		add(light.rgb, throughput * pdf * estimator_weight(estimator, pdf, light.pdf), sum);
}

/* On to where the sphere is met from inside. */
static void cross(struct vertex *at, struct vec3 into)
{
	const struct vec3 ray = frame_from(&at->frame, into);
	const double length = -2 * vec3_dot(at->normal, ray);
	at->normal = vec3_unit(vec3_add(at->normal, vec3_scale(ray, length)));
	at->frame = frame_of(at->normal);
	at->w = frame_to(&at->frame, vec3_opposite(ray));
}

void glass_light(const struct glass *glass, const struct environment *environment, enum estimator estimator,
		 struct vec3 normal, const double u[4], uint64_t *random, double sum[3])
{
	struct vertex at = {
		.glass = glass, .normal = normal, .frame = frame_of(normal), .numbers = {next_number, random}};
	double number[4] = {u[0], u[1], u[2], u[3]}, throughput = 1;
	at.w = frame_to(&at.frame, (struct vec3){0, 0, 1});
	for (int i = 0; i < VERTICES_MAX && fabs(at.w.z) > HORIZON; i++) {
		struct vec3 to;
		add_lights(&at, environment, estimator, throughput, number, sum);
		throughput *= go_on(&at, number + 2, &to);
		if (throughput > 0 && to.z > 0)
			add_environment(&at, environment, estimator, to, throughput, sum);
		if (!(throughput > 0) || to.z >= 0)
			return;
		const double chance = i < VERTICES_SURE ? 1 : fmin(throughput, 1);
		if (!(splitmix_uniform(random) < chance))
			return;
		throughput /= chance;
		cross(&at, to);
		for (int k = 0; k < 4; k++)
			number[k] = splitmix_uniform(random);
	}
}
