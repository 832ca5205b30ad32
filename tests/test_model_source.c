/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where models come from: a row gives back the very model that was fitted, pl's table included; parameters are taken
 * as they are; what cannot be had is told in one line. */
#include "check.h"
#include "data_readers/merl.h"
#include "fit/sources/model_source.h"
#include "make_table.h"

#include <stdio.h>
#include <unistd.h>

static char directory[] = "/tmp/stdfit-source-XXXXXX";
static atomic_bool cancel;

/* Parses a command line of up to 20 words, which stay where they are. */
static int parse(struct options *options, enum command command, const char *line)
{
	static char words[1024];
	static char *argv[24];
	int argc = 0;

	snprintf(words, sizeof words, "%s", line);
	for (char *word = strtok(words, " "); word; word = strtok(NULL, " "))
		argv[argc++] = word;
	argv[argc] = NULL;
	return options_parse(options, command, argc, argv, &cancel);
}

static void must_read(const struct options *options, const char *path, struct model_source *source)
{
	struct error error = {""};

	assert_int_equal(model_source_check(options, true), -1);
	if (model_source_read(options, path, source, &error) != STATUS_OK)
		fail_msg("%s", error.text);
}

static void same_model(const struct source_model *a, const struct source_model *b)
{
	assert_string_equal(ndf_name(a->model.ndf.class), ndf_name(b->model.ndf.class));
	for (int i = 0; i < 40; i++) {
		const double theta = 1.5 * i / 40;
		const struct vec3 wi = {sin(theta), 0, cos(theta)}, wo = {0, sin(1.5 - theta), cos(1.5 - theta)};
		double f[3], g[3];

		cook_torrance_f(&a->model, wi, wo, f);
		cook_torrance_f(&b->model, wi, wo, g);
		for (int c = 0; c < 3; c++)
			check_rel(f[c], g[c], a->pwl ? 1e-12 : 0, "the model of the row");
	}
}

/* Writes the fitted models of a source as a result table. */
static void write_table(const char *path, const struct model_source *source)
{
	struct csv_table table = csv_table_make(result_columns, RESULT_COLUMNS);
	const struct result_source from = {.path = "m.binary", .input = "", .options = ""};
	FILE *file = fopen(path, "w");

	assert_non_null(file);
	for (size_t i = 0; i < source->n; i++) {
		const struct source_model *m = &source->model[i];
		const struct fit_result result = {
			.model = m->model, .diffuse = true, .specular = true, .error = m->error};

		assert_int_equal(result_add(&table, &from, &m->fit, &result), STATUS_OK);
	}
	csv_write(file, &table);
	assert_int_equal(fclose(file), 0);
	csv_table_free(&table);
}

static void a_row_is_the_model_that_was_fitted(void **state)
{
	struct options options;
	struct model_source fitted, rows;

	(void)state;
	assert_int_equal(parse(&options, COMMAND_FIT, "fit m.binary --ndf ggx,pl --max-theta 12 --ior 1.5 --sigma 0.3"),
			 -1);
	assert_int_equal(model_source_kind(&options), SOURCE_FIT);
	must_read(&options, "m.binary", &fitted);
	assert_int_equal(fitted.n, 2);
	assert_non_null(fitted.measurement.value[0]);
	assert_string_equal(fitted.model[0].material, "m");
	assert_string_equal(fitted.model[0].path, "m.binary");
	assert_non_null(fitted.model[1].pwl);
	check_between(fitted.model[0].error, 1e-9, 1, "error");
	write_table("fits.csv", &fitted);

	assert_int_equal(parse(&options, COMMAND_EVAL, "eval m.binary --from fits.csv"), -1);
	assert_int_equal(model_source_kind(&options), SOURCE_ROWS);
	must_read(&options, "m.binary", &rows);
	assert_int_equal(rows.n, 2);
	assert_null(rows.measurement.value[0]);
	for (size_t i = 0; i < 2; i++) {
		same_model(&rows.model[i], &fitted.model[i]);
		assert_true(rows.model[i].error == fitted.model[i].error);
		assert_true(rows.model[i].fit.criterion.max_theta == 12);
		assert_int_equal(rows.model[i].row, i + 1);
	}
	model_source_free(&rows);

	assert_int_equal(parse(&options, COMMAND_EVAL, "eval m.binary --from fits.csv --row 2"), -1);
	must_read(&options, NULL, &rows);
	assert_int_equal(rows.n, 1);
	same_model(&rows.model[0], &fitted.model[1]);
	model_source_free(&rows);

	assert_int_equal(parse(&options, COMMAND_EVAL, "eval m.binary --from fits.csv --ndf ggx"), -1);
	must_read(&options, NULL, &rows);
	assert_int_equal(rows.n, 1);
	same_model(&rows.model[0], &fitted.model[0]);
	model_source_free(&rows);
	model_source_free(&fitted);
}

