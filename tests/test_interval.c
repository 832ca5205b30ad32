/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The intervals of a fit's parameters: at their ends, fits with the parameter fixed there find E at the percentage; the truth is
 * inside; two valleys are two intervals; an end that is none of the data's is open. */
#include "check.h"
#include "make_scattered.h"
#include "run_fit.h"

static void run_intervals(const struct measurement *measurement, const struct fit_options *options, double percent,
			  struct fit_result *r)
{
	struct fit_context *context;
	struct error error = {""};

	run_fit(measurement, options, r);
	assert_int_equal(r->interval[INTERVAL_SIGMA].n, 0);
	assert_int_equal(fit_context_new(&context, measurement->n_phi_d, options), STATUS_OK);
	if (fit_intervals(context, measurement, options, percent, r, &error) != STATUS_OK)
		fail_msg("intervals: %s", error.text);
	fit_context_free(context);
}

/* E of a fit with one parameter fixed. */
static double error_with(const struct measurement *measurement, struct fit_options options,
			 enum interval_parameter parameter, double value)
{
	struct fit_result r;

	if (parameter == INTERVAL_SIGMA)
		options.sigma = value;
	else if (parameter == INTERVAL_GAMMA)
		options.gamma = value;
	else
		options.ior = value;
	run_fit(measurement, &options, &r);
	return r.error;
}

/* Both ends of an interval, by fits that know nothing of it. */
static void check_ends(const struct measurement *measurement, const struct fit_options *options,
		       const struct fit_result *r, enum interval_parameter parameter, int number, double percent)
{
	const struct interval *at = &r->interval[parameter].at[number];
	const char *name = interval_parameter_name(parameter);

	assert_true(r->interval[parameter].n > number);
	if (!at->lo_open)
		check_between(100 * (error_with(measurement, *options, parameter, at->lo) / r->error - 1),
			      0.97 * percent, 1.02 * percent, name);
	if (!at->hi_open)
		check_between(100 * (error_with(measurement, *options, parameter, at->hi) / r->error - 1),
			      0.97 * percent, 1.02 * percent, name);
}

static void fits_with_the_parameter_fixed_find_the_percentage(void **state)
{
	const struct cook_torrance m = make_model("std", 0.2, 2.5, 1.5);
	struct measurement measurement = make_sparse_table(&m, 180, BINS_NODE, 0.3, 30);
	struct fit_options options = options_for("std");
	struct fit_result r;

	(void)state;
	run_intervals(&measurement, &options, 1, &r);
	for (enum interval_parameter p = 0; p < INTERVAL_K; p++) {
		check_ends(&measurement, &options, &r, p, 0, 1);
		assert_false(r.interval[p].at[0].lo_open || r.interval[p].at[0].hi_open);
	}
	assert_int_equal(r.interval[INTERVAL_K].n, 0);
	measurement_free(&measurement);
}

static void the_fit_is_inside_and_fixed_parameters_have_none(void **state)
{
	const struct cook_torrance m = make_model("ggx", 0.3, 2, 1.6);
	struct measurement measurement = make_sparse_table(&m, 180, BINS_NODE, 0.2, 60);
	struct fit_options options = options_for("ggx");
	struct fit_result r, one;

	(void)state;
	options.ior = 1.6;
	run_intervals(&measurement, &options, 2, &r);
	assert_int_equal(r.interval[INTERVAL_IOR].n, 0);
	assert_int_equal(r.interval[INTERVAL_GAMMA].n, 0);
	assert_int_equal(r.interval[INTERVAL_SIGMA].n, 1);
	assert_true(r.interval[INTERVAL_SIGMA].at[0].lo < r.model.ndf.sigma_x);
	assert_true(r.interval[INTERVAL_SIGMA].at[0].hi > r.model.ndf.sigma_x);
	check_ends(&measurement, &options, &r, INTERVAL_SIGMA, 0, 2);
	/* The number of threads changes nothing. */
	options.threads = 1;
	run_intervals(&measurement, &options, 2, &one);
	assert_memory_equal(&r.interval[INTERVAL_SIGMA].at[0], &one.interval[INTERVAL_SIGMA].at[0], 2 * sizeof(double));
	measurement_free(&measurement);
}

