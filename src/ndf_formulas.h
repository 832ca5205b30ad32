/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ndf_formulas - the closed forms of the distributions, each once.
 *
 * Notation: m a microfacet normal, w a direction, both unit vectors above the horizon;
 *     q = (m.x/sigma_x)^2 / m.z^2 + (m.y/sigma_y)^2 / m.z^2,  which is tan^2(theta)/sigma^2 when isotropic;
 *     z = cot(theta_w)/sigma_eff = w.z / sqrt((sigma_x w.x)^2 + (sigma_y w.y)^2).
 *
 * exp(-q) and (1 + q/(gamma-1))^-gamma turn a relative error of q into one |ln D| times as large. So q comes as
 * the sum of two doubles: what is left is the rounding of m itself,
 * at most 4.5e-16 |d ln D / d ln q|. */
#ifndef NDF_FORMULAS_H
#define NDF_FORMULAS_H

#include "src/ndf.h"

/* A direction as the axes of the roughness see it, and back. */
static inline struct vec3 ndf_to_axes(const struct ndf *ndf, struct vec3 v)
{
	if (ndf->angle == 0.0)
		return v;
	return (struct vec3){ndf->turn_cos * v.x + ndf->turn_sin * v.y, ndf->turn_cos * v.y - ndf->turn_sin * v.x, v.z};
}

static inline struct vec3 ndf_from_axes(const struct ndf *ndf, struct vec3 v)
{
	if (ndf->angle == 0.0)
		return v;
	return (struct vec3){ndf->turn_cos * v.x - ndf->turn_sin * v.y, ndf->turn_cos * v.y + ndf->turn_sin * v.x, v.z};
}

/* A normal of the distribution without its tilt, as one with it, and back; and a direction that the first sees as the second
 * sees w: w.m stays. None is of length 1 then. All along the axes. */
static inline struct vec3 ndf_tilted_normal(const struct ndf *ndf, struct vec3 m)
{
	return (struct vec3){m.x + ndf->lean_x * m.z, m.y + ndf->lean_y * m.z, m.z};
}

static inline struct vec3 ndf_untilted_normal(const struct ndf *ndf, struct vec3 m)
{
	return (struct vec3){m.x - ndf->lean_x * m.z, m.y - ndf->lean_y * m.z, m.z};
}

static inline struct vec3 ndf_untilted_direction(const struct ndf *ndf, struct vec3 w)
{
	return (struct vec3){w.x, w.y, w.z + ndf->lean_x * w.x + ndf->lean_y * w.y};
}

/* An unevaluated sum, |lo| <= ulp(hi)/2. */
struct dd {
	double hi, lo;
};

/* Closer to the horizon than this a normal counts as this close: with sigma inside NDF_SIGMA_MIN..MAX no intermediate
 * result over- or underflows then. */
#define NDF_COS_MIN 1e-100

static inline struct dd dd_sum(double a, double b)
{
	const double hi = a + b;
	const double a_part = hi - b;
	return (struct dd){hi, (a - a_part) + (b - (hi - a_part))};
}

static inline struct dd dd_product(double a, double b)
{
	const double hi = a * b;
	return (struct dd){hi, fma(a, b, -hi)};
}

/* (x / d)^2 */
static inline struct dd dd_ratio_squared(double x, struct dd d)
{
	const double t = x / d.hi;
	const double t_lo = (fma(-t, d.hi, x) - t * d.lo) / d.hi;
	const struct dd square = dd_product(t, t);
	return dd_sum(square.hi, square.lo + 2.0 * t * t_lo);
}

/* cos(theta_m), kept from the horizon; NaN stays NaN. */
static inline double ndf_cos(struct vec3 m)
{
	return m.z < NDF_COS_MIN ? NDF_COS_MIN : m.z;
}

/* q of the notation above. */
static inline struct dd ndf_q(const struct ndf *ndf, struct vec3 m)
{
	const double z = ndf_cos(m);
	const struct dd x = dd_ratio_squared(m.x, dd_product(ndf->sigma_x, z));
	const struct dd y = dd_ratio_squared(m.y, dd_product(ndf->sigma_y, z));
	const struct dd sum = dd_sum(x.hi, y.hi);
	return dd_sum(sum.hi, sum.lo + x.lo + y.lo);
}

/* sigma_eff sin(theta_w), so that z = w.z / this. */
static inline double ndf_r(const struct ndf *ndf, struct vec3 w)
{
	const double x = ndf->sigma_x * w.x;
	const double y = ndf->sigma_y * w.y;
	return sqrt(x * x + y * y);
}

/* From this z on a direction is the normal itself: Lambda is 0 and nothing overflows on the way. */
#define NDF_Z_NORMAL 1e150

