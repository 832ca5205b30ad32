/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/model_ladder.h"
#include "fit/cli/messages.h"
#include "fit/results/ladder_table.h"
#include "fit/search/ladder.h"
#include "fit/sources/batch.h"
#include "fit/sources/row_pictures.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fits of one file. */
struct climb {
	char **row[LADDER_RUNGS]; /* NULL: none */
	double gain;
};

struct ladder {
	const struct options *options;
	int n_rungs;
	struct ladder_rung rung[LADDER_RUNGS];
	struct csv_table rows; /* of all files and rungs */
	struct climb *climb;   /* of each file */
	struct files left;     /* those that have not failed; the paths are borrowed */
	size_t *number;        /* which of all they are */
};

/* Keeps the row of each file that is done, and leaves the others out from now on. */
static enum status keep_rows(struct ladder *l, struct batch *batch, int rung)
{
	size_t kept = 0;
	for (size_t i = 0; i < batch->n; i++) {
		struct batch_file *file = &batch->file[i];
		if (!file->done || file->failed || file->rows.n_rows != 1)
			continue;
		if (csv_table_move(&l->rows, &file->rows) != STATUS_OK)
			return STATUS_NO_MEMORY;
		l->climb[l->number[i]].row[rung] = l->rows.row[l->rows.n_rows - 1];
		l->left.path[kept] = l->left.path[i];
		l->number[kept++] = l->number[i];
	}
	l->left.n = kept;
	return STATUS_OK;
}

static int fit_rung(struct ladder *l, int rung)
{
	struct options own = *l->options;
	struct batch batch;
	own.fit = l->rung[rung].options;
	if (batch_init(&batch, &own, &l->left) != STATUS_OK)
		return EXIT_FAILED;
	int code = batch_run(&batch);
	if (keep_rows(l, &batch, rung) != STATUS_OK) {
		report_error("out of memory");
		code = EXIT_FAILED;
	}
	batch_free(&batch);
	return code;
}

/* The lines of a file. */
static void set_lines(const struct ladder *l, const struct climb *climb, struct ladder_line line[LADDER_RUNGS])
{
	for (int r = 0; r < l->n_rungs; r++)
		line[r] = (struct ladder_line){l->rung[r].name, l->rung[r].parameters, climb->row[r], NAN, NAN};
}

/* Puts in how the models look. What cannot be rendered is reported and left empty. */
static enum status add_pictures(const struct ladder *l, const struct climb *climb, const struct environment *light,
				struct ladder_line line[LADDER_RUNGS])
{
	char **row[LADDER_RUNGS];
	struct picture_error looks[LADDER_RUNGS];
	int of[LADDER_RUNGS], n = 0;
	struct error error;
	for (int r = 0; r < l->n_rungs; r++)
		if (climb->row[r]) {
			row[n] = climb->row[r];
			of[n++] = r;
		}
	const enum status status = row_pictures_errors(row, (size_t)n, &l->options->fit, light, looks, &error);
	for (int i = 0; i < n; i++) {
		line[of[i]].delta_e = looks[i].delta_e;
		line[of[i]].ssim = looks[i].ssim;
	}
	if (status != STATUS_OK && status != STATUS_INTERRUPTED)
		report_error("%s", error.text);
	return status;
}

static int by_name(const void *a, const void *b)
{
	const struct climb *p = a, *q = b;
	const int order = strcmp(p->row[0][RESULT_MATERIAL], q->row[0][RESULT_MATERIAL]);
	return order ? order : strcmp(p->row[0][RESULT_PATH], q->row[0][RESULT_PATH]);
}

static int by_gain(const void *a, const void *b)
{
	const struct climb *p = a, *q = b;
	if (p->gain != q->gain)
		return p->gain > q->gain ? -1 : 1;
	return by_name(a, b);
}

/* The files that were fitted, in the order of the lines. Returns how many. */
static size_t sort_climbs(struct ladder *l, size_t n)
{
	struct ladder_line line[LADDER_RUNGS];
	size_t kept = 0;
	for (size_t i = 0; i < n; i++) {
		if (!l->climb[i].row[0])
			continue;
		set_lines(l, &l->climb[i], line);
		l->climb[kept] = l->climb[i];
		const double gain = ladder_gain(line, l->n_rungs, LADDER_LOBE);
		l->climb[kept++].gain = isnan(gain) ? -INFINITY : gain;
	}
	qsort(l->climb, kept, sizeof *l->climb, l->options->sort_by_gain ? by_gain : by_name);
	return kept;
}

static int write_lines(struct ladder *l, size_t n, struct csv_table *table)
{
	const size_t n_fitted = sort_climbs(l, n);
	struct environment light = {0};
	int code = EXIT_DONE;
	if (environment_named("studio", &light) != STATUS_OK) {
		report_error("out of memory");
		return EXIT_FAILED;
	}
	for (size_t i = 0; i < n_fitted && code != EXIT_INTERRUPTED; i++) {
		struct ladder_line line[LADDER_RUNGS];
		const struct climb *climb = &l->climb[i];
		set_lines(l, climb, line);
		const enum status shown = add_pictures(l, climb, &light, line);
		const enum status added =
			ladder_table_add(table, climb->row[0][RESULT_MATERIAL], line, l->n_rungs, LADDER_LOBE);
		if (added != STATUS_OK)
			report_error("out of memory");
		if (shown != STATUS_OK || added != STATUS_OK)
			code = EXIT_FAILED;
		if (*l->options->cancel)
			code = EXIT_INTERRUPTED;
	}
	environment_free(&light);
	return code;
}

int model_ladder(const struct options *options, const struct files *files, struct csv_table *table)
{
	struct ladder l = {.options = options,
			   .rows = csv_table_make(result_columns, RESULT_COLUMNS),
			   .climb = calloc(files->n + 1, sizeof *l.climb),
			   .left = {.path = calloc(files->n + 1, sizeof *l.left.path), .n = files->n},
			   .number = calloc(files->n + 1, sizeof *l.number)};
	int code = EXIT_FAILED;
	l.n_rungs = ladder_rungs(&options->fit, l.rung);
	if (!l.climb || !l.left.path || !l.number) {
		report_error("out of memory");
	} else {
		code = EXIT_DONE;
		for (size_t i = 0; i < files->n; i++) {
			l.left.path[i] = files->path[i];
			l.number[i] = i;
		}
	}
	for (int r = 0; r < l.n_rungs && l.left.n > 0 && l.climb && code != EXIT_INTERRUPTED; r++) {
		const int mine = fit_rung(&l, r);
		code = mine == EXIT_DONE ? code : mine;
	}
	if (l.climb && l.rows.n_rows > 0 && code != EXIT_INTERRUPTED) {
		const int mine = write_lines(&l, files->n, table);
		code = mine == EXIT_DONE ? code : mine;
	}
	csv_table_free(&l.rows);
	free(l.climb);
	free(l.left.path);
	free(l.number);
	return code;
}
