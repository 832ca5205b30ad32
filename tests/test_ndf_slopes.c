/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "src/ndf_slopes.h"
#include "src/pwl.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>

/* The general family's (B, C) as Hyper-Cauchy, B = 1/sigma^2. */
static struct ndf family_make(double B, double C)
{
	struct ndf ndf;
	const double params[] = {1.0 / sqrt(B), C};
	assert_int_equal(ndf_init_params(&ndf, ndf_find("hyper-cauchy"), params), STATUS_OK);
	return ndf;
}

static struct ndf ndf_make(const char *name, double sigma_x, double sigma_y, double gamma)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find(name), sigma_x, sigma_y, gamma), STATUS_OK);
	return ndf;
}

/* sigma carries the rounding of 1/sqrt(B), which the power C multiplies. */
static void family_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/general_family.csv", "B,C,theta_deg,q,D,P2,Lambda,G1");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = family_make(v[0], v[1]);
		const struct vec3 w = vec3_from_spherical_deg(v[2], 0.0);
		const double tolerance = 2e-15 * (1.0 + v[1]);
		if (v[4] > 0.0)
			check_rel(ndf_D(&ndf, w), v[4], tolerance, golden.label);
		else
			check_between(ndf_D(&ndf, w), 0.0, 1e-300, golden.label);
		check_rel(ndf_P2(&ndf, 0.7, v[3]), v[5], tolerance, golden.label);
		if (v[6] > 0.0)
			check_rel(ndf_lambda(&ndf, w), v[6], tolerance, golden.label);
		else
			check_between(ndf_lambda(&ndf, w), 0.0, 1e-300, golden.label);
		check_rel(ndf_G1(&ndf, w), v[7], 2e-15, golden.label);
	}
}

static void P2_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/p2.csv", "gamma,sigma,q,P2");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make("std", v[1], v[1], v[0]);
		if (v[3] == 0.0) /* below 1e-300 */
			check_between(ndf_P2(&ndf, 0.0, v[2]), 0.0, 1e-300, golden.label);
		else
			check_rel(ndf_P2(&ndf, 0.0, v[2]), v[3], 2e-15 + 1e-15 * fabs(log(v[3] * v[1])), golden.label);
	}
}

static void moments_match_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/moments.csv", "B,C,nu0,nu2,nu4,nu6,nu8,excess_kurtosis");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = family_make(v[0], v[1]);
		for (int k = 0; k <= 4; k++) {
			double moment = NAN;
			const enum status status = ndf_moment(&ndf, 1.1, 2 * k, &moment);
			assert_int_equal(status, isnan(v[2 + k]) ? STATUS_DOMAIN : STATUS_OK);
			check_rel(moment, v[2 + k], 1e-15 * (1.0 + 2.0 * k), golden.label);
		}
		double kurtosis = NAN;
		const enum status status = ndf_excess_kurtosis(&ndf, &kurtosis);
		assert_int_equal(status, isnan(v[7]) ? STATUS_DOMAIN : STATUS_OK);
		check_rel(kurtosis, v[7], 1e-15, golden.label);
	}
}

static void gtr_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/gtr_D.csv", "gamma,sigma,theta_deg,D");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make("gtr", v[1], v[1], v[0]);
		check_rel(ndf_D(&ndf, vec3_from_spherical_deg(v[2], 40.0)), v[3], 2e-15 + 1e-15 * v[0], golden.label);
	}
}

static const struct {
	const char *name;
	double gamma;
} rows[] = {
	{"std", 1.6},      {"std", 2.7},          {"std", 41.0},         {"ggx", 2.0},      {"beckmann", INFINITY},
	{"std", INFINITY}, {"hyper-cauchy", 1.6}, {"hyper-cauchy", 5.3}, {"t-family", 2.1}, {"t-family", 8.0},
	{"gtr", 0.6},      {"gtr", 1.0},          {"gtr", 4.2},          {"low", 0.4},      {"low", 1.0},
	{"low", 2.0},      {"low", 9.1},
};

