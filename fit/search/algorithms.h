/* SPDX-License-Identifier: GPL-3.0-or-later */
/* algorithms - searches to hold the default one against: nlopt's, on the full table, until their time is up.
 *
 * Each comes in two forms. Separable: over the shape (sigma, gamma, ior, k), with kd and ks solved for inside. Joint
 * ("-joint" behind the name): over the shape, kd and ks alike, as most fits of the field are made.
 *     esch, isres, crs2    evolutionary: populations of shapes (the paper's kind of search)
 *     direct-l             divides the space into ever smaller boxes; deterministic
 *     mlsl                 SBPLX from points of a sequence, but not twice towards one local minimum
 *     sbplx, bobyqa, cobyla, praxis   local searches from points of a sequence, one after the other */
#ifndef ALGORITHMS_H
#define ALGORITHMS_H

#include "fit/search/search.h"

enum { ALGORITHM_COUNT = 19 }; /* the default included */

/* struct algorithm - one of the others; NULL stands for the default, see search.h. */
struct algorithm;

/* algorithm_at - number i, 0 .. ALGORITHM_COUNT - 1; the first is the default. */
const struct algorithm *algorithm_at(int i);
/* algorithm_name - "crs2", "crs2-joint", ...; "default" for NULL. */
const char *algorithm_name(const struct algorithm *algorithm);
/* algorithm_find - the one called `name`. Returns STATUS_DOMAIN, *algorithm untouched, when there is none. */
MUST_CHECK enum status algorithm_find(const char *name, const struct algorithm **algorithm);

/* algorithm_run - minimises E with options->algorithm (not NULL) for options->time_s seconds.
 * The first shape is evaluated whatever the time; which one the last is depends on the machine, what comes before
 * on options->seed only.
 * Returns: in *found the best of all it saw; limited unless nothing was left to search; starts are the local searches
 *          (1 for the others)
 * Errors:  STATUS_NO_MEMORY, STATUS_INTERRUPTED, STATUS_UNSUPPORTED: nlopt refused this many parameters */
MUST_CHECK enum status algorithm_run(const struct sample_set *full, const struct fit_options *options,
				     const struct ndf_class *class, struct found *found);

#endif
