/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ellipsoid as one of the distributions, held against its own formulas (ellipsoid.h), quadrature and GGX. */
#include "check.h"
#include "chi_square.h"
#include "src/cook_torrance.h"
#include "src/ellipsoid.h"
#include "src/energy.h"
#include "src/ndf_cdf.h"
#include "src/ndf_slopes.h"
#include "src/quadrature.h"
#include "src/sampling.h"
#include "src/vndf.h"
#include <gsl/gsl_integration.h>

#define DEGREE (M_PI / 180.0)

static const double shapes[][5] = {{0.3, 0.3, 0.0, 0.0, 0.0},     {0.25, 0.9, 0.0, 0.0, 40.0},
				   {0.4, 0.4, 25.0, 0.0, 0.0},    {0.5, 0.3, -15.0, 35.0, 70.0},
				   {1.7, 0.6, 40.0, -20.0, 10.0}, {0.05, 0.01, 3.0, 8.0, -20.0}};
enum { SHAPES = sizeof(shapes) / sizeof(shapes[0]) };

static struct ellipsoid ellipsoid_at(int shape)
{
	const double *s = shapes[shape];
	struct ellipsoid e;
	assert_int_equal(ellipsoid_init_angles(&e, s[0], s[1], s[2] * DEGREE, s[3] * DEGREE, s[4] * DEGREE), STATUS_OK);
	return e;
}

static struct ndf ndf_of(const struct ellipsoid *e)
{
	struct ndf ndf;
	assert_int_equal(ndf_from_ellipsoid(&ndf, e), STATUS_OK);
	return ndf;
}

static struct vec3 direction(uint64_t *random, double end)
{
	const double theta = end * uniform(random), phi = 360.0 * uniform(random);
	return vec3_from_spherical_deg(theta, phi);
}

static void it_is_the_ellipsoid(void **state)
{
	(void)state;
	uint64_t random = 4;
	int bounded = 0;
	for (int i = 0; i < SHAPES; i++) {
		const struct ellipsoid e = ellipsoid_at(i);
		const struct ndf ndf = ndf_of(&e);
		for (int j = 0; j < 300; j++) {
			const struct vec3 m = direction(&random, 89.9), w = direction(&random, 89.9);
			const double smith = ellipsoid_smith(&e, w);
			check_rel(ndf_D(&ndf, m), ellipsoid_D(&e, m), 1e-12, "D");
			check_rel(ndf_G1(&ndf, w), ellipsoid_G1(&e, w), 1e-12, "G1");
			check_rel(vndf_area(&ndf, w), w.z / smith, 1e-12, "area");
			check_rel(vndf_pdf(&ndf, w, m), ellipsoid_pdf(&e, w, m), 1e-11, "visible pdf");
			bounded += smith > 1.0;
		}
	}
	assert_in_range(bounded, 50, 1000);
}

/* Signs, scale and what turns A from the left do not matter. */
static void any_matrix_of_it_makes_it(void **state)
{
	(void)state;
	const double A[3][3] = {{0.7, -0.2, 0.5}, {0.1, 0.4, -0.3}, {-0.6, 0.2, 0.9}};
	const double B[3][3] = {{-6, 2, 9}, {7, -2, 5}, {1, 4, -3}};
	struct ellipsoid a, b;
	assert_int_equal(ellipsoid_init(&a, A), STATUS_OK);
	assert_int_equal(ellipsoid_init(&b, B), STATUS_OK);
	const struct ndf first = ndf_of(&a), second = ndf_of(&b);
	check_rel(first.sigma_x, second.sigma_x, 1e-14, "sigma_x");
	check_rel(first.sigma_y, second.sigma_y, 1e-14, "sigma_y");
	check_rel(first.angle, second.angle, 1e-14, "angle");
	check_rel(first.tilt_x, second.tilt_x, 1e-14, "tilt_x");
	check_rel(first.tilt_y, second.tilt_y, 1e-14, "tilt_y");
	/* Roughness that is not is refused. */
	const double flat[3][3] = {{1e-40, 0, 0}, {0, 1e-45, 0}, {0, 0, 1e200}};
	struct ndf ndf = first;
	assert_int_equal(ellipsoid_init(&a, flat), STATUS_OK);
	assert_int_equal(ndf_from_ellipsoid(&ndf, &a), STATUS_DOMAIN);
	assert_true(ndf.sigma_x == first.sigma_x);
}

