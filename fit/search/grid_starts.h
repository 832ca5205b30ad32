/* SPDX-License-Identifier: GPL-3.0-or-later */
/* grid_starts - which shapes of an evaluated grid a search begins at. */
#ifndef GRID_STARTS_H
#define GRID_STARTS_H

#include "fit/error/objective.h"

/* struct grid_candidate - a shape of the grid, its error and its place there, which decides between equal errors. */
struct grid_candidate {
	struct shape shape;
	double error;
	int index;
};

/* grid_starts_choose - the shapes of grid[0 .. n-1] that are near() none better, best first, `count` at most, into start[].
 * The grid is sorted. Returns: how many there are. */
int grid_starts_choose(struct grid_candidate grid[], int n, bool (*near)(const struct shape *a, const struct shape *b),
		       struct shape start[], int count);

#endif
