/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fresnel - reflectance of a smooth interface, unpolarised light.
 * cos_d is the cosine of the angle between the light and the microfacet normal; c = cos_d and s = sin_d below.
 * All functions return F in [0, 1] and cannot fail; cos_d outside [0, 1] counts as the nearer end, NaN in gives NaN. */
#ifndef FRESNEL_H
#define FRESNEL_H

#include "src/status.h"

enum fresnel {
	FRESNEL_DIELECTRIC, /* exact, real index n */
	FRESNEL_SCHLICK,    /* F0 + (1 - F0)(1 - cos_d)^5 with F0 = ((n-1)/(n+1))^2 */
	FRESNEL_CONDUCTOR,  /* exact, complex index n + i k */
	FRESNEL_NONE,       /* 1 */
	FRESNEL_COUNT
};

/* fresnel_name - "dielectric", "schlick", "conductor", "none"; "unknown" for any other value. */
const char *fresnel_name(enum fresnel fresnel);
/* fresnel_find - the form called `name`. Returns STATUS_DOMAIN, *fresnel untouched, when there is none. */
MUST_CHECK enum status fresnel_find(const char *name, enum fresnel *fresnel);

/* fresnel_dielectric - (r_s^2 + r_p^2)/2 with r_s = (c - g)/(c + g), r_p = (n^2 c - g)/(n^2 c + g), g^2 = n^2 - s^2.
 * Given:   n > 0, index of the far side over that of the near side, up to 1e75
 * Returns: exactly 0 at n = 1, 1 at c = 0, 1 under total internal reflection (n < 1); relative error below 2e-15,
 *          times the conditioning close to the critical angle. */
double fresnel_dielectric(double cos_d, double n);

/* fresnel_schlick - F0 + (1 - F0)(1 - c)^5, F0 = ((n-1)/(n+1))^2 [Schlick 1994]. n > 0. */
double fresnel_schlick(double cos_d, double n);

/* fresnel_conductor - the dielectric form with the complex index eta + i k, (|r_s|^2 + |r_p|^2)/2.
 * Given:   eta > 0, k >= 0, up to 1e75 each
 * Returns: the dielectric form at k = 0; relative error below 2e-15 (for 0 < k < 1e-150 the digits of denormal numbers).
 */
double fresnel_conductor(double cos_d, double eta, double k);

/* fresnel_F - the chosen form; k is read by the conductor only, n by all but FRESNEL_NONE. */
double fresnel_F(enum fresnel fresnel, double cos_d, double n, double k);

#endif
