/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits of scattered entries: known parameters come back, isotropic and with axes, and richer models never lose. */
#include "check.h"
#include "fit/error/sample_set.h"
#include "fit/search/fit.h"
#include "fit/search/options_check.h"
#include "fit/search/within.h"
#include "make_scattered.h"

/* Whether this is `make check-long`; `make check` is to be short. */
static bool is_long(void)
{
	return case_step(2) == 1;
}

static struct cook_torrance anisotropic_model(void)
{
	struct cook_torrance model = make_model("std", 0.2, 2.5, 1.5);

	if (ndf_init(&model.ndf, ndf_find("std"), 0.3, 0.1, 2.5) != STATUS_OK || ndf_turn(&model.ndf, 20) != STATUS_OK)
		abort();
	return model;
}

static struct fit_options options_for(const char *ndf, bool anisotropic)
{
	struct fit_options o = fit_options_default();

	o.threads = 2;
	o.anisotropic = anisotropic;
	if (ndf) {
		o.n_ndf = 1;
		o.ndf[0] = ndf_find(ndf);
	}
	return o;
}

static void run(const struct measurement *measurement, const struct fit_options *options, struct fit_result results[])
{
	struct fit_context *context;
	struct error error = {""};

	assert_int_equal(fit_context_new(&context, measurement->n_phi_d, options), STATUS_OK);
	if (fit_run(context, measurement, options, results, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	fit_context_free(context);
}

/* One channel: gray, the same value three times. */
static void make_gray(struct measurement *measurement)
{
	struct scattered *s = measurement->scattered;

	s->gray = true;
	for (size_t n = 0; n < s->n; n++)
		s->value[1][n] = s->value[2][n] = s->value[0][n];
}

static void isotropic_parameters_come_back(void **state)
{
	const struct cook_torrance truth = make_model("std", 0.2, 2.5, 1.5);
	const struct fit_options options = options_for(NULL, false);
	struct measurement measurement = make_scattered(&truth, 20000, 0.05, 3);
	struct fit_result r[3];

	(void)state;
	make_gray(&measurement);
	run(&measurement, &options, r);
	/* The mean of |normal deviate| is 0.8, and so E 0.05 of it. */
	check_rel(r[0].error, 0.04, 0.03, "E");
	check_rel(r[0].model.ndf.sigma_x, 0.2, 0.02, "sigma");
	check_rel(r[0].model.ndf.gamma, 2.5, 0.02, "gamma");
	check_rel(r[0].model.n, 1.5, 0.02, "n");
	check_rel(r[0].model.kd[0], truth.kd[0], 0.02, "kd");
	assert_true(r[0].model.kd[0] == r[0].model.kd[2] && r[0].model.ks[0] == r[0].model.ks[1]);
	assert_true(isnan(r[0].error_isotropic));
	for (int n = 0; n < 3; n++) {
		assert_true(r[0].error <= r[n].error);
		/* ks is a float to the kernel; of so many entries, tables give the lobe. */
		assert_true(r[n].lower_bound <= r[n].error * (1 + 1e-6) && r[n].error <= r[n].lower_bound * (1 + 2e-6));
		assert_int_equal(r[n].metrics.samples, 3 * 20000);
	}
	measurement_free(&measurement);
}

static void parameters_with_axes_come_back(void **state)
{
	const struct cook_torrance truth = anisotropic_model();
	const struct fit_options options = options_for(is_long() ? NULL : "ggx", true);
	struct measurement measurement = make_scattered(&truth, is_long() ? 50000 : 2000, 0.05, 3);
	struct fit_result r[3];

	(void)state;
	run(&measurement, &options, r);
	for (int n = 0; n < options.n_ndf; n++) {
		const char *name = ndf_name(r[n].model.ndf.class);

		assert_true(r[n].error <= r[n].error_isotropic);
		assert_true(r[0].error <= r[n].error);
		check_between(r[n].error_isotropic, 0.2, 0.3, name);
		check_abs(r[n].model.ndf.angle, 20, is_long() ? 0.2 : 1, name);
		assert_int_equal(r[n].undetermined & BOUND_ANGLE, 0);
	}
	if (is_long()) {
		check_rel(r[0].model.ndf.sigma_x, 0.3, 0.02, "sigma_x");
		check_rel(r[0].model.ndf.sigma_y, 0.1, 0.02, "sigma_y");
		check_rel(r[0].model.ndf.gamma, 2.5, 0.02, "gamma");
		check_rel(r[0].model.n, 1.5, 0.02, "n");
		for (int c = 0; c < 3; c++) {
			check_rel(r[0].model.kd[c], truth.kd[c], 0.02, "kd");
			check_rel(r[0].model.ks[c], truth.ks[c], 0.02, "ks");
		}
	} else {
		/* GGX is another tail. */
		check_rel(r[0].model.ndf.sigma_x / r[0].model.ndf.sigma_y, 3, 0.1, "ratio");
	}
	measurement_free(&measurement);
}

/* Fixed roughnesses stay to the last bit; a fixed angle keeps its name. */
static void what_is_fixed_stays(void **state)
{
	const struct cook_torrance truth = anisotropic_model();
	struct fit_options options = options_for("ggx", true);
	struct measurement measurement = make_scattered(&truth, 2000, 0.05, 5);
	struct fit_result r;

	(void)state;
	options.sigma = 0.3;
	options.sigma_y = 0.1;
	run(&measurement, &options, &r);
	assert_true(r.model.ndf.sigma_x == 0.3 && r.model.ndf.sigma_y == 0.1 && isnan(r.error_isotropic));
	check_abs(r.model.ndf.angle, 20, 1, "angle");
	options.sigma = options.sigma_y = NAN;
	options.angle = 110; /* the axis of the smaller one */
	run(&measurement, &options, &r);
	check_abs(r.model.ndf.angle, -70, 1e-9, "angle");
	check_rel(r.model.ndf.sigma_y / r.model.ndf.sigma_x, 3, 0.15, "ratio");
	measurement_free(&measurement);
}

/* An isotropic sample: E is no higher with axes, of which the angle is then open. */
static void axes_of_an_isotropic_sample(void **state)
{
	const struct cook_torrance truth = make_model("ggx", 0.2, 2, 1.5);
	const struct fit_options options = options_for("ggx", true);
	struct measurement measurement = make_scattered(&truth, 2000, 0.01, 9);
	struct fit_result r;

	(void)state;
	run(&measurement, &options, &r);
	assert_true(r.error <= r.error_isotropic);
	check_rel(r.model.ndf.sigma_x / r.model.ndf.sigma_y, 1, 0.02, "ratio");
	measurement_free(&measurement);
}

/* A goniometer: both directions in the plane of incidence, one channel. */
static struct measurement in_plane(const struct cook_torrance *model)
{
	struct measurement measurement = make_scattered(model, 1400, 0, 1);
	unsigned seed = 4;

	for (size_t n = 0; n < 1400; n++) {
		struct scattered *s = measurement.scattered;
		const double theta_o = -80 + 160.0 * (double)(n % 200) / 199;
		double f[3];

		s->wi[n] = vec3_from_spherical_deg(10.0 * (double)(n / 200) + 1, 0);
		s->wo[n] = vec3_from_spherical_deg(fabs(theta_o), theta_o < 0 ? 180 : 0);
		cook_torrance_f(model, s->wi[n], s->wo[n], f);
		for (int c = 0; c < 3; c++)
			s->value[c][n] = (float)(f[0] * (1 + 0.02 * random_normal(&seed)));
	}
	make_gray(&measurement);
	return measurement;
}

static void same_bits(const struct fit_result *a, const struct fit_result *b)
{
	assert_true(a->error == b->error && a->lower_bound == b->lower_bound);
	assert_true(a->model.ndf.sigma_x == b->model.ndf.sigma_x && a->model.ndf.gamma == b->model.ndf.gamma);
	assert_true(a->model.n == b->model.n && a->evaluations == b->evaluations);
	assert_memory_equal(a->model.ks, b->model.ks, sizeof a->model.ks);
	assert_int_equal(a->undetermined, b->undetermined);
}

static void few_entries_of_a_goniometer(void **state)
{
	const struct cook_torrance truth = make_model("ggx", 0.15, 2, 1.6);
	struct fit_options options = options_for("ggx", false);
	struct measurement measurement = in_plane(&truth);
	struct fit_result two, one;

	(void)state;
	run(&measurement, &options, &two);
	check_rel(two.model.ndf.sigma_x, 0.15, 0.02, "sigma");
	check_between(two.error, 0.01, 0.02, "E");
	/* So few are exact: what the search minimised is what the metrics say, to the 1e-7 that a certificate may leave. */
	check_abs(two.lower_bound, two.error, 1.2e-7, "certificate");
	options.threads = 1;
	run(&measurement, &options, &one);
	same_bits(&one, &two);
	measurement_free(&measurement);
}

/* Noise of few entries leaves local minima along the valley of gamma and n: no shape in it is much better. */
static void few_noisy_entries_do_not_end_half_way_along_the_valley(void **state)
{
	const struct cook_torrance truth = make_model("std", 0.15, 1.7, 1.5);
	struct fit_options options = options_for("std", false);
	struct measurement measurement = make_scattered(&truth, 300, 0.3, 10);
	struct fit_result r, other;

	(void)state;
	run(&measurement, &options, &r);
	for (int n = -3; n <= 3; n++) {
		options.ior = r.model.n * (1 + 0.01 * n);
		run(&measurement, &options, &other);
		check_between(other.error / r.error, 1 - 3e-4, 1.1, "E of another n");
	}
	measurement_free(&measurement);
}

static void a_table_is_isotropic(void **state)
{
	const struct cook_torrance truth = anisotropic_model();
	struct fit_options options = options_for("ggx", true);
	struct fit_context *context;
	struct fit_result r;
	struct fit_metrics metrics;
	struct error error;
	struct measurement measurement;

	(void)state;
	assert_int_equal(measurement_alloc(&measurement, 180), STATUS_OK);
	assert_int_equal(fit_context_new(&context, 180, &options), STATUS_OK);
	assert_int_equal(fit_run(context, &measurement, &options, &r, &error), STATUS_DOMAIN);
	assert_non_null(strstr(error.text, "isotropic"));
	assert_int_equal(fit_eval(&measurement, &truth, &options, &metrics, &error), STATUS_DOMAIN);
	assert_non_null(strstr(error.text, "isotropic"));
	fit_context_free(context);
	measurement_free(&measurement);
}

static void what_makes_no_anisotropic_fit(void **state)
{
	struct fit_options o = options_for("gtr", true);
	struct error error;

	(void)state;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_ANISOTROPIC);
	assert_non_null(strstr(error.text, "gtr has one roughness"));
	o = options_for("ggx", true);
	o.sigma = 0.2;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_ANISOTROPIC);
	o.sigma_y = 0.1;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_KEPT);
	o.sigma_y = 1e-3;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_ANISOTROPIC);
	o = options_for("ggx", false);
	o.angle = 10;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_ANISOTROPIC);
	o = options_for("ggx", true);
	o.specular = false;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_ANISOTROPIC);
	o = options_for("ggx", true);
	o.angle = INFINITY;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RANGE);
}

