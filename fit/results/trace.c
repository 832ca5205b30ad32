/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/trace.h"

#include <stdlib.h>

const struct csv_column trace_columns[TRACE_COLUMNS] = {
	[TRACE_MATERIAL] = {"material", false},
	[TRACE_NDF] = {"ndf", false},
	[TRACE_ALGORITHM] = {"algorithm", false},
	[TRACE_STAGE] = {"stage", false},
	[TRACE_EVALUATIONS] = {"evaluations", true},
	[TRACE_SECONDS] = {"seconds", true},
	[TRACE_ERROR] = {"error", true},
};

void trace_note(void *data, const struct fit_trace *point)
{
	struct trace *trace = data;
	if (trace->n == trace->capacity) {
		const size_t capacity = trace->capacity ? 2 * trace->capacity : 64;
		struct fit_trace *grown = realloc(trace->point, capacity * sizeof(*grown));
		if (!grown) {
			trace->incomplete = true;
			return;
		}
		trace->point = grown;
		trace->capacity = capacity;
	}
	trace->point[trace->n++] = *point;
}

void trace_free(struct trace *trace)
{
	free(trace->point);
	*trace = (struct trace){0};
}

static void write_point(FILE *file, const char *material, const char *algorithm, const struct fit_trace *point)
{
	char evaluations[CSV_NUMBER_SIZE], seconds[CSV_NUMBER_SIZE], error[CSV_NUMBER_SIZE];
	/* The cells are only read. */
	char *const cell[TRACE_COLUMNS] = {
		[TRACE_MATERIAL] = (char *)material,
		[TRACE_NDF] = (char *)ndf_name(point->ndf),
		[TRACE_ALGORITHM] = (char *)algorithm,
		[TRACE_STAGE] = (char *)point->stage,
		[TRACE_EVALUATIONS] = (char *)csv_number(evaluations, (double)point->evaluations),
		[TRACE_SECONDS] = (char *)csv_number(seconds, point->seconds),
		[TRACE_ERROR] = (char *)csv_number(error, point->error),
	};
	csv_write_row(file, cell, TRACE_COLUMNS);
}

void trace_write(FILE *file, const char *material, const char *algorithm, const struct trace *trace)
{
	const struct ndf_class *ndf;
	/* Searches of several NDFs may have run at the same time. */
	for (int k = 0; (ndf = ndf_at(k)) != NULL; k++)
		for (size_t i = 0; i < trace->n; i++)
			if (trace->point[i].ndf == ndf)
				write_point(file, material, algorithm, &trace->point[i]);
}
