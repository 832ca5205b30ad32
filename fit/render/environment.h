/* SPDX-License-Identifier: GPL-3.0-or-later */
/* environment - the light around a sphere: a map of radiance at infinity, point lights at infinity, or both.
 *
 * Directions: x to the right, y up, z to the viewer. A map is of latitude and longitude, row 0 around +y; its middle is
 * what lies behind the sphere (-z), its right half lies to the right. Between texels it is interpolated bilinearly. */
#ifndef ENVIRONMENT_H
#define ENVIRONMENT_H

#include "fit/render/image.h"
#include "src/vec3.h"

enum { ENVIRONMENT_LIGHTS_MAX = 16 };

/* struct light - a point at infinity. */
struct light {
	struct vec3 to;       /* unit vector */
	double irradiance[3]; /* of a surface that faces it */
};

struct environment {
	struct image map; /* owned; no pixels: no map */
	double *row_cdf;  /* height + 1 values from 0 to 1, */
	double *cell_cdf; /* and per row width + 1: the share of the light in the texels before this one */
	int n_lights;
	struct light light[ENVIRONMENT_LIGHTS_MAX];
};

/* environment_named - one of the built-in ones, "studio" (soft boxes in a dark room), "sky" (a sun in haze, blue sky,
 * brown ground: drawn, not physics) or "lights" (a point light from the upper left); each such that the brightest point
 * of a white Lambertian sphere has about radiance 1. STATUS_DOMAIN, *environment untouched, for another name;
 * STATUS_NO_MEMORY. */
MUST_CHECK enum status environment_named(const char *name, struct environment *environment);
/* environment_name - the i-th of these names, NULL past the last. */
const char *environment_name(int i);

/* environment_from_map - takes over *map, which is cleared, and gets it ready for sampling.
 * Returns STATUS_FORMAT, *map untouched and `why` filled, where it is not twice as wide as high, has a value that is
 * negative, above 1e30 or not finite, or no light; STATUS_NO_MEMORY. */
MUST_CHECK enum status environment_from_map(struct environment *environment, struct image *map, struct error *why);
/* environment_from_lights - n point lights, at most ENVIRONMENT_LIGHTS_MAX, and nothing else. */
void environment_from_lights(struct environment *environment, const struct light *light, int n);
void environment_free(struct environment *environment);

/* environment_scale - makes all light brighter by a factor > 0. */
void environment_scale(struct environment *environment, double factor);

/* struct arriving - light of the map from one direction. */
struct arriving {
	double rgb[3]; /* radiance */
	double pdf; /* with which environment_sample() gives this direction, 1/sr: > 0 wherever there is light, but on
			* a set of measure zero */
};

/* environment_at - the light from the direction `to`. Needs a map, as the other does. */
struct arriving environment_at(const struct environment *environment, struct vec3 to);
/* environment_sample - a direction that is the likelier, the brighter the map is there: texels by the luminance of what
 * is interpolated in them, evenly within one. u1, u2 in [0, 1); goes down with u1 and right with u2. */
struct vec3 environment_sample(const struct environment *environment, double u1, double u2);

#endif
