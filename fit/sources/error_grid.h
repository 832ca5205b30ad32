/* SPDX-License-Identifier: GPL-3.0-or-later */
/* error_grid - the errors of many materials by NDF, and by weight where there are several. */
#ifndef ERROR_GRID_H
#define ERROR_GRID_H

#include "fit/sources/materials.h"

/* struct error_line - one material. */
struct error_line {
	const struct material *material;
	double error[FIT_NDFS_MAX]; /* per NDF; NaN: no fit */
	int best;                   /* NDF of the lowest error, pl only where there is no other; -1: no fit at all */
	double key;                 /* error_grid_sort() sorts by this */
};

struct error_grid {
	int n_ndf;
	bool weights;                  /* of several: then an NDF has a column under each */
	const char *ndf[FIT_NDFS_MAX]; /* in the order of their first rows */
	const char *weight[FIT_NDFS_MAX];
	size_t n, n_fitted;      /* materials; those with a fit */
	size_t n_distinct;       /* of these without those that differ from another by options only, as the weight */
	struct error_line *line; /* in the order of the materials */
	bool by_std;             /* sorted by the error of STD, which every fitted material has; of one weight only */
};

/* error_grid_make - STATUS_NO_MEMORY; the materials have to outlive the grid. NDFs beyond FIT_NDFS_MAX are left out. */
MUST_CHECK enum status error_grid_make(const struct materials *materials, struct error_grid *grid);
/* error_grid_label - what a column is of: "std", or "std, solid-angle" where there are several weights. Returns
 * label. */
enum { ERROR_GRID_LABEL = 64 };
const char *error_grid_label(const struct error_grid *grid, int column, char label[ERROR_GRID_LABEL]);
/* error_grid_sort - puts the materials in order of STD's error or, where one has no STD, of their lowest; those without
 * a fit come last. */
void error_grid_sort(struct error_grid *grid);
void error_grid_free(struct error_grid *grid);

#endif
