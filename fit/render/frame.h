/* SPDX-License-Identifier: GPL-3.0-or-later */
/* frame - a direction in space as seen at a point of a surface, where z is the normal, and back. */
#ifndef FRAME_H
#define FRAME_H

#include "src/vec3.h"

struct frame {
	struct vec3 x, y, z; /* orthonormal */
};

/* frame_from_x - of a normal and x, which is perpendicular to it; both unit vectors. */
static inline struct frame frame_from_x(struct vec3 x, struct vec3 n)
{
	const struct vec3 y = {n.y * x.z - n.z * x.y, n.z * x.x - n.x * x.z, n.x * x.y - n.y * x.x};
	return (struct frame){x, y, n};
}

/* frame_of - of a normal, a unit vector, where the material is isotropic: any x and y will do. */
static inline struct frame frame_of(struct vec3 n)
{
	const struct vec3 aside = fabs(n.y) < 0.9 ? (struct vec3){0, 1, 0} : (struct vec3){1, 0, 0};
	return frame_from_x(vec3_unit(vec3_sub(aside, vec3_scale(n, vec3_dot(aside, n)))), n);
}

/* frame_along_parallels - x to the right and y to the upper pole of a sphere, at which x is to the right, too. */
static inline struct frame frame_along_parallels(struct vec3 n)
{
	const double length = hypot(n.x, n.z);
	return frame_from_x(length > 0 ? (struct vec3){n.z / length, 0, -n.x / length} : (struct vec3){1, 0, 0}, n);
}

static inline struct vec3 frame_to(const struct frame *frame, struct vec3 w)
{
	return (struct vec3){vec3_dot(frame->x, w), vec3_dot(frame->y, w), vec3_dot(frame->z, w)};
}

static inline struct vec3 frame_from(const struct frame *frame, struct vec3 w)
{
	return vec3_add(vec3_add(vec3_scale(frame->x, w.x), vec3_scale(frame->y, w.y)), vec3_scale(frame->z, w.z));
}

#endif
