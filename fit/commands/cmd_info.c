/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit info - what is in a MERL file. */
#include "data_readers/merl.h"
#include "fit/cli/messages.h"
#include "fit/cli/options.h"
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/error/entries.h"
#include "fit/error/sample_set.h"
#include "fit/error/suspects.h"

#include <gsl/gsl_statistics_float.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum info_column {
	INFO_PATH,
	INFO_SIZE,
	INFO_HASH,
	INFO_N_THETA_H,
	INFO_N_THETA_D,
	INFO_N_PHI_D,
	INFO_VALID,
	INFO_NEGATIVE,
	INFO_NONFINITE,
	INFO_ABOVE,
	INFO_VALID_ABOVE,
	INFO_RANGE,                   /* min, median, max of red, green, blue */
	INFO_ALBEDO = INFO_RANGE + 9, /* red, green, blue and the share measured, at 0, 30 and 60 degrees */
	INFO_ENDS_AT = INFO_ALBEDO + 4 * SUSPECTS_ALBEDOS,
	INFO_SUSPECTS,
	INFO_COLUMNS
};

static const struct csv_column columns[INFO_COLUMNS] = {
	[INFO_PATH] = {"path", false},
	[INFO_SIZE] = {"size", true},
	[INFO_HASH] = {"hash", false},
	[INFO_N_THETA_H] = {"theta_h", true},
	[INFO_N_THETA_D] = {"theta_d", true},
	[INFO_N_PHI_D] = {"phi_d", true},
	[INFO_VALID] = {"valid", true},
	[INFO_NEGATIVE] = {"negative", true},
	[INFO_NONFINITE] = {"non_finite", true},
	[INFO_ABOVE] = {"above_horizon", true},
	[INFO_VALID_ABOVE] = {"valid_above_horizon", true},
	[INFO_RANGE] = {"min_r", true},
	{"median_r", true},
	{"max_r", true},
	{"min_g", true},
	{"median_g", true},
	{"max_g", true},
	{"min_b", true},
	{"median_b", true},
	{"max_b", true},
	[INFO_ALBEDO] = {"albedo_0_r", true},
	{"albedo_0_g", true},
	{"albedo_0_b", true},
	{"measured_0", true},
	{"albedo_30_r", true},
	{"albedo_30_g", true},
	{"albedo_30_b", true},
	{"measured_30", true},
	{"albedo_60_r", true},
	{"albedo_60_g", true},
	{"albedo_60_b", true},
	{"measured_60", true},
	[INFO_ENDS_AT] = {"ends_at", true},
	[INFO_SUSPECTS] = {"suspects", false},
};

struct range {
	double min, median, max;
};

/* A cosine nearer to 0 is that of an entry on the horizon, to rounding; a measurement there is nothing strange. */
#define HORIZON 1e-9

/* What is counted over the entries. Ranges are of valid entries above the horizon; NaN when there is none. */
struct census {
	size_t valid, above, valid_above, valid_below;
	struct range range[MERL_CHANNELS];
};

/* Counts, and picks out the valid entries above the horizon into value[channel]. */
static void count_entries(const struct measurement *measurement, enum bins bins, float *const value[],
			  struct census *census)
{
	const struct entries entries = entries_make(bins, measurement->n_phi_d);
	size_t at = 0;
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < measurement->n_phi_d; k++, at++) {
				struct vec3 wi, wo;
				entries_dirs(&entries, i, j, k, &wi, &wo);
				const bool above = entry_in_range(wi, wo, 0), valid = !isnan(measurement->value[0][at]);
				census->above += above;
				census->valid += valid;
				census->valid_below += valid && fmin(wi.z, wo.z) < -HORIZON;
				if (!above || !valid)
					continue;
				for (int c = 0; c < MERL_CHANNELS; c++)
					value[c][census->valid_above] = measurement->value[c][at];
				census->valid_above++;
			}
}

/* In double: the sum of two floats may be none. Reorders the values. */
static double median(float *value, size_t n)
{
	const double below = (double)gsl_stats_float_select(value, 1, n, (n - 1) / 2);

	return below / 2 + (double)gsl_stats_float_select(value, 1, n, n / 2) / 2;
}

static enum status take_census(const struct measurement *measurement, enum bins bins, struct census *census)
{
	const size_t n = measurement_count(measurement);
	float *values = malloc(MERL_CHANNELS * n * sizeof(*values));
	if (!values)
		return STATUS_NO_MEMORY;
	float *const value[MERL_CHANNELS] = {values, values + n, values + 2 * n};
	*census = (struct census){0};
	count_entries(measurement, bins, value, census);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		struct range *range = &census->range[c];
		*range = (struct range){NAN, NAN, NAN};
		if (!census->valid_above)
			continue;
		range->min = (double)gsl_stats_float_min(value[c], 1, census->valid_above);
		range->max = (double)gsl_stats_float_max(value[c], 1, census->valid_above);
		range->median = median(value[c], census->valid_above);
	}
	free(values);
	return STATUS_OK;
}