static void level_it_is_ggx(void **state)
{
	(void)state;
	struct ndf level, ggx, plain;
	uint64_t random = 11;
	assert_int_equal(ndf_init(&level, ndf_find("ellipsoid"), 0.2, 0.5, NAN), STATUS_OK);
	assert_int_equal(ndf_init(&ggx, ndf_find("ggx"), 0.2, 0.5, NAN), STATUS_OK);
	assert_int_equal(ndf_turn(&level, 25.0), STATUS_OK);
	assert_int_equal(ndf_turn(&ggx, 25.0), STATUS_OK);
	assert_true(ndf_plain(&level, &plain) && plain.class == ggx.class && plain.angle == 25.0);
	for (int i = 0; i < 200; i++) {
		const struct vec3 w = direction(&random, 90.0), m = direction(&random, 90.0);
		const double u1 = uniform(&random), u2 = uniform(&random);
		check_rel(ndf_D(&level, m), ndf_D(&ggx, m), 0, "D");
		check_rel(ndf_lambda(&level, w), ndf_lambda(&ggx, w), 1e-14, "Lambda");
		check_rel(ndf_P2(&level, 3.0 * u1, u2), ndf_P2(&ggx, 3.0 * u1, u2), 1e-14, "P2");
		check_rel(vndf_pdf(&level, w, m), vndf_pdf(&ggx, w, m), 1e-14, "visible pdf");
		check_abs(vec3_length(vec3_sub(vndf_sample(&level, w, u1, u2), vndf_sample(&ggx, w, u1, u2))), 0, 0,
			  "visible normal");
		check_abs(vec3_length(vec3_sub(ndf_sample(&level, u1, u2), ndf_sample(&ggx, u1, u2))), 0, 0, "normal");
	}
	assert_int_equal(ndf_tilt(&level, 0.1, 0.0), STATUS_OK);
	assert_false(ndf_plain(&level, &plain));
	assert_int_equal(ndf_tilt(&level, NAN, 0.0), STATUS_DOMAIN);
	assert_int_equal(ndf_tilt(&level, 0.0, 1e51), STATUS_DOMAIN);
	assert_true(level.tilt_x == 0.1 && level.tilt_y == 0.0);
	assert_int_equal(ndf_tilt(&ggx, 0.0, 0.0), STATUS_UNSUPPORTED);
}

/* In either order, and the axes alone turn. */
static void tilt_and_turn_are_apart(void **state)
{
	(void)state;
	struct ndf a, b;
	uint64_t random = 2;
	assert_int_equal(ndf_init(&a, ndf_find("ellipsoid"), 0.2, 0.5, NAN), STATUS_OK);
	b = a;
	assert_int_equal(ndf_turn(&a, -35.0), STATUS_OK);
	assert_int_equal(ndf_tilt(&a, 0.3, -0.2), STATUS_OK);
	assert_int_equal(ndf_tilt(&b, 0.3, -0.2), STATUS_OK);
	assert_int_equal(ndf_turn(&b, -35.0), STATUS_OK);
	double mean_x = 0.0, mean_y = 0.0;
	enum { COUNT = 4000 };
	for (int i = 0; i < COUNT; i++) {
		const struct vec3 m = direction(&random, 90.0);
		check_rel(ndf_D(&a, m), ndf_D(&b, m), 0, "D");
		/* The median needs no second moment: half of the normals lie on either side. */
		const struct vec3 n = ndf_sample(&a, (i + 0.5) / COUNT, fmod(0.618 * i, 1.0));
		mean_x += n.x / n.z > 0.3 ? 1.0 : -1.0;
		mean_y += n.y / n.z > -0.2 ? 1.0 : -1.0;
	}
	check_abs(mean_x / COUNT, 0.0, 0.01, "share beyond tilt_x");
	check_abs(mean_y / COUNT, 0.0, 0.01, "share beyond tilt_y");
}

struct line {
	const struct ndf *ndf;
	double phi, q;
};

static double P22_across(double t, void *data)
{
	const struct line *line = data;
	const double c = cos(line->phi), s = sin(line->phi), p = tan(t);
	return ndf_P22(line->ndf, line->q * c - p * s, line->q * s + p * c) * (1.0 + p * p);
}

static void slopes_are_those_of_D(void **state)
{
	(void)state;
	for (int i = 1; i < 5; i++) {
		const struct ellipsoid e = ellipsoid_at(i);
		const struct ndf ndf = ndf_of(&e);
		for (int j = 0; j < 12; j++) {
			struct line line = {&ndf, 0.6 * j, 0.4 * (j % 5 - 2)};
			const double sum = quadrature_adaptive(P22_across, &line, -M_PI / 2, M_PI / 2, 1e-10);
			check_rel(ndf_P2(&ndf, line.phi, line.q), sum, 1e-7, "P2");
		}
		double along, across;
		assert_int_equal(ndf_moment(&ndf, 0.0, 1, &along), STATUS_OK);
		assert_int_equal(ndf_moment(&ndf, M_PI / 2, 1, &across), STATUS_OK);
		check_abs(along, -ndf.tilt_x, 1e-13, "mean slope");
		check_abs(across, -ndf.tilt_y, 1e-13, "mean slope");
		assert_int_equal(ndf_moment(&ndf, 0.0, 2, &along), STATUS_DOMAIN);
	}
}

