/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measured_ndf - the NDF read off a table with the help of a fit.
 *
 * With kd, ks, n and G of the fit held fixed, each entry gives one D(theta_h): the one with which the model equals the
 * measurement there, D = (m - kd/pi - r) 4 cos_i cos_o / (ks F G), r being what a grazing term and a second lobe add. For each
 * theta_h the D that minimises the sum of |m - f| is used: the median of these values, weighted by what a unit of D adds to f.
 * Only entries with theta_d <= 30 degrees count, where F is all but constant and G the same for wi and wo, and with theta_i,
 * theta_o <= 80 degrees, where measurements can be
 * trusted. A cheap estimate: the free form `pl` (free_form.h) has kd, ks, n and G follow D as well. */
#ifndef MEASURED_NDF_H
#define MEASURED_NDF_H

#include "data_readers/measurement.h"
#include "src/cook_torrance.h"
#include "src/pwl.h"

struct measured_ndf {
	double D[MERL_THETA_H]; /* 1/sr; NaN where nothing was measured */
	/* The same as a distribution, normalised, for its G1. Beyond the last theta_h with data the fit's own tail goes
	 * on from there (that of a free form as it is): masking comes from steep facets that no table shows. */
	struct pwl pwl;
	double scale; /* factor of the normalisation: 1 if ks, F and D of the fit agree with the data */
};

/* measured_ndf_make - reads the NDF off the measurement.
 * Errors: STATUS_NO_DATA: the model has no specular term, or no entry that counts shows one; STATUS_NO_MEMORY.
 * *ndf is then empty. */
MUST_CHECK enum status measured_ndf_make(const struct measurement *measurement, const struct cook_torrance *model,
					 enum bins bins, struct measured_ndf *ndf);
void measured_ndf_free(struct measured_ndf *ndf);

#endif
