/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/student_t.h"
#include "src/ndf_formulas.h"
#include <stddef.h>

/* From here on STD is Beckmann: D differs from it by a factor 1 + q^2/(2 gamma), less than 3e-17 even at 1e-304. */
#define GAMMA_BECKMANN 1e22

/* Gamma(a + 1/2)/Gamma(a); from 32 on by its asymptotic series, whose eight terms are then good to 1e-15. */
static double gamma_ratio(double a)
{
	static const double series[] = {39325.0 / 33554432.0, 869.0 / 4194304.0, -399.0 / 262144.0, -21.0 / 32768.0,
					5.0 / 1024.0,         1.0 / 128.0,       -1.0 / 8.0,        1.0};
	if (a < 32.0)
		return tgamma(a + 0.5) / tgamma(a);
	double sum = 0.0;
	for (size_t i = 0; i < sizeof(series) / sizeof(series[0]); i++)
		sum = sum / a + series[i];
	return sqrt(a) * sum;
}

double student_t_K(double gamma)
{
	return gamma_ratio(gamma - 1.0) / sqrt(M_PI);
}

static bool is_ggx(const struct ndf *ndf)
{
	return ndf->gamma == 2.0 && ndf->a == 1.0;
}

static bool is_beckmann(const struct ndf *ndf)
{
	return ndf->gamma >= GAMMA_BECKMANN;
}

bool student_t_prepare(struct ndf *ndf, double a)
{
	ndf->a = a;
	ndf->stretch = a == ndf->gamma - 1.0 || is_beckmann(ndf) ? 1.0 : sqrt((ndf->gamma - 1.0) / a);
	if (!is_ggx(ndf) && !is_beckmann(ndf))
		ndf->K = student_t_K(ndf->gamma);
	return true;
}

double student_t_z(const struct ndf *ndf, struct vec3 w)
{
	return ndf_z(ndf, w) * ndf->stretch;
}

/* From here on D is written as Beckmann's times a factor: 1 + q/a has no digits left for q. */
#define GAMMA_LARGE 1e12

/* -gamma ln(1 + q/a) = -q - q (gamma-a)/a + gamma q^2/(2 a^2), the next term being below 1e-15 where D is not 0. */
static double large_gamma_D(const struct ndf *ndf, struct vec3 m)
{
	const double D = beckmann_D(ndf, m);
	if (!(D > 0.0))
		return D;
	const double ratio = ndf_q(ndf, m).hi / ndf->a;
	return D * ndf->stretch * ndf->stretch * exp(ratio * (0.5 * ndf->gamma * ratio - (ndf->gamma - ndf->a)));
}

/* D = stretch^2 (1 + q/a)^-gamma / (pi sigma_x sigma_y cos^4), with two of the powers put to the cosines:
 * D = stretch^2 v^(2-gamma) / (pi sigma_x sigma_y (cos^2 v)^2), v = 1 + q/a. Nothing overflows before D does. */
double student_t_D(const struct ndf *ndf, struct vec3 m)
{
	const double gamma = ndf->gamma;
	const double a = ndf->a; /* exact for std */
	if (is_ggx(ndf))
		return ggx_D(ndf, m);
	if (is_beckmann(ndf))
		return beckmann_D(ndf, m);
	if (gamma > GAMMA_LARGE)
		return large_gamma_D(ndf, m);
	const struct dd q = ndf_q(ndf, m);
	const double ratio = q.hi / a;
	const double ratio_lo = (fma(-ratio, a, q.hi) + q.lo) / a;
	const struct dd v = dd_sum(1.0, ratio);
	const double v_lo = v.lo + ratio_lo;
	const double power = 1.0 - 0.5 * gamma;
	const double z = ndf_cos(m);
	const double half = ndf->stretch * (pow(v.hi, power) * exp(power * v_lo / v.hi) / (z * z * v.hi));
	return M_1_PI * (half / ndf->sigma_x) * (half / ndf->sigma_y);
}

