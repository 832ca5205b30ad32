/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ladder of models: its rungs, their parameters, and the table of what they gain. */
#include "check.h"
#include "fit/results/ladder_table.h"
#include "fit/search/ladder.h"
#include "fit/search/options_check.h"

static const struct ladder_rung *find(const struct ladder_rung rung[], int n, const char *name)
{
	for (int i = 0; i < n; i++)
		if (!strcmp(rung[i].name, name))
			return &rung[i];
	return NULL;
}

/* Counted by hand: factors of each term, then sigma, gamma, n, the exponent, sigma and gamma of the second lobe. */
static void rungs_have_the_parameters_that_they_have(void **state)
{
	static const struct {
		const char *name;
		int parameters;
	} want[LADDER_RUNGS] = {{"gray-lambert", 1},
				{"lambert", 3},
				{"gray-lobe", 2 + 3},
				{"gray-specular", 4 + 3},
				{"gray-two-lobes", 3 + 3 + 2},
				{LADDER_LOBE, 6 + 3},
				{"burley", 9 + 4},
				{"two-lobes", 9 + 3 + 2},
				{"f82", 3 + 9 + 2},
				{"burley+two-lobes", 12 + 4 + 2},
				{"burley+f82", 6 + 9 + 3}};
	const struct fit_options options = fit_options_default();
	struct ladder_rung rung[LADDER_RUNGS];
	struct error error;

	(void)state;
	assert_int_equal(ladder_rungs(&options, rung), LADDER_RUNGS);
	for (int i = 0; i < LADDER_RUNGS; i++) {
		const struct ladder_rung *r = find(rung, LADDER_RUNGS, want[i].name);

		assert_non_null(r);
		assert_int_equal(r->parameters, want[i].parameters);
		assert_int_equal(fit_options_check(&r->options, &error), STATUS_OK);
		assert_true(i == 0 || rung[i].parameters >= rung[i - 1].parameters);
	}
}

/* What is fixed is no parameter, and what the options rule out is no rung. */
static void fixed_values_are_no_parameters(void **state)
{
	struct fit_options options = fit_options_default();
	struct ladder_rung rung[LADDER_RUNGS];

	(void)state;
	options.ndf[0] = ndf_find("ggx");
	options.ior = 1.5;
	options.sigma = 0.2;
	const int n = ladder_rungs(&options, rung);

	assert_int_equal(n, LADDER_RUNGS - 3); /* two lobes want a free sigma */
	assert_null(find(rung, n, "two-lobes"));
	assert_int_equal(find(rung, n, LADDER_LOBE)->parameters, 6);
	options.grazing_exponent = 5;
	assert_int_equal(ladder_rungs(&options, rung), n);
	assert_int_equal(find(rung, n, "burley")->parameters, 9);
	options.fresnel = FRESNEL_CONDUCTOR;
	options.ior = NAN;
	assert_int_equal(ladder_rungs(&options, rung), n);
	assert_int_equal(find(rung, n, LADDER_LOBE)->parameters, 8);
}

static void gains_are_against_the_model_of_the_paper(void **state)
{
	char *cells[3][RESULT_COLUMNS];
	static char *const error[] = {"0.5", "0.25", "0.1875"};
	struct ladder_line line[] = {{"lambert", 3, cells[0], 4, 0.5},
				     {LADDER_LOBE, 9, cells[1], 2, 0.75},
				     {"two-lobes", 14, cells[2], 1, 0.875},
				     {"f82", 14, NULL, NAN, NAN}};
	struct csv_table table = csv_table_make(ladder_columns, LADDER_COLUMNS);

	(void)state;
	for (int i = 0; i < 3; i++) {
		for (int c = 0; c < RESULT_COLUMNS; c++)
			cells[i][c] = "";
		cells[i][RESULT_ERROR] = error[i];
		cells[i][RESULT_SECONDS] = "1.5";
	}
	assert_int_equal(ladder_table_add(&table, "m", line, 4, LADDER_LOBE), STATUS_OK);
	assert_string_equal(table.row[0][LADDER_GAIN], "-100");
	assert_string_equal(table.row[1][LADDER_GAIN], "0");
	assert_string_equal(table.row[2][LADDER_GAIN], "25");
	assert_string_equal(table.row[2][LADDER_DELTA_E], "1");
	assert_string_equal(table.row[2][LADDER_SECONDS], "1.5");
	assert_string_equal(table.row[3][LADDER_ERROR], "");
	assert_string_equal(table.row[3][LADDER_PARAMETERS], "14");
	check_rel(ladder_gain(line, 4, LADDER_LOBE), 25, 1e-12, "gain");
	assert_true(isnan(ladder_gain(line, 4, "burley")));
	csv_table_free(&table);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rungs_have_the_parameters_that_they_have),
		cmocka_unit_test(fixed_values_are_no_parameters),
		cmocka_unit_test(gains_are_against_the_model_of_the_paper),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
