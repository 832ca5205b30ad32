/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models with more terms than two: known parameters come back, a richer model never loses, rows and JSON bring them back. */
#include "fit/results/result.h"
#include "fit/search/options_check.h"
#include "fit/search/within.h"
#include "make_scattered.h"
#include "run_fit.h"

static struct fit_result run(const struct measurement *measurement, const struct fit_options *options)
{
	struct fit_result result;

	run_fit(measurement, options, &result);
	return result;
}

enum kind { F82, BURLEY, TWO_LOBES, KINDS };

static struct cook_torrance truth_of(enum kind kind, const char *ndf)
{
	struct cook_torrance truth = make_model(ndf, 0.15, 2, 1.5);

	for (int c = 0; c < 3; c++) {
		if (kind == F82) {
			truth.fresnel = FRESNEL_F82;
			truth.ks[c] = 1;
			truth.reflectance[c][0] = 0.8 - 0.2 * c;
			truth.reflectance[c][1] = 0.6 - 0.1 * c;
			truth.reflectance[c][2] = 0.9;
		} else if (kind == BURLEY) {
			truth.grazing = 3;
			truth.kg[c] = 0.3 - 0.1 * c;
		} else {
			truth.ks_second[c] = 0.5 - 0.15 * c;
		}
	}
	if (kind == TWO_LOBES && ndf_init(&truth.second, truth.ndf.class, 0.6, 0.6, 2) != STATUS_OK)
		abort();
	return truth;
}

static void ask_for(enum kind kind, struct fit_options *o)
{
	if (kind == F82)
		o->fresnel = FRESNEL_F82;
	o->grazing = kind == BURLEY;
	o->lobes = kind == TWO_LOBES ? 2 : 1;
}

/* GGX, which STD has inside. */
static void parameters_come_back(void **state)
{
	(void)state;
	for (enum kind kind = 0; kind < KINDS; kind++) {
		const struct cook_torrance truth = truth_of(kind, "ggx");
		struct measurement measurement = make_scattered(&truth, 16000, 0.01, 3);
		struct fit_options o = options_for("std"), simpler = o;

		ask_for(kind, &o);
		if (kind == F82)
			simpler.fresnel = FRESNEL_SCHLICK;
		const struct fit_result r = run(&measurement, &o), one = run(&measurement, &simpler);

		/* The mean of |normal deviate| is 0.8. */
		check_between(r.error, 0.006, 0.0085, "E");
		assert_true(r.error < 0.9 * one.error);
		check_rel(r.model.ndf.sigma_x, 0.15, 0.02, "sigma");
		for (int c = 0; c < 3; c++) {
			check_rel(r.model.kd[c], truth.kd[c], 0.03, "kd");
			if (kind == F82) {
				check_abs(r.model.reflectance[c][0], truth.reflectance[c][0], 0.02, "F0");
				check_abs(r.model.reflectance[c][1], truth.reflectance[c][1], 0.02, "F82");
			} else if (kind == BURLEY) {
				check_abs(r.model.kg[c], truth.kg[c], 0.02, "kg");
			} else {
				check_abs(r.model.ks_second[c], truth.ks_second[c], 0.04, "ks of the second lobe");
			}
		}
		if (kind == BURLEY)
			check_rel(r.model.grazing, 3, 0.1, "exponent");
		if (kind == TWO_LOBES) {
			check_rel(r.model.second.sigma_x, 0.6, 0.03, "sigma of the second lobe");
			assert_false(r.undetermined & (BOUND_SECOND_SIGMA | BOUND_SECOND_GAMMA));
		}
		measurement_free(&measurement);
	}
}

