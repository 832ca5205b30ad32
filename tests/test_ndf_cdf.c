/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cumulative distributions: against the numbers that samplers invert, and against integrals of the densities. */
#include "check.h"
#include "chi_square.h"
#include "src/ndf_cdf.h"
#include "src/ndf_slopes.h"
#include "src/pwl.h"
#include "src/vndf.h"
#include <gsl/gsl_integration.h>

enum { NODES = 5, CASES = 12 };

static const double pl_theta[NODES] = {0, 0.2, 0.6, 1.1, M_PI_2}, pl_D[NODES] = {3, 2, 0.7, 0.3, 0.05};

/* Distributions of every class, some anisotropic and turned; the last is pl over *pwl. */
static struct ndf ndf_number(int i, const struct pwl *pwl)
{
	static const struct {
		const char *name;
		double sigma_x, sigma_y, gamma, turn;
	} cases[CASES - 1] = {
		{"std", 0.3, 0.3, 1.6, 0},      {"std", 0.7, 0.2, 2.7, 0},     {"std", 0.1, 0.9, 40, 33},
		{"ggx", 0.5, 0.1, 2, -60},      {"beckmann", 0.2, 0.6, 0, 10}, {"gtr", 0.4, 0.4, 1.3, 0},
		{"gtr", 1.7, 1.7, 0.8, 0},      {"gtr", 0.3, 0.3, 1, 0},       {"hyper-cauchy", 0.9, 0.4, 3, 0},
		{"t-family", 0.3, 0.4, 2.5, 0}, {"low", 0.6, 0.6, 1.4, 0},
	};
	struct ndf ndf;

	if (i == CASES - 1) {
		ndf_from_pwl(&ndf, pwl);
		return ndf;
	}
	assert_int_equal(ndf_init(&ndf, ndf_find(cases[i].name), cases[i].sigma_x, cases[i].sigma_y, cases[i].gamma),
			 STATUS_OK);
	if (cases[i].turn != 0)
		assert_int_equal(ndf_turn(&ndf, cases[i].turn), STATUS_OK);
	return ndf;
}

static struct pwl make_pwl(void)
{
	struct pwl pwl;

	assert_int_equal(pwl_init(&pwl, NODES, pl_theta, pl_D, NULL), STATUS_OK);
	return pwl;
}

/* The sampler turns by u1 from its own axis, and tilts by u2. */
static void cdfs_are_what_samples_invert(void **state)
{
	(void)state;
	struct pwl pwl = make_pwl();
	uint64_t seed = 1;

	for (int i = 0; i < CASES; i++) {
		const struct ndf ndf = ndf_number(i, &pwl);
		const struct vec3 start = ndf_sample(&ndf, 0, 0.5);
		const double from = ndf_cdf_phi(&ndf, atan2(start.y, start.x));
		char label[64];

		snprintf(label, sizeof label, "distribution %d", i);
		for (int n = 0; n < 500; n++) {
			const double u1 = uniform(&seed), u2 = uniform(&seed);
			const struct vec3 m = ndf_sample(&ndf, u1, u2);
			const double phi = atan2(m.y, m.x), theta = atan2(hypot(m.x, m.y), m.z);
			const double turned = ndf_cdf_phi(&ndf, phi) - from - u1;

			check_abs(turned, round(turned), 4e-15, label);
			check_abs(ndf_cdf_theta(&ndf, theta, phi), u2, 1e-14, label);
		}
		check_rel(ndf_cdf_theta(&ndf, M_PI_2, 1), 1, 1e-14, label);
		check_abs(ndf_cdf_theta(&ndf, 0, 1), 0, 0, label);
		check_rel(ndf_cdf_phi(&ndf, 2 * M_PI + 0.3) - ndf_cdf_phi(&ndf, 0.3), 1, 1e-14, label);
		check_abs(ndf_cdf_phi(&ndf, 0), 0, 0, label);
	}
	pwl_free(&pwl);
}

