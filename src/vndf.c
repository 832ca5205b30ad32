/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/vndf.h"
#include "src/ndf_class.h"
#include "src/ndf_formulas.h"
#include "src/student_t.h"
#include "src/vndf_student.h"
#include <gsl/gsl_cdf.h>
#include <stddef.h>

/* A slope vector (x, y) as (x, y, 1) times any positive factor: slopes of heavy tails leave the range of a double. */
struct scaled_slopes {
	double x, y, one;
};

/* Away from 0 and 1. Uniform numbers are multiples of 2^-53 or coarser: 0 stands for [0, 2^-53). */
static double inside(double u)
{
	return fmin(fmax(u, 0x1p-54), 1.0 - 0x1p-53);
}

/* |slope| of the density (2/pi) (1 + z^2)^-2 exceeded with probability m <= 1/2. With z = cot(e/2) the tail is
 * (e - sin e)/(2 pi): Kepler's equation at eccentricity 1. */
static double t3_tail_quantile(double m)
{
	static const double series[] = {151439.0 / 12713500800000.0,
					1213.0 / 7207200000.0,
					43.0 / 17248000.0,
					1.0 / 25200.0,
					1.0 / 1400.0,
					1.0 / 60.0,
					1.0};
	const double s = cbrt(12.0 * M_PI * m);
	double e = 0.0;
	for (size_t i = 0; i < sizeof(series) / sizeof(series[0]); i++)
		e = e * (s * s) + series[i];
	e *= s;
	/* The series alone is exact to 1e-16 for s < 0.3; a step of fourth order takes the rest from 1e-5. */
	if (s > 0.3) {
		const double sin_e = sin(e), cos_e = cos(e);
		const double f = e - sin_e - 2.0 * M_PI * m, f1 = 1.0 - cos_e;
		const double newton = f / f1;
		const double halley = f / (f1 - 0.5 * newton * sin_e);
		e -= f / (f1 - halley * (0.5 * sin_e - halley * cos_e / 6.0));
	}
	return 1.0 / tan(0.5 * e);
}

static double t3_quantile(double u)
{
	return u < 0.5 ? -t3_tail_quantile(u) : t3_tail_quantile(1.0 - u);
}

/* The paper's rational fit of the same quantile at u = (1 + v)/2. */
struct t3_fraction {
	double top, bottom;
};

static struct t3_fraction t3_fraction(double v)
{
	return (struct t3_fraction){v * (0.46341 + v * (-0.73369 + v * 0.27385)),
				    0.597999 + v * (-1.0 + v * (0.309420 + v * 0.093073))};
}

static double t3_fit(double v)
{
	const struct t3_fraction fit = t3_fraction(v);
	return fit.top / fit.bottom;
}

static double t3_quantile_fit(double u)
{
	const double z = t3_fit(fabs(2.0 * u - 1.0));
	return u > 0.5 ? z : -z;
}

/* Density of the fit's slopes by that of the true ones, (2/pi) (1 + z^2)^-2. The fit rises: v by bisection. */
static double t3_fit_ratio(double z)
{
	double low = 0.0, high = 1.0;
	z = fabs(z);
	if (z >= t3_fit(1.0))
		return 0.0;
	for (int i = 0; i < 60; i++) {
		const double v = 0.5 * (low + high);
		if (t3_fit(v) < z)
			low = v;
		else
			high = v;
	}
	const double v = 0.5 * (low + high);
	const struct t3_fraction fit = t3_fraction(v);
	const double top_slope = 0.46341 + v * (-2.0 * 0.73369 + v * 3.0 * 0.27385);
	const double bottom_slope = -1.0 + v * (2.0 * 0.309420 + v * 3.0 * 0.093073);
	const double slope = (top_slope - fit.top / fit.bottom * bottom_slope) / fit.bottom; /* dz/dv, v = 2 u - 1 */
	const double root = 1.0 + z * z;
	return 0.25 * M_PI * root * root / slope;
}

/* With x = tan(psi) the CDF of x is (sin(theta + psi) + cos_i)/(1 + cos_i). So sin(theta + psi) is k = u1 (1 + cos_i) -
 * cos_i, its cosine r, and sine and cosine of psi follow by subtracting theta, each written without cancellation; also
 * for theta beyond the horizon. */
