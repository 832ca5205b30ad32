/* SPDX-License-Identifier: GPL-3.0-or-later */
/* csv - tables of text cells in RFC 4180's form (lines end with a newline alone).
 * Written by hand: no common library tells a cut last line from a whole one, which resuming needs. */
#ifndef CSV_H
#define CSV_H

#include "fit/results/csv_number.h"
#include "src/status.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct csv_column {
	const char *name;
	bool number; /* each cell is empty or a number */
};

struct csv_table {
	const struct csv_column *column; /* borrowed; must outlive the table */
	int n_columns;
	char ***row; /* row[i][c], never NULL; each row is one allocation */
	size_t n_rows, capacity;
};

/* An empty table with the given columns, for which nothing is allocated yet. */
struct csv_table csv_table_make(const struct csv_column *column, int n_columns);
/* csv_table_free - releases the rows; the columns stay. */
void csv_table_free(struct csv_table *table);
/* csv_table_add - appends a copy of n_columns cells (NULL = empty). STATUS_NO_MEMORY leaves the table as it was. */
MUST_CHECK enum status csv_table_add(struct csv_table *table, const char *const *cell);
/* csv_table_move - appends all rows of `from`, which is empty afterwards. STATUS_NO_MEMORY leaves both as they were. */
MUST_CHECK enum status csv_table_move(struct csv_table *table, struct csv_table *from);

/* csv_table_read - fills an empty table from a file, whose columns are found by their names in the header line and may
 * stand in any order among others. Columns before the first `needed` ones must be there, others may be absent (empty).
 * complete: NULL, or receives how many bytes at the beginning of the file hold complete lines; what follows them, the
 * rest of an interrupted write, is then left out instead of refused.
 * Errors: STATUS_IO, STATUS_NO_MEMORY, STATUS_FORMAT (with file, line, expected, found). The table is then empty. */
MUST_CHECK enum status csv_table_read(struct csv_table *table, const char *path, int needed, size_t *complete,
				      struct error *error);

/* Lines on a stream; failures show in ferror(). */
void csv_write_header(FILE *file, const struct csv_column *column, int n_columns);
void csv_write_row(FILE *file, char *const *cell, int n_columns);
/* csv_write - header and all rows. */
void csv_write(FILE *file, const struct csv_table *table);

/* csv_is_name - whether a file of this name is a table: it ends in .csv, in letters of either case, and does not hold
 * samples of a measurement. */
bool csv_is_name(const char *path);

#endif
