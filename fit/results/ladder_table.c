/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/ladder_table.h"

#include <math.h>
#include <string.h>

const struct csv_column ladder_columns[LADDER_COLUMNS] = {
	[LADDER_MATERIAL] = {"material", false},
	[LADDER_NAME] = {"model", false},
	[LADDER_PARAMETERS] = {"parameters", true},
	[LADDER_ERROR] = {"error", true},
	[LADDER_GAIN] = {"gain", true},
	[LADDER_DELTA_E] = {"delta_e", true},
	[LADDER_SSIM] = {"ssim", true},
	[LADDER_SECONDS] = {"seconds", true},
};

static double error_of(const struct ladder_line *line)
{
	return line->row ? result_number(line->row, RESULT_ERROR) : NAN;
}

static double paper_error(const struct ladder_line line[], int n, const char *paper)
{
	for (int i = 0; i < n; i++)
		if (!strcmp(line[i].name, paper))
			return error_of(&line[i]);
	return NAN;
}

static double gain(double error, double paper)
{
	return 100 * (1 - error / paper);
}

double ladder_gain(const struct ladder_line line[], int n, const char *paper)
{
	double least = NAN;
	for (int i = 0; i < n; i++)
		least = fmin(least, error_of(&line[i]));
	return gain(least, paper_error(line, n, paper));
}

enum status ladder_table_add(struct csv_table *table, const char *material, const struct ladder_line line[], int n,
			     const char *paper)
{
	const double of_paper = paper_error(line, n, paper);
	for (int i = 0; i < n; i++) {
		const double error = error_of(&line[i]);
		const double value[LADDER_COLUMNS] = {
			[LADDER_PARAMETERS] = line[i].parameters,
			[LADDER_ERROR] = error,
			[LADDER_GAIN] = gain(error, of_paper),
			[LADDER_DELTA_E] = line[i].delta_e,
			[LADDER_SSIM] = line[i].ssim,
			[LADDER_SECONDS] = line[i].row ? result_number(line[i].row, RESULT_SECONDS) : NAN,
		};
		char text[LADDER_COLUMNS][CSV_NUMBER_SIZE];
		const char *cell[LADDER_COLUMNS] = {[LADDER_MATERIAL] = material, [LADDER_NAME] = line[i].name};
		for (int c = LADDER_PARAMETERS; c < LADDER_COLUMNS; c++)
			cell[c] = csv_number(text[c], value[c]);
		if (csv_table_add(table, cell) != STATUS_OK)
			return STATUS_NO_MEMORY;
	}
	return STATUS_OK;
}
