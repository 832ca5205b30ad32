/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/ellipsoid.h"
#include "src/mat3.h"
#include <stdbool.h>

/* Below this, with rows of length 1, the determinant is rounding. */
#define DET_MIN 2e-15
/* Grazing: closer to the horizon a direction counts as this close. */
#define COS_MIN 1e-100

static struct vec3 row(const double A[3], double scale)
{
	return (struct vec3){A[0] / scale, A[1] / scale, A[2] / scale};
}

enum status ellipsoid_init(struct ellipsoid *ellipsoid, const double A[3][3])
{
	double largest = 0.0;
	for (int i = 0; i < 9; i++) {
		const double element = A[i / 3][i % 3];
		if (!isfinite(element))
			return STATUS_DOMAIN;
		largest = fmax(largest, fabs(element));
	}
	if (largest == 0.0)
		return STATUS_DOMAIN;
	struct ellipsoid e = {.A = {row(A[0], largest), row(A[1], largest), row(A[2], largest)}};
	struct vec3 unit[3];
	double length[3];
	for (int i = 0; i < 3; i++) {
		length[i] = vec3_length(e.A[i]);
		unit[i] = vec3_scale(e.A[i], 1.0 / length[i]);
	}
	const double det = vec3_dot(unit[0], vec3_cross(unit[1], unit[2]));
	if (!(fabs(det) >= DET_MIN))
		return STATUS_DOMAIN;
	for (int i = 0; i < 3; i++) {
		const struct vec3 cofactors = vec3_cross(unit[(i + 1) % 3], unit[(i + 2) % 3]);
		e.inverse[i] = vec3_scale(cofactors, 1.0 / (det * length[i]));
	}
	e.det = fabs(det) * length[0] * length[1] * length[2];
	e.sign = copysign(1.0, det);
	e.An = (struct vec3){e.A[0].z, e.A[1].z, e.A[2].z};
	e.length_An = vec3_length(e.An);
	*ellipsoid = e;
	return STATUS_OK;
}

static bool alpha_valid(double alpha)
{
	return alpha >= ELLIPSOID_ALPHA_MIN && alpha <= ELLIPSOID_ALPHA_MAX;
}

enum status ellipsoid_init_angles(struct ellipsoid *ellipsoid, double alpha_x, double alpha_y, double theta_x,
				  double theta_y, double theta_z)
{
	if (!alpha_valid(alpha_x) || !alpha_valid(alpha_y))
		return STATUS_DOMAIN;
	const double sx = sin(theta_x), cx = cos(theta_x), sy = sin(theta_y), cy = cos(theta_y), sz = sin(theta_z),
		     cz = cos(theta_z);
	const double A[3][3] = {
		{alpha_x * cy * cz, -alpha_x * cy * sz, alpha_x * sy},
		{alpha_y * (cx * sz + sx * sy * cz), alpha_y * (cx * cz - sx * sy * sz), -alpha_y * sx * cy},
		{sx * sz - cx * sy * cz, sx * cz + cx * sy * sz, cx * cy},
	};
	return ellipsoid_init(ellipsoid, A);
}

double ellipsoid_D(const struct ellipsoid *ellipsoid, struct vec3 m)
{
	if (m.z <= 0.0)
		return 0.0;
	const struct vec3 v = mat3_apply(ellipsoid->inverse, m);
	const double square = vec3_dot(v, v);
	return M_1_PI / (square * ellipsoid->det) / (square * ellipsoid->length_An);
}

/* |A u| |A n| + (A u).(A n), over |A u| |A n|: twice the share of the disk that the lune between u and n covers. */
static double lune(const struct ellipsoid *ellipsoid, struct vec3 u, struct vec3 Au, double length_Au)
{
	const double length = length_Au * ellipsoid->length_An;
	const double dot = vec3_dot(Au, ellipsoid->An);
	if (dot >= 0.0)
		return 1.0 + dot / length;
	/* (A u) x (A n) = det A A^-T (u x n): the sum of opposite numbers as a quotient. */
	const struct vec3 cross = mat3_apply(ellipsoid->inverse, (struct vec3){u.y, -u.x, 0.0});
	const double sine = ellipsoid->det * vec3_length(cross) / length;
	return sine * sine / (1.0 - dot / length);
}

