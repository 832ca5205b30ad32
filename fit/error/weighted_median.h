/* SPDX-License-Identifier: GPL-3.0-or-later */
/* weighted_median - the factor D >= 0 of a term of the model, kd among them, that is nearest to many values in the L1 sense. */
#ifndef WEIGHTED_MEDIAN_H
#define WEIGHTED_MEDIAN_H

#include <stddef.h>

/* At one entry D = value makes the model right; weight is what a unit of D adds to the model there. */
struct weighted_value {
	float value, weight;
};

/* weighted_median - the D >= 0 that minimises sum weight |value - D|; sorts the values.
 * Returns: `otherwise` where there is none of positive weight. */
double weighted_median(struct weighted_value *value, size_t n, double otherwise);

#endif
