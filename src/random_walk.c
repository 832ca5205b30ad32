/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/random_walk.h"
#include "src/dielectric.h"
#include "src/vndf.h"
#include <float.h>

/* Below this share of the light a walk goes on with the probability that makes up for it. */
#define WEIGHT_MIN 0.1

static enum status init(struct random_walk *walk, const struct ndf *ndf, enum fresnel fresnel, bool refracts)
{
	if (!vndf_supports(ndf))
		return STATUS_UNSUPPORTED;
	*walk = (struct random_walk){.ndf = *ndf, .fresnel = fresnel, .refracts = refracts};
	return ndf_set_lambda_form(&walk->ndf, LAMBDA_EXACT);
}

enum status random_walk_init_mirror(struct random_walk *walk, const struct ndf *ndf, enum fresnel fresnel,
				    const double n[3], const double k[3])
{
	for (int c = 0; c < 3; c++) {
		const bool bad_n = fresnel != FRESNEL_NONE && !(n[c] > 0.0 && n[c] <= 1e75);
		const bool bad_k = fresnel == FRESNEL_CONDUCTOR && !(k[c] >= 0.0 && k[c] <= 1e75);
		if (bad_n || bad_k)
			return STATUS_DOMAIN;
	}
	const enum status status = init(walk, ndf, fresnel, false);
	for (int c = 0; c < 3 && status == STATUS_OK; c++) {
		walk->n[c] = fresnel != FRESNEL_NONE ? n[c] : 1.0;
		walk->k[c] = fresnel == FRESNEL_CONDUCTOR ? k[c] : 0.0;
	}
	return status;
}

enum status random_walk_init_dielectric(struct random_walk *walk, const struct ndf *ndf, double n)
{
	if (!dielectric_takes(n))
		return STATUS_DOMAIN;
	const enum status status = init(walk, ndf, FRESNEL_DIELECTRIC, true);
	if (status == STATUS_OK)
		walk->n[0] = walk->n[1] = walk->n[2] = n;
	return status;
}

/* struct ray - a ray between the facets, in the frame of the side on which it is: there its medium is above, and the other
 * side is the surface mirrored through the origin. */
struct ray {
	const struct random_walk *walk;
	struct vec3 w;
	double x; /* -ln of the share of the surface that is lower; >= DBL_MIN at a facet */
	bool below;
	double n; /* of a dielectric: the other side's index over that of this one */
	double weight[3];
};

static struct ray enter(const struct random_walk *walk, struct vec3 wi)
{
	const bool below = wi.z < 0.0;
	return (struct ray){.walk = walk,
			    .w = below ? wi : vec3_opposite(wi),
			    .x = 0.0,
			    .below = below,
			    .n = below ? 1.0 / walk->n[0] : walk->n[0],
			    .weight = {1.0, 1.0, 1.0}};
}

/* x as the other side counts it. */
static double x_of_other_side(double x)
{
	const double other = x < M_LN2 ? -log(-expm1(-x)) : -log1p(-exp(-x));
	return fmax(other, DBL_MIN);
}

/* To the next facet. Returns whether there is one. */
static bool advance(struct ray *ray, const struct random_numbers *numbers)
{
	const double e = -log1p(-numbers->next(numbers->state));
	if (ray->w.z > 0.0) {
		const double lambda = ndf_lambda(&ray->walk->ndf, ray->w);
		if (!(ray->x * lambda > e))
			return false;
		ray->x -= e / lambda;
	} else {
		ray->x += e / (1.0 + ndf_lambda(&ray->walk->ndf, vec3_opposite(ray->w)));
	}
	ray->x = fmax(ray->x, DBL_MIN);
	return true;
}

static void pass_through(struct ray *ray, struct vec3 w)
{
	ray->w = vec3_opposite(w);
	ray->x = x_of_other_side(ray->x);
	ray->below = !ray->below;
	ray->n = 1.0 / ray->n;
}

/* Multiplies the weights by the facet's reflectance. Returns whether the walk goes on. */
static bool absorb(struct ray *ray, double cos_d, const struct random_numbers *numbers)
{
	const struct random_walk *walk = ray->walk;
	double largest = 0.0;
	if (walk->fresnel == FRESNEL_NONE)
		return true;
	for (int c = 0; c < 3; c++) {
		ray->weight[c] *= fresnel_F(walk->fresnel, cos_d, walk->n[c], walk->k[c]);
		largest = fmax(largest, ray->weight[c]);
	}
	if (!(largest < WEIGHT_MIN))
		return true;
	if (!(numbers->next(numbers->state) * WEIGHT_MIN < largest))
		return false;
	for (int c = 0; c < 3; c++)
		ray->weight[c] *= WEIGHT_MIN / largest;
	return true;
}

