/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fresnel - reflectance of a smooth interface, unpolarised light.
 * cos_d is the cosine of the angle between the light and the microfacet normal; c = cos_d and s = sin_d below.
 * All functions return F in [0, 1] and cannot fail; cos_d outside [0, 1] counts as the nearer end, NaN in gives NaN. */
#ifndef FRESNEL_H
#define FRESNEL_H

#include "src/status.h"
#include <stdbool.h>

enum fresnel {
	FRESNEL_DIELECTRIC, /* exact, real index n */
	FRESNEL_SCHLICK,    /* F0 + (1 - F0)(1 - cos_d)^5 with F0 = ((n-1)/(n+1))^2 */
	FRESNEL_CONDUCTOR,  /* exact, complex index n + i k */
	FRESNEL_NONE,       /* 1 */
	FRESNEL_F82,        /* three reflectances, see fresnel_f82(): not a function of n and k */
	FRESNEL_COUNT
};

/* fresnel_name - "dielectric", "schlick", "conductor", "none", "f82"; "unknown" for any other value. */
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

/* fresnel_f82 - Schlick's form with the reflectances F0 at the normal, F82 at cos_d = 1/7 and F90 at grazing incidence
 * [Hoffman 2019, "Fresnel equations considered harmful"; as generalized_schlick in MaterialX and the metal of OpenPBR]:
 *
 *     F = F0 + (F90 - F0) (1 - c)^5 + a c (1 - c)^6,        a such that F is F82 at c = 1/7
 *
 * It is linear in the three: F = sum of reflectance[i] part[i], parts in the order F0, F82, F90. The sum is moved into [0, 1],
 * beyond which reflectances in [0, 1] lead by 0.13 at most, at F0 = F82 = 1 and F90 = 0. */
enum { F82_PARTS = 3 };
void fresnel_f82_parts(double cos_d, double part[F82_PARTS]);
double fresnel_f82(double cos_d, const double reflectance[F82_PARTS]);

/* fresnel_has_ior - whether the form is a function of an index of refraction. */
static inline bool fresnel_has_ior(enum fresnel fresnel)
{
	return fresnel != FRESNEL_NONE && fresnel != FRESNEL_F82;
}

/* fresnel_F - the chosen form; k is read by the conductor only, n by all but FRESNEL_NONE. 1 for FRESNEL_F82, whose
 * reflectances a caller has to know. */
double fresnel_F(enum fresnel fresnel, double cos_d, double n, double k);

#endif
