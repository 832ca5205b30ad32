/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/sphere.h"
#include "fit/render/frame.h"
#include "src/splitmix.h"
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdlib.h>

/* The numbers of a sample, in pairs: position in the pixel, light, surface. */
enum { AT_PIXEL = 0, AT_LIGHT = 2, AT_SURFACE = 4, DIMENSIONS = 6 };

#define MARGIN 0.02

struct scene {
	const struct surface *surface; /* one of the two */
	const struct glass *glass;
	const struct environment *environment;
	const struct sphere_options *options;
	uint32_t (*point)[DIMENSIONS]; /* per sample: bits behind the point, before the pixel's scrambling */
};

static uint64_t mix(uint64_t x)
{
	return splitmix_bits(&x);
}

/* Bits to be changed in each of a pixel's numbers. All the intervals that the points fill evenly stay so. */
static void pixel_scramble(uint64_t seed, int x, int y, uint32_t scramble[DIMENSIONS])
{
	uint64_t state = mix(mix(seed) ^ ((uint64_t)y << 32 | (uint64_t)x));
	for (int d = 0; d < DIMENSIONS; d++) {
		state = mix(state);
		scramble[d] = (uint32_t)(state >> 32);
	}
}

/* The first points of the sequence in two dimensions, the origin among them, which GSL leaves out. */
static enum status fill_sobol(uint32_t (*point)[2], int n)
{
	gsl_qrng *sobol = gsl_qrng_alloc(gsl_qrng_sobol, 2);
	if (!sobol)
		return STATUS_NO_MEMORY;
	point[0][0] = point[0][1] = 0;
	for (int i = 1; i < n; i++) {
		double u[2];
		gsl_qrng_get(sobol, u);
		point[i][0] = (uint32_t)ldexp(u[0], 32);
		point[i][1] = (uint32_t)ldexp(u[1], 32);
	}
	gsl_qrng_free(sobol);
	return STATUS_OK;
}

/* Each pair of numbers runs through the same points, in an order of its own: two dimensions of Sobol's sequence are far
 * more even than any higher ones. */
static enum status fill_points(struct scene *scene, int n)
{
	uint32_t(*pair)[2] = calloc((size_t)n, sizeof *pair);
	scene->point = calloc((size_t)n, sizeof *scene->point);
	const enum status status = pair && scene->point ? fill_sobol(pair, n) : STATUS_NO_MEMORY;
	for (int d = 0; d < DIMENSIONS && status == STATUS_OK; d += 2)
		for (int i = 0; i < n; i++) {
			const int other = i + (int)(mix((uint64_t)d << 32 | (uint64_t)i) % (uint64_t)(n - i));
			for (int e = 0; e < 2; e++) {
				const uint32_t kept = pair[i][e];
				scene->point[i][d + e] = pair[i][e] = pair[other][e];
				pair[other][e] = kept;
			}
		}
	free(pair);
	return status;
}

/* A point of the surface, seen. */
struct point {
	struct frame frame;
	struct view view;
};

static void add_light(const double f[3], const double light[3], double weight, double sum[3])
{
	for (int c = 0; c < 3; c++)
		sum[c] += weight * f[c] * light[c];
}

static void add_point_lights(const struct scene *scene, const struct point *at, double sum[3])
{
	for (int i = 0; i < scene->environment->n_lights; i++) {
		const struct light *light = &scene->environment->light[i];
		const struct vec3 wi = frame_to(&at->frame, light->to);
		double f[3];
		surface_f(scene->surface, &at->view, wi, f);
		add_light(f, light->irradiance, wi.z, sum);
	}
}

static void add_map_light(const struct scene *scene, const struct point *at, const double u[DIMENSIONS], double sum[3])
{
	const enum estimator estimator = scene->options->estimator;
	const struct environment *environment = scene->environment;
	double f[3];
	if (estimator != ESTIMATE_SURFACE) {
		const struct vec3 to = environment_sample(environment, u[AT_LIGHT], u[AT_LIGHT + 1]);
		const struct vec3 wi = frame_to(&at->frame, to);
		const double pdf = surface_f(scene->surface, &at->view, wi, f);
		if (pdf > 0) {
			const struct arriving light = environment_at(environment, to);
			add_light(f, light.rgb, wi.z * estimator_weight(estimator, light.pdf, pdf), sum);
		}
	}
	struct vec3 wi;
	if (estimator != ESTIMATE_LIGHT && surface_sample(scene->surface, &at->view, u + AT_SURFACE, &wi)) {
		const double pdf = surface_f(scene->surface, &at->view, wi, f);
		const struct arriving light = environment_at(environment, frame_from(&at->frame, wi));
		add_light(f, light.rgb, wi.z * estimator_weight(estimator, pdf, light.pdf), sum);
	}
}

