/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit convert - a measurement as a CSV of samples, as a MERL file or as an RGL file. */
#include "data_readers/measurement_read.h"
#include "data_readers/merl.h"
#include "data_readers/resample.h"
#include "data_readers/samples_csv.h"
#include "fit/cli/messages.h"
#include "fit/cli/outputs.h"
#include "fit/commands/commands.h"
#include "fit/render/measured_bsdf.h"

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
	char left_out[MEASUREMENT_LEFT_OUT], words[LOST_SIZE / 2];
	if (gamut == GAMUT_CLIP)
		add_count(text, measurement->n_out_of_gamut, "out of gamut, their negative part set to 0");
	if (s && measurement->n_channels > MERL_CHANNELS)
		add_count(text, (size_t)measurement->n_channels,
			  s->gray ? "wavelengths became their mean" : "wavelengths became linear sRGB");
	if (!*measurement_left_out(measurement, LEFT_OUT_ALL, gamut == GAMUT_MASK, left_out))
		return;
	snprintf(words, sizeof words, "left out: %s", left_out);
	add(text, words);
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

/* Whatever is no table already, nor turns, is made one. */
static enum status write_bsdf(const struct options *options, const struct measurement *measurement,
			      char lost[LOST_SIZE], size_t *n, struct error *error)
{
	const bool table = !measurement->scattered || measurement_turns(measurement);
	const enum bins bins = options->fit.criterion.bins;
	const int threads = options->fit.threads;
	struct measurement filled = {0};
	double distance = 0;
	char words[LOST_SIZE / 4];
	enum status status =
		table ? STATUS_OK : measurement_resample(measurement, bins, 180, GAPS_FILLED, threads, &filled, NULL);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	status = *options->cancel
			 ? STATUS_INTERRUPTED
			 : measured_bsdf_write(options->path[1], table ? measurement : &filled, bins,
					       "a measurement, interpolated; written by stdfit " STDFIT_VERSION,
					       threads, &distance, error);
	measurement_free(&filled);
	*n = 0;
	for (size_t e = 0; e < measurement_count(measurement); e++)
		*n += measurement->scattered || !isnan(measurement->value[0][e]);
	snprintf(words, sizeof words, "interpolated, with an error of %.2g %% (L1, weight solid-angle)",
		 100 * distance);
	add(lost, words);
	add_left_out(lost, measurement, options->gamut);
	return status;
}

static enum status convert(const struct options *options, struct error *error)
{
	const struct read_options reading = options_reading(options, options->fit.threads);
	const bool as_table = outputs_end_with(options->path[1], ".binary");
	const char *const one = as_table ? "entry" : "sample", *const many = as_table ? "entries" : "samples";
	struct measurement measurement;
	char lost[LOST_SIZE] = "";
	size_t n = 0;
	enum status status = measurement_read(options->path[0], &reading, &measurement, error);
	if (status != STATUS_OK)
		return status;
	const bool as_bsdf = outputs_end_with(options->path[1], ".bsdf");
	status = (as_table  ? write_table
		  : as_bsdf ? write_bsdf
			    : write_samples)(options, &measurement, lost, &n, error);
	measurement_free(&measurement);
	if (status == STATUS_OK && !options->quiet)
		fprintf(stderr, "%zu %s%s; lost: %s\n", n, n == 1 ? one : many, as_table ? " of the table" : "",
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
	    !outputs_end_with(options.path[1], ".bsdf") && !outputs_standard(options.path[1]))
		code = options_usage(COMMAND_CONVERT, "expected OUT.csv, OUT.binary or OUT.bsdf, or - for a CSV");
	if (code < 0 && !outputs_end_with(options.path[1], ".binary") && options_given(&options, "phi"))
		code = options_usage(COMMAND_CONVERT, "--phi means nothing but for a MERL file");
	if (code >= 0)
		return code;
	const enum status status = convert(&options, &error);
	if (*cancel || status == STATUS_INTERRUPTED)
		return EXIT_INTERRUPTED;
	if (status != STATUS_OK)
		report_error("%s", error.text);
	return status != STATUS_OK ? EXIT_FAILED : EXIT_DONE;
}