enum { BINS_THETA = 9, BINS_PHI = 12, BINS = BINS_THETA * BINS_PHI };

static double D_cos(const struct ellipsoid *e, struct vec3 wi, struct vec3 m)
{
	(void)wi;
	return ellipsoid_D(e, m) * m.z;
}

static double bin_integral(const struct ellipsoid *e, struct vec3 wi, int bin, bool visible)
{
	double (*const f)(const struct ellipsoid *e, struct vec3 wi, struct vec3 m) = visible ? ellipsoid_pdf : D_cos;
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(8);
	assert_non_null(table);
	double sum = 0.0;
	for (int k = 0; k < 64; k++) {
		double z, phi, w, w_phi;
		const int i = bin / BINS_PHI, j = bin % BINS_PHI;
		gsl_integration_glfixed_point((double)i / BINS_THETA, (i + 1.0) / BINS_THETA, (size_t)k / 8, &z, &w,
					      table);
		gsl_integration_glfixed_point(2.0 * M_PI * j / BINS_PHI, 2.0 * M_PI * (j + 1) / BINS_PHI, (size_t)k % 8,
					      &phi, &w_phi, table);
		const double r = sqrt(1.0 - z * z);
		sum += w * w_phi * f(e, wi, (struct vec3){r * cos(phi), r * sin(phi), z});
	}
	gsl_integration_glfixed_table_free(table);
	return sum;
}

/* Visible ones from three directions, and all. */
static void normals_follow_the_formulas(void **state)
{
	(void)state;
	enum { SAMPLES = 15000, WAYS = 4 };
	const double angles[WAYS] = {0.0, 40.0, 86.0, 0.0};
	uint64_t random = 2;
	for (int i = 1; i < 5; i++)
		for (int way = 0; way < WAYS; way++) {
			const struct ellipsoid e = ellipsoid_at(i);
			const struct ndf ndf = ndf_of(&e);
			const struct vec3 wi = vec3_from_spherical_deg(angles[way], 250.0);
			const bool visible = way < 3;
			struct sampler sampler;
			int count[BINS] = {0};
			double expected[BINS];
			assert_int_equal(sampler_init(&sampler, &ndf, visible ? SAMPLING_VISIBLE : SAMPLING_NDF),
					 STATUS_OK);
			for (int j = 0; j < SAMPLES; j++) {
				const double u1 = uniform(&random), u2 = uniform(&random);
				const struct vec3 m = sampler_sample(&sampler, wi, u1, u2);
				check_unit(m.x, m.y, m.z, "normal");
				const double turn = atan2(m.y, m.x) / (2.0 * M_PI);
				const int k = (int)fmin(m.z * BINS_THETA, BINS_THETA - 1);
				const int l = (int)fmin((turn < 0.0 ? turn + 1.0 : turn) * BINS_PHI, BINS_PHI - 1);
				count[k * BINS_PHI + l]++;
				const double pdf = visible ? ellipsoid_pdf(&e, wi, m) : ellipsoid_D(&e, m) * m.z;
				check_rel(sampler_pdf(&sampler, wi, m), pdf, 1e-10, "pdf");
			}
			for (int j = 0; j < BINS; j++)
				expected[j] = SAMPLES * bin_integral(&e, wi, j, visible);
			char label[64];
			snprintf(label, sizeof(label), "shape %d, way %d", i, way);
			check_counts(BINS, count, expected, 4 * WAYS, label);
		}
}

/* The map of the square to the visible normals increases with both numbers: vndf_cdf() inverts it, rational or not. */
static void visible_CDFs_are_the_numbers(void **state)
{
	(void)state;
	uint64_t random = 8;
	for (int i = 0; i < SHAPES; i++) {
		const struct ellipsoid e = ellipsoid_at(i);
		const struct ndf ndf = ndf_of(&e);
		for (int j = 0; j < 200; j++) {
			const struct vec3 wi = direction(&random, 89.0);
			const double u1 = uniform(&random), u2 = uniform(&random);
			double along, across;
			vndf_cdf(&ndf, wi, vndf_sample(&ndf, wi, u1, u2), &along, &across);
			/* Where most facets lean away, the CDF is none of vndf_student.h. */
			const bool away = wi.z + ndf.tilt_x * wi.x + ndf.tilt_y * wi.y < 0.0;
			assert_true(isnan(along) == away && isnan(across) == away);
			if (away)
				continue;
			check_abs(along, u1, 1e-10, "along");
			check_abs(across, u2, 1e-10, "across");
		}
		/* Of all normals there are none in closed form. */
		assert_true(isnan(ndf_cdf(&ndf, 0.5, 0.5)) == ndf_is_tilted(&ndf));
	}
}

