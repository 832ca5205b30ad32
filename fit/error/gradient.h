/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gradient - how the error of a shape changes with the shape, in one more pass.
 *
 * At the best coefficients of a shape no derivative of the error by them is left: to first order the error changes as that of the
 * same coefficients does (Danskin 1967), by - sum sign(r) x_t da_t over samples and terms. So every parameter costs one
 * evaluation of the terms, at a shape a small step away, and all of them together one pass over the measured values. */
#ifndef GRADIENT_H
#define GRADIENT_H

#include "fit/error/objective.h"

enum { GRADIENT_STEPS = 8 };

struct gradient {
	struct objective *objective;
	int n;
	struct objective *probe;        /* each has the tables of a shape a step away */
	double (*sums)[GRADIENT_STEPS]; /* one set a block */
};

/* gradient_init - for the gradients of an objective by n <= GRADIENT_STEPS parameters; *objective is borrowed. STATUS_NO_MEMORY. */
MUST_CHECK enum status gradient_init(struct gradient *gradient, struct objective *objective, int n,
				     enum masking_density density);
void gradient_free(struct gradient *gradient);

/* gradient_changes - change[i]: by how much E changes from the shape of `linear`, at which the objective has been evaluated last, to
 * near[i], to first order in their distance. STATUS_DOMAIN outside the NDF's domain. */
MUST_CHECK enum status gradient_changes(struct gradient *gradient, const struct linear *linear,
					const struct shape near[], double change[]);

#endif
