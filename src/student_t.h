/* SPDX-License-Identifier: GPL-3.0-or-later */
/* student_t - the distributions with Student-t slopes, the general family of the STD paper and its supplement:
 *
 *     P22(p, q) = (gamma-1)/(pi a sigma_x sigma_y) (1 + ((p/sigma_x)^2 + (q/sigma_y)^2)/a)^-gamma
 *
 * a = gamma-1 is std, a = 1 Hyper-Cauchy, a = gamma-2 has a variance that gamma leaves alone; in the paper's terms
 * B = 1/(a sigma^2), C = gamma. All are std with the roughness sigma/stretch, stretch = sqrt((gamma-1)/a).
 * Private to src/: these are the rows of the table of classes that share their formulas. */
#ifndef STUDENT_T_H
#define STUDENT_T_H

#include "src/ndf.h"

/* student_t_K - Gamma(gamma-1/2) / (sqrt(pi) Gamma(gamma-1)), relative error 1e-15; 1/sqrt(pi) times the root of
 * gamma - 1 for large gamma, INFINITY for INFINITY. */
double student_t_K(double gamma);

/* student_t_prepare - fills in a, stretch and K. Returns true. */
bool student_t_prepare(struct ndf *ndf, double a);

/* student_t_z - cot(theta_w)/sigma in terms of std; INFINITY along the normal. */
double student_t_z(const struct ndf *ndf, struct vec3 w);

double student_t_D(const struct ndf *ndf, struct vec3 m);
double student_t_lambda(const struct ndf *ndf, struct vec3 w);
double student_t_P2(const struct ndf *ndf, double s, double q);
double student_t_tilt(const struct ndf *ndf, double u);
double student_t_share(const struct ndf *ndf, double s);

#endif