static struct scaled_slopes ggx_slopes(double cos_i, double sin_i, double u1, double u2, enum vndf_ggx how)
{
	const double one_plus_cos = cos_i < 0.0 ? sin_i * sin_i / (1.0 - cos_i) : 1.0 + cos_i;
	const double k_plus_cos = u1 * one_plus_cos;
	const double k = k_plus_cos - cos_i;
	const double r = sqrt((1.0 - u1) * (sin_i * sin_i + k_plus_cos * one_plus_cos));
	const bool alike = k > 0.0 && cos_i >= 0.0;
	const double sin_psi = alike ? (k - sin_i) * (k + sin_i) / (k * cos_i + r * sin_i) : k * cos_i - r * sin_i;
	const double cos_psi = alike ? r * cos_i + k * sin_i : k_plus_cos * (cos_i - k) / (r * cos_i - k * sin_i);
	const double z = how == VNDF_GGX_FIT ? t3_quantile_fit(u2) : t3_quantile(u2);
	return (struct scaled_slopes){sin_psi, z, cos_psi};
}

/* The area seen is (cos_i - x sin_i): below -cot it splits into two terms that can be inverted; in (-cot, cot) the
 * slopes x and -x share cos_i P2(x) of it. */
static struct scaled_slopes beckmann_slopes(double cos_i, double sin_i, double u1, double u2)
{
	const double cot = cos_i < 1e100 * sin_i ? cos_i / sin_i : 1e100; /* no facet is as steep as that */
	const double erf_cot = erf(cot), erfc_cot = erfc(cot);
	const double by_sine = 0.5 * M_2_SQRTPI * 0.5 * sin_i * exp(-cot * cot);
	const double by_cosine = 0.5 * cos_i * erfc_cot;
	const double below = by_sine + by_cosine;
	const double part = below / (below + cos_i * erf_cot);
	double x;
	if (u1 < part) {
		const double u = u1 / part, p = by_sine / below;
		x = u < p ? -sqrt(cot * cot - log(u / p))
			  : M_SQRT1_2 * gsl_cdf_ugaussian_Pinv(0.5 * erfc_cot * inside((u - p) / (1.0 - p)));
	} else {
		const double u = inside((u1 - part) / (1.0 - part));
		x = M_SQRT1_2 * (u < 0.5 ? gsl_cdf_ugaussian_Pinv(0.5 * erfc_cot + u * erf_cot)
					 : gsl_cdf_ugaussian_Qinv(0.5 * erfc_cot + (1.0 - u) * erf_cot));
		const double p = 0.5 - 0.5 * x / cot;
		if (u2 > p)
			x = -x;
		u2 = u2 > p ? (u2 - p) / (1.0 - p) : u2 / p;
	}
	return (struct scaled_slopes){x, M_SQRT1_2 * gsl_cdf_ugaussian_Pinv(inside(u2)), 1.0};
}

/* With X = x/sqrt(gamma-1) the slope along wi has density K (1 + X^2)^(1/2-gamma), and y/sqrt(gamma-1+x^2) has
 * Gamma(gamma)/(sqrt(pi) Gamma(gamma-1/2)) (1 + z^2)^-gamma whatever x is. */
static struct scaled_slopes std_slopes(double gamma, double K, double cos_i, double sin_i, double u1, double u2)
{
	const double a = gamma - 1.0;
	const double scale = sqrt(a);
	/* Along the normal all facets are seen alike. */
	const struct student along = {gamma - 0.5, K, cos_i, sin_i > 1e-160 ? scale * sin_i : 0.0};
	const struct student across = {gamma, a * M_1_PI / K, 1.0, 0.0};
	const double w = student_quantile(&along, u1);
	const double v = student_quantile(&across, u2);
	return (struct scaled_slopes){scale * copysign(sqrt(-expm1(-w * w)), w),
				      scale * copysign(sqrt(expm1(v * v)), v), exp(-0.5 * w * w)};
}

static struct vndf_slopes slopes_of(struct scaled_slopes s)
{
	return (struct vndf_slopes){s.x / s.one, s.y / s.one};
}

struct vndf_slopes vndf_ggx_slopes(double cos_i, double sin_i, double u1, double u2, enum vndf_ggx how)
{
	return slopes_of(ggx_slopes(cos_i, sin_i, inside(u1), inside(u2), how));
}

struct vndf_slopes vndf_beckmann_slopes(double cos_i, double sin_i, double u1, double u2)
{
	return slopes_of(beckmann_slopes(cos_i, sin_i, inside(u1), inside(u2)));
}

