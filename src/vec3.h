/* SPDX-License-Identifier: GPL-3.0-or-later */
/* vec3 - directions. The surface normal is +z; angles are in radians unless a name says deg.
 * A direction is a unit vector and not an angle or a cosine, because its components keep their full relative precision
 * at both ends: near the normal x and y tell small angles apart, near the horizon z does. */
#ifndef VEC3_H
#define VEC3_H

#include <math.h>

struct vec3 {
	double x, y, z;
};

static inline double vec3_dot(struct vec3 a, struct vec3 b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

/* Their results have names because C++ knows no compound literals. */
static inline struct vec3 vec3_add(struct vec3 a, struct vec3 b)
{
	const struct vec3 sum = {a.x + b.x, a.y + b.y, a.z + b.z};
	return sum;
}

static inline struct vec3 vec3_sub(struct vec3 a, struct vec3 b)
{
	const struct vec3 difference = {a.x - b.x, a.y - b.y, a.z - b.z};
	return difference;
}

static inline struct vec3 vec3_scale(struct vec3 a, double s)
{
	const struct vec3 scaled = {a.x * s, a.y * s, a.z * s};
	return scaled;
}

static inline struct vec3 vec3_opposite(struct vec3 a)
{
	return vec3_scale(a, -1.0);
}

/* w mirrored at the axis m, a unit vector: where a facet with normal m reflects what comes from w. */
static inline struct vec3 vec3_reflect(struct vec3 w, struct vec3 m)
{
	return vec3_sub(vec3_scale(m, 2.0 * vec3_dot(w, m)), w);
}

/* Neither over- nor underflows before the length itself does. */
static inline double vec3_length(struct vec3 a)
{
	return hypot(hypot(a.x, a.y), a.z);
}

/* The unit vector along a; NaN for the zero vector. */
static inline struct vec3 vec3_unit(struct vec3 a)
{
	const double length = vec3_length(a);
	const struct vec3 unit = {a.x / length, a.y / length, a.z / length};
	return unit;
}

/* sincos_deg - sine and cosine of an angle in degrees, each within 0.51 ulp for the double given (1 ulp where
 * long double is no wider than double); exact at the multiples of 90 degrees.
 * Given:   deg in [0, 360]; any finite value works
 * Returns: *s, *c; NaN for NaN and infinities
 * Note:    deg itself has been rounded. Close to 90 degrees half an ulp of it is many ulps of the cosine: where
 *          90 - deg is known better than deg, pass that and swap the two. */
void sincos_deg(double deg, double *s, double *c);

/* vec3_from_spherical_deg - the unit vector at polar angle theta_deg from +z, azimuth phi_deg from +x towards +y.
 * Each component is within 1 ulp; x and y are rounded such that x/z and y/z, the slopes, are within 0.6 ulp.
 * NaN or an infinity in gives three NaN. */
struct vec3 vec3_from_spherical_deg(double theta_deg, double phi_deg);

#endif
