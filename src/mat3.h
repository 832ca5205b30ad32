/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mat3 - 3x3 matrices as three rows. */
#ifndef MAT3_H
#define MAT3_H

#include "src/vec3.h"

static inline struct vec3 vec3_cross(struct vec3 a, struct vec3 b)
{
	return (struct vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline struct vec3 mat3_apply(const struct vec3 M[3], struct vec3 v)
{
	return (struct vec3){vec3_dot(M[0], v), vec3_dot(M[1], v), vec3_dot(M[2], v)};
}

static inline struct vec3 mat3_apply_transposed(const struct vec3 M[3], struct vec3 v)
{
	return vec3_add(vec3_add(vec3_scale(M[0], v.x), vec3_scale(M[1], v.y)), vec3_scale(M[2], v.z));
}

#endif