/* Calls check(&ndf) for every row, oval where it can be. */
static void for_all(void (*check)(const struct ndf *ndf))
{
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		const double sigma_y = ndf_has_anisotropy(ndf_find(rows[i].name)) ? 0.23 : 0.71;
		const struct ndf ndf = ndf_make(rows[i].name, 0.71, sigma_y, rows[i].gamma);
		check(&ndf);
	}
}

struct line {
	const struct ndf *ndf;
	double phi, along;
};

/* P22 at `along` in the direction phi and r across it. */
static double across(double r, void *params)
{
	const struct line *l = params;
	return ndf_P22(l->ndf, l->along * cos(l->phi) - r * sin(l->phi), l->along * sin(l->phi) + r * cos(l->phi));
}

static void check_P2(const struct ndf *ndf)
{
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(300);
	for (double phi = 0.0; phi < 2.0; phi += 0.8) {
		for (double q = 0.0; q < 3.0; q = 2.0 * q + 0.07) {
			struct line line = {ndf, phi, q};
			gsl_function f = {across, &line};
			double sum = NAN, error;
			gsl_integration_qagi(&f, 0.0, 1e-11, 300, workspace, &sum, &error);
			check_rel(ndf_P2(ndf, phi, q), sum, 1e-10, ndf_name(ndf->class));
			check_rel(ndf_P2(ndf, phi, -q), ndf_P2(ndf, phi, q), 0.0, "even");
		}
	}
	gsl_integration_workspace_free(workspace);
}

/* Piecewise linear, with a kink at each node: against sums over the pieces between them. */
static void P2_of_pl_is_the_integral_of_P22(void **state)
{
	enum { NODES = 13 };
	static const double value[NODES] = {9, 7, 8, 3, 2, 2.5, 1, 0.4, 0.5, 0.1, 0.02, 0.3, 0.2};
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(300);
	double theta[NODES], all = 0;
	struct pwl pwl;
	struct ndf ndf;

	(void)state;
	for (int i = 0; i < NODES; i++)
		theta[i] = 0.5 * M_PI * i / (NODES - 1);
	assert_int_equal(pwl_init(&pwl, NODES, theta, value, NULL), STATUS_OK);
	ndf_from_pwl(&ndf, &pwl);
	for (double q = 0; q < 40; q = 1.7 * q + 0.07) {
		struct line line = {&ndf, 0.3, q};
		gsl_function f = {across, &line};
		double sum = 0, part, error, low = 0;

		for (int i = 1; i < NODES - 1; i++) {
			const double t = tan(theta[i]), high = t > q ? sqrt((t - q) * (t + q)) : 0;

			if (high > low) {
				gsl_integration_qag(&f, low, high, 0, 1e-13, 300, GSL_INTEG_GAUSS31, workspace, &part,
						    &error);
				sum += part;
				low = high;
			}
		}
		gsl_integration_qagiu(&f, low, 0, 1e-12, 300, workspace, &part, &error);
		check_rel(ndf_P2(&ndf, 0.3, q), 2 * (sum + part), 1e-11, "P2 of pl");
		check_rel(ndf_P2(&ndf, 1, -q), ndf_P2(&ndf, 0.3, q), 0, "even, the same all round");
	}
	/* With q = tan a. */
	for (int i = 0; i < 4000; i++) {
		const double a = (i + 0.5) * (M_PI / 2) / 4000;

		all += 2 * ndf_P2(&ndf, 0, tan(a)) / (cos(a) * cos(a)) * (M_PI / 2) / 4000;
	}
	check_rel(all, 1, 1e-6, "integral of P2");
	assert_true(ndf_P2(&ndf, 0, INFINITY) == 0 && isnan(ndf_P2(&ndf, 0, NAN)));
	pwl_free(&pwl);
	gsl_integration_workspace_free(workspace);
}

