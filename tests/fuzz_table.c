/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The first byte chooses what is done with a result table: its models are evaluated, as by eval --from; it is compared,
 * as by compare; merged; or resumed. Below 128, the rest of the bytes are the file. From 128 on they are lines that
 * each change a cell of a sound row: the first byte is the column, what follows is the new content; an empty line
 * begins the next row. */
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/results/result.h"
#include "fit/results/store.h"
#include "fuzz_rows.h"
#include "json_check.h"

#include <sys/stat.h>
#include <unistd.h>

static char directory[64], table_path[80], back_path[80];

static void clean_up(void)
{
	unlink(table_path);
	unlink(back_path);
	rmdir(directory);
}

static void make_directory(void)
{
	if (directory[0])
		return;
	fuzz_make_directory(directory);
	snprintf(table_path, sizeof table_path, "%s/x.csv", directory);
	snprintf(back_path, sizeof back_path, "%s/x.csv~", directory);
	atexit(clean_up);
}

static void check_message(enum status status, const struct error *error)
{
	char message[1024];
	snprintf(message, sizeof message, "stdfit: %s\n", error->text);
	PROMISE(status == STATUS_OK || is_message(message));
}

/* A model that a row describes has numbers for values, wherever it is looked at. */
static void check_model(const struct cook_torrance *model)
{
	static const double angle[] = {0, 1e-4, 0.3, 1.1, 1.5707};
	for (size_t i = 0; i < sizeof angle / sizeof *angle; i++)
		for (size_t o = 0; o < sizeof angle / sizeof *angle; o++) {
			const struct vec3 wi = {sin(angle[i]), 0, cos(angle[i])};
			const struct vec3 wo = {0.6 * sin(angle[o]), -0.8 * sin(angle[o]), cos(angle[o])};
			double f[3];
			cook_torrance_f(model, wi, wo, f);
			for (int c = 0; c < 3; c++)
				PROMISE(!isnan(f[c]) && f[c] >= 0);
		}
}

static struct csv_table empty_table(void)
{
	return csv_table_make(result_columns, RESULT_COLUMNS);
}

static char *as_text(void (*write)(FILE *, const struct csv_table *), const struct csv_table *table)
{
	char *text = NULL;
	size_t size;
	FILE *file = open_memstream(&text, &size);
	if (!file)
		abort();
	write(file, table);
	if (fclose(file))
		abort();
	return text;
}

static void check_same(const struct csv_table *a, const struct csv_table *b)
{
	PROMISE(a->n_rows == b->n_rows);
	for (size_t i = 0; i < a->n_rows; i++)
		for (int c = 0; c < RESULT_COLUMNS; c++)
			PROMISE(!strcmp(a->row[i][c], b->row[i][c]));
}

/* What was read is valid JSON, and read again from CSV it is the same. */
static void check_written(const struct csv_table *rows)
{
	struct csv_table back = empty_table();
	char *json = as_text(report_json, rows), *csv = as_text(csv_write, rows);
	struct error error;
	PROMISE(json_is_valid(json));
	fuzz_write_file(table_path, csv, strlen(csv));
	PROMISE(csv_table_read(&back, table_path, RESULT_COLUMNS, NULL, &error) == STATUS_OK);
	check_same(&back, rows);
	csv_table_free(&back);
	free(csv);
	free(json);
}

static void evaluate(void)
{
	struct csv_table rows = empty_table();
	struct error error;
	const enum status status = csv_table_read(&rows, table_path, RESULT_SAMPLES, NULL, &error);
	check_message(status, &error);
	for (size_t i = 0; i < rows.n_rows; i++) {
		struct cook_torrance model;
		struct fit_options options = fit_options_default();
		struct pwl *pwl;
		const enum status described = result_model(rows.row[i], &model, &options, &pwl, &error);
		check_message(described, &error);
		if (described == STATUS_OK)
			check_model(&model);
		result_model_free(&model, pwl);
	}
	if (status == STATUS_OK)
		check_written(&rows);
	csv_table_free(&rows);
}