bool vndf_supports(const struct ndf *ndf)
{
	return ndf->class->student_t || ndf->class == &ndf_class_ggx || ndf->class == &ndf_class_beckmann ||
	       ndf->class->tilts;
}

bool vndf_rational_supports(const struct ndf *ndf)
{
	return vndf_supports(ndf) && ndf->gamma == 2.0;
}

/* All but Beckmann: what differs is of the order 1/gamma. */
#define GAMMA_BECKMANN 1e16

/* Student-t slopes at gamma = 2 are those of GGX, and where they have no K they are Beckmann's. From below the horizon the
 * latter are a difference of two terms: the solver has that. */
static struct scaled_slopes sample_slopes(const struct ndf *ndf, double cos_i, double sin_i, double u1, double u2,
					  enum vndf_ggx how)
{
	if (ndf->gamma == 2.0)
		return ggx_slopes(cos_i, sin_i, u1, u2, how);
	if (ndf->K > 0.0)
		return std_slopes(ndf->gamma, ndf->K, cos_i, sin_i, u1, u2);
	if (cos_i < 0.0)
		return std_slopes(GAMMA_BECKMANN, sqrt(GAMMA_BECKMANN * M_1_PI), cos_i, sin_i, u1, u2);
	return beckmann_slopes(cos_i, sin_i, u1, u2);
}

/* wi as unit roughness sees it. */
struct stretched {
	double cos_i, sin_i, cos_phi, sin_phi;
};

static struct stretched stretch(double sigma_x, double sigma_y, struct vec3 wi)
{
	const double x = sigma_x * wi.x, y = sigma_y * wi.y;
	const double r = sqrt(x * x + y * y);
	const double length = sqrt(r * r + wi.z * wi.z);
	return (struct stretched){wi.z / length, r / length, r > 0.0 ? x / r : 1.0, r > 0.0 ? y / r : 0.0};
}

static struct vec3 sample(const struct ndf *ndf, struct vec3 wi, double u1, double u2, enum vndf_ggx how)
{
	if (!vndf_supports(ndf) || isnan(wi.x + wi.y + wi.z) || (wi.z < 0.0 && !(vndf_area(ndf, wi) > 0.0)))
		return (struct vec3){NAN, NAN, NAN};
	wi = ndf_to_axes(ndf, wi);
	wi.z = fabs(wi.z) < NDF_COS_MIN ? NDF_COS_MIN : wi.z;
	const double sigma_x = ndf->sigma_x / ndf->stretch, sigma_y = ndf->sigma_y / ndf->stretch; /* of std */
	const struct stretched seen = stretch(sigma_x, sigma_y, ndf_untilted_direction(ndf, wi));
	const struct scaled_slopes s = sample_slopes(ndf, seen.cos_i, seen.sin_i, inside(u1), inside(u2), how);
	const struct vec3 untilted = {-sigma_x * (seen.cos_phi * s.x - seen.sin_phi * s.y),
				      -sigma_y * (seen.sin_phi * s.x + seen.cos_phi * s.y), s.one};
	struct vec3 m = vec3_unit(ndf_tilted_normal(ndf, untilted));
	m.z = ndf_cos(m);
	/* The rounding of m can turn the very last bit of wi.m. */
	const double cos_d = vec3_dot(wi, m);
	if (cos_d < 0.0)
		m = vec3_sub(m, vec3_scale(wi, 2.0 * cos_d));
	m.z = ndf_cos(m);
	return ndf_from_axes(ndf, m);
}

struct vec3 vndf_sample_inside(const struct ndf *ndf, struct vec3 wi, double u1, double u2)
{
	return sample(ndf, wi, u1, u2, VNDF_GGX_EXACT);
}

struct vec3 vndf_sample(const struct ndf *ndf, struct vec3 wi, double u1, double u2)
{
	wi.z = wi.z < 0.0 ? 0.0 : wi.z;
	return vndf_sample_inside(ndf, wi, u1, u2);
}

double vndf_area(const struct ndf *ndf, struct vec3 wi)
{
	if (ndf->class->area)
		return ndf->class->area(ndf, ndf_to_axes(ndf, wi));
	if (wi.z <= -NDF_COS_MIN)
		return -wi.z * ndf_lambda(ndf, vec3_opposite(wi));
	const struct vec3 up = {wi.x, wi.y, ndf_cos(wi)};
	return up.z * (1.0 + ndf_lambda(ndf, up));
}

