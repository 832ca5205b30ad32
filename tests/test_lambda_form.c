/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "src/lambda_form.h"
#include "src/ndf.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_sf_gamma.h>

static int handler_calls;

static void count_call(const char *reason, const char *file, int line, int code)
{
	(void)reason, (void)file, (void)line, (void)code;
	handler_calls++;
}

static struct ndf std_make(double sigma, double gamma, enum lambda_form form)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find("std"), sigma, sigma, gamma), STATUS_OK);
	assert_int_equal(ndf_set_lambda_form(&ndf, form), STATUS_OK);
	return ndf;
}

/* The direction of cot(theta) = mu. */
static struct vec3 direction(double mu)
{
	return vec3_unit((struct vec3){1.0, 0.0, mu});
}

/* Gamma(gamma-1/2) / (sqrt(pi) Gamma(gamma-1)) as the library holds it. */
static double K_of(double gamma)
{
	return std_make(1.0, gamma, LAMBDA_2F1).lambda_K;
}

static void gauss_2f1_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/hyp2f1.csv", "gamma,z,F");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const double tolerance = v[0] <= 100.0 ? 3e-14 : 2e-12;
		check_rel(lambda_form_2f1(v[0], K_of(v[0]), v[1]), v[2], tolerance, golden.label);
	}
}

/* GSL is asked inside its domain only: its handler, which by default ends the process, is never called. */
static void gsl_error_handler_is_never_called(void **state)
{
	(void)state;
	handler_calls = 0;
	for (double gamma = 1.50001; gamma <= 1e5; gamma *= 1.031) {
		for (int halves = 0; halves < 3; halves++) { /* gamma itself, and next to it integers and halves */
			const double g = halves == 0 ? gamma : fmax(2.0, floor(gamma)) + 0.5 * (halves - 1);
			if (!lambda_form_takes(LAMBDA_2F1, g))
				continue;
			const double K = K_of(g);
			for (double x = 1e-14; x < 1e14; x *= 2.3)
				check_between(lambda_form_2f1(g, K, -x), 0.0, 1.0 + 1e-13, "2F1");
		}
	}
	assert_int_equal(handler_calls, 0);
}

/* Largest relative difference of G1 from the exact form over z. */
static double worst_G1(double gamma, enum lambda_form form)
{
	const struct ndf exact = std_make(1.0, gamma, LAMBDA_EXACT), other = std_make(1.0, gamma, form);
	double worst = 0.0;
	for (double z = 1e-3; z < 1e4; z *= 1.05) {
		const double error = fabs(ndf_G1(&other, direction(z)) / ndf_G1(&exact, direction(z)) - 1.0);
		check_between(error, 0.0, 1.0, "relative difference of G1");
		check_between(ndf_G1(&other, direction(z)), 0.0, 1.0, "G1");
		worst = fmax(worst, error);
	}
	return worst;
}

static void finite_sums_match_the_exact_form(void **state)
{
	(void)state;
	const double gammas[] = {1.5001, 1.51, 1.72, 2.0, 2.2, 2.5, 3.0, 3.5, 7.5, 10.0, 11.9, 12.0, 15.0, 15.5, 39.0};
	for (int i = 0; i < 15; i++) {
		for (int form = LAMBDA_2F1; form <= LAMBDA_HALF_INTEGER; form++) {
			if (lambda_form_takes((enum lambda_form)form, gammas[i]))
				check_between(worst_G1(gammas[i], (enum lambda_form)form), 0.0,
					      form == LAMBDA_2F1 ? 2e-14 : 1.5e-13,
					      lambda_form_name((enum lambda_form)form));
		}
	}
	check_between(worst_G1(1e3, LAMBDA_2F1), 0.0, 2e-13, "2F1 at 1e3");
	check_between(worst_G1(1e5, LAMBDA_2F1), 0.0, 2e-12, "2F1 at 1e5");
}

