/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit export - a model in the form of another program. */
#include "data_readers/atomic_file.h"
#include "data_readers/measurement_read.h"
#include "data_readers/merl.h"
#include "fit/cli/messages.h"
#include "fit/cli/outputs.h"
#include "fit/commands/commands.h"
#include "fit/sources/export_pictures.h"
#include "fit/sources/model_source.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

static int check(const struct options *options)
{
	if (options->n_paths > 1)
		return options_usage(COMMAND_EXPORT, "expected one FILE, found %d", options->n_paths);
	const int code = model_source_check(options, true);
	if (code >= 0)
		return code;
	if (!options_given(options, "format"))
		return options_usage(COMMAND_EXPORT, "expected --format");
	if (model_source_kind(options) == SOURCE_FIT && !options->n_paths)
		return options_usage(COMMAND_EXPORT, "expected FILE to fit, or --from, or --kd and --ks");
	if (model_source_kind(options) != SOURCE_ROWS && options->fit.n_ndf != 1)
		return options_usage(COMMAND_EXPORT, "--ndf takes one name here");
	const bool bsdf = options->format == EXPORT_BSDF || options->format == EXPORT_BSDF_RGB;
	if (!bsdf && (options_given(options, "accuracy") || options_given(options, "size")))
		return options_usage(COMMAND_EXPORT, "--%s means nothing without --format bsdf or bsdf-rgb",
				     options_given(options, "accuracy") ? "accuracy" : "size");
	if (options_given(options, "weight") && model_source_kind(options) != SOURCE_FIT &&
	    !export_has_substitutes(options->format))
		return options_usage(COMMAND_EXPORT,
				     "--weight means nothing without a fit: --format %s has every model",
				     export_format_name(options->format));
	if (export_is_binary(options->format) && !options->output)
		return options_usage(COMMAND_EXPORT, "--format %s is binary and needs -o FILE",
				     export_format_name(options->format));
	return -1;
}

/* Reads the measurement where the export has use for it: the FILE given, or the one that the row is of, if that is there
 * and still the same. Else it does without; the export says what its errors are against. *found is its path, or NULL.
 * Fails only when out of memory: that says nothing about the file. */
static enum status find_samples(const struct options *options, const struct source_model *model,
				struct measurement *measurement, const char **found, struct error *error)
{
	const char *path = options->n_paths ? options->path[0] : model->path;
	*found = measurement->value[0] ? path : NULL;
	if (*found || !path || !export_wants_samples(options->format, &model->model))
		return STATUS_OK;
	const enum status status = measurement_read(path, &model->reading, measurement, error);
	if (status != STATUS_OK)
		return status == STATUS_NO_MEMORY ? status : STATUS_OK;
	if (options->n_paths || result_is_input(model->input, measurement))
		*found = path;
	else
		measurement_free(measurement);
	return STATUS_OK;
}

static enum status write_merl(const struct export *export, const char *path, struct error *error)
{
	struct measurement measurement;
	enum status status = export_table(export, &measurement);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	status = merl_write(path, &measurement, error);
	measurement_free(&measurement);
	return status;
}

static enum status write_stream(const struct export *export, FILE *stream, struct error *error)
{
	struct error why;
	const enum status status = export_write(export, stream, &why);
	if (status != STATUS_OK)
		return error_set(error, status, "cannot export to %s: %.400s", export_format_name(export->format),
				 why.text);
	return STATUS_OK;
}

/* On standard output there is no half of a text that cannot be written whole: that shows in a first go, to nowhere.
 * (A stream in memory would lose a part without a word when it cannot grow.) */
static enum status write_standard(const struct export *export, struct error *error)
{
	FILE *nowhere = fopen("/dev/null", "w");
	if (!nowhere)
		return error_set(error, STATUS_IO, "cannot write '/dev/null': %s", strerror(errno));
	const enum status status = write_stream(export, nowhere, error);
	fclose(nowhere);
	/* main() reports when writing fails. */
	return status != STATUS_OK ? status : write_stream(export, stdout, error);
}

static enum status write_text(const struct export *export, const char *path, struct error *error)
{
	struct atomic_file file;
	if (!path)
		return write_standard(export, error);
	enum status status = atomic_file_open(&file, path, error);
	if (status != STATUS_OK)
		return status;
	status = write_stream(export, file.stream, error);
	if (status == STATUS_OK)
		return atomic_file_commit(&file, error);
	atomic_file_abort(&file);
	return status;
}

/* Writes the one model; reports on standard error what a binary file has no room for. */
static enum status write_model(const struct options *options, const struct source_model *model,
			       struct measurement *measurement, struct error *error)
{
	const char *measured;
	enum status status = find_samples(options, model, measurement, &measured, error);
	if (status != STATUS_OK)
		return status;
	const struct export_source source = {.model = &model->model,
					     .fit = &model->fit,
					     .error = model->error,
					     .weight = options_given(options, "weight") ? options->fit.criterion.weight
											: WEIGHT_SOLID_ANGLE,
					     .material = model->material,
					     .path = measured ? measured : model->path,
					     .measurement = measured ? measurement : NULL,
					     .accuracy = options->accuracy,
					     .size = options->file_size};
	struct export export;
	struct error why;
	status = export_prepare(&export, options->format, &source, &why);
	if (status != STATUS_OK)
		return error_set(error, status, "cannot export to %s: %.400s", export_format_name(options->format),
				 why.text);
	if (*options->cancel)
		return STATUS_INTERRUPTED;
	status = export_pictures(&export, measured ? measurement : NULL);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	status = options->format == EXPORT_MERL ? write_merl(&export, options->output, error)
						: write_text(&export, options->output, error);
	if (status == STATUS_OK && !options->quiet && export_is_binary(options->format))
		fprintf(stderr, "%s\n", export.why);
	return status;
}

/* *wrong: the exit code of a command line that names the row's file as output; that is reported. */
static enum status run(const struct options *options, int *wrong, struct error *error)
{
	struct model_source source;
	enum status status = model_source_read(options, options->n_paths ? options->path[0] : NULL, &source, error);
	if (status != STATUS_OK)
		return status;
	if (model_source_kind(options) == SOURCE_FIT)
		options_say_weight(options);
	if (source.n > 1)
		status =
			error_set(error, STATUS_FORMAT, "%zu rows are meant: choose one with --ndf or --row", source.n);
	else if (source.model[0].path)
		*wrong = outputs_check(options, &source.model[0].path, 1);
	if (status == STATUS_OK && *wrong < 0)
		status = write_model(options, &source.model[0], &source.measurement, error);
	model_source_free(&source);
	return status;
}

int cmd_export(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error = {""};
	int code = options_parse(&options, COMMAND_EXPORT, argc, argv, cancel);
	if (code < 0)
		code = check(&options);
	if (code >= 0)
		return code;
	const enum status status = run(&options, &code, &error);
	if (code >= 0)
		return code;
	if (*cancel || status == STATUS_INTERRUPTED)
		return EXIT_INTERRUPTED;
	if (status != STATUS_OK)
		report_error("%s", error.text);
	return status != STATUS_OK ? EXIT_FAILED : EXIT_DONE;
}
