/* SPDX-License-Identifier: GPL-3.0-or-later */
/* glass - the light that a viewer sees in a solid sphere of glass with a rough surface: paths from the viewer, reflected and
 * refracted where they meet the surface, until they leave into the environment. The glass absorbs nothing. */
#ifndef GLASS_H
#define GLASS_H

#include "fit/render/environment.h"
#include "fit/render/estimator.h"
#include "src/dielectric.h"
#include "src/random_walk.h"
#include <stdint.h>

struct glass {
	struct dielectric dielectric; /* single scattering by the facets; above is outside */
	struct random_walk walk;      /* or all orders of it, */
	bool multiple;                /* if this */
	enum sampling sampling;       /* of single scattering */
};

/* glass_init - n: index of the glass, that of its surroundings being 1. Where the NDF has no such sampler, SAMPLING_VISIBLE
 * takes its place, or else SAMPLING_NDF. Returns: as dielectric_init(); with `multiple` as random_walk_init_dielectric(), and
 * gaf does not matter but for GAF_V_GROOVE, STATUS_UNSUPPORTED. */
MUST_CHECK enum status glass_init(struct glass *glass, const struct ndf *ndf, enum gaf gaf, double n, bool multiple,
				  enum sampling sampling);

/* glass_light - adds to sum[] an estimate of the radiance that a viewer in direction z sees at the point of the unit sphere
 * whose normal is `normal`, normal.z > 0. u: numbers in [0, 1) for the first light and the first facet; random: state of the
 * others. */
void glass_light(const struct glass *glass, const struct environment *environment, enum estimator estimator,
		 struct vec3 normal, const double u[4], uint64_t *random, double sum[3]);

#endif
