/* SPDX-License-Identifier: GPL-3.0-or-later */
/* search - the best shape (sigma, gamma, ior, k) of one NDF: a scan of a thinned table, then nlopt on finer ones. */
#ifndef SEARCH_H
#define SEARCH_H

#include "fit/search/local.h"

enum { SEARCH_LEVELS = 4, SEARCH_GIVEN = 20 };

/* struct multiresolution - the table of a material and its thinned copies, coarsest first; the last is the full table. */
struct multiresolution {
	struct sample_set table[SEARCH_LEVELS];
};

/* multiresolution_init - thins `full`, which *multiresolution owns from then on, whatever is returned. */
MUST_CHECK enum status multiresolution_init(struct multiresolution *multiresolution, struct sample_set *full);
void multiresolution_free(struct multiresolution *multiresolution);

/* struct scan_minima - what the scan of the coarsest table has shown of the shapes that were not chosen: the best for each
 * value of each axis of the space. */
struct scan_minima {
	struct space_point slice[SPACE_DIMS][SPACE_VALUES];
};

/* struct found - where a search ended. */
struct found {
	struct shape shape;
	struct linear linear;
	int starts, starts_agreeing; /* local searches on the coarsest table; those within 0.1 % of the best there */
	bool limited;                /* a limit on evaluations stopped the last local search */
	long evaluations;
	long passes; /* over the full table */
};

/* search_clock - seconds of a clock that only runs forward. */
double search_clock(void);

/* search_run - minimises E over the free parameters among sigma, gamma, ior and k, wherever its minimum is. *minima is set if
 * there was anything to search.
 * Errors:  STATUS_NO_MEMORY, STATUS_INTERRUPTED */
MUST_CHECK enum status search_run(const struct multiresolution *multiresolution, const struct fit_options *options,
				  const struct ndf_class *class, struct scan_minima *minima, struct found *found);

/* search_estimate - about what search_run() would end with, from the two smallest samples alone: *error is within 0.3 % of
 * it as a rule, for a quarter of the work; *shape is where. given: shapes to go down from, SEARCH_GIVEN at most; n_given 0: from a scan.
 * Where there is nothing to search, E of the space's only shape.
 * Errors:  as search_run() */
MUST_CHECK enum status search_estimate(const struct multiresolution *multiresolution, const struct fit_options *options,
				       const struct ndf_class *class, const struct shape given[], int n_given,
				       struct shape *shape, double *error);

/* search_minima - the local minima that the scan leads to, refined on the samples up to `level`, best first: at most n_max
 * of those whose E is within `margin` (relative) of the least; and what the scan has shown. Counts the shapes that it
 * evaluates in *evaluations.
 * Errors:  as search_run() */
MUST_CHECK enum status search_minima(const struct multiresolution *multiresolution, const struct fit_options *options,
				     const struct ndf_class *class, int level, double margin,
				     struct space_point point[], int n_max, int *n, struct scan_minima *scan,
				     _Atomic long *evaluations);

/* search_near - whether there is an E below `enough` near a shape: *error is one, or the least of forty evaluations, on the
 * smallest sample alone; INFINITY if there is nothing to search.
 * Errors:  as search_run() */
MUST_CHECK enum status search_near(const struct multiresolution *multiresolution, const struct fit_options *options,
				   const struct ndf_class *class, const struct shape *shape, double enough,
				   double *error);

/* search_from - goes down from the given shapes only (at most SEARCH_GIVEN), against a shape that is known already and
 * its error: what leads there, or to nothing better, is given up early. If all is, found->linear.error is INFINITY. Of two
 * lobes the options' random starts come after that.
 * Errors:  as search_run() */
MUST_CHECK enum status search_from(const struct multiresolution *multiresolution, const struct fit_options *options,
				   const struct ndf_class *class, const struct shape given[], int n_given,
				   const struct shape *known, double error, struct found *found);

#endif
