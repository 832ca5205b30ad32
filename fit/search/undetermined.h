/* SPDX-License-Identifier: GPL-3.0-or-later */
/* undetermined - which parameters of a fit the data do not determine, see FIT_UNDETERMINED in fit.h.
 *
 * To show that a parameter is determined, one value will do at which no other parameters bring the error back. It is sought
 * where the scan was worst, on the coarsest table, with a wide margin: that settles nearly all parameters of
 * nearly all materials for a hundredth of the fit's work. What is left is tried at every value of the scan's axis and at
 * the ends of the range, on finer tables; what is reached on the full table at all of them is undetermined. */
#ifndef UNDETERMINED_H
#define UNDETERMINED_H

#include "fit/search/search.h"

/* undetermined_limit - what E may be, the other parameters refitted, for a parameter to count as undetermined: of a fit
 * that ended at `error`, see FIT_UNDETERMINED. */
double undetermined_limit(double error);

/* undetermined_find - the free parameters, as bits of enum fit_bound, that are undetermined at the optimum *best, whose E
 * on the full table is `error`. Counts the shapes that it evaluates in *evaluations.
 * Given:  *minima of the search_run() of this NDF under these options; determined: parameters known not to be
 * Errors: STATUS_NO_MEMORY, STATUS_INTERRUPTED */
MUST_CHECK enum status undetermined_find(const struct multiresolution *multiresolution,
					 const struct fit_options *options, const struct ndf_class *class,
					 const struct scan_minima *minima, const struct shape *best, double error,
					 unsigned determined, unsigned *undetermined, long *evaluations);

#endif
