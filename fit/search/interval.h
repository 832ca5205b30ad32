/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interval - how certain a fit's shape is: where each of its parameters may lie while E, the others refitted, stays
 * within some per cent of the best.
 *
 * From each local minimum that is good enough the parameter is moved both ways, the others following, on a sample of the
 * table, until E is too high; where that is, the full table tells. A gap narrower than the spacing of the scan's grid may be
 * stepped over. */
#ifndef INTERVAL_H
#define INTERVAL_H

#include "fit/search/search.h"

enum interval_parameter {
	INTERVAL_SIGMA, /* sqrt(sigma_x sigma_y) of an anisotropic shape; of low: sqrt(2/(B C)) */
	INTERVAL_GAMMA, /* of low: C */
	INTERVAL_IOR,
	INTERVAL_K,
	INTERVAL_EXPONENT, /* of the grazing term */
	INTERVAL_SIGMA2,   /* of the second lobe */
	INTERVAL_GAMMA2,
	INTERVAL_RATIO, /* sigma_x/sigma_y of an anisotropic shape, the angle refitted: below 1 the axes have changed over */
	INTERVAL_ANGLE, /* degrees, within 90 of the fit's on either side, so perhaps beyond those */
	INTERVAL_PARAMETERS
};

/* interval_parameter_name - as the columns of the result table: "sigma", "ior", "sigma2". */
const char *interval_parameter_name(enum interval_parameter parameter);

/* struct interval - values of one parameter. An open end is the end of the parameter's domain, inf for a gamma that may be
 * that, and E is near enough even there. */
struct interval {
	double lo, hi;
	bool lo_open, hi_open;
};

enum { INTERVALS_MAX = 4 };

/* struct interval_list - of one parameter: the interval with the fit's own value, then others, ascending; n = 0: the parameter
 * is fixed, the model has it not, or nobody has asked. */
struct interval_list {
	int n;
	struct interval at[INTERVALS_MAX];
};

/* interval_find - those of the free parameters at the optimum *best, whose E on the full table is `error`: where the least
 * E at a value is at most (1 + percent/100) times that, or 1e-6 above it; E is met to about a hundredth of
 * the percentage. Nothing for a tabulated NDF. Of two lobes, and of the axes, only the interval
 * around the fit is found: another valley would be the same fit with lobes or axes changed over. Counts the shapes that it evaluates in *evaluations.
 * Errors: STATUS_NO_MEMORY, STATUS_INTERRUPTED */
MUST_CHECK enum status interval_find(const struct multiresolution *multiresolution, const struct fit_options *options,
				     const struct ndf_class *class, const struct shape *best, double error,
				     double percent, struct interval_list list[INTERVAL_PARAMETERS], long *evaluations);

#endif
