/* SPDX-License-Identifier: GPL-3.0-or-later */
/* contradiction - rows of one fit that do not agree, as two runs that wrote to one table, or hands, can leave them. */
#ifndef CONTRADICTION_H
#define CONTRADICTION_H

#include "fit/results/result.h"

/* Which rows are of one fit. */
enum same_fit {
	SAME_RUN,  /* all that it was made from and with: path, NDF, options, version, input; a failed row is of none */
	SAME_LINE, /* all that tells rows apart in a table for the eye: material, path, options, NDF */
};

struct contradiction {
	size_t first, second; /* rows, from 1; 0: there is none */
	enum result_column column;
};

/* contradiction_find - the first two rows of one fit that differ in another column than seconds. With --within a
 * file has one row, whatever its NDF. doubtful, repeated: NULL, or per row: whether it is of a fit whose rows
 * differ; whether it agrees with an earlier one. STATUS_NO_MEMORY. */
MUST_CHECK enum status contradiction_find(const struct csv_table *rows, enum same_fit same, struct contradiction *found,
					  bool *doubtful, bool *repeated);

/* contradiction_check - STATUS_FORMAT, with both rows named, if rows of one line of the table at `path` differ;
 * STATUS_NO_MEMORY. */
MUST_CHECK enum status contradiction_check(const struct csv_table *rows, const char *path, struct error *error);

#endif
