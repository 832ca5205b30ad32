/* SPDX-License-Identifier: GPL-3.0-or-later */
/* halfdiff - half and difference angles [Rusinkiewicz 1998], the coordinates of the MERL table. */
#ifndef HALFDIFF_H
#define HALFDIFF_H

#include "src/vec3.h"

struct halfdiff {
	double theta_h, theta_d, phi_d; /* radians; phi_h = 0: isotropic materials */
};

/* halfdiff_to_dirs - light direction wi and view direction wo of (theta_h, theta_d, phi_d), half vector in the
 * xz plane. cos_i, cos_o = cos theta_h cos theta_d -/+ sin theta_h sin theta_d cos phi_d.
 * Given:   any angles; theta_h, theta_d in [0, pi/2] in practice
 * Returns: *wi, *wo, unit vectors with components good to 4e-16 absolute; z <= 0 where a direction is below the
 *          horizon, which large theta_h and theta_d together make so. */
void halfdiff_to_dirs(struct halfdiff a, struct vec3 *wi, struct vec3 *wo);

/* struct halfdiff_trig - the same coordinates by their sines and cosines, which the nodes of a table have exactly. */
struct halfdiff_trig {
	double sin_h, cos_h, sin_d, cos_d, sin_phi, cos_phi;
};
void halfdiff_trig_dirs(struct halfdiff_trig a, struct vec3 *wi, struct vec3 *wo);

/* halfdiff_from_dirs - the inverse, for any azimuth of the pair.
 * Given:   unit vectors
 * Returns: theta_h in [0, pi], theta_d in [0, pi/2], phi_d in [0, 2 pi); swapping wi and wo turns phi_d by pi. Where an
 *          angle has no meaning it is 0: phi_d for wi = wo, theta_h for wi = -wo. */
struct halfdiff halfdiff_from_dirs(struct vec3 wi, struct vec3 wo);

#endif
