/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/weighted_median.h"
#include <math.h>
#include <stdlib.h>

static int by_value(const void *a, const void *b)
{
	const float x = ((const struct weighted_value *)a)->value, y = ((const struct weighted_value *)b)->value;

	return (x > y) - (x < y);
}

double weighted_median(struct weighted_value *value, size_t n, double otherwise)
{
	double total = 0, sum = 0;

	for (size_t a = 0; a < n; a++)
		total += (double)value[a].weight;
	if (!(total > 0))
		return otherwise;
	qsort(value, n, sizeof *value, by_value);
	for (size_t a = 0; a < n; a++) {
		sum += (double)value[a].weight;
		if (sum >= total / 2)
			return fmax(0, (double)value[a].value);
	}
	return otherwise;
}
