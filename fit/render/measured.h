/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measured - a measurement as a BRDF for any pair of directions. */
#ifndef MEASURED_H
#define MEASURED_H

#include "data_readers/interpolant.h"

/* struct measured - a copy of a table without gaps, or what lies between scattered entries. */
struct measured {
	struct interpolant turned; /* of scattered entries; else its `scattered` is NULL */
	enum bins bins;
	int n_phi_d;
	float *value; /* 1/sr; three channels of an entry beside each other, entries ordered as in struct measurement */
};

/* measured_init - takes the values of a table, or borrows those of a sample that turns (measurement_turns()). A masked entry gets the value of the valid one at the next smaller
 * theta_d, else at the next smaller theta_h, same phi_d; where there is none either, 0. STATUS_NO_MEMORY. */
MUST_CHECK enum status measured_init(struct measured *measured, const struct measurement *measurement, enum bins bins,
				     int threads);
void measured_free(struct measured *measured);

/* measured_f - the BRDF in three channels, 1/sr; of scattered entries interpolant_f(). Of a table linear between the entries in the table's own coordinates, in which
 * theta_h goes with the square of its index; phi_d goes round after 360 degrees, or, as a material is reciprocal, after
 * 180. Beyond the first and the last entry in theta_h and theta_d their value stays. All 0 unless cos_i, cos_o > 0. */
void measured_f(const struct measured *measured, struct vec3 wi, struct vec3 wo, double f[3]);

#endif
