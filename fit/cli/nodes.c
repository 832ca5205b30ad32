/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/nodes.h"
#include "data_readers/text_quote.h"
#include "fit/results/csv.h"

#include <math.h>
#include <stdlib.h>

enum { NODES_THETA, NODES_D, NODES_DX, NODES_DY, NODES_COLUMNS };

static const struct csv_column columns[NODES_COLUMNS] = {
	[NODES_THETA] = {"theta", true},
	[NODES_D] = {"D", true},
	[NODES_DX] = {"Dx", true},
	[NODES_DY] = {"Dy", true},
};

/* Whether every row has a number in the column. */
static bool is_filled(const struct csv_table *table, int column)
{
	for (size_t i = 0; i < table->n_rows; i++)
		if (!*table->row[i][column])
			return false;
	return true;
}

/* Newly allocated; NULL: out of memory. */
static double *numbers_of(const struct csv_table *table, int column, double unit)
{
	double *value = calloc(table->n_rows + 1, sizeof *value);
	for (size_t i = 0; value && i < table->n_rows; i++) {
		value[i] = NAN;
		if (csv_parse_number(table->row[i][column], &value[i]))
			value[i] *= unit;
	}
	return value;
}

static enum status make(const struct csv_table *table, struct pwl *pwl)
{
	const bool round = is_filled(table, NODES_D), axes = is_filled(table, NODES_DX) && is_filled(table, NODES_DY);
	if (round == axes || table->n_rows > PWL_NODES_MAX)
		return STATUS_DOMAIN;
	double *theta = numbers_of(table, NODES_THETA, M_PI / 180);
	double *Dx = numbers_of(table, round ? NODES_D : NODES_DX, 1), *Dy = numbers_of(table, NODES_DY, 1);
	const enum status status =
		theta && Dx && Dy ? pwl_init(pwl, (int)table->n_rows, theta, Dx, round ? NULL : Dy) : STATUS_NO_MEMORY;
	free(theta);
	free(Dx);
	free(Dy);
	return status;
}

enum status nodes_read(const char *path, struct pwl *pwl, struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	struct csv_table table = csv_table_make(columns, NODES_COLUMNS);
	*pwl = (struct pwl){0};
	enum status status = csv_table_read(&table, path, NODES_THETA + 1, NULL, error);
	if (status != STATUS_OK)
		return status;
	status = make(&table, pwl);
	csv_table_free(&table);
	text_quote(path, name, sizeof name);
	if (status == STATUS_NO_MEMORY)
		return error_set(error, status, "cannot read '%s': out of memory", name);
	if (status != STATUS_OK)
		return error_set(
			error, STATUS_FORMAT,
			"'%s' has no nodes: expected theta from 0 to 90 degrees, ascending, and D, or Dx and Dy, "
			"not negative nor all 0",
			name);
	return STATUS_OK;
}
