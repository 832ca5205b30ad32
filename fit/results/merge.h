/* SPDX-License-Identifier: GPL-3.0-or-later */
/* merge - the rows of several result tables, the shares of one batch, joined and checked. */
#ifndef MERGE_H
#define MERGE_H

#include "fit/results/csv.h"

/* A row, and where it stands. */
struct merge_part {
	char **cell;
	const char *table; /* the path of its table */
	size_t number;     /* of the row in it, from 1 */
	size_t turn;       /* in the order of the tables given */
};

struct merge {
	char *const *path; /* of the tables, borrowed */
	int n_paths;
	struct csv_table *table; /* one each */
	struct merge_part *part; /* all rows; after merge_tables() in order of path and NDF, none twice */
	size_t n;
};

/* Paths of the files that were to be fitted, in order of strcmp. */
struct merge_files {
	char *const *path; /* borrowed */
	size_t n;
};

/* merge_tables - reads the tables m->path[0] to m->path[m->n_paths - 1] and puts their rows in order, equal ones once.
 * All rows must come from one version and the same options (but for the weight), rows of one file from the same bytes,
 * and every file must have rows of the same weights and NDFs. files: NULL, or the rows must be those of these files and
 * of no others. Errors: STATUS_IO, STATUS_NO_MEMORY, STATUS_FORMAT (tables that do not fit each other), STATUS_NO_DATA
 * (no row, or none of a file). merge_free() is due in any case. */
MUST_CHECK enum status merge_tables(struct merge *m, const struct merge_files *files, struct error *error);
/* merge_free - releases the rows; harmless when nothing was read. */
void merge_free(struct merge *m);

#endif
