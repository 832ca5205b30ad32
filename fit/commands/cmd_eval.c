/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit eval - how far given models are from a MERL file. */
#include "data_readers/merl.h"
#include "data_readers/text_quote.h"
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/results/energy_conservation.h"
#include "fit/sources/model_source.h"

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
	EVAL_ALBEDO_R,
	EVAL_ALBEDO_G,
	EVAL_ALBEDO_B,
	EVAL_FURNACE,
	EVAL_ENERGY,
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
	[EVAL_ALBEDO_R] = {"albedo_r", true},
	[EVAL_ALBEDO_G] = {"albedo_g", true},
	[EVAL_ALBEDO_B] = {"albedo_b", true},
	[EVAL_FURNACE] = {"furnace", true},
	[EVAL_ENERGY] = {"energy", false},
};

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
	const double number[EVAL_COLUMNS] = {
		[EVAL_NONE] = m.error[WEIGHT_NONE],
		[EVAL_COSINE] = m.error[WEIGHT_COSINE],
		[EVAL_SOLID_ANGLE] = m.error[WEIGHT_SOLID_ANGLE],
		[EVAL_RMS_COSINE] = m.rms_cosine,
		[EVAL_RMS_CUBE_ROOT] = m.rms_cube_root,
		[EVAL_LOG] = m.log_error,
		[EVAL_SAMPLES] = (double)m.samples,
		[EVAL_ALBEDO_R] = energy.albedo[0],
		[EVAL_ALBEDO_G] = energy.albedo[1],
		[EVAL_ALBEDO_B] = energy.albedo[2],
		[EVAL_FURNACE] = energy_conservation_furnace(&source->model),
	};
	char text[EVAL_COLUMNS][CSV_NUMBER_SIZE];
	const char *cell[EVAL_COLUMNS] = {e->path, ndf_name(source->model.ndf.class)};
	for (int c = EVAL_NONE; c < EVAL_ENERGY; c++)
		cell[c] = csv_number(text[c], number[c]);
	cell[EVAL_ENERGY] = energy_conservation_name(&energy);
	if (csv_table_add(&e->output, cell))
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	return STATUS_OK;
}

static enum status evaluate_all(struct evaluation *e, const struct options *options, struct error *error)
{
	struct model_source source;
	enum status status = merl_read(e->path, options->fit.threads, &e->measurement, error);
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
	struct evaluation e = {.path = options.path[0], .output = csv_table_make(columns, EVAL_COLUMNS)};
	const enum status status = evaluate_all(&e, &options, &error);
	measurement_free(&e.measurement);
	return options_end(&options, status, &error, &e.output, report_records);
}
