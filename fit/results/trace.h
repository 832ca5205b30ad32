/* SPDX-License-Identifier: GPL-3.0-or-later */
/* trace - the course of searches, kept in memory, and as CSV: best error against seconds and evaluations. */
#ifndef TRACE_H
#define TRACE_H

#include "fit/results/csv.h"
#include "fit/search/fit.h"

enum trace_column {
	TRACE_MATERIAL,
	TRACE_NDF,
	TRACE_ALGORITHM,
	TRACE_STAGE,
	TRACE_EVALUATIONS,
	TRACE_SECONDS,
	TRACE_ERROR,
	TRACE_COLUMNS
};

extern const struct csv_column trace_columns[TRACE_COLUMNS];

/* struct trace - points in the order in which they were noted; a zeroed one is empty. */
struct trace {
	struct fit_trace *point;
	size_t n, capacity;
	bool incomplete; /* memory ran out; later points are missing */
};

/* trace_note - appends a point: what fit_options.trace calls, `data` being a struct trace. */
void trace_note(void *data, const struct fit_trace *point);
void trace_free(struct trace *trace);

/* trace_write - the rows of one material and algorithm, those of an NDF one after another. Failures show in ferror().
 */
void trace_write(FILE *file, const char *material, const char *algorithm, const struct trace *trace);

#endif