/* A facet sends the ray on. Returns whether the walk goes on. */
static bool scatter(struct ray *ray, const struct random_numbers *numbers)
{
	const struct vec3 wi = vec3_opposite(ray->w);
	const double u1 = numbers->next(numbers->state), u2 = numbers->next(numbers->state);
	const struct vec3 m = vndf_sample_inside(&ray->walk->ndf, wi, u1, u2);
	const double cos_d = vec3_dot(wi, m);
	struct vec3 through;
	if (!ray->walk->refracts) {
		ray->w = vec3_unit(vec3_reflect(wi, m));
		return absorb(ray, cos_d, numbers);
	}
	if (numbers->next(numbers->state) >= fresnel_dielectric(cos_d, ray->n) &&
	    dielectric_refract(wi, m, ray->n, &through))
		pass_through(ray, through);
	else
		ray->w = vec3_unit(vec3_reflect(wi, m));
	return true;
}

struct random_walk_exit random_walk_sample(const struct random_walk *walk, struct vec3 wi,
					   const struct random_numbers *numbers)
{
	struct ray ray = enter(walk, wi);
	struct random_walk_exit out = {wi, {0.0, 0.0, 0.0}, 0};
	while (advance(&ray, numbers)) {
		if (out.events == RANDOM_WALK_EVENTS_MAX || !scatter(&ray, numbers))
			return out;
		out.events++;
	}
	out.wo = ray.below ? vec3_opposite(ray.w) : ray.w;
	for (int c = 0; c < 3; c++)
		out.weight[c] = ray.weight[c];
	return out;
}

/* Density per solid angle with which the facet at the ray's end sends it to wo, in the ray's frame, but for F or 1 - F, and
 * *cos_d there. */
static double phase(const struct ray *ray, struct vec3 wo, double *cos_d)
{
	const struct ndf *ndf = &ray->walk->ndf;
	const struct vec3 wi = vec3_opposite(ray->w);
	if (wo.z > 0.0) {
		const struct vec3 sum = vec3_add(wi, wo);
		*cos_d = fmin(0.5 * vec3_length(sum), 1.0);
		/* Straight on, which no facet does, and where D and the area are both too small for a double. */
		const double D = *cos_d > 0.0 ? ndf_D(ndf, vec3_unit(sum)) : 0.0;
		return D > 0.0 ? 0.25 * D / vndf_area(ndf, wi) : 0.0;
	}
	const struct dielectric_half half = dielectric_half(wi, wo, ray->n);
	*cos_d = vec3_dot(wi, half.m);
	if (half.length == 0.0)
		return 0.0;
	return vndf_pdf_inside(ndf, wi, half.m) * dielectric_jacobian(&half, wo, ray->n);
}

/* Adds what the facet at the ray's end sends to wo, in the ray's frame; from there the share G gets away. */
static void connect(const struct ray *ray, struct vec3 wo, double G, double f[3])
{
	const struct random_walk *walk = ray->walk;
	double cos_d;
	const double density = phase(ray, wo, &cos_d);
	if (!(density > 0.0))
		return;
	for (int c = 0; c < 3; c++) {
		const double F = fresnel_F(walk->fresnel, cos_d, walk->refracts ? ray->n : walk->n[c], walk->k[c]);
		f[c] += ray->weight[c] * (wo.z > 0.0 ? F : 1.0 - F) * density * G / fabs(wo.z);
	}
}

void random_walk_f(const struct random_walk *walk, struct vec3 wi, struct vec3 wo, int events,
		   const struct random_numbers *numbers, double f[3])
{
	struct ray ray = enter(walk, wi);
	f[0] = f[1] = f[2] = 0.0;
	if (wi.z == 0.0 || wo.z == 0.0 || (!walk->refracts && !(wi.z > 0.0 && wo.z > 0.0)))
		return;
	const double lambda_i = ndf_lambda(&walk->ndf, vec3_opposite(ray.w));
	const double lambda_o = ndf_lambda(&walk->ndf, wo.z < 0.0 ? vec3_opposite(wo) : wo);
	/* The mean over the heights of the first facet */
	const bool through = wi.z * wo.z < 0.0;
	const double first =
		(through ? gaf_smith_through : gaf_smith)(GAF_CORRELATED, lambda_i, lambda_o) * (1.0 + lambda_i);
	const int last = events > 0 && events < RANDOM_WALK_EVENTS_MAX ? events : RANDOM_WALK_EVENTS_MAX;
	connect(&ray, ray.below ? vec3_opposite(wo) : wo, first, f);
	if (last == 1 || !advance(&ray, numbers))
		return;
	for (int i = 1; i < last && scatter(&ray, numbers) && advance(&ray, numbers); i++) {
		const struct vec3 local = ray.below ? vec3_opposite(wo) : wo;
		if (local.z > 0.0)
			connect(&ray, local, exp(-lambda_o * ray.x), f);
		else if (walk->refracts)
			connect(&ray, local, exp(-lambda_o * x_of_other_side(ray.x)), f);
	}
}
