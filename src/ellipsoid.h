/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ellipsoid - the ellipsoid NDF: the normals of the ellipsoid |A p| = 1, cut in half [Walter et al. 2014].
 *
 * A is any regular 3x3 matrix, n = (0, 0, 1) the normal of the surface. c A and Q A, Q orthogonal, give the same
 * distribution. A = S R with S = diag(alpha_x, alpha_y, 1) is the usual form; R = 1 is anisotropic GGX with sigma =
 * alpha, other R skew it: the commonest normal is then not n. */
#ifndef ELLIPSOID_H
#define ELLIPSOID_H

#include "src/status.h"
#include "src/vec3.h"

/* Roughness alpha of ellipsoid_init_angles(). */
#define ELLIPSOID_ALPHA_MIN 1e-50
#define ELLIPSOID_ALPHA_MAX 1e50

/* struct ellipsoid - one distribution; filled by ellipsoid_init(), then only read. */
struct ellipsoid {
	struct vec3 A[3];       /* rows, divided by the largest element */
	struct vec3 inverse[3]; /* rows of the transposed inverse */
	double det;             /* |det A| */
	double sign;            /* of det A */
	struct vec3 An;         /* A n */
	double length_An;
};

/* ellipsoid_init - from the rows of A.
 * Returns: STATUS_OK, or STATUS_DOMAIN with *ellipsoid untouched: an element is not finite, or A is singular: its
 *          determinant, each row taken at length 1, is below 2e-15. */
MUST_CHECK enum status ellipsoid_init(struct ellipsoid *ellipsoid, const double A[3][3]);

/* ellipsoid_init_angles - from A = S Rx(theta_x) Ry(theta_y) Rz(theta_z) [Eq. 2, 3].
 * Given:   alpha_x, alpha_y in [ELLIPSOID_ALPHA_MIN, ELLIPSOID_ALPHA_MAX]; angles finite, radians
 * Returns: STATUS_OK, or STATUS_DOMAIN with *ellipsoid untouched. */
MUST_CHECK enum status ellipsoid_init_angles(struct ellipsoid *ellipsoid, double alpha_x, double alpha_y,
					     double theta_x, double theta_y, double theta_z);

/* ellipsoid_D - density of microfacet normals, 1/sr, D = 1/(pi |det A| |A n| |A^-T m|^4) [Eq. 1]: the integral of D cos
 * is 1. 0 for m.z <= 0; NaN in gives NaN out. Relative error 1e-14 times the condition of A. */
double ellipsoid_D(const struct ellipsoid *ellipsoid, struct vec3 m);

/* ellipsoid_smith - Smith's masking cos_u / (int max(0, u.m) D dm), exactly [Eq. 32 without its bound]. Skewed
 * distributions are not those of a surface level on average: then it exceeds 1 for some u.
 * Returns: >= 0; 0 for u.z <= 0; NaN in gives NaN out. */
double ellipsoid_smith(const struct ellipsoid *ellipsoid, struct vec3 u);

/* ellipsoid_G1 - min(1, Smith's masking) [Eq. 6], for facets that face u. */
double ellipsoid_G1(const struct ellipsoid *ellipsoid, struct vec3 u);

/* ellipsoid_sample - a normal with density ellipsoid_pdf(), through the concentric map of the square to the disk
 * [Sec. 4.1, for any sign of det A].
 * Given:   wi a unit vector, wi.z > 0; wi.z <= 0 counts as grazing incidence; u1, u2 in [0, 1), ends included
 * Returns: a unit vector with m.z > 0 and wi.m >= -2^-52, which is the rounding of m; NaN where wi has a NaN. */
struct vec3 ellipsoid_sample(const struct ellipsoid *ellipsoid, struct vec3 wi, double u1, double u2);

/* ellipsoid_pdf - density of the normals seen from wi, 1/sr: Smith's masking, not its bound, times
 * max(0, wi.m) D(m)/cos_i [Eq. 33]; 0 for wi.m <= 0 and for wi or m at or below the horizon. */
double ellipsoid_pdf(const struct ellipsoid *ellipsoid, struct vec3 wi, struct vec3 m);

#endif
