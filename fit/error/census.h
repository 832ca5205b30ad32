/* SPDX-License-Identifier: GPL-3.0-or-later */
/* census - what is in a measurement: valid entries on either side of the horizon, and the range of their values. */
#ifndef CENSUS_H
#define CENSUS_H

#include "data_readers/measurement.h"

/* struct census_range - 1/sr, of one channel; NaN when there is no value. An even number of values has the mean of the two in
 * the middle for its median. */
struct census_range {
	double min, median, max;
};

struct census {
	size_t valid;                             /* not masked */
	size_t above;                             /* both directions above the horizon, masked or not */
	size_t valid_above;                       /* both of these */
	size_t valid_below;                       /* valid, and more below the horizon than rounding explains */
	struct census_range range[MERL_CHANNELS]; /* of valid entries above the horizon */
};

/* census_take - counts the entries of a table (n_phi_d of 180 or 360), or scattered ones. STATUS_NO_MEMORY. */
MUST_CHECK enum status census_take(const struct measurement *measurement, enum bins bins, struct census *census);

#endif
