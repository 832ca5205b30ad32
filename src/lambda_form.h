/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lambda_form - the forms in which the STD paper and its supplement give Lambda of Student-t slopes.
 *
 * In all of them z = cot(theta)/sigma, u = z/sqrt(gamma-1), K = Gamma(gamma-1/2)/(sqrt(pi) Gamma(gamma-1)), and
 *     Lambda = K ((1+u^2)^(3/2-gamma)/((2 gamma-3) u) - integral from u of (1+t^2)^(1/2-gamma))
 * which subtracts nearly equal numbers: where Lambda is small it has no digits left and counts as 0 once negative,
 * while G1 = 1/(1+Lambda) is good. The exact form (student_t.h) has no such weakness. Here for a renderer that uses one
 * of these, so that its own Lambda can be fitted. */
#ifndef LAMBDA_FORM_H
#define LAMBDA_FORM_H

#include "src/status.h"
#include <stdbool.h>

enum lambda_form {
	LAMBDA_EXACT,        /* the class's own: all digits, every gamma */
	LAMBDA_2F1,          /* eq. 13 with Gauss's 2F1 by algorithm 2: gamma up to 1e5; G1 to 2e-14 for gamma < 40,
			      * 2e-13 at 1e3, 2e-12 at 1e5 */
	LAMBDA_INTEGER,      /* finite sum: gamma = 2, 3, ..., 15; G1 to 1e-13 */
	LAMBDA_HALF_INTEGER, /* finite sum: gamma = 2.5, 3.5, ..., 15.5; G1 to 1e-13 */
	LAMBDA_RATIONAL,     /* eq. 22: rational functions; G1 to 0.72 %, every gamma; not 0 at normal incidence */
	LAMBDA_FORM_COUNT,
	LAMBDA_TRAPEZOID /* of pl alone: pwl_G1_trapezoid(), as its paper evaluates it; Lambda is 0 where G1 exceeds 1 */
};

/* lambda_form_name - "exact", "2f1", "integer", "half-integer", "rational", "trapezoid"; "unknown" for any other value. */
const char *lambda_form_name(enum lambda_form form);
/* lambda_form_find - the form called `name`. Returns STATUS_DOMAIN, *form untouched, when there is none. */
MUST_CHECK enum status lambda_form_find(const char *name, enum lambda_form *form);

/* lambda_form_takes - whether the form is defined and accurate at this gamma > 1.5; no for NaN and unknown forms. */
bool lambda_form_takes(enum lambda_form form, double gamma);

/* lambda_form_lambda - Lambda in one of the forms but LAMBDA_EXACT.
 * Given:   gamma that the form takes; K as above, not read for gamma = INFINITY; z > 0, INFINITY along the normal
 * Returns: Lambda >= 0, 0 for huge z but for the rational form; NaN for NaN and for LAMBDA_EXACT. */
double lambda_form_lambda(enum lambda_form form, double gamma, double K, double z);

/* struct lambda_rational - eq. 22 at one gamma:
 *     Lambda = factor (S1 e/z + r21(z) (S22 + S23 r24(z))) - 1/2,   e = exp(-z^2) or (1 + z^2/(gamma-1))^(3/2-gamma)
 * where r21, r24 are ratios p/q of the cubics below, whose coefficients are those of z^0 to z^3. */
struct lambda_rational {
	double factor, S1, S22, S23;
};
struct lambda_rational lambda_form_rational(double gamma, double K);
extern const double lambda_form_p21[4], lambda_form_q21[4], lambda_form_p24[4], lambda_form_q24[4];

/* lambda_form_2f1 - 2F1(1/2, gamma-1/2; 3/2; x), GSL's where GSL has it [STD supplement, algorithm 2, corrected].
 * Given:   gamma in (1.5, 1e5], K as above, x <= 0
 * Returns: relative error 3e-14 for gamma up to 100, 2e-12 at 1e5. Calls GSL inside its domain only: under any error
 *          handler it comes back. */
double lambda_form_2f1(double gamma, double K, double x);

#endif