static void parameters_are_taken_as_they_are(void **state)
{
	struct options options;
	struct model_source source;

	(void)state;
	assert_int_equal(
		parse(&options, COMMAND_EVAL, "eval ./m.binary --kd 0.1,0.2,0.3 --ks 0.5 --sigma 0.2 --gamma 1.7"), -1);
	assert_int_equal(model_source_kind(&options), SOURCE_GIVEN);
	must_read(&options, "a/b.binary", &source); /* is not read */
	assert_int_equal(source.n, 1);
	assert_true(isnan(source.model[0].error));
	assert_string_equal(source.model[0].material, "b");
	assert_null(source.model[0].path);
	assert_true(source.model[0].model.kd[1] == 0.2 && source.model[0].model.ks[2] == 0.5);
	assert_true(source.model[0].model.ndf.gamma == 1.7 && source.model[0].model.n == 1.5);
	model_source_free(&source);
}

static void what_cannot_be_had_is_told(void **state)
{
	static const struct {
		const char *line, *path, *part;
		enum status status;
	} bad[] = {
		{"eval m.binary --from none.csv", NULL, "none.csv", STATUS_IO},
		{"eval m.binary --from fits.csv", "other.binary", "has no such row", STATUS_NO_DATA},
		{"eval m.binary --from fits.csv --row 3", NULL, "has no such row", STATUS_NO_DATA},
		{"eval m.binary --from fits.csv --ndf std", "m.binary", "has no such row", STATUS_NO_DATA},
		{"fit m.binary", "none.binary", "none.binary", STATUS_IO},
		{"fit m.binary", NULL, "no file", STATUS_NO_DATA},
	};

	(void)state;
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct options options;
		struct model_source source;
		struct error error = {""};

		assert_int_equal(
			parse(&options, strncmp(bad[i].line, "fit", 3) ? COMMAND_EVAL : COMMAND_FIT, bad[i].line), -1);
		assert_int_equal(model_source_check(&options, true), -1);
		if (model_source_read(&options, bad[i].path, &source, &error) != bad[i].status)
			fail_msg("%s: another status", bad[i].line);
		if (!strstr(error.text, bad[i].part))
			fail_msg("%s: '%s'", bad[i].line, error.text);
		assert_null(source.model);
	}
}

static int set_up(void **state)
{
	const struct cook_torrance model = make_model("std", 0.3, 1.9, 1.5);
	struct measurement measurement = make_table(&model, 180, BINS_NODE, 0.1);
	struct error error = {""};

	(void)state;
	if (!mkdtemp(directory) || chdir(directory) || merl_write("m.binary", &measurement, &error) != STATUS_OK)
		return -1;
	measurement_free(&measurement);
	return 0;
}

static int tear_down(void **state)
{
	(void)state;
	return remove("m.binary") || remove("fits.csv") || rmdir(directory);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_row_is_the_model_that_was_fitted),
		cmocka_unit_test(parameters_are_taken_as_they_are),
		cmocka_unit_test(what_cannot_be_had_is_told),
	};

	return cmocka_run_group_tests(tests, set_up, tear_down);
}
