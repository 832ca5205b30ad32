/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit eval - how far given models are from a MERL file. */
#include "merl.h"
#include "options.h"
#include "report.h"
#include "result.h"
#include "text_quote.h"

#include <stdlib.h>
#include <string.h>

enum eval_column {
	EVAL_PATH,
	EVAL_NDF,
	EVAL_NONE,
	EVAL_COSINE,
	EVAL_SOLID_ANGLE,
	EVAL_RMS_COSINE,
	EVAL_RMS_CUBE_ROOT,
	EVAL_LOG,
	EVAL_SAMPLES,
	EVAL_COLUMNS
};

static const struct csv_column columns[EVAL_COLUMNS] = {
	[EVAL_PATH] = {"path", false},
	[EVAL_NDF] = {"ndf", false},
	[EVAL_NONE] = {"error_none", true},
	[EVAL_COSINE] = {"error_cosine", true},
	[EVAL_SOLID_ANGLE] = {"error_solid_angle", true},
	[EVAL_RMS_COSINE] = {"rms_cosine", true},
	[EVAL_RMS_CUBE_ROOT] = {"rms_cube_root", true},
	[EVAL_LOG] = {"log_error", true},
	[EVAL_SAMPLES] = {"samples", true},
};

struct evaluation {
	const struct options *options;
	struct samples samples;
	struct csv_table output;
};

static enum status evaluate(struct evaluation *e, const struct cook_torrance *model, const struct fit_options *fit,
			    struct error *error)
{
	struct fit_metrics m;
	struct error why;
	const enum status status = fit_eval(&e->samples, model, fit, &m, &why);
	if (status) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(e->options->path[0], name, sizeof name);
		return error_set(error, status, "cannot compare with '%s': %.200s", name, why.text);
	}
	const double number[EVAL_COLUMNS] = {
		[EVAL_NONE] = m.error[WEIGHT_NONE],
		[EVAL_COSINE] = m.error[WEIGHT_COSINE],
		[EVAL_SOLID_ANGLE] = m.error[WEIGHT_SOLID_ANGLE],
		[EVAL_RMS_COSINE] = m.rms_cosine,
		[EVAL_RMS_CUBE_ROOT] = m.rms_cube_root,
		[EVAL_LOG] = m.log_error,
		[EVAL_SAMPLES] = (double)m.samples,
	};
	char text[EVAL_COLUMNS][CSV_NUMBER_SIZE];
	const char *cell[EVAL_COLUMNS] = {e->options->path[0], ndf_name(model->ndf.class)};
	for (int c = EVAL_NONE; c < EVAL_COLUMNS; c++)
		cell[c] = csv_number(text[c], number[c]);
	if (csv_table_add(&e->output, cell))
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	return STATUS_OK;
}

static bool wanted(const struct options *options, char *const *row, size_t i, const char *material)
{
	if (options->row)
		return i + 1 == (size_t)options->row;
	return !strcmp(row[RESULT_MATERIAL], material) && !result_failed(row) &&
	       (!options_given(options, "ndf") || !strcmp(row[RESULT_NDF], ndf_name(options->fit.ndf[0])));
}

/* Evaluates the rows of a result table that are wanted. */
static enum status evaluate_rows(struct evaluation *e, struct error *error)
{
	const struct options *options = e->options;
	struct csv_table rows = csv_table_make(result_columns, RESULT_COLUMNS);
	char *material = result_material(options->path[0]), name[TEXT_QUOTE_SIZE];
	enum status status = material ? csv_table_read(&rows, options->from, RESULT_SAMPLES, NULL, error)
				      : error_set(error, STATUS_NO_MEMORY, "out of memory");
	size_t found = 0;
	text_quote(options->from, name, sizeof name);
	for (size_t i = 0; i < rows.n_rows && !status; i++) {
		struct cook_torrance model;
		struct fit_options fit = options->fit;
		struct error why;
		if (!wanted(options, rows.row[i], i, material))
			continue;
		found++;
		struct pwl *pwl;
		status = result_model(rows.row[i], &model, &fit, &pwl, &why);
		if (status)
			error_set(error, status, "'%s' row %zu: %.200s", name, i + 1, why.text);
		else
			status = evaluate(e, &model, &fit, error);
		result_model_free(&model, pwl);
	}
	if (!status && !found)
		status = error_set(error, STATUS_NO_DATA, "'%s' has no such row", name);
	free(material);
	csv_table_free(&rows);
	return status;
}

static int check_from(const struct options *options)
{
	static const char *const useful[] = {"from", "row", "ndf", "threads", "json", "table", NULL};
	const char *ignored = options_given_beside(options, useful);
	if (ignored)
		return options_usage(COMMAND_EVAL, "--%s and --from exclude each other", ignored);
	if (options->row && options_given(options, "ndf"))
		return options_usage(COMMAND_EVAL, "--ndf and --row exclude each other");
	return options->fit.n_ndf == 1 ? -1 : options_usage(COMMAND_EVAL, "--ndf takes one name here");
}

int cmd_eval(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct cook_torrance model;
	struct error error;
	int code = options_parse(&options, COMMAND_EVAL, argc, argv, cancel);
	if (code < 0 && options.n_paths > 1)
		code = options_usage(COMMAND_EVAL, "expected one FILE, found %d", options.n_paths);
	if (code < 0 && options.row && !options.from)
		code = options_usage(COMMAND_EVAL, "--row means nothing without --from");
	if (code < 0)
		code = options.from ? check_from(&options) : options_model(&options, &model);
	if (code >= 0)
		return code;
	struct evaluation e = {.options = &options, .output = csv_table_make(columns, EVAL_COLUMNS)};
	enum status status = merl_read(options.path[0], options.fit.threads, &e.samples, &error);
	if (!status)
		status = options.from ? evaluate_rows(&e, &error) : evaluate(&e, &model, &options.fit, &error);
	samples_free(&e.samples);
	if (!status)
		report_output(&e.output, options_show(&options), report_records);
	else if (status != STATUS_INTERRUPTED)
		report_error("%s", error.text);
	csv_table_free(&e.output);
	if (*cancel)
		return EXIT_INTERRUPTED;
	return status ? EXIT_FAILED : EXIT_DONE;
}