/* compare or merge, with an option or NULL. */
static void run_command(enum command command, const char *form)
{
	char name[] = "command", option[16];
	char *argv[] = {name, table_path, form ? option : NULL, NULL};
	const int argc = form ? 3 : 2;
	atomic_bool cancel = false;
	snprintf(option, sizeof option, "%s", form ? form : "");
	struct capture out = capture_begin(stdout), err = capture_begin(stderr);
	const int code = (command == COMMAND_MERGE ? cmd_merge : cmd_compare)(argc, argv, &cancel);
	capture_end(&err, stderr);
	capture_end(&out, stdout);
	/* EXIT_USAGE: the file is a measurement, whatever its name. */
	PROMISE(code == EXIT_DONE || code == EXIT_FAILED || code == EXIT_USAGE);
	PROMISE(code == EXIT_DONE ? err.size == 0 : is_message(err.text));
	PROMISE((code == EXIT_DONE) == (out.size > 0));
	PROMISE(code != EXIT_DONE || !form || strcmp(form, "--json") || json_is_valid(out.text));
	free(out.text);
	free(err.text);
}

static off_t file_size(const char *path)
{
	struct stat info;
	return stat(path, &info) ? -1 : info.st_size;
}

/* Every row that is not made again is there after the table was written anew. */
static void rewrite(struct store *store)
{
	const struct csv_table none = empty_table();
	struct csv_table back = empty_table();
	struct error error;
	size_t kept = 0;
	for (size_t i = 0; i < store->old.n_rows; i++) {
		char *const *row = store->old.row[i];
		const struct result_source source = {
			.path = row[RESULT_PATH], .input = row[RESULT_INPUT], .options = row[RESULT_OPTIONS]};
		PROMISE(result_failed(row) || strcmp(row[RESULT_VERSION], STDFIT_VERSION) || store->doubtful[i] ||
			store_has(store, &source, row[RESULT_NDF]));
	}
	if (store->old.n_rows) {
		char *const *row = store->old.row[0];
		const struct result_source source = {
			.path = row[RESULT_PATH], .input = "another", .options = row[RESULT_OPTIONS]};
		PROMISE(!store_has(store, &source, NULL) || !strcmp(row[RESULT_INPUT], "another"));
		store_drop_stale(store, &source, 1);
	}
	for (size_t i = 0; i < store->old.n_rows; i++)
		kept += !store->stale[i];
	const bool headed = store->headed;
	PROMISE(store_rewrite(store, &none, &error) == STATUS_OK);
	if (!headed)
		return;
	PROMISE(csv_table_read(&back, table_path, RESULT_COLUMNS, NULL, &error) == STATUS_OK);
	PROMISE(back.n_rows == kept);
	PROMISE((kept < store->old.n_rows) == (file_size(back_path) >= 0));
	csv_table_free(&back);
}

static void resume(void)
{
	const off_t size = file_size(table_path);
	struct store store;
	struct error error;
	const enum status status = store_open(&store, table_path, true, &error);
	check_message(status, &error);
	if (status == STATUS_OK)
		rewrite(&store);
	else
		PROMISE(file_size(table_path) == size); /* nothing is lost */
	store_close(&store);
	unlink(back_path);
}

int fuzz_table(const uint8_t *data, size_t size)
{
	static const char *const form[] = {NULL, "--json", "--table"};
	if (size == 0)
		return 0;
	make_directory();
	fuzz_write_table(table_path, data, size);
	const int what = data[0] % 128 % 6;
	switch (what) {
	case 0:
		evaluate();
		break;
	case 1:
		resume();
		break;
	case 5:
		run_command(COMMAND_MERGE, NULL);
		break;
	default:
		run_command(COMMAND_COMPARE, form[what - 2]);
	}
	return 0;
}
