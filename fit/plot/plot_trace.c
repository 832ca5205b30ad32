/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/text_stream.h"
#include "fit/plot/gnuplot.h"
#include "fit/plot/plot_common.h"
#include "fit/plot/plot_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The points of one material, NDF and algorithm. */
struct curve {
	char *const *row; /* its first */
	char *label;      /* what distinguishes it from the others */
	double last;      /* error at its end */
	bool full;        /* which is one on the full table */
	int colour;
};

struct curves {
	const struct csv_table *trace;
	struct curve *curve;
	size_t *of; /* per row its curve; n of them: none */
	size_t n;
	bool differ[TRACE_ALGORITHM + 1]; /* whether curves differ in this column */
	double start, end;                /* seconds, of all */
};

static const enum trace_column curve_key[] = {TRACE_MATERIAL, TRACE_NDF, TRACE_ALGORITHM};
enum { CURVE_KEYS = sizeof curve_key / sizeof *curve_key };

static double cell_number(char *const *row, enum trace_column column)
{
	double x = NAN;
	return csv_parse_number(row[column], &x) ? x : NAN;
}

static bool is_point(char *const *row)
{
	return cell_number(row, TRACE_SECONDS) > 0 && isfinite(cell_number(row, TRACE_ERROR));
}

static bool same_curve(char *const *a, char *const *b)
{
	for (int k = 0; k < CURVE_KEYS; k++)
		if (strcmp(a[curve_key[k]], b[curve_key[k]]))
			return false;
	return true;
}

/* The curve of a row; a new one is added for its first row. */
static size_t curve_of(struct curves *c, char *const *row)
{
	for (size_t n = c->n; n-- > 0;)
		if (same_curve(c->curve[n].row, row))
			return n;
	c->curve[c->n] = (struct curve){.row = row};
	for (int k = 0; k < CURVE_KEYS; k++)
		c->differ[curve_key[k]] |= strcmp(c->curve[0].row[curve_key[k]], row[curve_key[k]]) != 0;
	return c->n++;
}

static bool has_stage(char *const *row, const char *stage)
{
	return !strcmp(row[TRACE_STAGE], stage);
}

/* Whether a further point shows something new. Once an error on the full table is known, the estimates on thinned tables
 * that the next search begins with do not. */
static bool is_news(const struct curve *curve, char *const *row)
{
	return !curve->full || (has_stage(row, "full") && cell_number(row, TRACE_ERROR) < curve->last);
}

/* `bench` judges all points by the full table, and ends its curves with one of stage "end". */
static bool is_judged(const struct csv_table *trace)
{
	return trace->n_rows > 0 && has_stage(trace->row[trace->n_rows - 1], "end");
}

/* What distinguishes the curve from the others; newly allocated, NULL when out of memory. */
static char *curve_label(const struct curves *c, const struct curve *curve)
{
	struct text_stream stream;
	if (!text_stream_open(&stream))
		return NULL;
	const char *between = "";
	for (int k = 0; k < CURVE_KEYS; k++)
		if (c->differ[curve_key[k]] || (c->n == 1 && curve_key[k] == TRACE_ALGORITHM)) {
			fprintf(stream.file, "%s%s", between, curve->row[curve_key[k]]);
			between = ", ";
		}
	return text_stream_close(&stream);
}

static enum status find_curves(struct curves *c, const struct csv_table *trace)
{
	const bool judged = is_judged(trace);
	*c = (struct curves){.trace = trace, .start = INFINITY};
	c->curve = calloc(trace->n_rows + 1, sizeof(*c->curve));
	c->of = calloc(trace->n_rows + 1, sizeof(*c->of));
	if (!c->curve || !c->of)
		return STATUS_NO_MEMORY;
	for (size_t i = 0; i < trace->n_rows; i++) {
		char *const *row = trace->row[i];
		c->of[i] = trace->n_rows;
		if (!is_point(row))
			continue;
		const size_t n = curve_of(c, row);
		struct curve *curve = &c->curve[n];
		if (!judged && !is_news(curve, row))
			continue;
		c->of[i] = n;
		curve->last = cell_number(row, TRACE_ERROR);
		curve->full = has_stage(row, "full");
		c->start = fmin(c->start, cell_number(row, TRACE_SECONDS));
		c->end = fmax(c->end, cell_number(row, TRACE_SECONDS));
	}
	c->end = c->end > c->start ? c->end : 2 * c->start;
	for (size_t n = 0; n < c->n; n++) {
		c->curve[n].label = curve_label(c, &c->curve[n]);
		if (!c->curve[n].label)
			return STATUS_NO_MEMORY;
	}
	return c->n ? STATUS_OK : STATUS_NO_DATA;
}

static void curves_free(struct curves *c)
{
	for (size_t n = 0; n < c->n; n++)
		free(c->curve[n].label);
	free(c->curve);
	free(c->of);
}

