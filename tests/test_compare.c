/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The arithmetic of `stdfit compare`: columns, winners, gains, distances from the floor, and the summary. */
#include "check.h"
#include "fit/results/compare.h"

struct fixture {
	struct csv_table rows;
	struct comparison c;
};

static void add_row(struct fixture *f, const char *material, const char *ndf, const char *error)
{
	const char *cell[RESULT_COLUMNS] = {[RESULT_MATERIAL] = material, [RESULT_NDF] = ndf, [RESULT_ERROR] = error};
	assert_int_equal(csv_table_add(&f->rows, cell), STATUS_OK);
}

static struct fixture fixture_make(void)
{
	return (struct fixture){.rows = csv_table_make(result_columns, RESULT_COLUMNS)};
}

static void fixture_free(struct fixture *f)
{
	comparison_free(&f->c);
	csv_table_free(&f->rows);
}

/* The whole table, as `compare` makes it. */
static void run(struct fixture *f, const struct compare_picture *picture)
{
	struct error error;
	assert_int_equal(comparison_init(&f->c, &f->rows, picture != NULL, false, &error), STATUS_OK);
	for (size_t start = 0, end; start < f->rows.n_rows; start = end) {
		end = comparison_material_end(&f->rows, start);
		assert_int_equal(
			comparison_add(&f->c, f->rows.row + start, end - start, picture ? picture + start : NULL),
			STATUS_OK);
	}
	assert_int_equal(comparison_end(&f->c), STATUS_OK);
}

/* The cell of a named column in the line of a material or of the summary. */
static const char *cell(const struct fixture *f, const char *line, const char *column)
{
	const struct csv_table *table = &f->c.table;
	int at = 0;
	while (at < table->n_columns && strcmp(table->column[at].name, column) != 0)
		at++;
	if (at == table->n_columns)
		fail_msg("no column %s", column);
	for (size_t i = 0; i < table->n_rows; i++)
		if (!strcmp(table->row[i][0], line))
			return table->row[i][at];
	fail_msg("no line %s", line);
}

static void lowest_error_wins_and_equal_ones_tie(void **state)
{
	(void)state;
	struct fixture f = fixture_make();
	add_row(&f, "b", "std", "0.25");
	add_row(&f, "a", "ggx", "0.5");
	add_row(&f, "a", "std", "0.125");
	add_row(&f, "b", "ggx", "0.25");
	add_row(&f, "c", "std", "");
	run(&f, NULL);
	assert_string_equal(f.c.table.row[0][0], "a");
	assert_string_equal(cell(&f, "a", "winner"), "std");
	assert_string_equal(cell(&f, "b", "winner"), "tie");
	assert_string_equal(cell(&f, "c", "winner"), "");
	assert_string_equal(cell(&f, "(wins)", "winner"), "1 tie");
	assert_string_equal(cell(&f, "(wins)", "error_std"), "1");
	assert_string_equal(cell(&f, "(wins)", "error_ggx"), "0");
	assert_string_equal(cell(&f, "(wins)", "gain_over_ggx"), "");
	fixture_free(&f);
}

static void worst_is_the_largest_error_and_the_smallest_gain(void **state)
{
	(void)state;
	struct fixture f = fixture_make();
	add_row(&f, "a", "std", "0.125");
	add_row(&f, "a", "ggx", "0.5");
	add_row(&f, "b", "std", "0.25");
	add_row(&f, "b", "ggx", "0.125");
	add_row(&f, "c", "std", "0.75");
	run(&f, NULL);
	assert_string_equal(cell(&f, "a", "gain_over_ggx"), "75");
	assert_string_equal(cell(&f, "b", "gain_over_ggx"), "-100");
	assert_string_equal(cell(&f, "c", "gain_over_ggx"), "");
	assert_string_equal(cell(&f, "a", "gain_over_beckmann"), "");
	assert_string_equal(cell(&f, "(mean)", "gain_over_ggx"), "-12.5");
	assert_string_equal(cell(&f, "(worst)", "gain_over_ggx"), "-100");
	assert_string_equal(cell(&f, "(mean)", "error_std"), "0.375");
	assert_string_equal(cell(&f, "(median)", "error_std"), "0.25");
	assert_string_equal(cell(&f, "(worst)", "error_std"), "0.75");
	assert_string_equal(cell(&f, "(worst)", "gain_over_beckmann"), "");
	fixture_free(&f);
}

