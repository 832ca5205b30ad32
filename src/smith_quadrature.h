/* SPDX-License-Identifier: GPL-3.0-or-later */
/* smith_quadrature - Smith's Lambda of an isotropic distribution without a closed form, from its D alone.
 *
 * Over all normals m the integral of (w.m) D is cos(theta_w); that of max(0, w.m) D, which is cos(theta_w)/G1, exceeds
 * it by the facets turned away. So Lambda = (1/cos(theta_w)) integral of max(0, -w.m) D dm: nothing cancels. Those have
 * slopes t > mu = cot(theta_w), and the azimuth is done in closed form. With t = mu cosh(y),
 *     Lambda = 2 integral over y > 0 of P22(t) mu^2 cosh(y) sinh(y) (sinh(y) - atan(sinh(y))) dy,   P22 = D cos^4,
 * even in y and smooth: the trapezoid rule converges exponentially. By hand for that: GSL's qag takes 8 times as long. */
#ifndef SMITH_QUADRATURE_H
#define SMITH_QUADRATURE_H

#include "src/ndf.h"

/* smith_quadrature_lambda - Lambda(w) of ndf, through ndf_D(), ndf->log_width, ndf->far and ndf->gamma.
 * Given:   w a unit vector, w.z > 0. D isotropic, finite at the horizon, and analytic in t = tan(theta) except where t
 * is imaginary, growing towards there no faster than (1 + t^2)^-gamma: so are powers of sums of 1, cos, cos^2 and sin^2
 * with positive weights Returns: Lambda >= 0, absolute error 1e-12 (1 + Lambda), relative 2e-8; 0 along the normal. 30
 * to 60 evaluations of D for mu > 1e-3, ten more for every decade below: 2 to 8 microseconds. */
double smith_quadrature_lambda(const struct ndf *ndf, struct vec3 w);

/* smith_quadrature_P2 - density of the slopes along one direction, integral of P22(sqrt(q^2 + p^2)) over p, for the
 * same distributions. s, the roughness, is not read. Relative error 1e-11. */
double smith_quadrature_P2(const struct ndf *ndf, double s, double q);

#endif
