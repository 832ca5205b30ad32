/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit compare - the NDFs side by side: errors per material, and what they come to in all. */
#include "data_readers/text_quote.h"
#include "fit/cli/messages.h"
#include "fit/cli/outputs.h"
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/results/compare.h"
#include "fit/results/contradiction.h"
#include "fit/results/ladder_table.h"
#include "fit/results/store.h"
#include "fit/sources/batch.h"
#include "fit/sources/model_ladder.h"
#include "fit/sources/row_pictures.h"

#include <stdlib.h>
#include <string.h>

/* The pictures of --pictures. */
struct pictures_light {
	struct environment environment;
	size_t n_failed; /* materials without pictures */
};

/* Adds the line of one material. What cannot be rendered is reported and left empty. */
static enum status add_with_pictures(struct comparison *c, const struct options *options, char **const *rows, size_t n,
				     struct pictures_light *light)
{
	struct picture_error *errors = calloc(n, sizeof *errors);
	struct compare_picture *picture = calloc(n, sizeof *picture);
	struct error error = {"out of memory"};
	enum status status = STATUS_NO_MEMORY;
	if (!errors || !picture)
		goto out;
	status = row_pictures_errors(rows, n, &options->fit, &light->environment, errors, &error);
	for (size_t i = 0; i < n; i++)
		picture[i] = (struct compare_picture){errors[i].delta_e, errors[i].ssim};
	if (status != STATUS_OK && status != STATUS_INTERRUPTED)
		report_error("%s", error.text);
	light->n_failed += status != STATUS_OK;
	status = comparison_add(c, rows, n, picture);
out:
	free(picture);
	free(errors);
	return status;
}

static enum status add_materials(struct comparison *c, const struct options *options, const struct csv_table *rows,
				 struct pictures_light *light)
{
	for (size_t start = 0, end; start < rows->n_rows; start = end) {
		end = comparison_material_end(rows, start);
		const enum status status =
			c->pictures ? add_with_pictures(c, options, rows->row + start, end - start, light)
				    : comparison_add(c, rows->row + start, end - start, NULL);
		if (status != STATUS_OK)
			return status;
		if (c->pictures && *options->cancel)
			return STATUS_INTERRUPTED;
	}
	return comparison_end(c);
}

static enum status write_output(const struct options *options, const struct csv_table *table, struct error *error)
{
	report_output(table, options_show(options), report_table);
	if (!options->output)
		return STATUS_OK;
	return store_write(options->output, table, options->json ? report_json : csv_write, error);
}

/* Compares the rows, which get reordered, and writes the outcome. Returns the exit code. */
static int compare(const struct options *options, struct csv_table *rows)
{
	struct comparison c;
	struct pictures_light light = {.n_failed = 0};
	struct error error;
	enum status status = comparison_init(&c, rows, options->pictures, options->sort_by_gain, &error);
	if (status == STATUS_OK) {
		status = options->pictures ? environment_named("studio", &light.environment) : STATUS_OK;
		if (status == STATUS_OK)
			status = add_materials(&c, options, rows, &light);
		if (status != STATUS_OK)
			error_set(&error, status, "%s", status_str(status));
	}
	if (status == STATUS_OK)
		status = write_output(options, &c.table, &error);
	if (status != STATUS_OK && status != STATUS_INTERRUPTED)
		report_error("%s", error.text);
	comparison_free(&c);
	environment_free(&light.environment);
	if (status == STATUS_INTERRUPTED)
		return EXIT_INTERRUPTED;
	return status != STATUS_OK || light.n_failed ? EXIT_FAILED : EXIT_DONE;
}

/* Whether anything was fitted: rows of failures alone have nothing to compare. */
static bool has_fits(const struct csv_table *rows)
{
	for (size_t i = 0; i < rows->n_rows; i++)
		if (*rows->row[i][RESULT_ERROR])
			return true;
	return false;
}

/* Rows that can be compared were made with the same options, but for the weight, and one fit has one result. */
static enum status check_rows(const struct csv_table *rows, const char *path, struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	if (!has_fits(rows))
		return error_set(error, STATUS_NO_DATA, "'%s' has no fits to compare", name);
	for (size_t i = 1; i < rows->n_rows; i++)
		if (!result_same_but_weight(rows->row[0], rows->row[i]))
			return error_set(error, STATUS_FORMAT, "'%s' row %zu: made with other options than row 1", name,
					 i + 1);
	return contradiction_check(rows, path, error);
}

