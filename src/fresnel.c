/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/fresnel.h"
#include "src/names.h"
#include <complex.h>
#include <math.h>

static const char *const names[FRESNEL_COUNT] = {"dielectric", "schlick", "conductor", "none", "f82"};

const char *fresnel_name(enum fresnel fresnel)
{
	return names_at(names, FRESNEL_COUNT, (int)fresnel);
}

enum status fresnel_find(const char *name, enum fresnel *fresnel)
{
	const int i = names_find(names, FRESNEL_COUNT, name);
	if (i < 0)
		return STATUS_DOMAIN;
	*fresnel = (enum fresnel)i;
	return STATUS_OK;
}

/* Both exact forms take the amplitudes, with m the (complex) index and c = cos_d, s = sin_d,
 * g = sqrt(m^2 - s^2), as
 *     r_s = (c - g) / (c + g)           = (1 - m^2) / (c + g)^2
 *     r_p = (m^2 c - g) / (m^2 c + g)   = (m^2 - 1) (m^2 c^2 - s^2) / (m^2 c + g)^2
 * since the left-hand sides subtract nearly equal numbers when m is close to 1. */

static double mean_of_squares(double r_s, double r_p)
{
	return fmin(0.5 * (r_s * r_s + r_p * r_p), 1.0);
}

/* The real part of g^2 = m^2 - 1 + c^2 = m^2 - s^2, by whichever sum has the smaller parts and so keeps its digits. */
static double g_squared(double m2, double m2_minus_1, double c)
{
	return c * c < 0.5 ? m2_minus_1 + c * c : m2 - (1.0 - c) * (1.0 + c);
}

double fresnel_dielectric(double cos_d, double n)
{
	if (isnan(cos_d) || isnan(n))
		return NAN;
	const double c = fmin(cos_d, 1.0);
	const double s2 = (1.0 - c) * (1.0 + c);
	const double m2 = n * n;
	const double m2_minus_1 = (n - 1.0) * (n + 1.0);
	const double g2 = g_squared(m2, m2_minus_1, c);
	if (c <= 0.0 || g2 < 0.0)
		return 1.0;
	if (n == 1.0)
		return 0.0;
	const double g = sqrt(g2);
	const double s_sum = c + g;
	const double p_sum = m2 * c + g;
	return mean_of_squares(m2_minus_1 / s_sum / s_sum, m2_minus_1 / p_sum * ((m2 * c * c - s2) / p_sum));
}

double fresnel_schlick(double cos_d, double n)
{
	const double root = (n - 1.0) / (n + 1.0);
	const double f0 = root * root;
	const double x = isnan(cos_d) ? NAN : 1.0 - fmin(fmax(cos_d, 0.0), 1.0);
	return f0 + (1.0 - f0) * (x * x) * (x * x) * x;
}

double fresnel_conductor(double cos_d, double eta, double k)
{
	if (isnan(cos_d) || isnan(eta) || isnan(k))
		return NAN;
	const double c = fmin(cos_d, 1.0);
	if (c <= 0.0)
		return 1.0;
	if (k == 0.0)
		return fresnel_dielectric(c, eta);
	const double s2 = (1.0 - c) * (1.0 + c);
	const double re_m2 = (eta - k) * (eta + k);
	const double im_m2 = 2.0 * eta * k;
	const double re_m2_minus_1 = (eta - 1.0) * (eta + 1.0) - k * k;
	const double complex m2 = re_m2 + im_m2 * I;
	const double complex g = csqrt(g_squared(re_m2, re_m2_minus_1, c) + im_m2 * I);
	const double s_sum = cabs(c + g);
	const double p_sum = cabs(m2 * c + g);
	const double front = hypot(re_m2_minus_1, im_m2);
	return mean_of_squares(front / s_sum / s_sum, front / p_sum * (cabs(m2 * (c * c) - s2) / p_sum));
}

void fresnel_f82_parts(double cos_d, double part[F82_PARTS])
{
	const double c_82 = 1.0 / 7.0, x_82 = 1.0 - c_82;
	const double five_82 = (x_82 * x_82) * (x_82 * x_82) * x_82, peak = c_82 * five_82 * x_82;
	const double c = isnan(cos_d) ? NAN : fmin(fmax(cos_d, 0.0), 1.0), x = 1.0 - c;
	const double five = (x * x) * (x * x) * x, bump = c * five * x / peak;
	part[0] = (1.0 - five) - (1.0 - five_82) * bump;
	part[1] = bump;
	part[2] = five - five_82 * bump;
}

double fresnel_f82(double cos_d, const double reflectance[F82_PARTS])
{
	double part[F82_PARTS];
	fresnel_f82_parts(cos_d, part);
	const double F = reflectance[0] * part[0] + reflectance[1] * part[1] + reflectance[2] * part[2];
	return isnan(F) ? NAN : fmin(fmax(F, 0.0), 1.0);
}

double fresnel_F(enum fresnel fresnel, double cos_d, double n, double k)
{
	switch (fresnel) {
	case FRESNEL_DIELECTRIC:
		return fresnel_dielectric(cos_d, n);
	case FRESNEL_SCHLICK:
		return fresnel_schlick(cos_d, n);
	case FRESNEL_CONDUCTOR:
		return fresnel_conductor(cos_d, n, k);
	case FRESNEL_NONE:
	case FRESNEL_F82:
	case FRESNEL_COUNT:
		break;
	}
	return 1.0;
}