/* Without a lobe in the data any sigma, gamma and n are as good. */
static void what_the_data_do_not_tell_is_open_at_both_ends(void **state)
{
	struct cook_torrance m = make_model("std", 0.3, 3, 1.6);
	struct fit_options options = options_for("std");
	struct fit_result r;

	(void)state;
	memset(m.ks, 0, sizeof m.ks);
	struct measurement measurement = make_sparse_table(&m, 180, BINS_NODE, 0.2, 60);

	run_intervals(&measurement, &options, 1, &r);
	for (enum interval_parameter p = 0; p < INTERVAL_K; p++) {
		const struct interval *at = &r.interval[p].at[0];

		assert_int_equal(r.interval[p].n, 1);
		assert_true(at->lo_open && at->hi_open);
	}
	check_rel(r.interval[INTERVAL_SIGMA].at[0].lo, FIT_SIGMA_MIN, 1e-9, "sigma_lo");
	check_rel(r.interval[INTERVAL_SIGMA].at[0].hi, FIT_SIGMA_MAX, 1e-9, "sigma_hi");
	check_rel(r.interval[INTERVAL_IOR].at[0].hi, FIT_IOR_MAX, 1e-9, "ior_hi");
	assert_true(isinf(r.interval[INTERVAL_GAMMA].at[0].hi));
	measurement_free(&measurement);
}

/* A narrow lobe on a wide one: there are two ways to fit it, with a low and with a high n, and nothing between them. */
static void two_valleys_are_two_intervals(void **state)
{
	const struct cook_torrance narrow = make_model("beckmann", 0.03, INFINITY, 1.5),
				   wide = make_model("beckmann", 0.4, INFINITY, 1.5);
	struct fit_options options = options_for("beckmann");
	struct fit_result r;

	(void)state;
	struct measurement measurement = make_sparse_table(&narrow, 180, BINS_NODE, 0, 12);
	struct measurement other = make_sparse_table(&wide, 180, BINS_NODE, 0, 12);

	for (int c = 0; c < 3; c++)
		for (size_t i = 0; i < (size_t)MERL_THETA_H * MERL_THETA_D * 180; i++)
			measurement.value[c][i] += 400.0f * other.value[c][i];
	run_intervals(&measurement, &options, 10, &r);
	for (enum interval_parameter p = 0; p < INTERVAL_K; p += INTERVAL_IOR) {
		const struct interval *at = r.interval[p].at;

		assert_int_equal(r.interval[p].n, 2);
		const bool first_is_low = at[0].hi < at[1].lo;
		const double gap = first_is_low ? sqrt(at[0].hi * at[1].lo) : sqrt(at[1].hi * at[0].lo);

		assert_true(first_is_low || at[1].hi < at[0].lo);
		assert_true(error_with(&measurement, options, p, gap) > 1.1 * r.error);
		check_ends(&measurement, &options, &r, p, 0, 10);
		check_ends(&measurement, &options, &r, p, 1, 10);
	}
	measurement_free(&measurement);
	measurement_free(&other);
}

static double error_of_axes(const struct measurement *measurement, struct fit_options options, double sigma,
			    double ratio)
{
	struct fit_result r;

	options.sigma = sigma * sqrt(ratio);
	options.sigma_y = sigma / sqrt(ratio);
	run_fit(measurement, &options, &r);
	return r.error;
}

/* Of a ratio of the axes, over all sigma: by thirds. */
static double error_of_ratio(const struct measurement *measurement, const struct fit_options *options, double sigma,
			     double ratio)
{
	double lo = sigma / 1.1, hi = sigma * 1.1;

	for (int i = 0; i < 16; i++) {
		const double a = lo + (hi - lo) / 3, b = hi - (hi - lo) / 3;

		if (error_of_axes(measurement, *options, a, ratio) < error_of_axes(measurement, *options, b, ratio))
			hi = b;
		else
			lo = a;
	}
	return error_of_axes(measurement, *options, lo, ratio);
}