/* 12 points of Gauss on each of the panels of theta, 0.1 wide, that end at the kinks of pl, and on 12 of phi. */
static double integrated(const struct ndf *ndf, double theta, double phi)
{
	enum { POINTS = 12, PANELS = 36 };
	const int panels = (int)lround(theta / 0.1);
	gsl_integration_glfixed_table *rule = gsl_integration_glfixed_table_alloc(POINTS);
	double sum = 0;

	assert_non_null(rule);
	for (int i = 0; i < panels * POINTS; i++)
		for (int j = 0; j < PANELS * POINTS; j++) {
			double t, p, wt, wp;
			const int k = i / POINTS, l = j / POINTS;

			gsl_integration_glfixed_point(0.1 * k, 0.1 * (k + 1), (size_t)(i % POINTS), &t, &wt, rule);
			gsl_integration_glfixed_point(phi * l / PANELS, phi * (l + 1) / PANELS, (size_t)(j % POINTS),
						      &p, &wp, rule);
			sum += wt * wp * sin(t) * ndf_pdf(ndf, (struct vec3){sin(t) * cos(p), sin(t) * sin(p), cos(t)});
		}
	gsl_integration_glfixed_table_free(rule);
	return sum;
}

static void joint_cdf_is_the_integral_of_the_density(void **state)
{
	(void)state;
	struct pwl pwl = make_pwl();

	for (int i = 0; i < CASES; i++) {
		static const double at[][2] = {{0.4, 0.5}, {1.2, -2}, {0.9, 5.5}};
		const struct ndf ndf = ndf_number(i, &pwl);

		for (size_t k = 0; k < sizeof at / sizeof *at; k++) {
			char label[64];

			snprintf(label, sizeof label, "distribution %d, %g, %g", i, at[k][0], at[k][1]);
			check_abs(ndf_cdf(&ndf, at[k][0], at[k][1]), integrated(&ndf, at[k][0], at[k][1]),
				  1e-12 * (1 + fabs(at[k][1])), label);
		}
		check_rel(ndf_cdf(&ndf, M_PI_2, 2 * M_PI), 1, 1e-12, "whole");
		check_abs(ndf_cdf(&ndf, M_PI_2, 1.1), ndf_cdf_phi(&ndf, 1.1), 1e-12, "eq. 39 is eq. 38 at the horizon");
	}
	pwl_free(&pwl);
}

/* What was drawn by the maps without jumps stands at the numbers that drew it. */
static void visible_cdfs_are_what_samples_invert(void **state)
{
	(void)state;
	static const double angles[] = {0, 20, 70, 89.9, 90};
	uint64_t seed = 2;

	for (int i = 0; i < CASES; i++) {
		const struct ndf ndf = ndf_number(i, NULL);

		if (!vndf_supports(&ndf) || ndf_number(i, NULL).gamma > 1e10)
			continue;
		for (size_t a = 0; a < sizeof angles / sizeof *angles; a++)
			for (int n = 0; n < 300; n++) {
				const struct vec3 wi = vec3_from_spherical_deg(angles[a], 25);
				const double u1 = uniform(&seed), u2 = uniform(&seed);
				const struct vec3 m = vndf_sample(&ndf, wi, u1, u2);
				double along, across;
				char label[64];

				snprintf(label, sizeof label, "distribution %d, %g deg", i, angles[a]);
				vndf_cdf(&ndf, wi, m, &along, &across);
				check_abs(along, u1, 1e-13, label);
				check_abs(across, u2, 1e-13, label);
			}
	}
}

/* The masses of 20 x 20 rectangles of the two CDFs of Beckmann, whose map jumps, and that of a distribution without. */
static void visible_cdfs_are_uniform(void **state)
{
	(void)state;
	enum { SIDE = 20, COUNT = 40000 };
	static const double angles[] = {0, 60, 90};
	const double expected_mass = (double)COUNT / (SIDE * SIDE);
	uint64_t seed = 3;

	for (size_t a = 0; a < sizeof angles / sizeof *angles; a++) {
		const struct ndf ndf = ndf_number(4, NULL);
		const struct vec3 wi = vec3_from_spherical_deg(angles[a], -50);
		int count[SIDE * SIDE] = {0};
		double expected[SIDE * SIDE], along, across;

		for (int n = 0; n < SIDE * SIDE; n++)
			expected[n] = expected_mass;
		for (int n = 0; n < COUNT; n++) {
			const double u1 = uniform(&seed), u2 = uniform(&seed);

			vndf_cdf(&ndf, wi, vndf_sample(&ndf, wi, u1, u2), &along, &across);
			count[(int)fmin(along * SIDE, SIDE - 1) * SIDE + (int)fmin(across * SIDE, SIDE - 1)]++;
		}
		check_counts(SIDE * SIDE, count, expected, 3, "beckmann");
	}
}

