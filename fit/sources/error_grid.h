/* SPDX-License-Identifier: GPL-3.0-or-later */
/* error_grid - the errors of many materials by NDF. */
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
	const char *ndf[FIT_NDFS_MAX]; /* in the order of their first rows */
	size_t n, n_fitted;            /* materials; those with a fit */
	struct error_line *line;       /* in the order of the materials */
	bool by_std;                   /* sorted by the error of STD, which every fitted material has */
};

/* error_grid_make - STATUS_NO_MEMORY; the materials have to outlive the grid. NDFs beyond FIT_NDFS_MAX are left out. */
MUST_CHECK enum status error_grid_make(const struct materials *materials, struct error_grid *grid);
/* error_grid_sort - puts the materials in order of STD's error or, where one has no STD, of their lowest; those without a
 * fit come last. */
void error_grid_sort(struct error_grid *grid);
void error_grid_free(struct error_grid *grid);

#endif
