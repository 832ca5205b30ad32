/* SPDX-License-Identifier: GPL-3.0-or-later */
/* make_scattered - scattered measurements of a model, in memory, for tests. */
#ifndef MAKE_SCATTERED_H
#define MAKE_SCATTERED_H

#include "make_table.h"

/* A normal deviate. */
static inline double random_normal(unsigned *seed)
{
	const double u = random_unit(seed), v = random_unit(seed);

	return sqrt(-2 * log(1 - u)) * cos(2 * M_PI * v);
}

/* A direction within 80 degrees of the normal: even in theta, even in azimuth. */
static inline struct vec3 random_direction(unsigned *seed)
{
	const double theta = 80 * random_unit(seed), phi = 360 * random_unit(seed);

	return vec3_from_spherical_deg(theta, phi);
}

/* wo that reflects wi at a normal drawn from the model's distribution or, every third time, any. */
static inline struct vec3 random_view(const struct cook_torrance *model, struct vec3 wi, unsigned *seed)
{
	const double u = random_unit(seed), v = random_unit(seed);
	const struct vec3 m = ndf_sample(&model->ndf, u, v);
	const struct vec3 wo = vec3_sub(vec3_scale(m, 2 * vec3_dot(wi, m)), wi);

	return random_unit(seed) < 1.0 / 3 || wo.z < 0.15 ? random_direction(seed) : wo;
}

/* The model at n pairs of directions, times 1 + noise * a normal deviate, at least 0. */
static inline struct measurement make_scattered(const struct cook_torrance *model, size_t n, double noise,
						unsigned seed)
{
	struct measurement measurement;

	if (measurement_scattered(&measurement, n) != STATUS_OK)
		abort();
	measurement.scattered->symmetry = SYMMETRY_ANISOTROPIC;
	for (size_t e = 0; e < n; e++) {
		struct scattered *s = measurement.scattered;
		double f[3];

		s->wi[e] = random_direction(&seed);
		s->wo[e] = random_view(model, s->wi[e], &seed);
		s->solid_angle[e] = (float)(39.5 / (double)n * (0.5 + random_unit(&seed)));
		cook_torrance_f(model, s->wi[e], s->wo[e], f);
		for (int c = 0; c < 3; c++)
			s->value[c][e] = (float)fmax(f[c] * (1 + noise * random_normal(&seed)), 0);
	}
	return measurement;
}

#endif
