/* SPDX-License-Identifier: GPL-3.0-or-later */
/* warp - functions on the unit square, bilinear between the nodes of a grid, that depend on parameters, between whose
 * values they are linear too; and the warp of the square that such a density makes.
 *
 * That of [Dupuy and Jakob 2018]: first y by the marginal density, then x by the conditional one. */
#ifndef WARP_H
#define WARP_H

#include "src/status.h"
#include <stdbool.h>
#include <stddef.h>

enum { WARP_PARAMS = 2 };

/* struct warp_axis - the values of a parameter, ascending; not owned. Between them one is linear, beyond them
 * constant. */
struct warp_axis {
	const float *value;
	size_t n; /* at least 1 */
};

/* struct grid - values[slice][y][x]; slices by the first parameter, then the second. Not owned. */
struct grid {
	struct warp_axis param[WARP_PARAMS];
	size_t width, height; /* at least 2 each */
	const float *value;
	size_t stride; /* from one slice to the next, in values */
};

struct square_point {
	double x, y;
};

/* grid_at - the value at a point of the square; points outside count as the nearest of its edge. */
double grid_at(const struct grid *grid, struct square_point p, const double param[WARP_PARAMS]);

/* struct warp - a grid of a density with its distribution functions. */
struct warp {
	struct grid density;
	float *row;    /* [slice][y][x]: the integral of the line through nodes y from 0 to x, in units of cells */
	float *column; /* [slice][y]: that over the rows from 0 to y; divided, as the other is, by the slice's total */
	float *scale;  /* [slice]: 1 / total, in units of cells */
};

/* warp_init - of a density >= 0 with something in each slice; *warp keeps density->value and the parameters, which are
 * not copied. STATUS_FORMAT: a negative value or an empty slice; STATUS_NO_MEMORY. */
MUST_CHECK enum status warp_init(struct warp *warp, const struct grid *density, struct error *why);
void warp_free(struct warp *warp);

/* warp_invert - where point p of the density stands in the square of uniform numbers.
 * warp_sample - the reverse; *pdf is the density at the result, per unit of area: 0 where none of it is. */
struct square_point warp_invert(const struct warp *warp, struct square_point p, const double param[WARP_PARAMS]);
struct square_point warp_sample(const struct warp *warp, struct square_point u, const double param[WARP_PARAMS],
				double *pdf);

#endif
