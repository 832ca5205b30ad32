/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit eval - how far given models are from a MERL file. */
#include "data_readers/measurement_read.h"
#include "data_readers/text_quote.h"
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/results/energy_conservation.h"
#include "fit/sources/model_source.h"

#include <string.h>

enum eval_column {
	EVAL_PATH,
	EVAL_NDF,
	EVAL_METRICS, /* those of the result table, under the same names */
	EVAL_SAMPLES = EVAL_METRICS + RESULT_METRICS,
	EVAL_ALBEDO_R,
	EVAL_ALBEDO_G,
	EVAL_ALBEDO_B,
	EVAL_FURNACE,
	EVAL_ENERGY,
	EVAL_COLUMNS
};

static void name_columns(struct csv_column columns[EVAL_COLUMNS])
{
	columns[EVAL_PATH] = result_columns[RESULT_PATH];
	columns[EVAL_NDF] = result_columns[RESULT_NDF];
	for (int m = 0; m < RESULT_METRICS; m++)
		columns[EVAL_METRICS + m] = result_columns[RESULT_ERROR_NONE + m];
	columns[EVAL_SAMPLES] = result_columns[RESULT_SAMPLES];
	for (int c = 0; c < 3; c++)
		columns[EVAL_ALBEDO_R + c] = result_columns[RESULT_ALBEDO_R + c];
	columns[EVAL_FURNACE] = (struct csv_column){"furnace", true};
	columns[EVAL_ENERGY] = result_columns[RESULT_ENERGY];
}

struct evaluation {
	const char *path;
	struct measurement measurement;
	struct csv_table output;
};

static enum status evaluate(struct evaluation *e, const struct source_model *source, struct error *error)
{
	struct fit_metrics m;
	struct error why;
	const enum status status = fit_eval(&e->measurement, &source->model, &source->fit, &m, &why);
	if (status != STATUS_OK) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(e->path, name, sizeof name);
		return error_set(error, status, "cannot compare with '%s': %.200s", name, why.text);
	}
	const struct energy_conservation energy = energy_conservation_of(&source->model);
	double number[EVAL_COLUMNS];
	for (int metric = 0; metric < RESULT_METRICS; metric++)
		number[EVAL_METRICS + metric] = result_metric(&m, RESULT_ERROR_NONE + (enum result_column)metric);
	number[EVAL_SAMPLES] = (double)m.samples;
	memcpy(&number[EVAL_ALBEDO_R], energy.albedo, sizeof energy.albedo);
	number[EVAL_FURNACE] = energy_conservation_furnace(&source->model);
	char text[EVAL_COLUMNS][CSV_NUMBER_SIZE];
	const char *cell[EVAL_COLUMNS] = {e->path, ndf_name(source->model.ndf.class)};
	for (int c = EVAL_METRICS; c < EVAL_ENERGY; c++)
		cell[c] = csv_number(text[c], number[c]);
	cell[EVAL_ENERGY] = energy_conservation_name(&energy);
	if (csv_table_add(&e->output, cell) != STATUS_OK)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	return STATUS_OK;
}

static enum status evaluate_all(struct evaluation *e, const struct options *options, struct error *error)
{
	struct model_source source;
	const struct read_options reading = options_reading(options, options->fit.threads);
	enum status status = measurement_read(e->path, &reading, &e->measurement, error);
	if (status == STATUS_OK)
		status = model_source_read(options, e->path, &source, error);
	if (status != STATUS_OK)
		return status;
	for (size_t i = 0; i < source.n && status == STATUS_OK; i++)
		status = evaluate(e, &source.model[i], error);
	model_source_free(&source);
	return status;
}

int cmd_eval(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error;
	int code = options_parse(&options, COMMAND_EVAL, argc, argv, cancel);
	if (code < 0 && options.n_paths > 1)
		code = options_usage(COMMAND_EVAL, "expected one FILE, found %d", options.n_paths);
	if (code < 0)
		code = model_source_check(&options, false);
	if (code < 0 && options.fit.n_ndf != 1)
		code = options_usage(COMMAND_EVAL, "--ndf takes one name here");
	if (code >= 0)
		return code;
	struct csv_column columns[EVAL_COLUMNS];
	name_columns(columns);
	struct evaluation e = {.path = options.path[0], .output = csv_table_make(columns, EVAL_COLUMNS)};
	const enum status status = evaluate_all(&e, &options, &error);
	measurement_free(&e.measurement);
	return options_end(&options, status, &error, &e.output, report_records);
}
