/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ladder_table - models of one material side by side, from the simplest to the richest: what each costs and gains. */
#ifndef LADDER_TABLE_H
#define LADDER_TABLE_H

#include "fit/results/result.h"

enum {
	LADDER_MATERIAL,
	LADDER_NAME,
	LADDER_PARAMETERS,
	LADDER_ERROR,
	LADDER_GAIN, /* by how many percent the error is below that of the paper's model; negative: above */
	LADDER_DELTA_E,
	LADDER_SSIM,
	LADDER_SECONDS,
	LADDER_COLUMNS
};

extern const struct csv_column ladder_columns[LADDER_COLUMNS];

/* struct ladder_line - the fit of one model: its row of the result table, NULL where it failed, and its picture; NaN: none. */
struct ladder_line {
	const char *name;
	int parameters;
	char *const *row;
	double delta_e, ssim;
};

/* ladder_gain - by how many percent the best of n lines is below the one called `paper`; NaN where either has no error. */
double ladder_gain(const struct ladder_line line[], int n, const char *paper);

/* ladder_table_add - adds the n lines of a material. STATUS_NO_MEMORY. */
MUST_CHECK enum status ladder_table_add(struct csv_table *table, const char *material, const struct ladder_line line[],
					int n, const char *paper);

#endif
