/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/error_grid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The column of an NDF under a weight, NULL: the first under any; -1 when it has none. */
static int find_column(const struct error_grid *grid, const char *ndf, const char *weight)
{
	for (int n = 0; n < grid->n_ndf; n++)
		if (!strcmp(grid->ndf[n], ndf) && (!weight || !strcmp(grid->weight[n], weight)))
			return n;
	return -1;
}

static int add_column(struct error_grid *grid, char *const *row)
{
	const char *ndf = row[RESULT_NDF], *weight = row[RESULT_WEIGHT];
	const int found = find_column(grid, ndf, weight);
	if (found >= 0 || grid->n_ndf == FIT_NDFS_MAX)
		return found;
	grid->ndf[grid->n_ndf] = ndf;
	grid->weight[grid->n_ndf] = weight;
	grid->weights |= strcmp(weight, grid->weight[0]) != 0;
	return grid->n_ndf++;
}

const char *error_grid_label(const struct error_grid *grid, int column, char label[ERROR_GRID_LABEL])
{
	snprintf(label, ERROR_GRID_LABEL, "%.30s%s%.30s", grid->ndf[column], grid->weights ? ", " : "",
		 grid->weights ? grid->weight[column] : "");
	return label;
}

static bool is_floor(const struct error_grid *grid, int column)
{
	return !strcmp(grid->ndf[column], "pl");
}

static bool is_better(const struct error_grid *grid, const struct error_line *line, int column)
{
	if (isnan(line->error[column]))
		return false;
	if (line->best < 0 || is_floor(grid, line->best))
		return true;
	return !is_floor(grid, column) && line->error[column] < line->error[line->best];
}

static void add_material(struct error_grid *grid, const struct material *material)
{
	struct error_line *line = &grid->line[grid->n++];
	*line = (struct error_line){.material = material, .best = -1};
	for (int n = 0; n < FIT_NDFS_MAX; n++)
		line->error[n] = NAN;
	for (size_t r = 0; r < material->n_rows; r++) {
		const double e = result_number(material->row[r], RESULT_ERROR);
		const int column = isnan(e) ? -1 : add_column(grid, material->row[r]);
		if (column >= 0)
			line->error[column] = e;
	}
	for (int n = 0; n < grid->n_ndf; n++)
		if (is_better(grid, line, n))
			line->best = n;
	grid->n_fitted += line->best >= 0;
}

enum status error_grid_make(const struct materials *materials, struct error_grid *grid)
{
	*grid = (struct error_grid){.line = calloc(materials->n + 1, sizeof(*grid->line))};
	if (!grid->line)
		return STATUS_NO_MEMORY;
	const struct material *last = NULL;
	for (size_t m = 0; m < materials->n; m++) {
		const struct material *material = &materials->material[m];
		add_material(grid, material);
		if (grid->line[m].best < 0)
			continue;
		grid->n_distinct += !last || !material_is_same(last, material);
		last = material;
	}
	return STATUS_OK;
}

static int line_order(const void *a, const void *b)
{
	const double x = ((const struct error_line *)a)->key, y = ((const struct error_line *)b)->key;
	return (x > y) - (x < y);
}

void error_grid_sort(struct error_grid *grid)
{
	const int std = find_column(grid, "std", NULL);
	grid->by_std = std >= 0 && !grid->weights;
	for (size_t m = 0; m < grid->n && grid->by_std; m++)
		grid->by_std = grid->line[m].best < 0 || !isnan(grid->line[m].error[std]);
	for (size_t m = 0; m < grid->n; m++) {
		struct error_line *line = &grid->line[m];
		line->key = line->best < 0 ? INFINITY : line->error[grid->by_std ? std : line->best];
	}
	qsort(grid->line, grid->n, sizeof(*grid->line), line_order);
}

void error_grid_free(struct error_grid *grid)
{
	free(grid->line);
	*grid = (struct error_grid){.n = 0};
}