/* Lobes that send back more than one may are not fitted so, nor taken for one of a ks beyond 1. */
static void two_lobes_share_the_bound_of_one(void **state)
{
	struct cook_torrance truth = truth_of(TWO_LOBES, "ggx");
	struct fit_options o = options_for("ggx");

	(void)state;
	for (int c = 0; c < 3; c++)
		truth.ks_second[c] = 0.9 - 0.1 * c;
	struct measurement measurement = make_scattered(&truth, 1500, 0, 9);

	o.lobes = 2;
	for (int gray = 0; gray < 3; gray++) {
		o.gray = gray == 1;
		o.gray_specular = gray == 2;
		const struct fit_result r = run(&measurement, &o);

		double most = 0;

		for (int c = 0; c < 3; c++)
			most = fmax(most, r.model.ks[c] + r.model.ks_second[c]);
		check_between(most, 0.999, 1 + 1e-6, "ks of both lobes");
	}
	o.gray_specular = false;
	o.unbounded = true;
	const struct fit_result r = run(&measurement, &o);

	assert_true(r.error < 1e-3);
	for (int c = 0; c < 3; c++)
		check_rel(r.model.ks[c] + r.model.ks_second[c], truth.ks[c] + truth.ks_second[c], 0.01, "unbounded");
	measurement_free(&measurement);
}

/* Data of another kind than each model: what the simpler one reaches is never lost, gray or not. */
static void a_richer_model_never_loses(void **state)
{
	const struct cook_torrance truth = make_model("gtr", 0.2, 1.4, 1.6);
	struct measurement measurement = make_scattered(&truth, 1500, 0.1, 5);

	(void)state;
	for (int gray = 0; gray < 2; gray++)
		for (enum kind kind = 0; kind < KINDS; kind++) {
			struct fit_options o = options_for("ggx");

			o.gray = gray;
			if (kind == F82)
				o.fresnel = FRESNEL_SCHLICK;
			const double simpler = run(&measurement, &o).error;

			ask_for(kind, &o);
			const struct fit_result r = run(&measurement, &o);

			assert_true(r.error <= simpler);
			for (int c = 1; c < 3 && gray; c++) {
				assert_true(r.model.kd[c] == r.model.kd[0] && r.model.ks[c] == r.model.ks[0]);
				assert_true(r.model.kg[c] == r.model.kg[0]);
				assert_true(r.model.ks_second[c] == r.model.ks_second[0]);
				for (int i = 0; i < F82_PARTS; i++)
					assert_true(r.model.reflectance[c][i] == r.model.reflectance[0][i]);
			}
			o.grazing = true;
			o.lobes = kind == F82 ? 1 : 2;
			if (kind == BURLEY)
				o.grazing_exponent = 5;
			assert_true(run(&measurement, &o).error <= (kind == BURLEY ? simpler : r.error));
		}
	measurement_free(&measurement);
}

/* Data of one lobe: of two no more than one is there, it is the first, and its row is read back. */
static void rows_bring_models_back(void **state)
{
	const struct result_source source = {.path = "x.csv", .input = "", .options = ""};

	(void)state;
	for (enum kind kind = 0; kind <= KINDS; kind++) {
		const bool one_lobe = kind == KINDS;
		const struct cook_torrance truth = one_lobe ? make_model("ggx", 0.2, 2, 1.5) : truth_of(kind, "ggx");
		struct measurement measurement = make_scattered(&truth, 1500, 0, 7);
		struct fit_options o = options_for("ggx"), read = o;
		struct csv_table table;
		struct cook_torrance model;
		struct pwl *pwl;
		struct error error;

		ask_for(one_lobe ? TWO_LOBES : kind, &o);
		const struct fit_result r = run(&measurement, &o);

		table = csv_table_make(result_columns, RESULT_COLUMNS);
		assert_int_equal(result_add(&table, &source, &o, &r), STATUS_OK);
		assert_int_equal(result_model(table.row[0], &model, &read, &pwl, &error), STATUS_OK);
		assert_true(read.grazing == o.grazing && read.lobes == o.lobes && read.fresnel == o.fresnel);
		for (int i = 0; i < 50; i++) {
			unsigned seed = (unsigned)i;
			const struct vec3 wi = random_direction(&seed), wo = random_view(&truth, wi, &seed);
			double want[3], got[3];

			cook_torrance_f(&r.model, wi, wo, want);
			cook_torrance_f(&model, wi, wo, got);
			for (int c = 0; c < 3; c++)
				assert_true(want[c] == got[c]);
		}
		assert_true(!one_lobe || (r.model.ks[1] > 0.5 && fabs(r.model.ndf.sigma_x - 0.2) < 0.01));
		result_model_free(&model, pwl);
		csv_table_free(&table);
		measurement_free(&measurement);
	}
}

