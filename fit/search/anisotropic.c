/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/anisotropic.h"
#include "fit/search/grid_starts.h"
#include <math.h>
#include <stdlib.h>

/* Ratios of 1.3 to 12, angles 15 degrees apart, and what the mean roughness becomes. */
static const double stretches[] = {0.25, 0.6, 1, 1.6, 2.5};
static const double factors[] = {0.45, 0.7, 1, 1.5};
enum { STRETCHES = 5, FACTORS = 4, ANGLES = 12, GRID = STRETCHES * FACTORS * ANGLES };

static struct shape grid_shape(const struct shape *isotropic, int index)
{
	struct shape shape = *isotropic;

	shape.sigma = fmin(fmax(shape.sigma * factors[index % FACTORS], FIT_SIGMA_MIN), FIT_SIGMA_MAX);
	shape.stretch = stretches[index / FACTORS % STRETCHES];
	shape.angle = 15.0 * (index / FACTORS / STRETCHES) - 75;
	return shape;
}

/* Whether two are next to each other, the mean roughness aside: in the plane of the coordinates of space.h. */
static bool near(const struct shape *a, const struct shape *b)
{
	const double p = a->angle * M_PI / 90, q = b->angle * M_PI / 90;

	return hypot(a->stretch * cos(p) - b->stretch * cos(q), a->stretch * sin(p) - b->stretch * sin(q)) < 0.65;
}

/* With a fixed angle the stretch has a sign: an axis across is the same as a negative one. */
static bool allowed(const struct fit_options *options, struct shape *shape)
{
	if (isnan(options->angle))
		return true;
	if (shape->angle != 0 && shape->angle != 90)
		return false;
	shape->stretch = shape->angle == 0 ? shape->stretch : -shape->stretch;
	shape->angle = options->angle;
	return true;
}

int anisotropic_starts(const struct multiresolution *multiresolution, const struct fit_options *options,
		       const struct ndf_class *class, const struct shape *isotropic, struct shape start[], int count,
		       long *evaluations, enum status *status)
{
	struct grid_candidate *grid = malloc(GRID * sizeof *grid);
	struct objective o;
	int n = 0, kept = 0;

	*status = grid ? objective_init(&o, &multiresolution->table[0], options, class, 1, MASKING_COARSE)
		       : STATUS_NO_MEMORY;
	for (int i = 0; i < GRID && *status == STATUS_OK && !fit_cancelled(options); i++) {
		struct linear linear;

		grid[n] = (struct grid_candidate){.shape = grid_shape(isotropic, i), .index = i};
		if (!allowed(options, &grid[n].shape))
			continue;
		grid[n].error = objective_eval(&o, &grid[n].shape, 2e-3, false, &linear);
		n++;
	}
	if (*status == STATUS_OK) {
		objective_free(&o);
		*evaluations += n;
		kept = grid_starts_choose(grid, n, near, start, count);
	}
	free(grid);
	return kept;
}