/* S = sum over n of prod_{i<n} (gamma - 1/2 + i)/(3/2 + i) y^n, all terms positive. */
static double lambda_series(double gamma, double y)
{
	double term = 1.0, sum = 1.0;
	for (int i = 0; term > 0x1p-54 * sum; i++) {
		term *= y * (gamma - 0.5 + i) / (1.5 + i);
		sum += term;
	}
	return sum;
}

/* 2F1(1, gamma - 3/2; gamma; x), the even part of Gauss's continued fraction, from the tail forward. a = gamma - 1. */
static double lambda_fraction(double a, double x, double y, int steps)
{
	double tail = 0.0;
	for (int i = steps; i > 0; i--) {
		const double m = i;
		const double A = a + 2.0 * m;
		const double b = (a * (2.0 * m + 1.5) + 2.0 * m * m - 1.5) / ((A - 1.0) * (A + 1.0)) +
				 y * (m * (m + 0.5) / ((A - 1.0) * A) + (a + m) * (a + m - 0.5) / (A * (A + 1.0)));
		const double p = (a + m - 1.0) * (a + m - 1.5) * m * (m + 0.5) * (x * x) /
				 ((A - 2.0) * (A - 1.0) * (A - 1.0) * A);
		tail = p / (b - tail);
	}
	return 1.0 / ((1.5 + (a - 0.5) * y) / (a + 1.0) - tail);
}

/* With u = z/sqrt(gamma-1), x = 1/(1+u^2), y = 1-x and e = x^(gamma-3/2), Smith's integral over the Student-t slopes
 * is
 *     Lambda = K e/((2 gamma-3) u) - 1/2 + K u e x S(y)                           small z
 *            = K e/(2 (gamma-1) (2 gamma-3) u) 2F1(1, gamma-3/2; gamma; x)        large z
 * S and 2F1 as above. */
double student_t_lambda(const struct ndf *ndf, struct vec3 w)
{
	const double gamma = ndf->gamma;
	if (is_ggx(ndf))
		return ggx_lambda(ndf, w);
	if (is_beckmann(ndf))
		return beckmann_lambda(ndf, w);
	const double z = student_t_z(ndf, w);
	if (z >= NDF_Z_NORMAL)
		return 0.0;
	const double a = gamma - 1.0;
	const double root_a = sqrt(a), u = z / root_a;
	const double x = 1.0 / (1.0 + u * u);
	const double y = u * u * x;
	const double e = exp(-(gamma - 1.5) * log1p(u * u));
	/* By z, as u has no digits left where it is denormal. */
	const double front = ndf->K * root_a / (2.0 * gamma - 3.0) * e / z;
	if (!(z >= LAMBDA_DIRECT_BELOW))
		return (front - 0.5) + ndf->K * u * e * x * lambda_series(gamma, y);
	return front * (lambda_fraction(a, x, y, lambda_steps(z)) / (2.0 * a));
}

double student_t_P2(const struct ndf *ndf, double s, double q)
{
	if (is_ggx(ndf))
		return ggx_P2(ndf, s, q);
	if (is_beckmann(ndf))
		return beckmann_P2(ndf, s, q);
	const double t = fabs(q / s / sqrt(ndf->a));
	const double log_v = t > 1e100 ? 2.0 * log(t) : log1p(t * t);
	return ndf->K * exp((0.5 - ndf->gamma) * log_v) / sqrt(ndf->a) / s;
}

/* The share (1 + s^2/a)^(1-gamma) of the normals is steeper than s. */
double student_t_tilt(const struct ndf *ndf, double u)
{
	if (is_beckmann(ndf))
		return beckmann_tilt(ndf, u);
	return sqrt(ndf->a * expm1(-log1p(-u) / (ndf->gamma - 1.0)));
}

double student_t_share(const struct ndf *ndf, double s)
{
	if (is_beckmann(ndf))
		return beckmann_share(ndf, s);
	const double t = s / sqrt(ndf->a);
	const double log_v = t > 1e100 ? 2.0 * log(t) : log1p(t * t);
	return -expm1((1.0 - ndf->gamma) * log_v);
}