/* Where the data are of one lobe, what noise makes of a second has no shape that they determine. */
static void a_second_lobe_of_noise_is_undetermined(void **state)
{
	const struct cook_torrance truth = make_model("ggx", 0.2, 2, 1.5);
	struct measurement measurement = make_scattered(&truth, 30000, 0.02, 5);
	struct fit_options o = options_for("ggx");

	(void)state;
	o.lobes = 2;
	o.ior = 1.5;
	const struct fit_result r = run(&measurement, &o);

	assert_true(cook_torrance_has_second(&r.model));
	assert_true(r.undetermined & BOUND_SECOND_SIGMA);
	measurement_free(&measurement);
}

/* Of the whole family the model that made the data is chosen, and one richer only where richer is let in. */
static void within_finds_the_model_of_the_data(void **state)
{
	static const unsigned all = WITHIN_BURLEY | WITHIN_F82 | WITHIN_TWO_LOBES;
	const struct fit_options options = options_for("ggx");
	struct fit_context *context;
	struct error error;

	(void)state;
	assert_int_equal(fit_context_new(&context, 0, &options), STATUS_OK);
	for (enum kind kind = 0; kind <= KINDS; kind++) {
		struct cook_torrance truth = truth_of(kind == KINDS ? BURLEY : kind, "ggx");
		struct fit_options chosen;
		struct fit_result r, plain;

		for (int c = 0; c < 3 && kind == KINDS; c++) {
			truth.kg[c] = truth.ks[c] = 0;
			truth.kd[c] = 0.3;
		}
		struct measurement measurement = make_scattered(&truth, 1500, 0.01, 11);

		assert_int_equal(within_run(context, &measurement, &options, all, 5, &chosen, &r, &error), STATUS_OK);
		assert_true(chosen.specular == (kind != KINDS) && chosen.gray == (kind == KINDS));
		assert_true(chosen.grazing == (kind == BURLEY));
		assert_true(chosen.lobes == (kind == TWO_LOBES ? 2 : 1));
		assert_true((chosen.fresnel == FRESNEL_F82) == (kind == F82));
		check_between(r.error, 0.006, 0.009, "E");
		assert_int_equal(within_run(context, &measurement, &options, 0, 5, &chosen, &plain, &error), STATUS_OK);
		assert_true(!chosen.grazing && chosen.lobes == 1 && chosen.fresnel != FRESNEL_F82);
		assert_true(kind == KINDS || plain.error > 1.05 * r.error);
		measurement_free(&measurement);
	}
	fit_context_free(context);
}

static void what_does_not_go_together_is_refused(void **state)
{
	struct error error;
	struct fit_options o = options_for("std");

	(void)state;
	o.lobes = 2;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_KEPT);
	o.sigma = 0.2;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RICHER);
	o.sigma = NAN;
	o.fresnel = FRESNEL_F82;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RICHER);
	o.lobes = 1;
	o.grazing = true;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_KEPT);
	o.ndf[0] = ndf_find("pl");
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RICHER);
	o = options_for("std");
	o.grazing = true;
	o.diffuse = false;
	assert_int_equal(fit_options_rule(&o, &error), FIT_RULE_RICHER);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(parameters_come_back),
		cmocka_unit_test(two_lobes_share_the_bound_of_one),
		cmocka_unit_test(a_richer_model_never_loses),
		cmocka_unit_test(rows_bring_models_back),
		cmocka_unit_test(a_second_lobe_of_noise_is_undetermined),
		cmocka_unit_test(within_finds_the_model_of_the_data),
		cmocka_unit_test(what_does_not_go_together_is_refused),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
