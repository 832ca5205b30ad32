/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ndf_cdf - cumulative distributions of the normals that ndf_sample() draws, with density D(m) m.z [STD supplement, eq. 38
 * to 41; piecewise-linear NDF, eq. 6 to 9]. Those of the visible slopes are in vndf.h. */
#ifndef NDF_CDF_H
#define NDF_CDF_H

#include "src/ndf.h"

/* ndf_cdf_phi - the share of normals whose azimuth is in (0, phi) [eq. 39, in the right quadrant].
 * Given:   phi in radians, finite; beyond a whole turn the share goes on past 1, below 0 it is negative
 * Returns: absolute error 1e-15 (1 + |phi|). */
double ndf_cdf_phi(const struct ndf *ndf, double phi);

/* ndf_cdf_theta - of the normals with the azimuth phi, the share whose polar angle is below theta
 * [eq. 41, divided by its value at pi/2].
 * Given:   theta in [0, pi/2], phi finite, radians
 * Returns: in [0, 1], absolute error 1e-14. */
double ndf_cdf_theta(const struct ndf *ndf, double theta, double phi);

/* ndf_cdf - the share of normals with both: polar angle below theta and azimuth in (0, phi) [eq. 38]; by quadrature
 * where the two are not independent.
 * Given:   theta in [0, pi/2], phi in [-4 pi, 4 pi], radians
 * Returns: absolute error 1e-12 (1 + |phi|). */
double ndf_cdf(const struct ndf *ndf, double theta, double phi);

#endif