/* Adds the light that one sample of the pixel sees. Returns whether it sees the sphere at all. */
static bool add_sample(const struct scene *scene, int x, int y, const double u[DIMENSIONS], uint64_t random,
		       double sum[3])
{
	const double radius = scene->options->size * (0.5 - MARGIN), middle = 0.5 * scene->options->size;
	const double right = (x + u[AT_PIXEL] - middle) / radius, up = (middle - y - u[AT_PIXEL + 1]) / radius;
	const double z2 = 1 - right * right - up * up;
	if (z2 < SURFACE_HORIZON * SURFACE_HORIZON)
		return false;
	const struct vec3 normal = {right, up, sqrt(z2)};
	if (scene->glass) {
		glass_light(scene->glass, scene->environment, scene->options->estimator, normal, u + AT_LIGHT, &random,
			    sum);
		return true;
	}
	struct point at = {.frame = scene->options->tangents ? frame_along_parallels(normal) : frame_of(normal)};
	at.view = surface_view(scene->surface, frame_to(&at.frame, (struct vec3){0, 0, 1}));
	add_point_lights(scene, &at, sum);
	if (scene->environment->map.rgb)
		add_map_light(scene, &at, u, sum);
	return true;
}

static void render_pixel(const struct scene *scene, int x, int y, struct sphere *sphere)
{
	const int size = scene->options->size, n = scene->options->samples;
	uint32_t scramble[DIMENSIONS];
	double sum[3] = {0, 0, 0};
	int seen = 0;
	pixel_scramble(scene->options->seed, x, y, scramble);
	for (int i = 0; i < n; i++) {
		double u[DIMENSIONS];
		for (int d = 0; d < DIMENSIONS; d++)
			u[d] = 0x1p-32 * (double)(scene->point[i][d] ^ scramble[d]);
		const uint64_t random = mix(((uint64_t)scramble[0] << 32 | scramble[1]) + (uint64_t)i);
		seen += add_sample(scene, x, y, u, random, sum);
	}
	sphere->coverage[x + size * y] = (float)seen / (float)n;
	for (int c = 0; c < 3; c++)
		image_at(&sphere->light, x, y)[c] = seen ? (float)(sum[c] / seen) : 0;
}

static bool cancelled(const struct sphere_options *options)
{
	return options->cancel && *options->cancel;
}

static void render_rows(const struct scene *scene, struct sphere *sphere)
{
	const struct sphere_options *options = scene->options;
#pragma omp parallel for schedule(dynamic) num_threads(options->threads)
	for (int y = 0; y < options->size; y++) {
		for (int x = 0; x < options->size && !cancelled(options); x++)
			render_pixel(scene, x, y, sphere);
		if (options->row_done) {
#pragma omp critical(sphere_row_done)
			options->row_done(options->user);
		}
	}
}

static enum status render(struct scene *scene, struct sphere *sphere)
{
	const struct sphere_options *options = scene->options;
	*sphere = (struct sphere){0};
	enum status status = fill_points(scene, options->samples);
	if (status == STATUS_OK)
		status = image_alloc(&sphere->light, options->size, options->size);
	if (status == STATUS_OK) {
		sphere->coverage = calloc((size_t)options->size * (size_t)options->size, sizeof(float));
		status = sphere->coverage ? STATUS_OK : STATUS_NO_MEMORY;
	}
	if (status == STATUS_OK) {
		render_rows(scene, sphere);
		status = cancelled(options) ? STATUS_INTERRUPTED : STATUS_OK;
	}
	free(scene->point);
	if (status != STATUS_OK)
		sphere_free(sphere);
	return status;
}

enum status sphere_render(const struct surface *surface, const struct environment *environment,
			  const struct sphere_options *options, struct sphere *sphere)
{
	struct scene scene = {.surface = surface, .environment = environment, .options = options};
	return render(&scene, sphere);
}

enum status sphere_render_glass(const struct glass *glass, const struct environment *environment,
				const struct sphere_options *options, struct sphere *sphere)
{
	struct scene scene = {.glass = glass, .environment = environment, .options = options};
	return render(&scene, sphere);
}

void sphere_free(struct sphere *sphere)
{
	image_free(&sphere->light);
	free(sphere->coverage);
	*sphere = (struct sphere){0};
}
