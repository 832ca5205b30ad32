/* SPDX-License-Identifier: GPL-3.0-or-later */
/* store - a result table on disk while it grows: each row is appended with one write, the whole is put in order at
 * the end, and what an earlier run left is used again. A kill at any moment leaves complete rows and perhaps a part
 * of one more. The table is locked from store_open() to the end of store_rewrite() or store_close(): two runs never
 * write to one. What a name means that is a link, a pipe or a descriptor, data_readers/output.h says. */
#ifndef STORE_H
#define STORE_H

#include "data_readers/output.h"
#include "fit/results/result.h"

struct store {
	const char *path;     /* borrowed */
	struct output output; /* open; a file made by us goes again if no line comes */
	bool replaces;        /* an older file is there and is replaced when the first row comes */
	bool headed;          /* the header line stands there */
	struct csv_table old; /* --resume: rows of the earlier run, in order of path and ndf */
	bool *stale;          /* of each old row: it is left out when the table is written anew */
	bool *doubtful;       /* of each old row: others of the same fit differ from it */
	struct error doubt;   /* "" or which rows contradict each other, for a warning */
};

/* store_open - prepares to write to `path`, which changes only when the first row comes.
 * resume: reads the rows of an existing table; the rest of an interrupted write behind them is removed. Rows of one fit
 * that contradict each other count for none, and store->doubt names the first two; of equal ones the first counts.
 * Errors: STATUS_IO (also: another process writes there; resume, and it is no file but written in order),
 * STATUS_NO_MEMORY, STATUS_FORMAT (resume, and the file is no result table of this version). */
MUST_CHECK enum status store_open(struct store *store, const char *path, bool resume, struct error *error);

/* store_has - whether the earlier run left a row, and none that contradicts it, of this file, bytes (any, where they
 * are not known), options and version, for the NDF of that name (NULL: for some NDF) that did not fail. Safe from
 * several threads. */
bool store_has(const struct store *store, const struct result_source *source, const char *ndf);
/* store_drop_stale - the old rows of a path will not be kept for which store_has() holds with none of these n >= 1
 * sources, all of that path. */
void store_drop_stale(struct store *store, const struct result_source *source, int n);

/* store_begin - writes the header line, if it is not there, as the first row would bring it. */
MUST_CHECK enum status store_begin(struct store *store, struct error *error);
/* store_append - writes the rows, each with one write. On failure (STATUS_IO, STATUS_NO_MEMORY) no part of a row is
 * left. */
MUST_CHECK enum status store_append(struct store *store, const struct csv_table *rows, struct error *error);
/* store_rewrite - writes old and new rows anew, in order of material and ndf, beside the table, and puts that in its
 * place. If old rows are left out, the table as it was is kept as FILE~. Nothing may be appended after it. */
MUST_CHECK enum status store_rewrite(struct store *store, const struct csv_table *rows, struct error *error);
/* store_close - releases everything; harmless on a zeroed struct. */
void store_close(struct store *store);

/* store_probe - fails if `path` could not be written, so that hours of work do not end on that. Changes nothing. */
MUST_CHECK enum status store_probe(const char *path, struct error *error);

/* store_check_columns - STATUS_FORMAT unless the file begins with the whole header line of this version, no column more
 * or less. */
MUST_CHECK enum status store_check_columns(const char *path, struct error *error);

/* store_write - a whole table of any kind, by csv_write() or report_json(), in the place of an older file, which is
 * kept as FILE~ beside it. On failure the older file stays. */
MUST_CHECK enum status store_write(const char *path, const struct csv_table *table,
				   void (*write)(FILE *file, const struct csv_table *table), struct error *error);

#endif
