/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit synth - a measurement of a model, as an ideal device would give it, or a noisy one: a MERL file or a CSV of samples. */
#include "data_readers/merl.h"
#include "data_readers/samples_csv.h"
#include "fit/cli/messages.h"
#include "fit/cli/outputs.h"
#include "fit/commands/commands.h"
#include "fit/error/model_samples.h"
#include "fit/error/model_table.h"

#include <gsl/gsl_randist.h>
#include <gsl/gsl_rng.h>

/* Multiplies each value with 1 + noise g, g normally distributed, in the order of the file; at least 0. */
static enum status add_noise(struct measurement *measurement, double noise, uint64_t seed)
{
	gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
	if (!rng)
		return STATUS_NO_MEMORY;
	gsl_rng_set(rng, (unsigned long)seed);
	float *const *plane = measurement->scattered ? measurement->scattered->value : measurement->value;
	for (int c = 0; c < MERL_CHANNELS; c++)
		for (size_t e = 0; e < measurement_count(measurement); e++) {
			float *value = &plane[c][e];
			if (!isnan(*value))
				*value *= (float)fmax(0, 1 + gsl_ran_gaussian(rng, noise));
		}
	gsl_rng_free(rng);
	return STATUS_OK;
}

static enum status make(const struct options *options, const struct cook_torrance *model, bool samples,
			struct measurement *measurement)
{
	const int threads = options->fit.threads;
	return samples ? model_samples(model, threads, measurement)
		       : model_table(model, options->fit.criterion.bins, options->n_phi_d, 90, threads, measurement);
}

static enum status write_file(const char *path, const struct measurement *measurement, struct error *error)
{
	size_t n;
	return measurement->scattered ? samples_csv_write(path, measurement, BINS_NODE, &n, error)
				      : merl_write(path, measurement, error);
}

static enum status synthesise(const struct options *options, const struct cook_torrance *model, bool samples,
			      struct error *error)
{
	struct measurement measurement;
	enum status status = make(options, model, samples, &measurement);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	if (options->noise > 0)
		status = add_noise(&measurement, options->noise, options->fit.seed);
	if (status != STATUS_OK)
		error_set(error, status, "%s", status_str(status));
	else
		status = *options->cancel ? STATUS_INTERRUPTED : write_file(options->path[0], &measurement, error);
	measurement_free(&measurement);
	return status;
}

/* Whether the options go with the kind of file. */
static int check_file(const struct options *options, const struct cook_torrance *model, bool samples)
{
	if (samples && (options_given(options, "phi") || options_given(options, "bins")))
		return options_usage(COMMAND_SYNTH, "--%s means nothing for a CSV",
				     options_given(options, "phi") ? "phi" : "bins");
	if (!samples && ndf_is_anisotropic(&model->ndf))
		return options_usage(COMMAND_SYNTH, "a MERL file is isotropic: expected OUT.csv with --sigma SX,SY");
	return -1;
}

int cmd_synth(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct cook_torrance model;
	struct distribution distribution = {0};
	struct error error;
	int code = options_parse(&options, COMMAND_SYNTH, argc, argv, cancel);
	if (code < 0 && options.n_paths > 1)
		code = options_usage(COMMAND_SYNTH, "expected one OUT.binary or OUT.csv, found %d names",
				     options.n_paths);
	if (code < 0)
		code = options_model(&options, &model, &distribution);
	if (code < 0 && options_given(&options, "seed") && !(options.noise > 0))
		code = options_usage(COMMAND_SYNTH, "--seed means nothing without --noise");
	const bool samples = code < 0 && outputs_end_with(options.path[0], ".csv");
	if (code < 0)
		code = check_file(&options, &model, samples);
	if (code >= 0) {
		distribution_free(&distribution);
		return code;
	}
	const enum status status = synthesise(&options, &model, samples, &error);
	distribution_free(&distribution);
	if (status != STATUS_OK && status != STATUS_INTERRUPTED)
		report_error("%s", error.text);
	if (status != STATUS_OK)
		return status == STATUS_INTERRUPTED ? EXIT_INTERRUPTED : EXIT_FAILED;
	return EXIT_DONE;
}
