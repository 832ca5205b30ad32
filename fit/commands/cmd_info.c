/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit info - what is in the file of a measurement. */
#include "data_readers/measurement_read.h"
#include "fit/cli/messages.h"
#include "fit/cli/options.h"
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/error/census.h"
#include "fit/error/suspects.h"

#include <inttypes.h>
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
	INFO_FORMAT,
	INFO_SYMMETRY,
	INFO_CHANNELS,
	INFO_LEFT_OUT,
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
	[INFO_FORMAT] = {"format", false},
	[INFO_SYMMETRY] = {"symmetry", false},
	[INFO_CHANNELS] = {"channels", true},
	[INFO_LEFT_OUT] = {"left_out", false},
};

enum { SUSPECTS_SIZE = 256 + SUSPECTS_TEXT };

static void add_count(char *text, const char *what, size_t n)
{
	const size_t used = strlen(text);
	if (n)
		snprintf(text + used, SUSPECTS_SIZE - used, "%s%s: %zu", used ? "; " : "", what, n);
}

/* What a sound measurement does not have. */
static void write_suspects(char text[SUSPECTS_SIZE], const struct measurement *measurement, const struct census *census,
			   enum gamut gamut, const struct suspects *suspects)
{
	const bool zero = census->range[0].max <= 0 && census->range[1].max <= 0 && census->range[2].max <= 0;
	snprintf(text, SUSPECTS_SIZE, "%s",
		 !census->valid_above ? "no valid entry above the horizon"
		 : zero               ? "all zero"
				      : "");
	add_count(text, "masked above the horizon", census->above - census->valid_above);
	add_count(text, "valid below the horizon", census->valid_below);
	add_count(text, "non-finite", measurement->n_nonfinite);
	if (gamut == GAMUT_CLIP)
		add_count(text, "out of gamut, set to 0", measurement->n_out_of_gamut);
	if (suspects->found) {
		char explained[SUSPECTS_TEXT];
		const size_t used = strlen(text);
		snprintf(text + used, SUSPECTS_SIZE - used, "%s%s", used ? "; " : "",
			 suspects_explain(suspects, explained));
	}
}

static enum status add_file(struct csv_table *table, const char *path, const struct measurement *measurement,
			    const struct census *census, enum gamut gamut, const struct suspects *found)
{
	const struct scattered *scattered = measurement->scattered;
	double number[INFO_COLUMNS] = {
		[INFO_SIZE] = (double)measurement->file_size,
		[INFO_N_THETA_H] = scattered ? (double)NAN : MERL_THETA_H,
		[INFO_N_THETA_D] = scattered ? (double)NAN : MERL_THETA_D,
		[INFO_N_PHI_D] = scattered ? (double)NAN : measurement->n_phi_d,
		[INFO_CHANNELS] = scattered ? measurement->n_channels : MERL_CHANNELS,
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
	char left_out[MEASUREMENT_LEFT_OUT];
	const char *cell[INFO_COLUMNS];
	for (int c = 0; c < INFO_COLUMNS; c++)
		cell[c] = csv_number(text[c], number[c]);
	snprintf(hash, sizeof hash, "%016" PRIx64, measurement->file_hash);
	write_suspects(suspects, measurement, census, gamut, found);
	cell[INFO_PATH] = path;
	cell[INFO_HASH] = hash;
	cell[INFO_SUSPECTS] = suspects;
	cell[INFO_FORMAT] = measurement->format;
	cell[INFO_SYMMETRY] = symmetry_name(scattered ? scattered->symmetry : SYMMETRY_ISOTROPIC);
	cell[INFO_LEFT_OUT] = measurement_left_out(measurement, LEFT_OUT_OF_TABLE, gamut == GAMUT_MASK, left_out);
	return csv_table_add(table, cell);
}

static enum status inspect(struct csv_table *table, const struct options *options, const char *path,
			   struct error *error)
{
	struct measurement measurement;
	struct census census;
	struct suspects suspects;
	const struct read_options reading = options_reading(options, options->fit.threads);
	enum status status = measurement_read(path, &reading, &measurement, error);
	if (status != STATUS_OK)
		return status;
	status = suspects_find(&measurement, &options->fit.criterion, &suspects);
	if (status == STATUS_OK)
		status = census_take(&measurement, options->fit.criterion.bins, &census);
	if (status == STATUS_OK)
		status = add_file(table, path, &measurement, &census, options->gamut, &suspects);
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
	struct files files;
	code = files_collect(&files, options.path, options.n_paths, options.recursive, cancel) ? EXIT_FAILED
											       : EXIT_DONE;
	for (size_t i = 0; i < files.n && !*cancel; i++) {
		if (inspect(&table, &options, files.path[i], &error) != STATUS_OK) {
			report_error("%s", error.text);
			code = EXIT_FAILED;
		}
	}
	files_free(&files);
	report_output(&table, options_show(&options), report_records);
	csv_table_free(&table);
	return *cancel ? EXIT_INTERRUPTED : code;
}
