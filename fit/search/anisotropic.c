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

/* A grid of shapes, evaluated on the coarsest table. Returns how many of them are starts. */
static int evaluate_grid(const struct multiresolution *multiresolution, const struct fit_options *options,
			 const struct ndf_class *class, struct grid_candidate grid[], int n,
			 bool (*is_near)(const struct shape *a, const struct shape *b), struct shape start[], int count,
			 long *evaluations, enum status *status)
{
	struct objective o;

	*status = objective_init(&o, &multiresolution->table[0], options, class, 1, MASKING_COARSE);
	if (*status != STATUS_OK)
		return 0;
	for (int i = 0; i < n; i++) {
		struct linear linear;

		grid[i].error = fit_cancelled(options) ? OBJECTIVE_NO_FIT
						       : objective_eval(&o, &grid[i].shape, 2e-3, false, &linear);
	}
	objective_free(&o);
	*evaluations += n;
	return grid_starts_choose(grid, n, is_near, start, count);
}

int anisotropic_starts(const struct multiresolution *multiresolution, const struct fit_options *options,
		       const struct ndf_class *class, const struct shape *isotropic, struct shape start[], int count,
		       long *evaluations, enum status *status)
{
	struct grid_candidate *grid = malloc(GRID * sizeof *grid);
	int n = 0;

	*status = grid ? STATUS_OK : STATUS_NO_MEMORY;
	for (int i = 0; i < GRID && grid; i++) {
		grid[n] = (struct grid_candidate){.shape = grid_shape(isotropic, i), .index = i};
		n += allowed(options, &grid[n].shape);
	}
	const int kept =
		grid ? evaluate_grid(multiresolution, options, class, grid, n, near, start, count, evaluations, status)
		     : 0;

	free(grid);
	return kept;
}

/* Of the roughness that a level lobe needs to reach as far: the tilt, and what is left. */
static const double leans[] = {0.3, 0.8, 1.6}, narrowed[] = {0.3, 0.6, 1};
enum { LEANS = 3, NARROWED = 3, DIRECTIONS = 8, TILTS = LEANS * NARROWED * DIRECTIONS };

static struct shape tilted_shape(const struct shape *level, int index)
{
	struct shape shape = *level;
	const double tilt = fmin(shape.sigma * leans[index % LEANS], FIT_TILT_MAX);
	const double turn = 2 * M_PI / DIRECTIONS * (index / LEANS / NARROWED);

	shape.sigma = fmax(shape.sigma * narrowed[index / LEANS % NARROWED], FIT_SIGMA_MIN);
	shape.tilt_x = tilt * cos(turn);
	shape.tilt_y = tilt * sin(turn);
	return shape;
}

static bool tilted_near(const struct shape *a, const struct shape *b)
{
	return hypot(a->tilt_x - b->tilt_x, a->tilt_y - b->tilt_y) < 0.5 * hypot(a->tilt_x, a->tilt_y);
}

int tilted_starts(const struct multiresolution *multiresolution, const struct fit_options *options,
		  const struct ndf_class *class, const struct shape level[], int n_level, struct shape start[],
		  int count, long *evaluations, enum status *status)
{
	const int n = n_level * TILTS;
	struct grid_candidate *grid = malloc((size_t)n * sizeof *grid);

	*status = grid ? STATUS_OK : STATUS_NO_MEMORY;
	for (int i = 0; i < n && grid; i++)
		grid[i] = (struct grid_candidate){.shape = tilted_shape(&level[i / TILTS], i % TILTS), .index = i};
	const int kept = grid ? evaluate_grid(multiresolution, options, class, grid, n, tilted_near, start, count,
					      evaluations, status)
			      : 0;

	free(grid);
	return kept;
}
