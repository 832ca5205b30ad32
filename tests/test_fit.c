/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whole fits of tables in memory: the parameters come back, richer models never lose, threads change nothing. */
#include "check.h"
#include "fit/search/fit.h"
#include "make_table.h"
#include "run_fit.h"
#include <omp.h>

struct material {
	const char *what, *ndf;
	double sigma, gamma, n;
};

/* Dielectrics with a diffuse part, and metals: kd 0 and a high index. */
static const struct material materials[] = {
	{"sharp plastic", "beckmann", 0.021, INFINITY, 1.47},
	{"rough metal", "beckmann", 0.37, INFINITY, 9.1},
	{"rough plastic", "ggx", 0.28, 2, 1.63},
	{"sharp metal", "ggx", 0.0133, 2, 12.3},
	{"rough plastic", "std", 0.31, 1.71, 1.52},
	{"sharp metal", "std", 0.017, 2.9, 8.7},
};

static void recovers_the_parameters(void **state)
{
	(void)state;
	for (size_t n = 0; n < sizeof materials / sizeof *materials; n += case_step(2)) {
		const struct material *m = &materials[n];
		const struct fit_options options = options_for(m->ndf);
		struct cook_torrance truth = make_model(m->ndf, m->sigma, m->gamma, m->n);
		struct fit_result r;
		struct measurement measurement;
		char label[64];

		if (m->n > 3)
			truth.kd[0] = truth.kd[1] = truth.kd[2] = 0;
		measurement = make_table(&truth, 180, BINS_NODE, 0);
		run_fit(&measurement, &options, &r);
		snprintf(label, sizeof label, "%s %s", m->what, m->ndf);
		check_between(r.error, 0, 2e-4, label);
		check_rel(r.model.ndf.sigma_x, m->sigma, 2e-3, label);
		if (ndf_has_gamma(r.model.ndf.class))
			check_rel(r.model.ndf.gamma - 1.5, m->gamma - 1.5, 5e-3, label);
		/* ks F of a metal hardly tells n from ks: only their product at normal incidence is certain. */
		const double f0 = fresnel_dielectric(1, r.model.n), want = fresnel_dielectric(1, m->n);

		for (int c = 0; c < 3; c++) {
			check_rel(r.model.ks[c] * f0, truth.ks[c] * want, 5e-3, label);
			check_abs(r.model.kd[c], truth.kd[c], 1e-3, label);
		}
		measurement_free(&measurement);
	}
}

/* Noisy measurements of something that no model is: a sum of two lobes. */
static struct measurement two_lobes(void)
{
	struct cook_torrance wide = make_model("beckmann", 0.5, INFINITY, 1.5),
			     narrow = make_model("ggx", 0.03, 2, 1.8);
	struct measurement a, b;

	narrow.kd[0] = narrow.kd[1] = narrow.kd[2] = 0;
	a = make_table(&wide, 180, BINS_NODE, 0.1);
	b = make_table(&narrow, 180, BINS_NODE, 0.3);
	for (int c = 0; c < 3; c++)
		for (size_t e = 0; e < measurement_count(&a); e++)
			a.value[c][e] += b.value[c][e];
	measurement_free(&b);
	return a;
}

static void check_same(const struct fit_result *a, const struct fit_result *b)
{
	assert_true(a->error == b->error);
	assert_true(a->lower_bound == b->lower_bound);
	assert_true(a->model.ndf.sigma_x == b->model.ndf.sigma_x);
	assert_true(a->model.ndf.gamma == b->model.ndf.gamma);
	assert_true(a->model.n == b->model.n);
	assert_memory_equal(a->model.kd, b->model.kd, sizeof a->model.kd);
	assert_memory_equal(a->model.ks, b->model.ks, sizeof a->model.ks);
	assert_memory_equal(&a->metrics, &b->metrics, sizeof a->metrics);
	assert_int_equal(a->evaluations, b->evaluations);
	assert_int_equal(a->starts_agreeing, b->starts_agreeing);
}

static void nested_models_and_threads(void **state)
{
	struct fit_options options = fit_options_default(), alone = options_for("std");
	struct fit_result r[3], again[3], std;
	struct measurement measurement = two_lobes();
	struct fit_metrics metrics;

	(void)state;
	options.threads = 1;
	run_fit(&measurement, &options, r);
	assert_true(r[0].error <= r[1].error);
	assert_true(r[0].error <= r[2].error);
	for (int n = 0; n < 3; n++) {
		assert_true(r[n].error < 1);
		/* kd and ks are the best of their shape, to 1e-7 of the table's sum, and provably. */
		check_between(r[n].error - r[n].lower_bound, -1e-8, 1.2e-7, "certified gap");
	}
	for (options.threads = 2; options.threads <= 3; options.threads++) {
		run_fit(&measurement, &options, again);
		for (int n = 0; n < 3; n++)
			check_same(&r[n], &again[n]);
	}
	/* STD asked for alone fits the nested models inside. */
	run_fit(&measurement, &alone, &std);
	check_same(&r[0], &std);
	assert_int_equal(fit_eval(&measurement, &std.model, &alone, &metrics, NULL), STATUS_OK);
	assert_memory_equal(&metrics, &std.metrics, sizeof metrics);
	measurement_free(&measurement);
}