/* One block, headed by the curve's label: what gnuplot calls an index. An end that comes early goes on flat. */
static void put_curve(FILE *file, const struct curves *c, size_t n)
{
	char number[CSV_NUMBER_SIZE];
	plot_text(file, c->curve[n].label);
	fputs(",error\n", file);
	for (size_t i = 0; i < c->trace->n_rows; i++) {
		if (c->of[i] != n)
			continue;
		fputs(c->trace->row[i][TRACE_SECONDS], file);
		plot_number(file, cell_number(c->trace->row[i], TRACE_ERROR));
		fputc('\n', file);
	}
	fputs(csv_number(number, c->end), file);
	plot_number(file, c->curve[n].last);
	fputc('\n', file);
}

static enum status write_curves(const char *directory, const struct curves *c, struct error *error)
{
	struct atomic_file file;
	const enum status status = plot_open(&file, directory, "trace.csv", error);
	if (status != STATUS_OK)
		return status;
	for (size_t n = 0; n < c->n; n++) {
		fputs(n ? "\n\n" : "", file.stream);
		put_curve(file.stream, c, n);
	}
	return atomic_file_commit(&file, error);
}

/* Below it E is that of a table without noise: a fall over so many powers of ten is shown whole. */
#define NEXT_TO_NOTHING 1e-3

/* The range that shows the curves whose ends are near the best one, and part of the way there. */
static void put_range(FILE *file, const struct curves *c)
{
	double best = INFINITY, top;
	for (size_t n = 0; n < c->n; n++)
		best = fmin(best, c->curve[n].last);
	top = best;
	for (size_t n = 0; n < c->n; n++)
		if (c->curve[n].last <= 3 * best)
			top = fmax(top, c->curve[n].last);
	const double span = fmax(1.6 * (top - best), 0.25 * best);
	const bool whole = best < NEXT_TO_NOTHING;
	fprintf(file, "set logscale %s\nset format %s \"%%g\"\nset xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n",
		whole ? "xy" : "x", whole ? "xy" : "x", c->start, c->end,
		whole ? fmax(0.5 * best, 1e-10) : best - 0.06 * span, whole ? 1 : best + span);
}

/* An algorithm and its joint form have one colour. */
static void choose_colours(struct curves *c)
{
	static const char joint[] = "-joint";
	int colours = 0;
	for (size_t n = 0; n < c->n; n++) {
		struct curve *curve = &c->curve[n];
		curve->colour = -1;
		for (size_t k = 0; k < n && curve->colour < 0 && c->differ[TRACE_ALGORITHM]; k++) {
			const char *a = c->curve[k].row[TRACE_ALGORITHM], *b = curve->row[TRACE_ALGORITHM];
			const size_t length = strlen(a) < strlen(b) ? strlen(a) : strlen(b);
			const char *rest = strlen(a) < strlen(b) ? b : a;
			if (!strncmp(a, b, length) && (!rest[length] || !strcmp(rest + length, joint)))
				curve->colour = c->curve[k].colour;
		}
		if (curve->colour < 0)
			curve->colour = colours++;
	}
}

static void put_curves(FILE *file, const struct curves *c)
{
	static const char *const hue[] = {"#000000", "#d55e00", "#0072b2", "#009e73", "#cc79a7",
					  "#e69f00", "#56b4e9", "#8a5a2b", "#6a3d9a", "#808000"};
	for (size_t n = 0; n < c->n; n++) {
		fprintf(file, "%s\"trace.csv\" index %zu skip 1 using 1:2 with steps lw %s dt %d lc rgb \"%s\" title ",
			n ? ", \\\n\t" : "plot ", n, n ? "1.6" : "3",
			strstr(c->curve[n].row[TRACE_ALGORITHM], "-joint") ? 2 : 1,
			hue[(size_t)c->curve[n].colour % (sizeof hue / sizeof *hue)]);
		/* No columnheader(1), which ends at a comma. */
		gnuplot_string(file, c->curve[n].label);
	}
	fputc('\n', file);
}

static enum status write_script(const char *directory, struct curves *c, struct error *error)
{
	enum { LINE = 20, HEIGHT = 640 };
	struct atomic_file file;
	const enum status status = plot_open(&file, directory, "trace.gp", error);
	if (status != STATUS_OK)
		return status;
	const int needed = (int)(c->n < 100 ? c->n : 100) * LINE + 100;
	gnuplot_begin(file.stream, "trace", 1000, needed > HEIGHT ? needed : HEIGHT);
	fputs("set title ", file.stream);
	gnuplot_string(file.stream, c->differ[TRACE_MATERIAL] ? "all materials" : c->curve[0].row[TRACE_MATERIAL]);
	fputs(" noenhanced\nset xlabel \"seconds\"\nset ylabel \"error E\"\nset key outside right top\n", file.stream);
	put_range(file.stream, c);
	choose_colours(c);
	put_curves(file.stream, c);
	gnuplot_end(file.stream);
	return atomic_file_commit(&file, error);
}

enum status plot_trace(const char *directory, const struct csv_table *trace, struct error *error)
{
	struct curves curves;
	enum status status = find_curves(&curves, trace);
	if (status != STATUS_OK)
		error_set(error, status, "%s", status == STATUS_NO_DATA ? "the trace has no points" : "out of memory");
	if (status == STATUS_OK)
		status = write_curves(directory, &curves, error);
	if (status == STATUS_OK)
		status = write_script(directory, &curves, error);
	curves_free(&curves);
	return status;
}
