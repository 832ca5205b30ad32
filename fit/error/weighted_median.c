/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/weighted_median.h"
#include <math.h>
#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
	const float x = ((const struct wish *)a)->value, y = ((const struct wish *)b)->value;

	return (x > y) - (x < y);
}

double weighted_median(struct wish *wish, size_t n, double otherwise)
{
	double total = 0, sum = 0;

	for (size_t a = 0; a < n; a++)
		total += (double)wish[a].weight;
	if (!(total > 0))
		return otherwise;
	qsort(wish, n, sizeof *wish, by_value);
	for (size_t a = 0; a < n; a++) {
		sum += (double)wish[a].weight;
		if (sum >= total / 2)
			return fmax(0, (double)wish[a].value);
	}
	return otherwise;
}