/* Albedo by visible normals and their weights, and by directions evenly over the hemisphere. */
static void weights_give_the_albedo(void **state)
{
	(void)state;
	enum { SAMPLES = 20000 };
	uint64_t random = 21;
	for (int i = 1; i < 5; i++)
		for (enum gaf gaf = GAF_UNCORRELATED; gaf <= GAF_CORRELATED; gaf++) {
			const struct ellipsoid e = ellipsoid_at(i);
			const struct cook_torrance model = {
				.ndf = ndf_of(&e), .gaf = gaf, .fresnel = FRESNEL_NONE, .ks = {1, 1, 1}};
			const struct vec3 wi = vec3_from_spherical_deg(50.0, 20.0);
			double sum[2] = {0.0}, squares[2] = {0.0}, balance;
			for (int j = 0; j < SAMPLES; j++) {
				const double u1 = uniform(&random), u2 = uniform(&random);
				const struct vec3 m = vndf_sample(&model.ndf, wi, u1, u2);
				const double weight = vndf_weight(&model.ndf, gaf, wi, m, vndf_pdf(&model.ndf, wi, m));
				const double r = sqrt(1.0 - u1 * u1);
				const struct vec3 even = {r * cos(2.0 * M_PI * u2), r * sin(2.0 * M_PI * u2), u1};
				double f[3];
				cook_torrance_f(&model, wi, even, f);
				const double other = 2.0 * M_PI * f[0] * even.z;
				sum[0] += weight;
				squares[0] += weight * weight;
				sum[1] += other;
				squares[1] += other * other;
			}
			const double mean = sum[0] / SAMPLES, other = sum[1] / SAMPLES;
			const double variance =
				squares[0] / SAMPLES - mean * mean + squares[1] / SAMPLES - other * other;
			check_mean(mean, sqrt(variance / SAMPLES), other, "albedo");
			check_between(mean, 0.1, 1.0, "albedo");
			/* Quadrature is of level surfaces. */
			assert_int_equal(energy_furnace(&model, &balance), STATUS_UNSUPPORTED);
		}
}

static void extremes_stay_finite(void **state)
{
	(void)state;
	const double sigmas[] = {1e-50, 1e-5, 0.4, 30.0, 1e50}, tilts[] = {0.0, 1e-300, -1e-3, 7.0, 1e50};
	const double thetas[] = {0.0, 1e-9, 45.0, 89.9999999, 90.0};
	for (int a = 0; a < 25 * 5; a++) {
		struct ndf ndf;
		const double tilt = tilts[a % 5];
		assert_int_equal(ndf_init(&ndf, ndf_find("ellipsoid"), sigmas[a / 25], sigmas[a / 5 % 5], NAN),
				 STATUS_OK);
		assert_int_equal(ndf_tilt(&ndf, tilt, -0.3 * tilt), STATUS_OK);
		for (int t = 0; t < 5; t++) {
			const struct vec3 wi = vec3_from_spherical_deg(thetas[t], 130.0);
			char label[96];
			snprintf(label, sizeof(label), "sigma %g %g tilt %g theta %g", sigmas[a / 25],
				 sigmas[a / 5 % 5], tilt, thetas[t]);
			check_between(ndf_G1(&ndf, wi), 0.0, 1.0, label);
			check_between(ndf_D(&ndf, wi), 0.0, INFINITY, label);
			for (int i = 0; i < EXTREME_NUMBERS * EXTREME_NUMBERS; i++) {
				const double u1 = extreme_numbers[i / EXTREME_NUMBERS],
					     u2 = extreme_numbers[i % EXTREME_NUMBERS];
				const struct vec3 m = vndf_sample(&ndf, wi, u1, u2), n = ndf_sample(&ndf, u1, u2);
				check_unit(m.x, m.y, m.z, label);
				check_between(vec3_dot(wi, m), -0x1p-52, 1.0 + 1e-15, label);
				check_between(vndf_pdf(&ndf, wi, m), 0.0, INFINITY, label);
				check_between(n.z, 0.0, 1.0, label);
			}
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_is_the_ellipsoid),
		cmocka_unit_test(any_matrix_of_it_makes_it),
		cmocka_unit_test(level_it_is_ggx),
		cmocka_unit_test(tilt_and_turn_are_apart),
		cmocka_unit_test(slopes_are_those_of_D),
		cmocka_unit_test(normals_follow_the_formulas),
		cmocka_unit_test(visible_CDFs_are_the_numbers),
		cmocka_unit_test(weights_give_the_albedo),
		cmocka_unit_test(extremes_stay_finite),
	};
	return cmocka_run_group_tests_name("ndf_ellipsoid", tests, NULL, NULL);
}
