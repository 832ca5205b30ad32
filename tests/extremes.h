/* SPDX-License-Identifier: GPL-3.0-or-later */
/* extremes - the parameters and directions between which the mathematics has to hold: shared by the stability report
 * and the tests. */
#ifndef EXTREMES_H
#define EXTREMES_H

#include "src/ndf.h"
#include <stdlib.h>

#define COUNT(array) ((int)(sizeof(array) / sizeof((array)[0])))

static const double extreme_sigma[] = {1e-7, 1e-4, 0.01, 0.3, 1.0, 4.0, 100.0, 1e4};
static const double extreme_gamma[] = {0x1.8000000000001p0,
				       1.5001,
				       1.51,
				       1.75,
				       0x1.fffffffffffffp0,
				       2.0,
				       0x1.0000000000001p1,
				       2.5,
				       3.0,
				       5.3,
				       10.0,
				       15.5,
				       32.99,
				       33.0,
				       33.01,
				       100.0,
				       1e3,
				       1e5,
				       1e6,
				       1e8,
				       1e12,
				       9.99e17,
				       1e20,
				       1e22,
				       INFINITY};
/* Cotangents of theta, from the normal to the horizon; what lies between is added in units of the roughness. */
static const double extreme_cot[] = {
	1e300, 1e160, 1e100,  1e17,   1e8,   1e3, 10.0, 2.0, 1.0, 0.5, 0.1, 1e-3, 1e-6, 1e-10, 6.123233995736766e-17,
	1e-30, 1e-99, 1e-101, 1e-160, 1e-280};
static const double extreme_in_sigma[] = {100.0, 26.0, 10.0, 4.0, 2.0, 1.0, 0.81, 0.79, 0.5, 0.1, 1e-3};

enum { EXTREME_DIRECTIONS = COUNT(extreme_cot) + COUNT(extreme_in_sigma) + 6 };

static inline int by_cot(const void *a, const void *b)
{
	const struct vec3 *v = a, *w = b;
	const double difference = log(w->z) - log(w->x) - (log(v->z) - log(v->x));
	return (difference > 0.0) - (difference < 0.0);
}

/* extreme_directions - in the xz plane, from the normal down to the horizon itself. */
static inline void extreme_directions(double sigma, struct vec3 w[EXTREME_DIRECTIONS])
{
	int n = 0;
	w[n++] = (struct vec3){0.0, 0.0, 1.0};
	w[n++] = (struct vec3){4.9406564584124654e-324, 0.0, 1.0};
	w[n++] = (struct vec3){1.0, 0.0, 1e-300};
	w[n++] = (struct vec3){1.0, 0.0, 2.2250738585072014e-308};
	w[n++] = (struct vec3){1.0, 0.0, 4.9406564584124654e-324};
	w[n++] = (struct vec3){1.0, 0.0, 0.0};
	for (int i = 0; i < COUNT(extreme_cot) + COUNT(extreme_in_sigma); i++) {
		const double cot =
			i < COUNT(extreme_cot) ? extreme_cot[i] : sigma * extreme_in_sigma[i - COUNT(extreme_cot)];
		w[n++] = cot > 1e8 ? (struct vec3){1.0 / cot, 0.0, 1.0}
				   : (struct vec3){1.0 / sqrt(1.0 + cot * cot), 0.0, cot / sqrt(1.0 + cot * cot)};
	}
	qsort(w, EXTREME_DIRECTIONS, sizeof(w[0]), by_cot);
}

static inline struct vec3 turned(struct vec3 w, double phi)
{
	return (struct vec3){w.x * cos(phi), w.x * sin(phi), w.z};
}

#endif