/* Axes are one of the things that a material may do without. */
static void within_drops_axes(void **state)
{
	const struct cook_torrance isotropic = make_model("ggx", 0.2, 2, 1.5), truth = anisotropic_model();
	const struct fit_options options = options_for("ggx", true);
	struct measurement with = make_scattered(&truth, 1500, 0.05, 5),
			   without = make_scattered(&isotropic, 1500, 0.05, 5);
	struct fit_context *context;
	struct fit_options chosen;
	struct fit_result r;
	struct error error;

	(void)state;
	assert_int_equal(fit_context_new(&context, 0, &options), STATUS_OK);
	assert_int_equal(within_run(context, &with, &options, WITHIN_BURLEY | WITHIN_F82 | WITHIN_TWO_LOBES, 5, &chosen,
				    &r, &error),
			 STATUS_OK);
	assert_true(chosen.anisotropic);
	assert_int_equal(within_run(context, &without, &options, WITHIN_BURLEY | WITHIN_F82 | WITHIN_TWO_LOBES, 5,
				    &chosen, &r, &error),
			 STATUS_OK);
	assert_false(chosen.anisotropic);
	fit_context_free(context);
	measurement_free(&with);
	measurement_free(&without);
}

static void a_table_of_nodes_is_below_std(void **state)
{
	const struct cook_torrance truth = make_model("std", 0.2, 2.5, 1.5);
	const struct fit_options options = options_for("std", false), nodes = options_for("pl", false);
	struct measurement measurement = make_scattered(&truth, 1500, 0.05, 5);
	struct fit_result std, pl;

	(void)state;
	run(&measurement, &options, &std);
	run(&measurement, &nodes, &pl);
	check_between(pl.error / std.error, 0.9, 1, "pl/std");
	fit_result_free(&pl);
	measurement_free(&measurement);
}

