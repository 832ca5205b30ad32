/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ndf - normal distribution functions (NDFs) of microfacet theory, behind one interface.
 *
 * D(m) is the density of microfacet normals per solid angle and macroscopic area: the integral of D(m) m.z over the
 * hemisphere is 1. Smith's Lambda(w) follows from the slopes of those normals along w.
 *     beckmann   Gaussian slopes
 *     ggx        Trowbridge-Reitz
 *     std        Student-t slopes with a shape gamma: ggx at gamma = 2, to the bit, and beckmann at gamma = infinity
 * Accuracy, with the given unit vector taken as exact: relative error of D at most 2e-15, of Lambda 3e-14 where it
 * exceeds 1e-20 and 1e-12 down to 1e-300, of G1 1e-15. The rounding of the vector itself changes a far tail of D by
 * more: with vec3_from_spherical_deg() by up to 2.3e-16 |ln D|, 1e-13 at D = 1e-200. */
#ifndef NDF_H
#define NDF_H

#include "status.h"
#include "vec3.h"
#include <stdbool.h>

struct ndf_class; /* one row of the table of distributions; see ndf_class.h */

/* Domain of a roughness: far beyond use, but inside it nothing overflows to NaN. */
#define NDF_SIGMA_MIN 1e-50
#define NDF_SIGMA_MAX 1e50

/* struct ndf - one distribution with its parameters; filled by ndf_init(), then only read. */
struct ndf {
	const struct ndf_class *class;
	double sigma_x, sigma_y; /* roughness along x and y, > 0; equal when isotropic */
	double gamma;            /* STD shape, (1.5, inf]; 2 for ggx, INFINITY for beckmann */
	double K;                /* Gamma(gamma-1/2) / (sqrt(pi) Gamma(gamma-1)), cached; 0 where unused */
};

/* ndf_find - the class called `name` ("std", "ggx", "beckmann"), or NULL. */
const struct ndf_class *ndf_find(const char *name);
/* ndf_at - the classes in the order of the table, index 0, 1, ...; NULL past the last. */
const struct ndf_class *ndf_at(int index);
const char *ndf_name(const struct ndf_class *class);
/* ndf_has_gamma - whether the shape gamma is a free parameter of the class. */
bool ndf_has_gamma(const struct ndf_class *class);

/* ndf_init - prepares a distribution.
 * Given:   sigma_x, sigma_y in [NDF_SIGMA_MIN, NDF_SIGMA_MAX]; gamma in the class's domain, (1.5, INFINITY] for std,
 *          read only by classes that have one
 * Returns: STATUS_OK, or STATUS_DOMAIN with *ndf untouched: an argument outside its range, NaN, or a NULL class. */
MUST_CHECK enum status ndf_init(struct ndf *ndf, const struct ndf_class *class, double sigma_x, double sigma_y,
				double gamma);

/* ndf_D - density of microfacet normals, 1/sr.
 *     beckmann   exp(-q) / (pi sigma_x sigma_y cos^4)                        q = tan^2 (cos^2 phi/sigma_x^2 +
 *     ggx        (1 + q)^-2 / (pi sigma_x sigma_y cos^4)                             sin^2 phi/sigma_y^2)
 *     std        (1 + q/(gamma-1))^-gamma / (pi sigma_x sigma_y cos^4)       [Ribardiere et al. 2017]
 * Given:   m a unit vector
 * Returns: D >= 0; 0 for m.z <= 0; NaN in gives NaN out. The limit at the horizon is 0 for beckmann and gamma > 2,
 *          finite for ggx, infinite for gamma < 2. */
double ndf_D(const struct ndf *ndf, struct vec3 m);

/* ndf_lambda - Smith's Lambda(w), dimensionless: (1/mu) integral over q > mu of (q - mu) P2(q), where mu = cot(theta)
 * and P2 is the density of the slopes along w; anisotropic through sigma^2 = sigma_x^2 cos^2 phi + sigma_y^2 sin^2 phi.
 * Given:   w a unit vector
 * Returns: Lambda >= 0; 0 at normal incidence; INFINITY for w.z <= 0; NaN in gives NaN out. */
double ndf_lambda(const struct ndf *ndf, struct vec3 w);

/* ndf_G1 - Smith's masking 1/(1 + Lambda(w)), in [0, 1]: 1 at normal incidence, 0 for w.z <= 0. */
double ndf_G1(const struct ndf *ndf, struct vec3 w);

#endif
