/* SPDX-License-Identifier: GPL-3.0-or-later */
/* least_distance - the point of a polytope that is nearest to a given one, in a few dimensions: a small strictly convex
 * quadratic program in coordinates in which its quadratic form is the identity. */
#ifndef LEAST_DISTANCE_H
#define LEAST_DISTANCE_H

#include <stdbool.h>

enum { LEAST_DISTANCE_DIMS = 8, LEAST_DISTANCE_ROWS = 112 };

struct least_distance {
	int dims, n_rows;
	double normal[LEAST_DISTANCE_ROWS][LEAST_DISTANCE_DIMS], level[LEAST_DISTANCE_ROWS]; /* normal . z >= level */
	double z[LEAST_DISTANCE_DIMS];          /* the given point; then the nearest one */
	double multiplier[LEAST_DISTANCE_ROWS]; /* >= 0: z - given = sum multiplier normal */
};

/* least_distance_solve - moves z, by the dual active-set method of Goldfarb and Idnani (1983). Returns false where the rows
 * leave no point, or rounding keeps it from an end; z and the multipliers are then those reached: they fulfil the equation above,
 * but not all rows. */
bool least_distance_solve(struct least_distance *problem);

#endif