enum { SUSPECTS_SIZE = 256 + SUSPECTS_TEXT };

static void add_count(char *text, const char *what, size_t n)
{
	const size_t used = strlen(text);
	if (n)
		snprintf(text + used, SUSPECTS_SIZE - used, "%s%s: %zu", used ? "; " : "", what, n);
}

/* What a sound measurement does not have. */
static void write_suspects(char text[SUSPECTS_SIZE], const struct measurement *measurement, const struct census *census,
			   const struct suspects *suspects)
{
	char explained[SUSPECTS_TEXT];
	const bool zero = census->range[0].max <= 0 && census->range[1].max <= 0 && census->range[2].max <= 0;
	snprintf(text, SUSPECTS_SIZE, "%s",
		 !census->valid_above ? "no valid entry above the horizon"
		 : zero               ? "all zero"
				      : "");
	add_count(text, "masked above the horizon", census->above - census->valid_above);
	add_count(text, "valid below the horizon", census->valid_below);
	add_count(text, "non-finite", measurement->n_nonfinite);
	const size_t used = strlen(text);
	if (suspects->found)
		snprintf(text + used, SUSPECTS_SIZE - used, "%s%s", used ? "; " : "",
			 suspects_explain(suspects, explained));
}

static enum status add_file(struct csv_table *table, const char *path, const struct measurement *measurement,
			    const struct census *census, const struct suspects *found)
{
	double number[INFO_COLUMNS] = {
		[INFO_SIZE] = (double)measurement->file_size,
		[INFO_N_THETA_H] = MERL_THETA_H,
		[INFO_N_THETA_D] = MERL_THETA_D,
		[INFO_N_PHI_D] = measurement->n_phi_d,
		[INFO_VALID] = (double)census->valid,
		[INFO_NEGATIVE] = (double)measurement->n_negative,
		[INFO_NONFINITE] = (double)measurement->n_nonfinite,
		[INFO_ABOVE] = (double)census->above,
		[INFO_VALID_ABOVE] = (double)census->valid_above,
	};
	for (int c = 0; c < MERL_CHANNELS; c++) {
		number[INFO_RANGE + 3 * c] = census->range[c].min;
		number[INFO_RANGE + 3 * c + 1] = census->range[c].median;
		number[INFO_RANGE + 3 * c + 2] = census->range[c].max;
	}
	for (int a = 0; a < SUSPECTS_ALBEDOS; a++) {
		for (int c = 0; c < MERL_CHANNELS; c++)
			number[INFO_ALBEDO + 4 * a + c] = found->albedo[a][c];
		number[INFO_ALBEDO + 4 * a + 3] = found->measured[a];
	}
	number[INFO_ENDS_AT] = found->ends_at;
	char text[INFO_COLUMNS][CSV_NUMBER_SIZE], hash[CSV_NUMBER_SIZE], suspects[SUSPECTS_SIZE];
	const char *cell[INFO_COLUMNS];
	for (int c = 0; c < INFO_COLUMNS; c++)
		cell[c] = csv_number(text[c], number[c]);
	snprintf(hash, sizeof hash, "%016" PRIx64, measurement->file_hash);
	write_suspects(suspects, measurement, census, found);
	cell[INFO_PATH] = path;
	cell[INFO_HASH] = hash;
	cell[INFO_SUSPECTS] = suspects;
	return csv_table_add(table, cell);
}

static enum status inspect(struct csv_table *table, const struct options *options, const char *path,
			   struct error *error)
{
	struct measurement measurement;
	struct census census;
	struct suspects suspects;
	enum status status = merl_read(path, options->fit.threads, &measurement, error);
	if (status != STATUS_OK)
		return status;
	suspects_find(&measurement, &options->fit.criterion, &suspects);
	status = take_census(&measurement, options->fit.criterion.bins, &census);
	if (status == STATUS_OK)
		status = add_file(table, path, &measurement, &census, &suspects);
	if (status != STATUS_OK)
		error_set(error, status, "out of memory");
	measurement_free(&measurement);
	return status;
}

int cmd_info(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error;
	int code = options_parse(&options, COMMAND_INFO, argc, argv, cancel);
	if (code >= 0)
		return code;
	struct csv_table table = csv_table_make(columns, INFO_COLUMNS);
	code = EXIT_DONE;
	for (int i = 0; i < options.n_paths && !*cancel; i++) {
		if (inspect(&table, &options, options.path[i], &error)) {
			report_error("%s", error.text);
			code = EXIT_FAILED;
		}
	}
	report_output(&table, options_show(&options), report_records);
	csv_table_free(&table);
	return *cancel ? EXIT_INTERRUPTED : code;
}
