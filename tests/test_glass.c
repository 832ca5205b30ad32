/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Spheres of rough glass: white furnaces, estimators against each other, the smooth limit. */
#include "chi_square.h"
#include "fit/render/sphere.h"

/* A map of 32 x 16 texels with the radiance of rule(texel). */
static struct environment light_of(float (*rule)(int x, int y, int channel))
{
	struct image map;
	struct environment environment;
	assert_int_equal(image_alloc(&map, 32, 16), STATUS_OK);
	for (int i = 0; i < 3 * 32 * 16; i++)
		map.rgb[i] = rule(i / 3 % 32, i / 3 / 32, i % 3);
	assert_int_equal(environment_from_map(&environment, &map, NULL), STATUS_OK);
	return environment;
}

static float white(int x, int y, int channel)
{
	(void)x;
	(void)y;
	(void)channel;
	return 1;
}

static float above(int x, int y, int channel)
{
	(void)x;
	(void)channel;
	return y < 8 ? 1 : 0;
}

static float spotted(int x, int y, int channel)
{
	uint64_t seed = (uint64_t)x + 32 * (uint64_t)y;
	const double u = uniform(&seed);
	return u < 0.5 ? 0 : (float)(pow(u, 6) * (1 + channel));
}

static struct glass glass_of(double sigma, double gamma, double n, bool multiple)
{
	struct ndf ndf;
	struct glass glass;
	assert_int_equal(ndf_init(&ndf, ndf_find("std"), sigma, sigma, gamma), STATUS_OK);
	assert_int_equal(glass_init(&glass, &ndf, GAF_CORRELATED, n, multiple, SAMPLING_VISIBLE), STATUS_OK);
	return glass;
}

/* Mean radiance over random points of the sphere, and its standard error, of three channels. */
struct seen {
	double mean[3], error[3];
};

static struct seen look(const struct glass *glass, struct environment *environment, enum estimator estimator, int n,
			uint64_t *random)
{
	struct seen seen;
	double sum[3] = {0}, squares[3] = {0};
	for (int i = 0; i < n; i++) {
		const double r = sqrt(0.95 * uniform(random)), phi = 2 * M_PI * uniform(random);
		const double u[4] = {uniform(random), uniform(random), uniform(random), uniform(random)};
		double light[3] = {0};
		if (environment->n_lights) { /* in a random direction */
			const double z = 2 * uniform(random) - 1, turn = 2 * M_PI * uniform(random);
			environment->light[0].to =
				(struct vec3){sqrt(1 - z * z) * cos(turn), sqrt(1 - z * z) * sin(turn), z};
		}
		glass_light(glass, environment, estimator, (struct vec3){r * cos(phi), r * sin(phi), sqrt(1 - r * r)},
			    u, random, light);
		for (int c = 0; c < 3; c++) {
			sum[c] += light[c];
			squares[c] += light[c] * light[c];
		}
	}
	for (int c = 0; c < 3; c++) {
		seen.mean[c] = sum[c] / n;
		seen.error[c] = sqrt(fmax(squares[c] / n - seen.mean[c] * seen.mean[c], 0) / n);
	}
	return seen;
}

/* In a white world glass that loses nothing cannot be seen: sampled by the surface, by the light, and by point lights from
 * everywhere. */
static void clear_glass_vanishes_in_a_white_world(void **state)
{
	(void)state;
	struct environment world = light_of(white);
	struct environment points = {.n_lights = 1};
	uint64_t random = 3;
	for (int c = 0; c < 3; c++)
		points.light[0].irradiance[c] = 4 * M_PI;
	for (int i = 0; i < 4; i++) {
		const struct glass glass = glass_of(i % 2 ? 0.8 : 0.5, i / 2 ? 2.0 : 9.0, i % 2 ? 1.5 : 1.2, true);
		struct seen seen = look(&glass, &world, ESTIMATE_SURFACE, 500, &random);
		check_abs(seen.mean[0], 1, 1e-9, "sampled by the surface");
		seen = look(&glass, &world, ESTIMATE_LIGHT, 6000, &random);
		check_between(seen.error[1], 1e-3, 0.15, "noise");
		check_mean(seen.mean[1], seen.error[1], 1, "sampled by the light");
		seen = look(&glass, &points, ESTIMATE_LIGHT, 6000, &random);
		check_between(seen.error[2], 1e-3, 0.15, "noise");
		check_mean(seen.mean[2], seen.error[2], 1, "lit by points");
	}
	/* Single scattering loses little where the surface is nearly smooth, and more where it is rough. */
	const struct glass fine = glass_of(0.03, 4.0, 1.5, false), rough = glass_of(0.9, 4.0, 1.5, false);
	check_between(look(&fine, &world, ESTIMATE_BOTH, 2000, &random).mean[0], 0.99, 1.001, "fine glass");
	check_between(look(&rough, &world, ESTIMATE_SURFACE, 4000, &random).mean[0], 0.3, 0.9, "rough glass");
	environment_free(&world);
}

