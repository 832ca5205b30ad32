/* SPDX-License-Identifier: GPL-3.0-or-later */
/* make_samples - scattered samples of a model, for tests. */
#ifndef MAKE_SAMPLES_H
#define MAKE_SAMPLES_H

#include "make_table.h"

/* n samples of the model, directions evenly over the hemispheres up to this angle; in the plane of incidence alone if wanted. */
static inline struct measurement scatter(const struct cook_torrance *model, size_t n, double max_theta, bool in_plane)
{
	struct measurement m;
	unsigned seed = 3;
	const double least = cos(max_theta * M_PI / 180);
	if (measurement_scattered(&m, n) != STATUS_OK)
		abort();
	for (size_t e = 0; e < n; e++) {
		double f[3];
		struct vec3 *const direction[] = {&m.scattered->wi[e], &m.scattered->wo[e]};
		for (int d = 0; d < 2; d++) {
			const double z = 1 - (1 - least) * random_unit(&seed), r = sqrt(1 - z * z);
			const double phi =
				(in_plane ? M_PI * floor(2 * random_unit(&seed)) : 2 * M_PI * random_unit(&seed));
			*direction[d] = (struct vec3){r * cos(phi), in_plane ? 0 : r * sin(phi), z};
		}
		cook_torrance_f(model, m.scattered->wi[e], m.scattered->wo[e], f);
		for (int c = 0; c < MERL_CHANNELS; c++)
			m.scattered->value[c][e] = (float)f[c];
	}
	return m;
}

#endif