/* The paper's approximation errs by 0.71 % at most, worst near gamma = 2.2. */
static void rational_form_errs_as_stated(void **state)
{
	(void)state;
	double worst = 0.0;
	for (double gamma = 1.5001; gamma < 1e8; gamma += 0.1 * (gamma - 1.4))
		worst = fmax(worst, worst_G1(gamma, LAMBDA_RATIONAL));
	worst = fmax(worst, worst_G1(INFINITY, LAMBDA_RATIONAL));
	check_between(worst, 0.0069, 0.0072, "largest error of the rational form");
	check_between(worst_G1(INFINITY, LAMBDA_RATIONAL), 0.0, 0.0060, "gamma = infinity");
	/* Where it would fall below 0 it is 0; far away it stops at a constant. */
	const struct ndf ndf = std_make(1.0, 2.5, LAMBDA_RATIONAL), ggx = std_make(1.0, 2.0, LAMBDA_RATIONAL);
	check_abs(ndf_lambda(&ndf, direction(5.0)), 0.0, 0.0, "clamped");
	check_between(ndf_lambda(&ggx, (struct vec3){0.0, 0.0, 1.0}), 0.006, 0.0064, "constant left over");
}

/* Table 1 of the supplement, corrected; mu, s = cot(theta), sigma. */
static double table_1(double gamma, double mu, double s)
{
	const double m2 = mu * mu, s2 = s * s;
	if (gamma == 2.0)
		return 0.5 * (sqrt(m2 + s2) / mu - 1.0);
	if (gamma == 2.5)
		return atan(sqrt(2.0 / 3.0) * mu / s) / M_PI - 0.5 + sqrt(1.5) * s / (M_PI * mu);
	if (gamma == 3.0)
		return 0.5 * ((m2 * m2 + 3.0 * m2 * s2 + 2.0 * s2 * s2) / (mu * pow(m2 + 2.0 * s2, 1.5)) - 1.0);
	if (gamma == 3.5)
		return atan(sqrt(0.4) * mu / s) / M_PI - 0.5 +
		       sqrt(2.5) * 2.0 * s * (3.0 * m2 + 5.0 * s2) / (3.0 * M_PI * mu * (2.0 * m2 + 5.0 * s2));
	if (gamma == 4.0)
		return 0.5 * ((8.0 * m2 * m2 * m2 + 60.0 * m2 * m2 * s2 + 135.0 * m2 * s2 * s2 + 81.0 * s2 * s2 * s2) /
				      (8.0 * mu * pow(m2 + 3.0 * s2, 2.5)) -
			      1.0);
	return 0.5 * (s * exp(-m2 / s2) / (mu * sqrt(M_PI)) - erfc(mu / s));
}

static void forms_match_the_closed_forms_of_table_1(void **state)
{
	(void)state;
	const double gammas[] = {2.0, 2.5, 3.0, 3.5, 4.0, INFINITY};
	for (int g = 0; g < 6; g++) {
		const struct ndf exact = std_make(0.5, gammas[g], LAMBDA_EXACT);
		for (double mu = 1e-3; mu < 3.0; mu *= 1.3) {
			const double want = table_1(gammas[g], mu, 0.5);
			const double tolerance = 2e-15 * (1.0 + want);
			check_abs(ndf_lambda(&exact, direction(mu)), want, tolerance, "Table 1, exact form");
			for (int form = LAMBDA_2F1; form <= LAMBDA_HALF_INTEGER; form++) {
				if (!lambda_form_takes((enum lambda_form)form, gammas[g]))
					continue;
				const struct ndf ndf = std_make(0.5, gammas[g], (enum lambda_form)form);
				check_abs(ndf_lambda(&ndf, direction(mu)), want, 5.0 * tolerance,
					  lambda_form_name((enum lambda_form)form));
			}
		}
	}
}

