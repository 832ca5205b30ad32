/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit synth - a MERL file of a model, as an ideal measurement would give it, or a noisy one. */
#include "data_readers/merl.h"
#include "fit/cli/messages.h"
#include "fit/cli/options.h"
#include "fit/commands/commands.h"
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
	for (int c = 0; c < MERL_CHANNELS; c++)
		for (size_t e = 0; e < measurement_count(measurement); e++) {
			float *value = &measurement->value[c][e];
			if (!isnan(*value))
				*value *= (float)fmax(0, 1 + gsl_ran_gaussian(rng, noise));
		}
	gsl_rng_free(rng);
	return STATUS_OK;
}

static enum status synthesise(const struct options *options, const struct cook_torrance *model, struct error *error)
{
	struct measurement measurement;
	enum status status = model_table(model, options->fit.criterion.bins, options->n_phi_d, 90, options->fit.threads,
					 &measurement);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	if (options->noise > 0)
		status = add_noise(&measurement, options->noise, options->fit.seed);
	if (status != STATUS_OK)
		error_set(error, status, "%s", status_str(status));
	else
		status = *options->cancel ? STATUS_INTERRUPTED : merl_write(options->path[0], &measurement, error);
	measurement_free(&measurement);
	return status;
}

int cmd_synth(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct cook_torrance model;
	struct error error;
	int code = options_parse(&options, COMMAND_SYNTH, argc, argv, cancel);
	if (code < 0 && options.n_paths > 1)
		code = options_usage(COMMAND_SYNTH, "expected one OUT.binary, found %d names", options.n_paths);
	if (code < 0)
		code = options_model(&options, &model);
	if (code < 0 && options_given(&options, "seed") && !(options.noise > 0))
		code = options_usage(COMMAND_SYNTH, "--seed means nothing without --noise");
	if (code >= 0)
		return code;
	const enum status status = synthesise(&options, &model, &error);
	if (status != STATUS_OK && status != STATUS_INTERRUPTED)
		report_error("%s", error.text);
	if (status != STATUS_OK)
		return status == STATUS_INTERRUPTED ? EXIT_INTERRUPTED : EXIT_FAILED;
	return EXIT_DONE;
}
