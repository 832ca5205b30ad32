/* SPDX-License-Identifier: GPL-3.0-or-later */
/* second_lobe - where the search of two lobes begins. */
#ifndef SECOND_LOBE_H
#define SECOND_LOBE_H

#include "fit/search/search.h"

/* second_lobe_starts - shapes to go down from, best first, found on the coarsest table: the optimum of one lobe, its roughness
 * as it is, less or more, beside a second lobe over a grid of sigma and gamma, far from one another.
 * Returns: how many there are in start[], at most `count`; 0 and *status when out of memory. */
int second_lobe_starts(const struct multiresolution *multiresolution, const struct fit_options *options,
		       const struct ndf_class *class, const struct shape *one, struct shape start[], int count,
		       long *evaluations, enum status *status);

#endif
