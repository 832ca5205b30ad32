/* SPDX-License-Identifier: GPL-3.0-or-later */
/* anisotropic - where the search of an anisotropic shape begins. */
#ifndef ANISOTROPIC_H
#define ANISOTROPIC_H

#include "fit/search/search.h"

/* anisotropic_starts - shapes to go down from, best first, found on the coarsest table: the isotropic optimum with axes, over a
 * grid of the ratio of its roughnesses, their angle and their mean, far from one another. The options' fixed angle is kept.
 * Returns: how many there are in start[], at most `count`; 0 and *status when out of memory. */
int anisotropic_starts(const struct multiresolution *multiresolution, const struct fit_options *options,
		       const struct ndf_class *class, const struct shape *isotropic, struct shape start[], int count,
		       long *evaluations, enum status *status);

/* tilted_starts - the same for facets that lean: over a grid of tilts in every direction, with the axes and less than the roughness
 * of each of the n_level shapes, which do not lean. */
int tilted_starts(const struct multiresolution *multiresolution, const struct fit_options *options,
		  const struct ndf_class *class, const struct shape level[], int n_level, struct shape start[],
		  int count, long *evaluations, enum status *status);

#endif