/* The supplement's C_wi: G1/cos_i times the integral of the projected area over the slopes below. */
static void visible_cdf_is_the_integral_of_the_projected_area(void **state)
{
	(void)state;
	static const double gammas[] = {1.6, 2, 3.5, 20, INFINITY};

	for (size_t g = 0; g < sizeof gammas / sizeof *gammas; g++)
		for (double theta = 10; theta < 90; theta += 25) {
			const struct vec3 wi = vec3_from_spherical_deg(theta, 0);
			struct ndf ndf;
			double along, across, sum = 0;

			assert_int_equal(ndf_init(&ndf, ndf_find("std"), 1, 1, gammas[g]), STATUS_OK);
			const double p = 0.5 * wi.z / wi.x - 0.4, y = 0.3;
			/* x = p - (exp(t) - 1) */
			for (int i = 0; i < 10000; i++) {
				const double t = (i + 0.5) * 0.01, x = p - expm1(t);

				sum += (wi.z - x * wi.x) * ndf_P2(&ndf, 0, x) * exp(t) * 0.01;
			}
			vndf_cdf(&ndf, wi, vec3_unit((struct vec3){-p, -y, 1}), &along, &across);
			check_abs(along, sum * ndf_G1(&ndf, wi) / wi.z, 1e-5, "along");
			const double a = gammas[g] - 1 + p * p;
			if (gammas[g] == 2)
				check_rel(across, 0.5 + (y / sqrt(a) / (1 + y * y / a) + atan(y / sqrt(a))) / M_PI,
					  1e-13, "across, ggx");
			if (isinf(gammas[g]))
				check_rel(across, 0.5 + 0.5 * erf(y), 1e-14, "across, beckmann");
		}
	struct ndf gtr = ndf_number(5, NULL);
	double along = 0, across = 0;
	vndf_cdf(&gtr, (struct vec3){0, 0, 1}, (struct vec3){0, 0, 1}, &along, &across);
	assert_true(isnan(along) && isnan(across));
}

/* rational */

static void rational_samples_have_their_density(void **state)
{
	(void)state;
	enum { RINGS = 10, SECTORS = 12, CELLS = RINGS * SECTORS, FINE = 30, COUNT = 100000 };
	static const double angles[] = {0, 50, 80};

	for (size_t a = 0; a < sizeof angles / sizeof *angles; a++) {
		struct ndf ndf;
		const struct vec3 wi = vec3_from_spherical_deg(angles[a], 40);
		int count[CELLS] = {0};
		double expected[CELLS] = {0};
		double mean = 0, whole = 0;
		uint64_t seed = 5;

		assert_int_equal(ndf_init(&ndf, ndf_find("ggx"), 0.7, 0.5, 2), STATUS_OK);
		for (int n = 0; n < COUNT; n++) {
			const double u1 = uniform(&seed), u2 = uniform(&seed);
			const struct vec3 m = vndf_rational_sample(&ndf, wi, u1, u2),
					  true_m = vndf_sample(&ndf, wi, u1, u2);
			const double turn = 0.5 + atan2(m.y, m.x) / (2 * M_PI);

			count[(int)fmin(m.z * RINGS, RINGS - 1) * SECTORS + (int)fmin(turn * SECTORS, SECTORS - 1)]++;
			mean += fabs(vndf_rational_pdf(&ndf, wi, true_m) / vndf_pdf(&ndf, wi, true_m) - 1) / COUNT;
		}
		for (int i = 0; i < RINGS * FINE; i++)
			for (int j = 0; j < SECTORS * FINE; j++) {
				const double z = (i + 0.5) / (RINGS * FINE), s = sqrt(1 - z * z);
				const double phi = ((j + 0.5) / (SECTORS * FINE) - 0.5) * 2 * M_PI;
				const double mass =
					vndf_rational_pdf(&ndf, wi, (struct vec3){s * cos(phi), s * sin(phi), z}) * 2 *
					M_PI / (RINGS * FINE) / (SECTORS * FINE);

				expected[i / FINE * SECTORS + j / FINE] += COUNT * mass;
				whole += mass;
			}
		check_abs(whole, 1, 2e-3, "rational density");
		check_counts(CELLS, count, expected, 3, "rational");
		check_between(mean, 0.0083, 0.0085, "mean error of the fit's density");
	}
}

