/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report - how the commands print result tables: as JSON, or as readable text. */
#ifndef REPORT_H
#define REPORT_H

#include "fit/results/csv.h"

/* report_json - the table as an array of objects: numbers as numbers, empty cells as null, inf as "inf";
 * control characters as \uNNNN, bytes that are no UTF-8 as U+FFFD. */
void report_json(FILE *file, const struct csv_table *table);
/* report_table - columns under each other, numbers in five digits. */
void report_table(FILE *file, const struct csv_table *table);
/* report_records - row by row, each cell on a line of its own behind its column's name: for few and long rows. */
void report_records(FILE *file, const struct csv_table *table);
/* report_output - the table on standard output; `readable` prints it if it is to be readable. */
typedef void report_readable(FILE *file, const struct csv_table *table);
enum show { SHOW_NOTHING, SHOW_CSV, SHOW_JSON, SHOW_READABLE };
void report_output(const struct csv_table *table, enum show show, report_readable *readable);

/* report_fits - the fitted rows (of result.h) of one file; a heading too if asked for. weights: with a column of the weight,
 * for fits under several. */
void report_fits(FILE *file, const struct csv_table *results, bool heading, bool weights);

#endif