double vndf_pdf_inside(const struct ndf *ndf, struct vec3 wi, struct vec3 m)
{
	const double cos_d = vec3_dot(wi, m);
	return cos_d <= 0.0 ? 0.0 : cos_d * ndf_D(ndf, m) / vndf_area(ndf, wi);
}

struct vec3 vndf_rational_sample(const struct ndf *ndf, struct vec3 wi, double u1, double u2)
{
	if (!vndf_rational_supports(ndf))
		return (struct vec3){NAN, NAN, NAN};
	wi.z = wi.z < 0.0 ? 0.0 : wi.z;
	return sample(ndf, wi, u1, u2, VNDF_GGX_FIT);
}

/* The slopes of m along and across wi, at unit roughness. */
static struct vndf_slopes slopes_seen(const struct ndf *ndf, struct vec3 wi, struct vec3 m, struct stretched *seen)
{
	const double sigma_x = ndf->sigma_x / ndf->stretch, sigma_y = ndf->sigma_y / ndf->stretch;
	wi = ndf_to_axes(ndf, wi);
	wi.z = wi.z < NDF_COS_MIN ? NDF_COS_MIN : wi.z;
	m = ndf_untilted_normal(ndf, ndf_to_axes(ndf, m));
	*seen = stretch(sigma_x, sigma_y, ndf_untilted_direction(ndf, wi));
	const double p = -m.x / ndf_cos(m) / sigma_x, q = -m.y / ndf_cos(m) / sigma_y;
	return (struct vndf_slopes){seen->cos_phi * p + seen->sin_phi * q, seen->cos_phi * q - seen->sin_phi * p};
}

/* Beckmann: int (cos_i - x' sin_i) exp(-x'^2)/sqrt(pi) up to x <= cot. */
static double beckmann_seen_below(const struct stretched *seen, double x)
{
	return 0.5 * seen->cos_i * erfc(-x) + 0.5 * seen->sin_i * exp(-x * x) / sqrt(M_PI);
}

void vndf_cdf(const struct ndf *ndf, struct vec3 wi, struct vec3 m, double *along, double *across)
{
	*along = *across = NAN;
	if (!vndf_supports(ndf) || isnan(wi.x + wi.y + wi.z + m.x + m.y + m.z))
		return;
	struct stretched seen;
	const struct vndf_slopes s = slopes_seen(ndf, wi, m, &seen);
	if (seen.cos_i < 0.0)
		return;
	if (ndf->gamma != 2.0 && ndf->K == 0.0) {
		const double cot = seen.sin_i > 1e-100 ? seen.cos_i / seen.sin_i : 1e100;
		*along = fmin(beckmann_seen_below(&seen, fmin(s.x, cot)) / beckmann_seen_below(&seen, cot), 1.0);
		*across = 0.5 * erfc(-s.y);
		return;
	}
	const double a = ndf->gamma - 1.0, K = student_t_K(ndf->gamma), scale = sqrt(a);
	const struct student slopes_along = {ndf->gamma - 0.5, K, seen.cos_i,
					     seen.sin_i > 1e-160 ? scale * seen.sin_i : 0.0};
	const struct student slopes_across = {ndf->gamma, a * M_1_PI / K, 1.0, 0.0};
	*along = fmin(student_cdf(&slopes_along, s.x / scale), 1.0);
	*across = fmin(student_cdf(&slopes_across, s.y / hypot(scale, s.x)), 1.0);
}

double vndf_rational_pdf(const struct ndf *ndf, struct vec3 wi, struct vec3 m)
{
	struct stretched seen;
	if (!vndf_rational_supports(ndf))
		return NAN;
	const struct vndf_slopes s = slopes_seen(ndf, wi, m, &seen);
	return vndf_pdf(ndf, wi, m) * t3_fit_ratio(s.y / hypot(1.0, s.x));
}

double vndf_pdf(const struct ndf *ndf, struct vec3 wi, struct vec3 m)
{
	const double cos_d = vec3_dot(wi, m);
	if (wi.z <= 0.0 || m.z <= 0.0 || cos_d <= 0.0)
		return 0.0;
	if (ndf_is_tilted(ndf)) /* G1 is bounded */
		return vndf_pdf_inside(ndf, wi, m);
	return ndf_G1(ndf, wi) / wi.z * cos_d * ndf_D(ndf, m);
}