static void options_leave_out_what_they_say(void **state)
{
	const struct cook_torrance truth = make_model("ggx", 0.2, 2, 1.5);
	struct measurement measurement = make_table(&truth, 180, BINS_NODE, 0.1);
	struct fit_options o = options_for("ggx");
	struct fit_result r, lambert, gray;

	(void)state;
	o.sigma = 0.25;
	o.ior = 1.7;
	run_fit(&measurement, &o, &r);
	check_abs(r.model.ndf.sigma_x, 0.25, 0, "fixed sigma");
	check_abs(r.model.n, 1.7, 0, "fixed ior");
	o.diffuse = false;
	run_fit(&measurement, &o, &r);
	check_abs(r.model.kd[0] + r.model.kd[1] + r.model.kd[2], 0, 0, "no diffuse");
	o.diffuse = true;
	o.gray = true;
	run_fit(&measurement, &o, &gray);
	assert_true(gray.model.kd[0] == gray.model.kd[1] && gray.model.ks[0] == gray.model.ks[2]);
	o.gray = false;
	o.specular = false;
	run_fit(&measurement, &o, &lambert);
	check_abs(lambert.model.ks[0] + lambert.model.ks[1] + lambert.model.ks[2], 0, 0, "no specular");
	assert_true(lambert.error > r.error || lambert.error > gray.error);
	/* Nothing is searched; what is left is whether kd is determined. */
	assert_in_range(lambert.evaluations, 1, 5);
	measurement_free(&measurement);
}

/* hyper-cauchy is STD with another sigma, t-family with gamma above 2 all but contains GGX, at sigmas beyond 4; random starts
 * only add to the search. */
static void the_family_of_std_ends_where_std_does(void **state)
{
	struct fit_options options = options_for("std"), more = options_for("t-family");
	struct fit_result r[4], again;
	struct measurement measurement;

	(void)state;
	measurement = two_lobes();
	options.criterion.max_theta = more.criterion.max_theta = 50;
	options.ndf[1] = ndf_find("hyper-cauchy");
	options.ndf[2] = ndf_find("ggx");
	options.ndf[3] = ndf_find("t-family");
	options.n_ndf = 4;
	run_fit(&measurement, &options, r);
	check_rel(r[1].error, r[0].error, 1e-8, "hyper-cauchy");
	check_between(r[3].error / r[2].error, 0, 1 + 4e-6, "t-family above GGX");
	more.starts = 3;
	run_fit(&measurement, &more, &again);
	assert_true(again.error <= r[3].error);
	measurement_free(&measurement);
}

/* The certificate of a table that a model meets exactly: rounding must not rule the minimum out. E of kd = pi m is computed
 * in long double. */
static void constant_tables_end_at_their_value(void **state)
{
	static const float value[][3] = {
		{1 / 1500.0F, 1.15F / 1500, 1.66F / 1500}, {0.47F, 0.3F, 0.21F}, {0.3F, 0.3F, 1e-5F}};
	struct measurement measurement;

	(void)state;
	assert_int_equal(measurement_alloc(&measurement, 180), STATUS_OK);
	for (size_t v = 0; v < sizeof value / sizeof *value; v++) {
		for (size_t e = 0; e < measurement_count(&measurement); e += 13)
			for (int c = 0; c < 3; c++)
				measurement.value[c][e] = value[v][c];
		for (int specular = 0; specular < 2; specular++) {
			struct fit_options options = options_for("beckmann");
			struct fit_result r;
			long double difference = 0, sum = 0;

			options.unbounded = true;
			options.specular = specular;
			run_fit(&measurement, &options, &r);
			for (int c = 0; c < 3; c++) {
				const double kd = M_PI * (double)value[v][c];

				difference += fabsl((long double)value[v][c] - (long double)kd / acosl(-1));
				sum += (long double)value[v][c];
			}
			check_between(r.error, 0, 2e-7, "E of a constant");
			check_between(r.lower_bound, 0, (double)(difference / sum) + 1e-9, "lower bound");
		}
	}
	measurement_free(&measurement);
}

static void can_be_cancelled(void **state)
{
	const struct cook_torrance truth = make_model("std", 0.2, 1.7, 1.5);
	struct measurement measurement = make_table(&truth, 180, BINS_NODE, 0);
	struct fit_options o = options_for("std");
	const atomic_bool cancel = true;
	struct fit_context *context;
	struct fit_result r;

	(void)state;
	o.cancel = &cancel;
	assert_int_equal(fit_context_new(&context, 180, &o), STATUS_OK);
	assert_int_equal(fit_run(context, &measurement, &o, &r, NULL), STATUS_INTERRUPTED);
	fit_context_free(context);
	measurement_free(&measurement);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(recovers_the_parameters),
		cmocka_unit_test(nested_models_and_threads),
		cmocka_unit_test(options_leave_out_what_they_say),
		cmocka_unit_test(constant_tables_end_at_their_value),
		cmocka_unit_test(can_be_cancelled),
	};
	const struct CMUnitTest long_tests[] = {cmocka_unit_test(the_family_of_std_ends_where_std_does)};
	const int failed = cmocka_run_group_tests_name("fit", tests, NULL, NULL);

	if (failed || case_step(2) > 1)
		return failed;
	return cmocka_run_group_tests_name("fit_long", long_tests, NULL, NULL);
}