/* z of the notation above, INFINITY from NDF_Z_NORMAL on. */
static inline double ndf_z(const struct ndf *ndf, struct vec3 w)
{
	const double r = ndf_r(ndf, w);
	return r * NDF_Z_NORMAL <= w.z ? INFINITY : w.z / r;
}

/* GGX: D = 1 / (pi sigma_x sigma_y cos^4 (1 + q)^2). Here cos^2 (1 + q) is taken as one positive sum. */
static inline double ggx_D(const struct ndf *ndf, struct vec3 m)
{
	const double x = m.x / ndf->sigma_x;
	const double y = m.y / ndf->sigma_y;
	const double s = m.z * m.z + x * x + y * y;
	return M_1_PI / (s * ndf->sigma_x) / (s * ndf->sigma_y);
}

/* GGX: the share 1/(1 + s^2) of the normals is steeper than s. */
static inline double ggx_tilt(const struct ndf *ndf, double u)
{
	(void)ndf;
	return sqrt(u / (1.0 - u));
}

/* GGX: the share below s, the inverse of the above. */
static inline double ggx_share(const struct ndf *ndf, double s)
{
	(void)ndf;
	return s < 1.0 ? s * s / (1.0 + s * s) : 1.0 / (1.0 + 1.0 / s / s);
}

/* GGX: P2 = (1 + (q/s)^2)^(-3/2) / (2 s) */
static inline double ggx_P2(const struct ndf *ndf, double s, double q)
{
	(void)ndf;
	const double root = hypot(1.0, q / s);
	return 0.5 / s / root / root / root;
}

/* GGX: Lambda = (sqrt(1 + 1/z^2) - 1)/2 with numerator and denominator of 1/z kept apart and the subtraction
 * rationalised away. */
static inline double ggx_lambda(const struct ndf *ndf, struct vec3 w)
{
	const double r = ndf_r(ndf, w);
	return 0.5 * r * (r / (w.z + sqrt(w.z * w.z + r * r))) / w.z;
}

/* Beckmann: D = exp(-q) / (pi sigma_x sigma_y cos^4), as a product of two halves so that neither factor leaves the
 * range of a double before D does. */
static inline double beckmann_D(const struct ndf *ndf, struct vec3 m)
{
	const struct dd q = ndf_q(ndf, m);
	const double z = ndf_cos(m);
	const double half = exp(-0.5 * q.hi) * (1.0 - 0.5 * q.lo) / (z * z);
	return M_1_PI * (half / ndf->sigma_x) * (half / ndf->sigma_y);
}

/* Beckmann: the share exp(-s^2) of the normals is steeper than s. */
static inline double beckmann_tilt(const struct ndf *ndf, double u)
{
	(void)ndf;
	return sqrt(-log1p(-u));
}

/* Beckmann: the share below s, the inverse of the above. */
static inline double beckmann_share(const struct ndf *ndf, double s)
{
	(void)ndf;
	return -expm1(-s * s);
}

/* Beckmann: P2 = exp(-(q/s)^2) / (s sqrt(pi)) */
static inline double beckmann_P2(const struct ndf *ndf, double s, double q)
{
	(void)ndf;
	const double t = fmin(fabs(q / s), 1e100); /* 0 from 28 on */
	return isnan(q) ? q : exp(-t * t) / (s * sqrt(M_PI));
}

/* Steps of the continued fractions below that give all digits, z >= 0.8. */
static inline int lambda_steps(double z)
{
	return 6 + (int)(90.0 / (z * z));
}

/* Below this z the direct forms of Lambda keep their digits; above it the subtraction of 1/2 would eat them. */
#define LAMBDA_DIRECT_BELOW 0.8

/* Beckmann: Lambda = (exp(-z^2)/(z sqrt(pi)) - erfc(z))/2; for large z the continued fraction of the difference,
 *     exp(-z^2)/(4 sqrt(pi) z) / (1.5 + z^2 - 1*1.5/(3.5 + z^2 - 2*2.5/(5.5 + z^2 - ...))). */
static inline double beckmann_lambda(const struct ndf *ndf, struct vec3 w)
{
	const double z = ndf_z(ndf, w);
	if (z == INFINITY)
		return 0.0;
	const double z2 = z * z;
	const double front = exp(-z2) / (sqrt(M_PI) * z);
	if (!(z >= LAMBDA_DIRECT_BELOW))
		return 0.5 * (front - erfc(z));
	double tail = 0.0;
	for (int m = lambda_steps(z); m > 0; m--)
		tail = m * (m + 0.5) / (1.5 + 2.0 * m + z2 - tail);
	return 0.25 * front / (1.5 + z2 - tail);
}

#endif
