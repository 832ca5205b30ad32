/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The census of a measured table, as `stdfit info` prints it. */
#include "check.h"
#include "fit/error/census.h"

/* Entries (i, 0, k) of small i are above the horizon; at theta_h = theta_d = 89 degrees
 * and phi_d = 0 one direction is far below it. */
static void set_value(struct measurement *m, int i, int j, int k, float value)
{
	for (int c = 0; c < MERL_CHANNELS; c++)
		m->value[c][measurement_at(m->n_phi_d, i, j, k)] = value * (float)(c + 1);
}

static void masked_table_has_no_range(void **state)
{
	(void)state;
	struct measurement m;
	struct census census;
	assert_int_equal(measurement_alloc(&m, 180), STATUS_OK);
	assert_int_equal(census_take(&m, BINS_NODE, &census), STATUS_OK);
	assert_int_equal(census.valid, 0);
	assert_int_equal(census.valid_above, 0);
	assert_in_range(census.above, 1, measurement_count(&m) - 1);
	for (int c = 0; c < MERL_CHANNELS; c++)
		assert_true(isnan(census.range[c].min) && isnan(census.range[c].median) && isnan(census.range[c].max));
	measurement_free(&m);
}

static void entries_on_either_side_of_the_horizon_are_counted(void **state)
{
	(void)state;
	struct measurement m;
	struct census census;
	assert_int_equal(measurement_alloc(&m, 360), STATUS_OK);
	set_value(&m, 0, 0, 0, 4);
	set_value(&m, 1, 0, 0, 1);
	set_value(&m, 2, 0, 0, 3);
	set_value(&m, 3, 0, 0, 0.5f);
	set_value(&m, 89, 89, 0, 100);
	assert_int_equal(census_take(&m, BINS_NODE, &census), STATUS_OK);
	assert_int_equal(census.valid, 5);
	assert_int_equal(census.valid_above, 4);
	assert_int_equal(census.valid_below, 1);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		check_rel(census.range[c].min, 0.5 * (c + 1), 0, "min");
		check_rel(census.range[c].median, 2 * (c + 1), 0, "median of an even number");
		check_rel(census.range[c].max, 4 * (c + 1), 0, "max");
	}
	measurement_free(&m);
}

static void median_of_huge_values_is_finite(void **state)
{
	(void)state;
	struct measurement m;
	struct census census;
	assert_int_equal(measurement_alloc(&m, 180), STATUS_OK);
	set_value(&m, 0, 0, 0, 1e38f);
	set_value(&m, 1, 0, 0, 1e38f);
	assert_int_equal(census_take(&m, BINS_CENTRE, &census), STATUS_OK);
	check_rel(census.range[2].median, (double)(1e38f * 3), 0, "median");
	measurement_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(masked_table_has_no_range),
		cmocka_unit_test(entries_on_either_side_of_the_horizon_are_counted),
		cmocka_unit_test(median_of_huge_values_is_finite),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
