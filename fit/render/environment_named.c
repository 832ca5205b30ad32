/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The built-in environments, drawn into maps. */
#include "fit/render/environment.h"
#include "src/mat3.h"
#include "src/names.h"
#include <math.h>

enum { MAP_HEIGHT = 256 }; /* texels of 0.7 degrees: a mirror sphere of 256 pixels shows hardly finer ones */

static const char *const names[] = {"studio", "sky", "lights"};
enum { NAMES = sizeof names / sizeof *names };

const char *environment_name(int i)
{
	return i >= 0 && i < NAMES ? names[i] : NULL;
}

/* 0 below a, 1 above b, smooth between. */
static double smooth_step(double a, double b, double x)
{
	const double t = fmin(fmax((x - a) / (b - a), 0), 1);
	return t * t * (3 - 2 * t);
}

/* A lamp behind a rectangular diffuser: direction of its middle, half width and height over its distance. */
struct soft_box {
	struct vec3 middle;
	double width, height, radiance[3];
};

/* How much of the box's radiance comes from `to`: soft at the edges, somewhat brighter in the middle. */
static double soft_box_at(const struct soft_box *box, struct vec3 to)
{
	const struct vec3 forward = vec3_unit(box->middle);
	const struct vec3 right = vec3_unit(vec3_cross(forward, (struct vec3){0, 1, 0}));
	const struct vec3 up = vec3_cross(right, forward);
	const double depth = vec3_dot(to, forward);
	if (depth <= 0)
		return 0;
	const double x = fabs(vec3_dot(to, right) / depth) / box->width;
	const double y = fabs(vec3_dot(to, up) / depth) / box->height;
	const double edge = 0.12;
	return (1 - smooth_step(1 - edge, 1, x)) * (1 - smooth_step(1 - edge, 1, y)) * (1 - 0.35 * (x * x + y * y) / 2);
}

static void studio_at(struct vec3 to, double rgb[3])
{
	static const struct soft_box boxes[] = {
		{{-0.72, 0.72, 0.66}, 0.50, 0.46, {6.0, 5.9, 5.7}},  /* key, upper left */
		{{0.95, 0.16, 0.22}, 0.15, 0.80, {3.4, 3.5, 3.7}},   /* strip, right */
		{{-0.98, -0.02, -0.45}, 0.10, 0.8, {3.0, 3.1, 3.2}}, /* rim, left from behind */
		{{0.35, 0.85, -0.55}, 0.60, 0.24, {2.5, 2.5, 2.5}},  /* top, from behind */
		{{0.25, -0.90, 0.50}, 0.6, 0.5, {0.45, 0.43, 0.41}}, /* light that the floor gives back */
	};
	/* The room: dark below, lighter towards the ceiling, lightest behind the viewer. */
	const double room = 0.07 + 0.36 * smooth_step(-0.5, 1.0, to.y) * (0.7 + 0.3 * to.z);
	rgb[0] = 0.96 * room;
	rgb[1] = 1.00 * room;
	rgb[2] = 1.06 * room;
	for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++) {
		const double share = soft_box_at(&boxes[i], to);
		for (int c = 0; c < 3; c++)
			rgb[c] += share * boxes[i].radiance[c];
	}
}

static void sky_at(struct vec3 to, double rgb[3])
{
	static const double zenith[] = {0.10, 0.22, 0.52}, horizon[] = {0.62, 0.72, 0.85},
			    ground[] = {0.19, 0.16, 0.12};
	const struct vec3 sun = vec3_unit((struct vec3){-0.55, 0.60, 0.58});
	const double height = fmax(0, to.y), above = smooth_step(-0.02, 0.02, to.y);
	/* Squared distance from the sun, in radians where that is small. */
	const struct vec3 off = vec3_sub(to, sun);
	const double d2 = vec3_dot(off, off);
	const double disc = 620 * exp(-d2 / (2 * 0.022 * 0.022)), haze = 0.9 * exp(-d2 / (2 * 0.25 * 0.25));
	static const double warm[] = {1.0, 0.93, 0.80};
	for (int c = 0; c < 3; c++) {
		const double sky = horizon[c] + (zenith[c] - horizon[c]) * sqrt(height);
		rgb[c] = above * (sky + (disc + haze) * warm[c]) + (1 - above) * ground[c] * (1 + 0.4 * to.y);
	}
}

static enum status draw(struct environment *e, void (*at)(struct vec3 to, double rgb[3]), double scale)
{
	struct image map;
	enum status status = image_alloc(&map, 2 * MAP_HEIGHT, MAP_HEIGHT);
	if (status != STATUS_OK)
		return status;
	for (int y = 0; y < map.height; y++)
		for (int x = 0; x < map.width; x++) {
			const double up = M_PI * (y + 0.5) / map.height,
				     turn = 2 * M_PI * ((x + 0.5) / map.width - 0.5);
			const struct vec3 to = {sin(up) * sin(turn), cos(up), -sin(up) * cos(turn)};
			double rgb[3];
			at(to, rgb);
			for (int c = 0; c < 3; c++)
				image_at(&map, x, y)[c] = (float)(scale * rgb[c]);
		}
	status = environment_from_map(e, &map, NULL);
	image_free(&map);
	return status;
}

enum status environment_named(const char *name, struct environment *e)
{
	/* The factors bring the brightest point of a white sphere to 1. */
	switch (names_find(names, NAMES, name)) {
	case 0:
		return draw(e, studio_at, 0.684);
	case 1:
		return draw(e, sky_at, 1.027);
	case 2:
		environment_from_lights(
			e, &(struct light){vec3_unit((struct vec3){-0.5, 0.6, 0.7}), {M_PI, M_PI, M_PI}}, 1);
		return STATUS_OK;
	default:
		return STATUS_DOMAIN;
	}
}
