/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sphere - a picture of a sphere in an environment, from far away, without interreflection. */
#ifndef SPHERE_H
#define SPHERE_H

#include "fit/render/environment.h"
#include "fit/render/estimator.h"
#include "fit/render/glass.h"
#include "fit/render/surface.h"
#include <stdatomic.h>
#include <stdint.h>

struct sphere_options {
	int size;    /* width and height of the picture, pixels */
	int samples; /* per pixel; each takes a direction from the light and one from the surface */
	uint64_t seed;
	bool tangents; /* the surface's x points to the right, along the parallels, y to the upper pole; else anywhere */
	enum estimator estimator;
	int threads;               /* change no result */
	const atomic_bool *cancel; /* stops when it becomes true; may be NULL */
	/* Called for each row that is done, by one thread at a time; may be NULL. */
	void (*row_done)(void *user);
	void *user;
};

/* struct sphere - the picture. */
struct sphere {
	struct image light; /* linear; of a pixel at the rim, the mean over what shows the sphere; else 0 */
	float *coverage;    /* size * size: share of the pixel that shows the sphere */
};

/* sphere_render - a sphere that fills the picture, 2 % of its size away from the border.
 * Places within a pixel and directions come from Sobol's sequence, scrambled per pixel by a hash of the seed and the
 * pixel's place: two spheres rendered with the same options differ by their surfaces, less by noise, and a seed gives
 * the same bits for any number of threads.
 * Returns: STATUS_OK; STATUS_NO_MEMORY, STATUS_INTERRUPTED with *sphere cleared. */
MUST_CHECK enum status sphere_render(const struct surface *surface, const struct environment *environment,
				     const struct sphere_options *options, struct sphere *sphere);
/* sphere_render_glass - the same of a solid sphere of glass, with all that it reflects and refracts inside. */
MUST_CHECK enum status sphere_render_glass(const struct glass *glass, const struct environment *environment,
					   const struct sphere_options *options, struct sphere *sphere);
void sphere_free(struct sphere *sphere);

#endif
