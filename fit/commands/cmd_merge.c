/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit merge - the tables of a batch's shares, joined into the one that a single run would have written. */
#include "fit/cli/messages.h"
#include "fit/cli/options.h"
#include "fit/cli/outputs.h"
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/results/merge.h"
#include "fit/results/store.h"

#include <stdlib.h>
#include <string.h>

static void show_fits(FILE *file, const struct csv_table *table)
{
	bool weights = false;
	for (size_t i = 1; i < table->n_rows; i++)
		weights |= strcmp(table->row[0][RESULT_WEIGHT], table->row[i][RESULT_WEIGHT]) != 0;
	report_fits(file, table, true, weights);
}

static enum status write_merged(const struct options *options, const struct merge *m, struct error *error)
{
	struct csv_table merged = csv_table_make(result_columns, RESULT_COLUMNS);
	merged.row = calloc(m->n, sizeof(*merged.row));
	if (!merged.row)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	for (size_t i = 0; i < m->n; i++)
		merged.row[merged.n_rows++] = m->part[i].cell;
	qsort(merged.row, merged.n_rows, sizeof(*merged.row), result_order);
	report_output(&merged, options_show(options), show_fits);
	enum status status = STATUS_OK;
	if (options->output)
		status = store_write(options->output, &merged, options->json ? report_json : csv_write, error);
	free(merged.row); /* the rows are the parts' */
	return status;
}

/* Puts the tables before what else is on the command line, each in its order; returns how many there are. */
static int tables_first(char **path, int n)
{
	int n_tables = 0;
	for (int i = 0; i < n; i++) {
		if (!csv_is_name(path[i]))
			continue;
		char *table = path[i];
		memmove(path + n_tables + 1, path + n_tables, (size_t)(i - n_tables) * sizeof(*path));
		path[n_tables++] = table;
	}
	return n_tables;
}

int cmd_merge(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error;
	struct files files = {0};
	const int code = options_parse(&options, COMMAND_MERGE, argc, argv, cancel);
	if (code >= 0)
		return code;
	struct merge m = {.path = options.path, .n_paths = tables_first(options.path, options.n_paths)};
	const int n_files = options.n_paths - m.n_paths;
	if (!m.n_paths)
		return options_usage(COMMAND_MERGE, "expected tables FILE.csv, found none");
	if (options.recursive && !n_files)
		return options_usage(COMMAND_MERGE, "--recursive means nothing without files or directories");
	const int bad =
		n_files ? files_collect(&files, options.path + m.n_paths, n_files, options.recursive, cancel) : 0;
	const int wrong = bad ? EXIT_FAILED : outputs_check(&options, files.path, files.n);
	if (wrong >= 0) {
		files_free(&files);
		return wrong;
	}
	files_sort(&files);
	const struct merge_files fitted = {files.path, files.n};
	enum status status = merge_tables(&m, n_files ? &fitted : NULL, &error);
	if (status == STATUS_OK)
		status = write_merged(&options, &m, &error);
	if (status != STATUS_OK)
		report_error("%s", error.text);
	merge_free(&m);
	files_free(&files);
	return status != STATUS_OK ? EXIT_FAILED : EXIT_DONE;
}
