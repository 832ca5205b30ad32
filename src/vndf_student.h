/* SPDX-License-Identifier: GPL-3.0-or-later */
/* vndf_student - CDF and inverse CDF of Student-t slopes, plain or as seen from a direction. Private to src/.
 *
 * The slope X has density k (1 + X^2)^-p, p > 1 (a Student t with 2p - 1 degrees of freedom, scaled). Seen from a
 * direction it is weighted by the facet's projected area (c - s X)+, s >= 0; c < 0 is a direction below the horizon, s > 0.
 * X is carried as the signed w = sign(X) sqrt(ln(1 + X^2)): for p -> 1 slopes leave the range of a double long
 * before w does, and both a Gaussian body and a power tail are smooth in w. */
#ifndef VNDF_STUDENT_H
#define VNDF_STUDENT_H

struct student {
	double p, k;
	double c, s; /* of the weight; s = 0 is the plain distribution */
};

/* student_quantile - w at which the weighted distribution, normalised, has the CDF u.
 * Given:   u in (0, 1)
 * Returns: w with |CDF(w) - u| <= 1e-13 and <= 1e-11 u; at most the w of X = c/s. For c < 0 the errors are those times the
 *          share of X < c/s that is seen from -c over that seen from c: more the steeper the direction. Where rounding
 *          leaves nothing to be seen, that w. */
double student_quantile(const struct student *student, double u);

/* student_cdf - the CDF itself at the slope X, for c >= 0: absolute error 1e-14, 1 from X = c/s on. */
double student_cdf(const struct student *student, double X);

#endif