static void estimators_agree(void **state)
{
	(void)state;
	struct environment world = light_of(spotted);
	uint64_t random = 8;
	for (int i = 0; i < 4; i++) {
		const struct glass glass = glass_of(0.5, i % 2 ? 2.2 : 6.0, i % 2 ? 1.5 : 0.8, i >= 2);
		const struct seen by_light = look(&glass, &world, ESTIMATE_LIGHT, 8000, &random);
		const struct seen by_surface = look(&glass, &world, ESTIMATE_SURFACE, 8000, &random);
		const struct seen by_both = look(&glass, &world, ESTIMATE_BOTH, 8000, &random);
		for (int c = 0; c < 3; c++) {
			check_between(by_both.error[c] / by_both.mean[c], 1e-4, 0.05, "noise");
			check_mean(by_light.mean[c], hypot(by_light.error[c], by_both.error[c]), by_both.mean[c],
				   "light");
			check_mean(by_surface.mean[c], hypot(by_surface.error[c], by_both.error[c]), by_both.mean[c],
				   "surface");
		}
	}
	environment_free(&world);
}

/* A smooth sphere is a lens: each ray turns by i - t on its way in and out, and by pi - 2 t at each reflection inside. */
static void a_smooth_sphere_is_a_lens(void **state)
{
	(void)state;
	struct environment world = light_of(above);
	const struct glass glass = glass_of(1e-5, 4.0, 1.5, false);
	for (int i = 1; i < 6; i++) {
		const double height = 0.17 * i * (i % 2 ? 1 : -1), in = asin(height), t = asin(height / 1.5);
		const double F = fresnel_dielectric(cos(in), 1.5);
		double want = height > 0 ? F : 0, inside = (1 - F) * (1 - F), sum[3] = {0};
		uint64_t random = 5;
		enum { N = 4000 };
		for (int k = 0; k < 20; k++, inside *= F)
			want += sin(2 * (in - t) + k * (copysign(M_PI, height) - 2 * t)) < 0 ? inside : 0;
		for (int k = 0; k < N; k++) {
			const double u[4] = {uniform(&random), uniform(&random), uniform(&random), uniform(&random)};
			glass_light(&glass, &world, ESTIMATE_SURFACE, (struct vec3){0, height, cos(in)}, u, &random,
				    sum);
		}
		char label[32];
		snprintf(label, sizeof label, "height %g", height);
		check_mean(sum[0] / N, sqrt(want * (1 - want) / N) + 1e-3, want, label);
	}
	environment_free(&world);
}

static void a_seed_gives_the_same_picture_on_any_number_of_threads(void **state)
{
	(void)state;
	struct environment world = light_of(spotted);
	const struct glass glass = glass_of(0.3, 3.0, 1.5, false);
	struct sphere one, two;
	struct sphere_options options = {.size = 16, .samples = 4, .seed = 7, .threads = 1};
	assert_int_equal(sphere_render_glass(&glass, &world, &options, &one), STATUS_OK);
	options.threads = 3;
	assert_int_equal(sphere_render_glass(&glass, &world, &options, &two), STATUS_OK);
	assert_memory_equal(one.light.rgb, two.light.rgb, 3 * 16 * 16 * sizeof(float));
	assert_true(image_at(&one.light, 8, 8)[1] > 0 && one.coverage[8 + 16 * 8] == 1);
	sphere_free(&one);
	sphere_free(&two);
	environment_free(&world);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(clear_glass_vanishes_in_a_white_world),
		cmocka_unit_test(estimators_agree),
		cmocka_unit_test(a_smooth_sphere_is_a_lens),
		cmocka_unit_test(a_seed_gives_the_same_picture_on_any_number_of_threads),
	};
	return cmocka_run_group_tests_name("glass", tests, NULL, NULL);
}
