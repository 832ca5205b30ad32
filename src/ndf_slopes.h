/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ndf_slopes - the distribution of the slopes of the surface that has a given NDF. The normal of slopes (p, q) along x
 * and y is (-p, -q, 1), normalised; all distributions here are even in p and in q. */
#ifndef NDF_SLOPES_H
#define NDF_SLOPES_H

#include "src/ndf.h"

/* ndf_P22 - density of the slopes (p, q), D cos^4 of their normal; relative error as ndf_D(). */
double ndf_P22(const struct ndf *ndf, double p, double q);

/* ndf_P2 - density of the slope q along the azimuth phi (radians), the integral of P22 across it.
 *     Student-t slopes   K (1 + (q/s)^2/a)^(1/2-gamma) / (s sqrt(a))         s^2 = sigma_x^2 cos^2 phi + sigma_y^2
 * sin^2 phi beckmann           exp(-(q/s)^2) / (s sqrt(pi))                        (eq. 4 and 15 of the STD supplement)
 *     gtr, low, pl       by quadrature
 * Returns: relative error 2e-15 + 1e-15 |ln(s P2)|; quadrature 1e-11. */
double ndf_P2(const struct ndf *ndf, double phi, double q);

/* ndf_moment - the moment of P2 of an even order, integral of q^order P2, from order 0, which is 1:
 *     order 2 k:  a^k s^2k Gamma(k + 1/2) Gamma(gamma-1-k) / (sqrt(pi) Gamma(gamma-1))         (eq. 7)
 * Odd ones vanish where they exist. gtr and low have the tail of gamma = 2.
 * Returns: STATUS_OK and *moment, relative error 1e-15 (1 + order); STATUS_DOMAIN, *moment untouched, where the moment
 *          does not exist (order + 2 >= 2 gamma) or order < 0. */
MUST_CHECK enum status ndf_moment(const struct ndf *ndf, double phi, int order, double *moment);

/* ndf_excess_kurtosis - nu_4/nu_2^2 - 3 of P2, 3/(gamma-3): how heavy the tail is, in every direction.
 * Returns: STATUS_OK and *kurtosis, 0 for beckmann; STATUS_DOMAIN, *kurtosis untouched, unless gamma > 3. */
MUST_CHECK enum status ndf_excess_kurtosis(const struct ndf *ndf, double *kurtosis);

#endif