/* How many values of the sample set are no normal floats: arithmetic on them is a hundred times slower. */
static size_t denormal_values(const struct measurement *measurement, const struct fit_options *options)
{
	struct geometry geometry;
	struct sample_set set;
	size_t count = 0;

	assert_int_equal(geometry_init(&geometry, measurement->n_phi_d, options), STATUS_OK);
	assert_int_equal(sample_set_init(&set, &geometry, measurement, 1), STATUS_OK);
	for (size_t v = 0; v < (size_t)set.n_blocks * MERL_CHANNELS * KERNEL_BLOCK; v++)
		count += set.value[v] != 0 && !isnormal(set.value[v]);
	sample_set_free(&set);
	geometry_free(&geometry);
	return count;
}

/* Values near the least normal float: in a unit of their own they cost what others cost, and end where they do. */
static void faint_values_are_fitted_in_a_unit_of_their_own(void **state)
{
	const struct cook_torrance truth = make_model("ggx", 0.2, 2, 1.5);
	struct fit_options options = options_for("ggx", false);
	struct measurement measurement = make_scattered(&truth, 20000, 0.05, 5);
	struct fit_result r, same;

	(void)state;
	options.ior = 1.5;
	options.criterion.weight = WEIGHT_SOLID_ANGLE; /* denormal products */
	run(&measurement, &options, &r);
	for (size_t n = 0; n < measurement.scattered->n; n++)
		for (int c = 0; c < MERL_CHANNELS; c++)
			measurement.scattered->value[c][n] *= 0x1p-120F;
	assert_int_equal(denormal_values(&measurement, &options), 0);
	run(&measurement, &options, &same);
	check_rel(same.error, r.error, 1e-6, "E of faint values");
	check_rel(same.model.kd[0] * 0x1p120, r.model.kd[0], 1e-3, "their kd");
	check_rel(same.model.ks[0] * 0x1p120, r.model.ks[0], 1e-3, "their ks");
	measurement_free(&measurement);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(parameters_with_axes_come_back),
		cmocka_unit_test(few_entries_of_a_goniometer),
		cmocka_unit_test(a_table_is_isotropic),
		cmocka_unit_test(what_makes_no_anisotropic_fit),
		cmocka_unit_test(faint_values_are_fitted_in_a_unit_of_their_own),
	};
	const struct CMUnitTest long_tests[] = {
		cmocka_unit_test(isotropic_parameters_come_back),
		cmocka_unit_test(what_is_fixed_stays),
		cmocka_unit_test(axes_of_an_isotropic_sample),
		cmocka_unit_test(within_drops_axes),
		cmocka_unit_test(a_table_of_nodes_is_below_std),
		cmocka_unit_test(few_noisy_entries_do_not_end_half_way_along_the_valley),
	};
	const int failed = cmocka_run_group_tests_name("scattered_fit", tests, NULL, NULL);

	if (failed || !is_long())
		return failed;
	return cmocka_run_group_tests_name("scattered_fit_long", long_tests, NULL, NULL);
}
