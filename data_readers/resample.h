/* SPDX-License-Identifier: GPL-3.0-or-later */
/* resample - a measurement as a table over (theta_h, theta_d, phi_d). */
#ifndef RESAMPLE_H
#define RESAMPLE_H

#include "data_readers/measurement.h"

/* What an entry of the table above the horizon becomes where nothing was measured near it. */
enum gaps {
	GAPS_MASKED, /* masked */
	GAPS_FILLED  /* the value of what was measured nearest: for pictures */
};

/* struct resampled - what the table has of the measurement. */
struct resampled {
	size_t n_measured; /* entries at or near which something was measured */
	size_t n_outside;  /* entries above the horizon at which nothing was */
	bool symmetrised;  /* the mean was taken: of both orders of wi and wo, of both sides or of several azimuths */
};

/* measurement_resample - a table with this n_phi_d of a measurement.
 * Given:   a table: the same entries; of 360 along phi_d to 180 the mean of both orders of wi and wo, the one that is
 *          valid if the other is masked. Scattered entries: interpolated; the order of wi and wo counts for 360 only,
 *          the side of phi_d and the azimuth of wi never.
 * Method:  the coordinates are 90 sqrt(theta_h / 90 deg), theta_d / 4 deg and phi_d / 5 deg, the latter shrunk where
 *          theta_h or theta_d is small and phi_d means little: the BRDF changes the fastest with theta_h. Of the four
 *          sides of a point in the first two of these, the nearest two entries each are averaged, with the reciprocal
 *          square of the distance for weight, so that an entry at the point is reproduced. Outside is what is farther
 *          from the nearest entry than 1.5 times its distance from its fourth neighbour, and half a cell more; or has a
 *          larger theta_i or theta_o than was measured.
 *          A measurement that keeps the interpolant of its file (rgl.h) is evaluated by that instead; its mean over 8
 *          turns where it is not isotropic.
 * Returns: STATUS_OK; STATUS_NO_MEMORY, STATUS_DOMAIN (n_phi_d); *table is then cleared. The size, the hash and the
 *          counts of the file go along. `result` may be NULL. */
MUST_CHECK enum status measurement_resample(const struct measurement *measurement, enum bins bins, int n_phi_d,
					    enum gaps gaps, int threads, struct measurement *table,
					    struct resampled *result);

/* measurement_fill - puts a table of 180 with filled gaps in the place of scattered entries; a table stays as it is.
 * measurement_fill_isotropic - the same, but what turns (measurement_turns()) stays, too. */
MUST_CHECK enum status measurement_fill(struct measurement *measurement, enum bins bins, int threads);
MUST_CHECK enum status measurement_fill_isotropic(struct measurement *measurement, enum bins bins, int threads);

#endif
