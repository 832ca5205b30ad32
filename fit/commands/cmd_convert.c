/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit convert - a measurement as a CSV of samples or as a MERL file. */
#include "data_readers/measurement_read.h"
#include "data_readers/merl.h"
#include "data_readers/resample.h"
#include "data_readers/samples_csv.h"
#include "fit/cli/messages.h"
#include "fit/cli/outputs.h"
#include "fit/commands/commands.h"

#include <string.h>

enum { LOST_SIZE = 512 };

/* Adds "; what" to the text. */
static void add(char text[LOST_SIZE], const char *what)
{
	const size_t used = strlen(text);
	snprintf(text + used, LOST_SIZE - used, "%s%s", used ? "; " : "", what);
}

static void add_count(char text[LOST_SIZE], size_t n, const char *what)
{
	char words[LOST_SIZE / 4];
	snprintf(words, sizeof words, "%zu %s", n, what);
	if (n)
		add(text, words);
}

/* What the readers already left out. */
static void add_left_out(char text[LOST_SIZE], const struct measurement *measurement, enum gamut gamut)
{
	const struct scattered *s = measurement->scattered;
	add_count(text, s ? measurement->n_negative : 0, "negative left out");
	add_count(text, s ? measurement->n_nonfinite : 0, "non-finite left out");
	add_count(text, measurement->n_missing, "not measured");
	add_count(text, measurement->n_below_horizon, "at or below the horizon left out");
	add_count(text, measurement->n_out_of_gamut,
		  gamut == GAMUT_MASK ? "out of gamut left out" : "out of gamut, their negative part set to 0");
	if (s && measurement->n_channels > MERL_CHANNELS)
		add_count(text, (size_t)measurement->n_channels,
			  s->gray ? "wavelengths became their mean" : "wavelengths became linear sRGB");
}

static enum status write_samples(const struct options *options, const struct measurement *measurement,
				 char lost[LOST_SIZE], size_t *n, struct error *error)
{
	const enum status status =
		samples_csv_write(options->path[1], measurement, options->fit.criterion.bins, n, error);
	if (!measurement->scattered)
		add_count(lost, measurement_count(measurement) - *n, "masked or below the horizon");
	add_left_out(lost, measurement, options->gamut);
	return status;
}

static enum status write_table(const struct options *options, const struct measurement *measurement,
			       char lost[LOST_SIZE], size_t *n, struct error *error)
{
	struct measurement table;
	struct resampled resampled;
	const struct scattered *s = measurement->scattered;
	enum status status = measurement_resample(measurement, options->fit.criterion.bins, options->n_phi_d,
						  GAPS_MASKED, options->fit.threads, &table, &resampled);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	*n = resampled.n_measured;
	if (s)
		add(lost, "interpolated");
	add_count(lost, resampled.n_outside, "outside what was measured are -1");
	if (resampled.symmetrised)
		add(lost, options->n_phi_d == 180 ? "the mean of both orders of wi and wo"
						  : "the mean of both sides of phi_d");
	if (s && s->symmetry != SYMMETRY_ISOTROPIC)
		add(lost, "turned samples are taken for one");
	add_left_out(lost, measurement, options->gamut);
	status = *options->cancel ? STATUS_INTERRUPTED : merl_write(options->path[1], &table, error);
	measurement_free(&table);
	return status;
}

static enum status convert(const struct options *options, struct error *error)
{
	const struct read_options reading = options_reading(options, options->fit.threads);
	const bool as_table = outputs_end_with(options->path[1], ".binary");
	struct measurement measurement;
	char lost[LOST_SIZE] = "";
	size_t n = 0;
	enum status status = measurement_read(options->path[0], &reading, &measurement, error);
	if (status != STATUS_OK)
		return status;
	status = (as_table ? write_table : write_samples)(options, &measurement, lost, &n, error);
	measurement_free(&measurement);
	if (status == STATUS_OK && !options->quiet)
		fprintf(stderr, "%zu %s; lost: %s\n", n, as_table ? "entries of the table" : "samples",
			lost[0] ? lost : "nothing");
	return status;
}

int cmd_convert(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error;
	int code = options_parse(&options, COMMAND_CONVERT, argc, argv, cancel);
	if (code < 0 && options.n_paths != 2)
		code = options_usage(COMMAND_CONVERT, "expected IN and OUT, found %d names", options.n_paths);
	if (code < 0 && !outputs_end_with(options.path[1], ".csv") && !outputs_end_with(options.path[1], ".binary") &&
	    !outputs_standard(options.path[1]))
		code = options_usage(COMMAND_CONVERT, "expected OUT.csv or OUT.binary, or - for a CSV");
	if (code < 0 && !outputs_end_with(options.path[1], ".binary") && options_given(&options, "phi"))
		code = options_usage(COMMAND_CONVERT, "--phi means nothing for a CSV");
	if (code >= 0)
		return code;
	const enum status status = convert(&options, &error);
	if (*cancel || status == STATUS_INTERRUPTED)
		return EXIT_INTERRUPTED;
	if (status != STATUS_OK)
		report_error("%s", error.text);
	return status != STATUS_OK ? EXIT_FAILED : EXIT_DONE;
}