static void axes_have_intervals(void **state)
{
	struct cook_torrance m = make_model("ggx", 0.25, 2, 1.5);
	struct fit_options options = options_for("ggx");
	struct fit_result r, other;

	(void)state;
	assert_int_equal(ndf_init(&m.ndf, ndf_find("ggx"), 0.3, 0.2, 2), STATUS_OK);
	assert_int_equal(ndf_turn(&m.ndf, 89.5), STATUS_OK);
	struct measurement measurement = make_scattered(&m, 1500, 0.1, 5);

	options.anisotropic = true;
	options.ior = 1.5;
	run_intervals(&measurement, &options, 1, &r);
	const double sigma = sqrt(r.model.ndf.sigma_x * r.model.ndf.sigma_y);
	const struct interval *angle = &r.interval[INTERVAL_ANGLE].at[0], *ratio = &r.interval[INTERVAL_RATIO].at[0];

	/* The ends of the angle's are next to each other, whether the fit's is 89 or -89. */
	check_between(angle->hi - angle->lo, 0.5, 20, "angle_hi - angle_lo");
	check_between(fabs(r.model.ndf.angle), 85, 90, "angle");
	assert_true(fmax(fabs(angle->lo), fabs(angle->hi)) > 90 && !angle->lo_open && !angle->hi_open);
	check_between(ratio->lo, 1, 1.5, "ratio_lo");
	check_between(ratio->hi, 1.5, 2, "ratio_hi");
	for (int e = 0; e < 2; e++) {
		struct fit_options fixed = options;

		fixed.angle = remainder(e ? angle->hi : angle->lo, 180);
		run_fit(&measurement, &fixed, &other);
		check_between(100 * (other.error / r.error - 1), 0.97, 1.03, "angle");
		check_between(
			100 * (error_of_ratio(&measurement, &options, sigma, e ? ratio->hi : ratio->lo) / r.error - 1),
			0.97, 1.03, "ratio");
	}
	measurement_free(&measurement);
}

/* Twenty shapes with noise: at so small a percentage the noise itself fills much of the interval. */
static void the_truth_is_inside(void **state)
{
	enum { TABLES = 20 };
	unsigned seed = 3;
	int inside[INTERVAL_K] = {0};

	(void)state;
	for (int n = 0; n < TABLES; n++) {
		const double sigma = 0.05 * pow(10, random_unit(&seed)), gamma = 1.6 + 4 * random_unit(&seed),
			     ior = 1.2 + random_unit(&seed);
		const double truth[INTERVAL_K] = {sigma, gamma, ior};
		const struct cook_torrance m = make_model("std", sigma, gamma, ior);
		struct measurement measurement = make_sparse_table(&m, 180, BINS_NODE, 0.4, 30);
		const struct fit_options options = options_for("std");
		struct fit_result r;

		run_intervals(&measurement, &options, 0.03, &r);
		for (enum interval_parameter p = 0; p < INTERVAL_K; p++)
			inside[p] += truth[p] >= r.interval[p].at[0].lo && truth[p] <= r.interval[p].at[0].hi;
		/* And the interval tells something. */
		check_between(r.interval[INTERVAL_SIGMA].at[0].hi / r.interval[INTERVAL_SIGMA].at[0].lo, 1, 1.2,
			      "sigma_hi/sigma_lo");
		measurement_free(&measurement);
	}
	for (enum interval_parameter p = 0; p < INTERVAL_K; p++)
		check_between(inside[p], TABLES - 1, TABLES, interval_parameter_name(p));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_fit_is_inside_and_fixed_parameters_have_none),
	};
	const struct CMUnitTest long_tests[] = {
		cmocka_unit_test(axes_have_intervals),
		cmocka_unit_test(fits_with_the_parameter_fixed_find_the_percentage),
		cmocka_unit_test(what_the_data_do_not_tell_is_open_at_both_ends),
		cmocka_unit_test(two_valleys_are_two_intervals),
		cmocka_unit_test(the_truth_is_inside),
	};
	const int failed = cmocka_run_group_tests_name("interval", tests, NULL, NULL);

	if (failed || case_step(2) > 1)
		return failed;
	return cmocka_run_group_tests_name("interval_long", long_tests, NULL, NULL);
}
