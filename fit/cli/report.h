/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report - what people read: messages, tables, the progress line; and JSON. */
#ifndef REPORT_H
#define REPORT_H

#include "fit/results/csv.h"

/* report_error - "stdfit: <text>" and a newline on standard error. */
void report_error(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* report_json - the table as an array of objects: numbers as numbers, empty cells as null, inf as "inf";
 * bytes that are no printable UTF-8 as U+FFFD. */
void report_json(FILE *file, const struct csv_table *table);
/* report_csv - header and rows. */
void report_csv(FILE *file, const struct csv_table *table);
/* report_table - columns under each other, numbers in five digits. */
void report_table(FILE *file, const struct csv_table *table);
/* report_records - row by row, each cell on a line of its own behind its column's name: for few and long rows. */
void report_records(FILE *file, const struct csv_table *table);
/* report_output - the table on standard output; `readable` prints it if it is to be readable. */
typedef void report_readable(FILE *file, const struct csv_table *table);
enum show { SHOW_NOTHING, SHOW_CSV, SHOW_JSON, SHOW_READABLE };
void report_output(const struct csv_table *table, enum show show, report_readable *readable);

/* report_fits - the fitted rows (of result.h) of one file; a heading too if asked for. */
void report_fits(FILE *file, const struct csv_table *results, bool heading);

/* The progress line of a long work, on standard error. */
struct progress {
	bool shown; /* there is one: standard error is a terminal, and nobody asked for quiet */
	size_t done, n;
	const char *unit;    /* what they are, "files" */
	double start, drawn; /* seconds; when the batch began, when the line was last drawn */
};

struct progress progress_start(size_t n, const char *unit, bool quiet);
/* progress_draw - draws the line anew, at most six times a second. */
void progress_draw(struct progress *progress);
/* progress_erase - clears the line so that something else can be written. */
void progress_erase(struct progress *progress);

#endif
