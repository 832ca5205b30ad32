/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Metals: published indices come back from measurements of models with them, and what does not determine them is told. */
#include "fit/results/result.h"
#include "fit/search/options_check.h"
#include "make_scattered.h"
#include "run_fit.h"

/* n + i k at 650, 550 and 450 nm, between the nearest values of Johnson and Christy 1972, "Optical constants of the noble metals",
 * as refractiveindex.info has them. */
static const struct metal {
	const char *name;
	double n[3], k[3];
} metals[] = {{"silver", {0.0522, 0.0596, 0.0402}, {4.4094, 3.5974, 2.6484}},
	      {"gold", {0.1556, 0.4241, 1.3831}, {3.6024, 2.4721, 1.9155}},
	      {"copper", {0.2378, 1.0066, 1.2404}, {3.6264, 2.5823, 2.3929}}};
enum { METALS = sizeof metals / sizeof *metals };

static struct cook_torrance metal_of(const struct metal *metal, int channel)
{
	struct cook_torrance model = make_model("ggx", 0.2, 2, metal->n[channel]);

	model.fresnel = FRESNEL_CONDUCTOR;
	model.k = metal->k[channel];
	for (int c = 0; c < 3; c++) {
		model.kd[c] = 0;
		model.ks[c] = 0.9;
	}
	return model;
}

static struct fit_options options_of_metal(const char *ndf)
{
	struct fit_options o = options_for(ndf);

	o.fresnel = FRESNEL_CONDUCTOR;
	return o;
}

static void check_index(const char *name, double n, double k, double want_n, double want_k)
{
	check_rel(n, want_n, 0.01, name);
	check_rel(k, want_k, 0.01, name);
}

static void published_indices_come_back(void **state)
{
	(void)state;
	for (size_t m = 0; m < METALS; m += case_step(METALS))
		for (int c = 0; c < 3; c += (int)case_step(3)) {
			const struct cook_torrance truth = metal_of(&metals[m], c);
			struct measurement measurement = make_scattered(&truth, 3000, 0, 5);
			const struct fit_options o = options_of_metal("ggx");
			struct fit_result r;

			run_fit(&measurement, &o, &r);
			assert_true(r.error < 2e-5);
			check_index(metals[m].name, r.model.n, r.model.k, truth.n, truth.k);
			check_rel(r.model.ks[1], 0.9, 1e-3, "ks");
			check_abs(r.model.kd[1], 0, 1e-4, "kd");
			assert_int_equal(r.undetermined & (BOUND_IOR | BOUND_K), 0);
			measurement_free(&measurement);
		}
}

static struct cook_torrance coloured(const struct metal *metal)
{
	struct cook_torrance model = metal_of(metal, 0);

	model.per_channel_ior = true;
	memcpy(model.channel_n, metal->n, sizeof metal->n);
	memcpy(model.channel_k, metal->k, sizeof metal->k);
	return model;
}

static void published_indices_of_each_channel_come_back(void **state)
{
	(void)state;
	for (size_t m = 0; m < METALS; m++) {
		const struct metal *metal = &metals[m];
		const struct cook_torrance truth = coloured(metal);
		struct measurement measurement = make_scattered(&truth, 3000, 0, 5);
		struct fit_options o = options_of_metal("ggx");
		struct fit_result r, shared;

		run_fit(&measurement, &o, &shared);
		o.per_channel_ior = true;
		run_fit(&measurement, &o, &r);
		assert_true(r.error < 2e-5 && shared.error > 10 * r.error);
		for (int c = 0; c < 3; c++) {
			check_index(metal->name, r.model.channel_n[c], r.model.channel_k[c], metal->n[c], metal->k[c]);
			check_rel(r.model.ks[c], 0.9, 1e-3, "ks");
		}
		assert_int_equal(r.undetermined & ~(unsigned)(BOUND_KD_R | BOUND_KD_G | BOUND_KD_B), 0);
		measurement_free(&measurement);
	}
}

/* Noise of a tenth leaves n open: half or twice of it does as well, which a fit with n fixed there shows. */
static void what_the_data_leave_open_is_told(void **state)
{
	const struct cook_torrance truth = metal_of(&metals[0], 0);
	struct measurement measurement = make_scattered(&truth, 3000, 0.1, 5);
	struct fit_options o = options_of_metal("ggx");
	double least = INFINITY;
	struct fit_result r, fixed;

	(void)state;
	run_fit(&measurement, &o, &r);
	assert_true(r.undetermined & BOUND_IOR);
	assert_int_equal(r.undetermined & (BOUND_SIGMA | BOUND_KS_R), 0);
	for (int side = 0; side < 2; side++) {
		o.ior = r.model.n * (side ? 2 : 0.5);
		run_fit(&measurement, &o, &fixed);
		least = fmin(least, fixed.error);
	}
	assert_true(least < r.error * (1 + FIT_UNDETERMINED));
	measurement_free(&measurement);
}