static int compare_table(const struct options *options)
{
	struct error error;
	struct csv_table rows = csv_table_make(result_columns, RESULT_COLUMNS);
	static const char *const useful[] = {"output", "json", "table", "pictures", "threads", "sort", NULL};
	const char *path = options->path[0], *ignored = options_given_beside(options, useful);
	if (!ignored && !options->pictures && options_given(options, "threads"))
		ignored = "threads";
	if (ignored)
		return options_usage(COMMAND_COMPARE, "--%s means nothing for a table that is there already", ignored);
	if (options->n_paths > 1)
		return options_usage(COMMAND_COMPARE, "expected one table and nothing beside it, found %d paths",
				     options->n_paths);
	enum status status = csv_table_read(&rows, path, RESULT_ERROR + 1, NULL, &error);
	if (status == STATUS_OK)
		status = check_rows(&rows, path, &error);
	if (status != STATUS_OK)
		report_error("%s", error.text);
	int code = status != STATUS_OK ? EXIT_FAILED : -1;
	if (code < 0 && options->pictures)
		code = outputs_check_rows(options, &rows);
	if (code < 0)
		code = compare(options, &rows);
	csv_table_free(&rows);
	return code;
}

/* Fits, then compares what came out. */
static int compare_fits(const struct options *options)
{
	struct files files;
	struct batch batch;
	struct error error = {""};
	struct csv_table rows = csv_table_make(result_columns, RESULT_COLUMNS);
	const int bad = files_collect(&files, options->path, options->n_paths, options->recursive, options->cancel);
	const int wrong = bad < 0 ? EXIT_FAILED : outputs_check(options, files.path, files.n);
	if (wrong >= 0 || batch_init(&batch, options, &files) != STATUS_OK) {
		files_free(&files);
		return wrong >= 0 ? wrong : EXIT_FAILED;
	}
	enum status status = options->output ? store_probe(options->output, &error) : STATUS_OK;
	int code = *options->cancel                 ? EXIT_INTERRUPTED
		   : files.n && status == STATUS_OK ? batch_run(&batch)
						    : EXIT_FAILED;
	for (size_t i = 0; i < batch.n && status == STATUS_OK; i++)
		if (csv_table_move(&rows, &batch.file[i].rows) != STATUS_OK)
			status = error_set(&error, STATUS_NO_MEMORY, "out of memory");
	if (status != STATUS_OK)
		report_error("%s", error.text);
	const int compared = status == STATUS_OK && has_fits(&rows) && code != EXIT_INTERRUPTED
				     ? compare(options, &rows)
				     : EXIT_DONE;
	csv_table_free(&rows);
	batch_free(&batch);
	files_free(&files);
	if (compared != EXIT_DONE)
		return compared;
	return code == EXIT_DONE && (bad || status != STATUS_OK) ? EXIT_FAILED : code;
}

/* The ladder of models instead. */
static int compare_models(struct options *options)
{
	static const char *const own[] = {"gray", "lobes", "diffuse", "pictures", "no-diffuse", "no-specular"};
	struct csv_table table = csv_table_make(ladder_columns, LADDER_COLUMNS);
	struct files files;
	struct error error;
	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		if (options_given(options, own[i]))
			return options_usage(COMMAND_COMPARE, "--%s means nothing with --models", own[i]);
	if (options->fit.fresnel == FRESNEL_F82)
		return options_usage(COMMAND_COMPARE, "--fresnel f82 means nothing with --models");
	if (options_given(options, "ndf") && options->fit.n_ndf > 1)
		return options_usage(COMMAND_COMPARE, "--models takes one --ndf");
	options->fit.n_ndf = 1;
	const int bad = files_collect(&files, options->path, options->n_paths, options->recursive, options->cancel);
	const int wrong = bad < 0 ? EXIT_FAILED : outputs_check(options, files.path, files.n);
	enum status status = options->output && wrong < 0 ? store_probe(options->output, &error) : STATUS_OK;
	int code = wrong >= 0 ? wrong : *options->cancel ? EXIT_INTERRUPTED : EXIT_FAILED;
	if (wrong < 0 && status == STATUS_OK && files.n > 0 && !*options->cancel)
		code = model_ladder(options, &files, &table);
	if (table.n_rows > 0 && code != EXIT_INTERRUPTED)
		status = write_output(options, &table, &error);
	if (status != STATUS_OK)
		report_error("%s", error.text);
	csv_table_free(&table);
	files_free(&files);
	return code == EXIT_DONE && (bad || status != STATUS_OK) ? EXIT_FAILED : code;
}

int cmd_compare(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	const int code = options_parse(&options, COMMAND_COMPARE, argc, argv, cancel);
	if (code >= 0)
		return code;
	for (int i = 0; i < options.n_paths; i++)
		if (csv_is_name(options.path[i])) {
			char *path = options.path[0];
			if (options.models)
				return options_usage(COMMAND_COMPARE, "--models needs measurements, not a table");
			options.path[0] = options.path[i];
			options.path[i] = path;
			return compare_table(&options);
		}
	return options.models ? compare_models(&options) : compare_fits(&options);
}
