/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/second_lobe.h"
#include "fit/search/grid_starts.h"
#include <math.h>
#include <stdlib.h>

static const double factors[] = {0.5, 0.75, 1, 1.5, 2.5};
static const double sigmas[] = {5e-4, 1.2e-3, 2.5e-3, 5e-3, 9e-3, 0.015, 0.025, 0.04, 0.06,
				0.09, 0.14,   0.2,    0.3,  0.45, 0.7,   1.1,   2};
/* Above the least gamma. */
static const double gammas[] = {0.05, 0.5, 3, 50};
enum { FACTORS = 5, SIGMAS = 17, GAMMAS = 4, GRID = FACTORS * SIGMAS * GAMMAS };

static struct shape grid_shape(const struct shape *one, const struct ndf_class *class, int index)
{
	struct shape shape = *one;

	shape.sigma = fmin(fmax(shape.sigma * factors[index % FACTORS], FIT_SIGMA_MIN), FIT_SIGMA_MAX);
	shape.second_sigma = sigmas[index / FACTORS % SIGMAS];
	if (ndf_has_gamma(class)) {
		const struct ndf_param *gamma = ndf_param_at(class, 1);

		shape.second_gamma =
			fmin(fmax(gamma->min + gammas[index / FACTORS / SIGMAS], gamma->search_min), gamma->search_max);
	}
	return shape;
}

static bool near(const struct shape *a, const struct shape *b)
{
	return fabs(log(a->sigma / b->sigma)) < 0.5 && fabs(log(a->second_sigma / b->second_sigma)) < 0.6;
}

int second_lobe_starts(const struct multiresolution *multiresolution, const struct fit_options *options,
		       const struct ndf_class *class, const struct shape *one, struct shape start[], int count,
		       long *evaluations, enum status *status)
{
	const int total = ndf_has_gamma(class) ? GRID : FACTORS * SIGMAS;
	struct grid_candidate *grid = malloc(GRID * sizeof *grid);
	int kept = 0;

	*status = grid ? STATUS_OK : STATUS_NO_MEMORY;
	if (!grid)
		return 0;
#pragma omp parallel num_threads(options->threads) if (options->threads > 1)
	{
		struct objective o;
		const enum status mine =
			objective_init(&o, &multiresolution->table[0], options, class, 1, MASKING_COARSE);

#pragma omp for schedule(dynamic)
		for (int i = 0; i < total; i++) {
			struct linear linear;

			grid[i] = (struct grid_candidate){
				.shape = grid_shape(one, class, i), .error = INFINITY, .index = i};
			if (mine != STATUS_OK || fit_cancelled(options))
				continue;
			/* Afresh: the result does not depend on the threads. */
			objective_forget(&o);
			grid[i].error = objective_eval(&o, &grid[i].shape, 2e-3, false, &linear);
		}
		if (mine == STATUS_OK)
			objective_free(&o);
		else
#pragma omp critical
			*status = mine;
	}
	*evaluations += total;
	if (*status == STATUS_OK)
		kept = grid_starts_choose(grid, total, near, start, count);
	free(grid);
	return kept;
}
