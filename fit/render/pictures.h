/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pictures - spheres of one material: as measured, and as each of its models has it. */
#ifndef PICTURES_H
#define PICTURES_H

#include "fit/render/picture_error.h"

/* struct pictures_model - a model of the material and how good it is said to be; NaN: nobody has said. */
struct pictures_model {
	const struct cook_torrance *model;
	double error;
};

struct pictures {
	int n; /* models */
	struct sphere measured;
	struct sphere *sphere;       /* of each model, */
	struct picture_error *error; /* and how far it is from the measured one */
};

/* pictures_render - renders n >= 1 models, and the table with the lobe of the one with the lowest error to sample by,
 * all with the same random numbers. The measurement is a table, or scattered entries of a sample that turns; of these, and of
 * models with axes, the spheres have tangents [sphere.h]. Returns STATUS_OK; STATUS_NO_MEMORY, STATUS_INTERRUPTED with *pictures cleared. */
MUST_CHECK enum status pictures_render(const struct measurement *measurement, enum bins bins,
				       const struct pictures_model *model, int n, enum sampling sampling,
				       const struct environment *environment, const struct sphere_options *options,
				       struct pictures *pictures);
void pictures_free(struct pictures *pictures);

/* pictures_render_model - the sphere of one model alone, to be freed with sphere_free(). Returns as sphere_render(). */
MUST_CHECK enum status pictures_render_model(const struct cook_torrance *model, enum sampling sampling,
					     const struct environment *environment,
					     const struct sphere_options *options, struct sphere *sphere);

#endif