/* The paper's A1, printed as two different sums, is K/(gamma-1). */
static void printed_sums_of_A1_are_K_over_gamma_minus_1(void **state)
{
	(void)state;
	for (unsigned gamma = 2; gamma <= 15; gamma++) {
		const double factorial = gsl_sf_fact(gamma - 1);
		const double printed = gsl_sf_fact(2 * gamma - 2) / factorial / factorial * pow(0.25, gamma - 1);
		check_rel(K_of(gamma) / (gamma - 1.0), printed, 1e-14, "A1, integer");
		double sum = 0.0;
		for (unsigned k = 0; k <= gamma - 1; k++)
			sum += gsl_sf_choose(gamma - 1, k) * (k % 2 ? -1.0 : 1.0) / (2.0 * k + 1.0);
		check_rel(K_of(gamma + 0.5) / (gamma - 0.5), 2.0 / M_PI * sum, 1e-11, "A1, half-integer");
	}
}

/* Other members of the family take the forms as std with another roughness does. */
static void other_members_of_the_family_take_the_forms_as_std_does(void **state)
{
	(void)state;
	struct ndf hyper, t2;
	assert_int_equal(ndf_init(&hyper, ndf_find("hyper-cauchy"), 0.6, 0.3, 5.0), STATUS_OK);
	assert_int_equal(ndf_init(&t2, ndf_find("t-family"), 0.6, 0.3, 5.0), STATUS_OK);
	struct ndf narrow, wide;
	assert_int_equal(ndf_init(&narrow, ndf_find("std"), 0.3, 0.15, 5.0), STATUS_OK); /* 1/sqrt(4) */
	assert_int_equal(ndf_init(&wide, ndf_find("std"), 0.6 * sqrt(0.75), 0.3 * sqrt(0.75), 5.0), STATUS_OK);
	for (int form = LAMBDA_EXACT; form < LAMBDA_FORM_COUNT; form++) {
		if (form == LAMBDA_HALF_INTEGER)
			continue;
		assert_int_equal(ndf_set_lambda_form(&hyper, (enum lambda_form)form), STATUS_OK);
		assert_int_equal(ndf_set_lambda_form(&narrow, (enum lambda_form)form), STATUS_OK);
		assert_int_equal(ndf_set_lambda_form(&t2, (enum lambda_form)form), STATUS_OK);
		assert_int_equal(ndf_set_lambda_form(&wide, (enum lambda_form)form), STATUS_OK);
		for (double theta = 3.0; theta < 90.0; theta += 7.0) {
			const struct vec3 w = vec3_from_spherical_deg(theta, 33.0);
			check_rel(ndf_G1(&hyper, w), ndf_G1(&narrow, w), 2e-14, "Hyper-Cauchy");
			check_rel(ndf_G1(&t2, w), ndf_G1(&wide, w), 2e-14, "t-family");
		}
	}
}