/* Data of another model than either: who asks for an index of each channel never ends above those who do not. */
static void an_index_for_each_channel_never_loses(void **state)
{
	const struct cook_torrance truth = make_model("std", 0.2, 2.5, 1.5);
	struct measurement measurement = make_scattered(&truth, 2000, 0.2, 3);
	struct fit_options o = options_of_metal("std");
	struct fit_result shared, r[2];

	(void)state;
	run_fit(&measurement, &o, &shared);
	o.per_channel_ior = true;
	o.ndf[0] = ndf_find("ggx");
	o.ndf[1] = ndf_find("std");
	o.n_ndf = 2;
	run_fit(&measurement, &o, r);
	assert_true(r[1].error <= shared.error && r[1].error <= r[0].error);
	/* As many names as there are parameters left open. */
	assert_int_equal(r[1].undetermined & (BOUND_IOR | BOUND_K), 0);
	measurement_free(&measurement);
}

static void rows_bring_models_back(void **state)
{
	const struct result_source source = {.path = "x", .input = "", .options = ""};
	struct cook_torrance truth = coloured(&metals[1]), model;
	struct measurement measurement = make_scattered(&truth, 1000, 0.1, 7);
	struct csv_table table = csv_table_make(result_columns, RESULT_COLUMNS);
	struct fit_options o = options_of_metal("ggx"), read = options_for("ggx");
	struct fit_result r;
	struct error error;
	struct pwl *pwl;
	unsigned seed = 9;

	(void)state;
	o.per_channel_ior = true;
	o.sigma = 0.2;
	run_fit(&measurement, &o, &r);
	assert_int_equal(result_add(&table, &source, &o, &r), STATUS_OK);
	assert_string_equal(table.row[0][RESULT_IOR], "");
	assert_int_equal(result_model(table.row[0], &model, &read, &pwl, &error), STATUS_OK);
	assert_true(read.per_channel_ior);
	for (int i = 0; i < 50; i++) {
		const struct vec3 wi = random_direction(&seed), wo = random_view(&truth, wi, &seed);
		double want[3], got[3];

		cook_torrance_f(&r.model, wi, wo, want);
		cook_torrance_f(&model, wi, wo, got);
		for (int c = 0; c < 3; c++)
			assert_true(want[c] == got[c]);
	}
	result_model_free(&model, pwl);
	csv_table_free(&table);
	measurement_free(&measurement);
}

static void what_does_not_go_with_an_index_for_each_channel_is_refused(void **state)
{
	struct fit_options o = options_of_metal("ggx");
	struct error error;

	(void)state;
	o.per_channel_ior = true;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_KEPT);
	o.gray = true;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RICHER);
	o.gray = false;
	o.ior = 0.5;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RICHER);
	o.ior = NAN;
	o.lobes = 2;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RICHER);
	o.lobes = 1;
	o.fresnel = FRESNEL_DIELECTRIC;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RICHER);
}

static void n_below_1_is_of_conductors(void **state)
{
	struct fit_options o = options_of_metal("ggx");
	struct error error;

	(void)state;
	o.ior = 0.01;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_KEPT);
	o.ior = 0.0099;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RANGE);
	o.ior = 0.5;
	o.fresnel = FRESNEL_DIELECTRIC;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RANGE);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(published_indices_come_back),
		cmocka_unit_test(rows_bring_models_back),
		cmocka_unit_test(what_does_not_go_with_an_index_for_each_channel_is_refused),
		cmocka_unit_test(n_below_1_is_of_conductors),
	};
	const struct CMUnitTest long_tests[] = {
		cmocka_unit_test(published_indices_of_each_channel_come_back),
		cmocka_unit_test(what_the_data_leave_open_is_told),
		cmocka_unit_test(an_index_for_each_channel_never_loses),
	};
	const int failed = cmocka_run_group_tests(tests, NULL, NULL);

	if (failed || case_step(2) > 1)
		return failed;
	return cmocka_run_group_tests_name("conductor_long", long_tests, NULL, NULL);
}
