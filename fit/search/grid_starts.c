/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/grid_starts.h"
#include <stdlib.h>

static int by_error(const void *a, const void *b)
{
	const struct grid_candidate *p = a, *q = b;

	if (p->error != q->error)
		return p->error < q->error ? -1 : 1;
	return p->index - q->index;
}

int grid_starts_choose(struct grid_candidate grid[], int n, bool (*near)(const struct shape *a, const struct shape *b),
		       struct shape start[], int count)
{
	int kept = 0;

	qsort(grid, (size_t)n, sizeof *grid, by_error);
	for (int i = 0; i < n && kept < count; i++) {
		bool repeats = false;

		for (int m = 0; m < kept && !repeats; m++)
			repeats = near(&grid[i].shape, &start[m]);
		if (!repeats)
			start[kept++] = grid[i].shape;
	}
	return kept;
}
