/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interpolant - the value of scattered entries at any pair of directions. */
#ifndef INTERPOLANT_H
#define INTERPOLANT_H

#include "data_readers/measurement.h"

struct place;
struct rgl;

/* struct interpolant - borrows from the measurement. */
struct interpolant {
	const struct scattered *scattered;
	const struct rgl *rgl; /* the file's own, if it has one: then there are no places */
	int n_phi_d;           /* 180: both orders of wi and wo are one; 360: they are not */
	bool turns;            /* the azimuth of the half vector counts */
	struct place *place;
	size_t n;
};

/* interpolant_init - of scattered entries. turns: the sample is not isotropic; n_phi_d is 180 then. STATUS_NO_MEMORY.
 * Method: the coordinates are 90 sqrt(theta_h / 90 deg), theta_d / 4 deg and phi_d / 5 deg, the latter shrunk where
 * theta_h or theta_d is small. Where the sample turns, the first is the radius of a point in the plane, at the azimuth
 * of the half vector. See resample.h for what is averaged; of a sample that turns, the eight nearest entries. */
MUST_CHECK enum status interpolant_init(struct interpolant *interpolant, const struct measurement *measurement,
					int n_phi_d, bool turns, int threads);
void interpolant_free(struct interpolant *interpolant);

/* struct interpolated - a sum of weighted values. */
struct interpolated {
	double sum[MERL_CHANNELS], weight;
	bool inside;     /* of what was measured */
	double distance; /* of the nearest entry, in the coordinates */
};

/* interpolant_at - about a pair of directions above the horizon; not of a file with its own interpolant. */
struct interpolated interpolant_at(const struct interpolant *interpolant, struct vec3 wi, struct vec3 wo);

/* interpolant_f - the BRDF, 1/sr, for pictures: where nothing was measured, that of the nearest entries. A file's own
 * interpolant is used as it is, what is out of gamut being 0, and bounded towards the horizon of wo. All 0 unless
 * cos_i, cos_o > 0. */
void interpolant_f(const struct interpolant *interpolant, struct vec3 wi, struct vec3 wo, double f[MERL_CHANNELS]);

#endif