static void P2_is_the_integral_of_P22(void **state)
{
	(void)state;
	for_all(check_P2);
}

static double power_times_P2(double q, void *params)
{
	const struct line *l = params;
	return 2.0 * pow(q, l->along) * ndf_P2(l->ndf, l->phi, q);
}

/* Moments against the integral of q^order P2, where it converges fast enough; the total is always 1. */
static void check_moments(const struct ndf *ndf)
{
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(300);
	for (int order = 0; order <= 6; order += 2) {
		double moment = NAN, sum = NAN, error;
		struct line line = {ndf, 0.9, order};
		if (ndf_moment(ndf, 0.9, order, &moment) != STATUS_OK)
			break;
		gsl_function f = {power_times_P2, &line};
		gsl_integration_qagiu(&f, 0.0, 0.0, 1e-9, 300, workspace, &sum, &error);
		check_rel(moment, sum, 1e-7, ndf_name(ndf->class));
	}
	gsl_integration_workspace_free(workspace);
}

static void moments_are_integrals_of_P2(void **state)
{
	(void)state;
	for_all(check_moments);
}

static void moments_at_the_edges_are_their_limits(void **state)
{
	(void)state;
	const struct ndf t3 = ndf_make("t-family", 0.4, 0.2, 3.0), gaussian = ndf_make("beckmann", 0.4, 0.4, NAN);
	double x = 7.0;
	assert_int_equal(ndf_moment(&t3, 0.0, 2, &x), STATUS_OK);
	check_rel(x, 0.08, 1e-15, "variance sigma^2/2");
	assert_int_equal(ndf_moment(&t3, M_PI / 2.0, 2, &x), STATUS_OK);
	check_rel(x, 0.02, 1e-15, "variance across");
	assert_int_equal(ndf_moment(&t3, 0.0, 3, &x), STATUS_OK);
	check_abs(x, 0.0, 0.0, "odd moment");
	x = 7.0;
	assert_int_equal(ndf_moment(&t3, 0.0, 4, &x), STATUS_DOMAIN);
	assert_int_equal(ndf_moment(&t3, 0.0, -2, &x), STATUS_DOMAIN);
	assert_int_equal(ndf_excess_kurtosis(&t3, &x), STATUS_DOMAIN);
	const char *const flat[] = {"gtr", "low"};
	for (int i = 0; i < 2; i++) { /* a D that is finite at the horizon has no variance of slopes */
		const struct ndf ndf = ndf_make(flat[i], 0.4, 0.4, 9.0);
		assert_int_equal(ndf_moment(&ndf, 0.0, 2, &x), STATUS_DOMAIN);
		assert_int_equal(ndf_excess_kurtosis(&ndf, &x), STATUS_DOMAIN);
	}
	check_abs(x, 7.0, 0.0, "untouched");
	assert_int_equal(ndf_excess_kurtosis(&gaussian, &x), STATUS_OK);
	check_abs(x, 0.0, 0.0, "Gaussian kurtosis");
	assert_int_equal(ndf_moment(&gaussian, 0.3, 4, &x), STATUS_OK);
	check_rel(x, 3.0 * 0.08 * 0.08, 1e-14, "Gaussian fourth moment");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(family_matches_golden_rows),  cmocka_unit_test(P2_matches_golden_rows),
		cmocka_unit_test(moments_match_golden_rows),   cmocka_unit_test(gtr_matches_golden_rows),
		cmocka_unit_test(P2_is_the_integral_of_P22),   cmocka_unit_test(P2_of_pl_is_the_integral_of_P22),
		cmocka_unit_test(moments_are_integrals_of_P2), cmocka_unit_test(moments_at_the_edges_are_their_limits),
	};
	gsl_set_error_handler_off();
	return cmocka_run_group_tests_name("ndf_slopes", tests, NULL, NULL);
}