double ellipsoid_smith(const struct ellipsoid *ellipsoid, struct vec3 u)
{
	if (u.z <= 0.0)
		return 0.0;
	const struct vec3 Au = mat3_apply(ellipsoid->A, u);
	const double length = vec3_length(Au);
	return 2.0 * ellipsoid->length_An * u.z / (length * lune(ellipsoid, u, Au, length));
}

double ellipsoid_G1(const struct ellipsoid *ellipsoid, struct vec3 u)
{
	const double smith = ellipsoid_smith(ellipsoid, u);
	return smith > 1.0 ? 1.0 : smith;
}

/* Shirley and Chiu's map of the unit square to the unit disk. */
static void concentric(double u1, double u2, double *x, double *y)
{
	const double a = 2.0 * u1 - 1.0, b = 2.0 * u2 - 1.0;
	if (fabs(a) > fabs(b)) {
		*x = a * cos(M_PI_4 * b / a);
		*y = a * sin(M_PI_4 * b / a);
	} else {
		const double angle = b != 0.0 ? M_PI_4 * a / b : 0.0;
		*x = b * sin(angle);
		*y = b * cos(angle);
	}
}

/* A unit vector across u. */
static struct vec3 across(struct vec3 u)
{
	const struct vec3 axis = fabs(u.x) < fabs(u.y) ? (struct vec3){1.0, 0.0, 0.0} : (struct vec3){0.0, 1.0, 0.0};
	return vec3_unit(vec3_cross(u, axis));
}

struct vec3 ellipsoid_sample(const struct ellipsoid *ellipsoid, struct vec3 wi, double u1, double u2)
{
	wi.z = wi.z < COS_MIN ? COS_MIN : wi.z;
	const struct vec3 Aw = mat3_apply(ellipsoid->A, wi);
	const double length = vec3_length(Aw);
	const double s = 0.5 * lune(ellipsoid, wi, Aw, length);
	/* Disk to crescent; h - x and h + x of the point on it apart, for z. */
	double x, y;
	concentric(u1, u2, &x, &y);
	const double h = sqrt(fmax((1.0 - y) * (1.0 + y), 0.0));
	const double z = sqrt(fmax(s * (h - x) * (s * x + (2.0 - s) * h), 0.0));
	x = s * x + (1.0 - s) * h;

	const struct vec3 e3 = vec3_scale(Aw, 1.0 / length);
	const bool collinear = wi.x == 0.0 && wi.y == 0.0;
	struct vec3 e2;
	if (collinear) {
		e2 = across(e3);
	} else { /* of length 1 first: denormal numbers would be lost */
		const struct vec3 level = vec3_unit((struct vec3){wi.y, -wi.x, 0.0});
		e2 = vec3_scale(vec3_unit(mat3_apply(ellipsoid->inverse, level)), ellipsoid->sign);
	}
	const struct vec3 e1 = vec3_cross(e2, e3);
	const struct vec3 p = vec3_add(vec3_add(vec3_scale(e1, x), vec3_scale(e2, y)), vec3_scale(e3, z));
	struct vec3 m = vec3_unit(mat3_apply_transposed(ellipsoid->A, p));
	/* Both edges of the lune are met up to rounding, which an A near singular can blow up. */
	if (m.z < 0.0)
		m = vec3_scale(m, -1.0);
	m.z = m.z < COS_MIN ? COS_MIN : m.z;
	const double cos_d = vec3_dot(wi, m);
	return cos_d < 0.0 ? vec3_sub(m, vec3_scale(wi, 2.0 * cos_d)) : m;
}

double ellipsoid_pdf(const struct ellipsoid *ellipsoid, struct vec3 wi, struct vec3 m)
{
	const double cos_d = vec3_dot(wi, m);
	if (wi.z <= 0.0 || m.z <= 0.0 || cos_d <= 0.0)
		return 0.0;
	return ellipsoid_smith(ellipsoid, wi) / wi.z * cos_d * ellipsoid_D(ellipsoid, m);
}