static void floor_is_no_rival(void **state)
{
	(void)state;
	struct fixture f = fixture_make();
	add_row(&f, "a", "pl", "0.125");
	add_row(&f, "a", "ggx", "0.25");
	add_row(&f, "b", "pl", "0.5");
	add_row(&f, "b", "ggx", "0.625");
	run(&f, NULL);
	assert_string_equal(cell(&f, "a", "winner"), "ggx");
	assert_string_equal(cell(&f, "a", "ggx_above_pl"), "100");
	assert_string_equal(cell(&f, "b", "ggx_above_pl"), "25");
	assert_string_equal(cell(&f, "(worst)", "ggx_above_pl"), "100");
	assert_string_equal(cell(&f, "(wins)", "error_pl"), "0");
	fixture_free(&f);

	struct fixture alone = fixture_make();
	add_row(&alone, "a", "pl", "0.125");
	run(&alone, NULL);
	assert_string_equal(cell(&alone, "a", "winner"), "pl");
	fixture_free(&alone);
}

static void pictures_have_columns_of_their_own(void **state)
{
	(void)state;
	static const struct compare_picture picture[] = {{1.5, 0.75}, {3, 0.5}, {2.5, 0.25}, {NAN, NAN}};
	struct fixture f = fixture_make();
	/* In order already: the pictures are given row by row. */
	add_row(&f, "a", "std", "0.125");
	add_row(&f, "b", "std", "0.125");
	add_row(&f, "c", "std", "0.125");
	add_row(&f, "d", "std", "");
	run(&f, picture);
	assert_string_equal(cell(&f, "a", "delta_e_std"), "1.5");
	assert_string_equal(cell(&f, "c", "ssim_std"), "0.25");
	assert_string_equal(cell(&f, "d", "ssim_std"), "");
	assert_string_equal(cell(&f, "(worst)", "delta_e_std"), "3");
	assert_string_equal(cell(&f, "(worst)", "ssim_std"), "0.25");
	assert_string_equal(cell(&f, "(median)", "delta_e_std"), "2.5");
	assert_string_equal(cell(&f, "(wins)", "ssim_std"), "");
	fixture_free(&f);
}

static void lines_go_by_gain(void **state)
{
	(void)state;
	static const char *const want[] = {"b", "c", "a", "d"};
	struct fixture f = fixture_make();
	struct error error;
	add_row(&f, "a", "std", "0.5");
	add_row(&f, "a", "ggx", "0.25");
	add_row(&f, "b", "std", "0.125");
	add_row(&f, "b", "ggx", "0.25");
	add_row(&f, "c", "std", "0.25");
	add_row(&f, "c", "ggx", "0.25");
	add_row(&f, "d", "std", "0.25");
	assert_int_equal(comparison_init(&f.c, &f.rows, false, true, &error), STATUS_OK);
	for (size_t start = 0, end; start < f.rows.n_rows; start = end) {
		end = comparison_material_end(&f.rows, start);
		assert_int_equal(comparison_add(&f.c, f.rows.row + start, end - start, NULL), STATUS_OK);
	}
	assert_int_equal(comparison_end(&f.c), STATUS_OK);
	for (size_t i = 0; i < sizeof want / sizeof *want; i++)
		assert_string_equal(f.c.table.row[i][0], want[i]);
	assert_string_equal(f.c.table.row[4][0], "(mean)");
	assert_string_equal(cell(&f, "b", "gain_over_ggx"), "50");
	fixture_free(&f);
}

static void more_ndfs_than_there_are_is_an_error(void **state)
{
	(void)state;
	struct fixture f = fixture_make();
	struct error error;
	for (int i = 0; i <= FIT_NDFS_MAX; i++) {
		char name[16];
		snprintf(name, sizeof name, "ndf%d", i);
		add_row(&f, "a", name, "0.5");
	}
	assert_int_equal(comparison_init(&f.c, &f.rows, false, false, &error), STATUS_UNSUPPORTED);
	fixture_free(&f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lowest_error_wins_and_equal_ones_tie),
		cmocka_unit_test(worst_is_the_largest_error_and_the_smallest_gain),
		cmocka_unit_test(floor_is_no_rival),
		cmocka_unit_test(pictures_have_columns_of_their_own),
		cmocka_unit_test(lines_go_by_gain),
		cmocka_unit_test(more_ndfs_than_there_are_is_an_error),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