static void forms_outside_their_domain_are_refused(void **state)
{
	(void)state;
	const struct {
		enum lambda_form form;
		double gamma;
	} bad[] = {
		{LAMBDA_2F1, 1.1e5},        {LAMBDA_2F1, INFINITY},      {LAMBDA_INTEGER, 2.5},
		{LAMBDA_INTEGER, 16.0},     {LAMBDA_INTEGER, INFINITY},  {LAMBDA_INTEGER, 3.0000000000000004},
		{LAMBDA_HALF_INTEGER, 3.0}, {LAMBDA_HALF_INTEGER, 16.5}, {LAMBDA_FORM_COUNT, 3.0},
		{LAMBDA_TRAPEZOID, 3.0},
	};
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
		struct ndf ndf = std_make(0.3, bad[i].gamma, LAMBDA_EXACT);
		const struct ndf before = ndf;
		assert_int_equal(ndf_set_lambda_form(&ndf, bad[i].form), STATUS_DOMAIN);
		assert_memory_equal(&ndf, &before, sizeof(ndf));
		assert_false(lambda_form_takes(bad[i].form, bad[i].gamma));
	}
	assert_false(lambda_form_takes(LAMBDA_EXACT, 1.5));
	assert_false(lambda_form_takes(LAMBDA_RATIONAL, NAN));
	const char *const closed[] = {"ggx", "beckmann", "gtr", "low"};
	for (int i = 0; i < 4; i++) {
		struct ndf ndf;
		assert_int_equal(ndf_init(&ndf, ndf_find(closed[i]), 0.3, 0.3, 2.0), STATUS_OK);
		assert_int_equal(ndf_set_lambda_form(&ndf, LAMBDA_RATIONAL), STATUS_UNSUPPORTED);
		assert_int_equal(ndf_set_lambda_form(&ndf, LAMBDA_EXACT), STATUS_OK);
	}
	check_abs(lambda_form_lambda(LAMBDA_EXACT, 3.0, 0.75, 1.0), NAN, 0.0, "exact is none of these");
	for (int form = LAMBDA_2F1; form < LAMBDA_FORM_COUNT; form++) {
		const double gamma = form == LAMBDA_HALF_INTEGER ? 3.5 : 3.0;
		check_abs(lambda_form_lambda((enum lambda_form)form, gamma, K_of(gamma), NAN), NAN, 0.0, "NaN in");
		const struct ndf ndf = std_make(1.0, gamma, (enum lambda_form)form);
		check_abs(ndf_lambda(&ndf, (struct vec3){1.0, 0.0, 0.0}), INFINITY, 0.0, "horizon");
		check_between(ndf_lambda(&ndf, (struct vec3){1.0, 0.0, 1e-300}), 1e299, INFINITY, "near the horizon");
		if (form != LAMBDA_RATIONAL)
			check_abs(ndf_lambda(&ndf, (struct vec3){0.0, 0.0, 1.0}), 0.0, 1e-15, "normal incidence");
	}
}

static void names_and_forms_are_inverse(void **state)
{
	(void)state;
	const char *const want[LAMBDA_FORM_COUNT] = {"exact", "2f1", "integer", "half-integer", "rational"};
	enum lambda_form found = LAMBDA_FORM_COUNT;
	for (int i = 0; i < LAMBDA_FORM_COUNT; i++) {
		assert_string_equal(lambda_form_name((enum lambda_form)i), want[i]);
		assert_int_equal(lambda_form_find(want[i], &found), STATUS_OK);
		assert_int_equal(found, i);
	}
	assert_int_equal(lambda_form_find("trapezoid", &found), STATUS_OK);
	assert_int_equal(found, LAMBDA_TRAPEZOID);
	assert_string_equal(lambda_form_name(LAMBDA_TRAPEZOID), "trapezoid");
	found = LAMBDA_RATIONAL;
	assert_int_equal(lambda_form_find("2F1", &found), STATUS_DOMAIN);
	assert_int_equal(lambda_form_find(NULL, &found), STATUS_DOMAIN);
	assert_int_equal(found, LAMBDA_RATIONAL);
	assert_string_equal(lambda_form_name(LAMBDA_FORM_COUNT), "unknown");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(gauss_2f1_matches_golden_rows),
		cmocka_unit_test(gsl_error_handler_is_never_called),
		cmocka_unit_test(finite_sums_match_the_exact_form),
		cmocka_unit_test(rational_form_errs_as_stated),
		cmocka_unit_test(forms_match_the_closed_forms_of_table_1),
		cmocka_unit_test(printed_sums_of_A1_are_K_over_gamma_minus_1),
		cmocka_unit_test(other_members_of_the_family_take_the_forms_as_std_does),
		cmocka_unit_test(forms_outside_their_domain_are_refused),
		cmocka_unit_test(names_and_forms_are_inverse),
	};
	gsl_set_error_handler(count_call);
	return cmocka_run_group_tests_name("lambda_form", tests, NULL, NULL);
}