static void rational_is_for_ggx_alone(void **state)
{
	(void)state;
	const struct vec3 up = {0, 0, 1};
	struct ndf ndf;

	assert_int_equal(ndf_init(&ndf, ndf_find("std"), 0.4, 0.4, 2), STATUS_OK);
	assert_true(vndf_rational_supports(&ndf));
	assert_int_equal(ndf_init(&ndf, ndf_find("std"), 0.4, 0.4, 2.1), STATUS_OK);
	assert_false(vndf_rational_supports(&ndf));
	assert_true(isnan(vndf_rational_sample(&ndf, up, 0.5, 0.5).z) && isnan(vndf_rational_pdf(&ndf, up, up)));
	assert_int_equal(ndf_init(&ndf, ndf_find("gtr"), 0.4, 0.4, 2), STATUS_OK);
	assert_false(vndf_rational_supports(&ndf));
}

/* f = 1/(gamma - x), anisotropic */

static void any_x_is_anisotropic(void **state)
{
	(void)state;
	static const double values[][5] = {
		/* sigma_x, sigma_y, gamma, x, azimuth */
		{0.3, 0.7, 2.5, 0, 20},
		{0.5, 0.1, 3, -4, 75},
		{0.2, 0.2, 1.7, 1.5, 130},
		{0.9, 0.4, 6, 5.5, 45},
	};

	for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
		const double sx = values[i][0], sy = values[i][1], C = values[i][2], x = values[i][3], f = 1 / (C - x);
		const double own[3] = {sx, C, x};
		struct ndf ndf, std;

		assert_int_equal(ndf_init_params_anisotropic(&ndf, ndf_find("t-family"), own, sy), STATUS_OK);
		for (double theta = 5; theta < 90; theta += 10) {
			const struct vec3 m = vec3_from_spherical_deg(theta, values[i][4]);
			const double A = pow(m.x / sx, 2) + pow(m.y / sy, 2), cos2 = m.z * m.z;

			/* Eq. 10 of the supplement. */
			check_rel(ndf_D(&ndf, m),
				  (C - 1) * f / (M_PI * sx * sy * cos2 * cos2 * pow(1 + f * A / cos2, C)), 1e-13, "D");
			/* Std of the roughness that has the same B. */
			const double s =
				hypot(sx * cos(values[i][4] * M_PI / 180), sy * sin(values[i][4] * M_PI / 180));
			assert_int_equal(
				ndf_init(&std, ndf_find("std"), s / sqrt(f * (C - 1)), s / sqrt(f * (C - 1)), C),
				STATUS_OK);
			check_rel(ndf_lambda(&ndf, m), ndf_lambda(&std, m), 1e-12, "Lambda");
		}
		check_rel(ndf_cdf(&ndf, M_PI_2, 2 * M_PI), 1, 1e-12, "normalisation");
		check_abs(integrated(&ndf, 1.4, 2), ndf_cdf(&ndf, 1.4, 2), 3e-12, "CDF");
	}
	const double own[3] = {0.3, 2.5, 2}, low[2] = {20, 1};
	struct ndf ndf;
	assert_int_equal(ndf_init_params_anisotropic(&ndf, ndf_find("t-family"), own, 0), STATUS_DOMAIN);
	assert_int_equal(ndf_init_params_anisotropic(&ndf, ndf_find("t-family"), own, NAN), STATUS_DOMAIN);
	assert_int_equal(ndf_init_params_anisotropic(&ndf, ndf_find("low"), low, 0.3), STATUS_DOMAIN);
	assert_int_equal(ndf_init_params_anisotropic(&ndf, NULL, low, 0.3), STATUS_DOMAIN);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cdfs_are_what_samples_invert),
		cmocka_unit_test(joint_cdf_is_the_integral_of_the_density),
		cmocka_unit_test(visible_cdfs_are_what_samples_invert),
		cmocka_unit_test(visible_cdfs_are_uniform),
		cmocka_unit_test(visible_cdf_is_the_integral_of_the_projected_area),
		cmocka_unit_test(rational_samples_have_their_density),
		cmocka_unit_test(rational_is_for_ggx_alone),
		cmocka_unit_test(any_x_is_anisotropic),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
