/* SPDX-License-Identifier: GPL-3.0-or-later */
/* high_precision - reference values for the stability report, from the definitions in many digits: long double where
 * its 64 bits do, MPFR where numbers cancel. Without MPFR, or where a value underflows, they are NaN: not known. */
#ifndef HIGH_PRECISION_H
#define HIGH_PRECISION_H

#include "src/vec3.h"
#include <float.h>
#include <stdbool.h>

static const long double pi_l = 3.14159265358979323846264338327950288L;

#ifdef HAVE_MPFR
#include <mpfr.h>

static const bool have_mpfr = true;

enum { DIGITS_MAX = 12 };

/* Numbers of one computation, all of `bits`. */
struct work {
	mpfr_t at[DIGITS_MAX];
};

static void work_begin(struct work *work, long bits)
{
	for (int i = 0; i < DIGITS_MAX; i++) {
		mpfr_init2(work->at[i], bits);
		mpfr_set_zero(work->at[i], 1);
	}
}

static long double work_end(struct work *work, mpfr_srcptr result)
{
	const long double value = mpfr_get_ld(result, MPFR_RNDN);
	for (int i = 0; i < DIGITS_MAX; i++)
		mpfr_clear(work->at[i]);
	return value;
}

/* k = Gamma(gamma-1/2) / (sqrt(pi) Gamma(gamma-1)), remembered: many directions ask for that of one gamma. */
static void set_K(mpfr_ptr k, double gamma)
{
	static double of_gamma;
	static mpfr_t K, t;
	int sign;
	if (of_gamma == 0.0)
		mpfr_inits2(2400, K, t, (mpfr_ptr)NULL);
	if (of_gamma != gamma) {
		of_gamma = gamma;
		mpfr_set_d(t, gamma, MPFR_RNDN);
		mpfr_sub_d(t, t, 0.5, MPFR_RNDN);
		mpfr_lgamma(K, &sign, t, MPFR_RNDN);
		mpfr_sub_d(t, t, 0.5, MPFR_RNDN);
		mpfr_lgamma(t, &sign, t, MPFR_RNDN);
		mpfr_sub(K, K, t, MPFR_RNDN);
		mpfr_exp(K, K, MPFR_RNDN);
		mpfr_const_pi(t, MPFR_RNDN);
		mpfr_sqrt(t, t, MPFR_RNDN);
		mpfr_div(K, K, t, MPFR_RNDN);
	}
	mpfr_set(k, K, MPFR_RNDN);
}

static long double reference_K(double gamma)
{
	struct work w;
	work_begin(&w, 256);
	set_K(w.at[0], gamma);
	return work_end(&w, w.at[0]);
}

/* u^2 = z^2/(gamma-1) = w.z^2/(a ((sigma_x w.x)^2 + (sigma_y w.y)^2)) */
static void set_u2(mpfr_ptr u2, double a, double sigma_x, double sigma_y, struct vec3 w, mpfr_ptr t)
{
	mpfr_set_d(u2, w.x, MPFR_RNDN);
	mpfr_mul_d(u2, u2, sigma_x, MPFR_RNDN);
	mpfr_sqr(u2, u2, MPFR_RNDN);
	mpfr_set_d(t, w.y, MPFR_RNDN);
	mpfr_mul_d(t, t, sigma_y, MPFR_RNDN);
	mpfr_sqr(t, t, MPFR_RNDN);
	mpfr_add(u2, u2, t, MPFR_RNDN);
	mpfr_mul_d(u2, u2, a, MPFR_RNDN);
	mpfr_set_d(t, w.z, MPFR_RNDN);
	mpfr_sqr(t, t, MPFR_RNDN);
	mpfr_div(u2, t, u2, MPFR_RNDN);
}

/* sum over n of prod_{i<n} (p + i)/(q + i) y^n */
static void set_series(mpfr_ptr sum, mpfr_srcptr p, double q, bool q_is_gamma, double gamma, mpfr_srcptr y,
		       mpfr_ptr term, mpfr_ptr t)
{
	mpfr_set_ui(sum, 1, MPFR_RNDN);
	mpfr_set_ui(term, 1, MPFR_RNDN);
	for (unsigned long i = 0;; i++) {
		mpfr_add_ui(t, p, i, MPFR_RNDN);
		mpfr_mul(term, term, t, MPFR_RNDN);
		mpfr_mul(term, term, y, MPFR_RNDN);
		mpfr_set_d(t, q_is_gamma ? gamma : q, MPFR_RNDN);
		mpfr_add_ui(t, t, i, MPFR_RNDN);
		mpfr_div(term, term, t, MPFR_RNDN);
		mpfr_add(sum, sum, term, MPFR_RNDN);
		if (mpfr_cmp_ui(term, 0) == 0 ||
		    mpfr_get_exp(term) < mpfr_get_exp(sum) - (mpfr_exp_t)mpfr_get_prec(sum))
			break;
	}
}

/* Lambda of Student-t slopes, finite gamma: with K, x, y as in student_t.c. Where u is large the series in x; else that
 * in y with as many more bits as 1/2 cancels. NaN below 1e-300, where no digit is promised. */
static long double reference_lambda_student(double gamma, double a, double sigma_x, double sigma_y, struct vec3 dir)
{
	struct work w;
	work_begin(&w, 128);
	set_u2(w.at[0], a, sigma_x, sigma_y, dir, w.at[1]);
	const double u2 = mpfr_get_d(w.at[0], MPFR_RNDN);
	work_end(&w, w.at[0]);
	const double log_e = (gamma - 1.5) * log1p(u2);
	if (!(log_e < 690.0))
		return NAN;
	work_begin(&w, 256 + (long)(3.0 * log_e));
	mpfr_ptr U2 = w.at[0], t = w.at[1], u = w.at[2], x = w.at[3], e = w.at[4], K = w.at[5], front = w.at[6],
		 sum = w.at[7], p = w.at[8], term = w.at[9], y = w.at[10], g = w.at[11];
	set_u2(U2, a, sigma_x, sigma_y, dir, t);
	set_K(K, gamma);
	mpfr_sqrt(u, U2, MPFR_RNDN);
	mpfr_add_ui(t, U2, 1, MPFR_RNDN);
	mpfr_ui_div(x, 1, t, MPFR_RNDN);
	mpfr_mul(y, U2, x, MPFR_RNDN);
	mpfr_set_d(g, gamma, MPFR_RNDN);
	mpfr_sub_d(p, g, 1.5, MPFR_RNDN);
	mpfr_pow(e, x, p, MPFR_RNDN);
	/* front = K e / ((2 gamma - 3) u) */
	mpfr_mul(front, K, e, MPFR_RNDN);
	mpfr_mul_ui(t, p, 2, MPFR_RNDN);
	mpfr_mul(t, t, u, MPFR_RNDN);
	mpfr_div(front, front, t, MPFR_RNDN);
	if (u2 > 0.5) {
		set_series(sum, p, 0.0, true, gamma, x, term, t);
		mpfr_sub_ui(t, g, 1, MPFR_RNDN);
		mpfr_mul_ui(t, t, 2, MPFR_RNDN);
		mpfr_div(front, front, t, MPFR_RNDN);
		mpfr_mul(sum, sum, front, MPFR_RNDN);
	} else {
		mpfr_add_ui(p, p, 1, MPFR_RNDN);
		set_series(sum, p, 1.5, false, gamma, y, term, t);
		mpfr_mul(sum, sum, K, MPFR_RNDN);
		mpfr_mul(sum, sum, u, MPFR_RNDN);
		mpfr_mul(sum, sum, e, MPFR_RNDN);
		mpfr_mul(sum, sum, x, MPFR_RNDN);
		mpfr_sub_d(front, front, 0.5, MPFR_RNDN);
		mpfr_add(sum, sum, front, MPFR_RNDN);
	}
	return work_end(&w, sum);
}

/* Lambda of Beckmann, (exp(-z^2)/(z sqrt(pi)) - erfc(z))/2. */
static long double reference_lambda_beckmann(double sigma_x, double sigma_y, struct vec3 dir)
{
	struct work w;
	work_begin(&w, 2600);
	mpfr_ptr z2 = w.at[0], t = w.at[1], z = w.at[2], front = w.at[3];
	set_u2(z2, 1.0, sigma_x, sigma_y, dir, t);
	if (!(mpfr_get_d(z2, MPFR_RNDN) < 690.0)) {
		work_end(&w, z2);
		return NAN;
	}
	mpfr_sqrt(z, z2, MPFR_RNDN);
	mpfr_neg(t, z2, MPFR_RNDN);
	mpfr_exp(front, t, MPFR_RNDN);
	mpfr_div(front, front, z, MPFR_RNDN);
	mpfr_const_pi(t, MPFR_RNDN);
	mpfr_sqrt(t, t, MPFR_RNDN);
	mpfr_div(front, front, t, MPFR_RNDN);
	mpfr_erfc(t, z, MPFR_RNDN);
	mpfr_sub(front, front, t, MPFR_RNDN);
	mpfr_div_ui(front, front, 2, MPFR_RNDN);
	return work_end(&w, front);
}

/* (s^p - 1)/p, ln s at 0 */
static void set_power_integral(mpfr_ptr to, mpfr_srcptr s, double p, double less, mpfr_ptr t)
{
	mpfr_set_d(t, p, MPFR_RNDN);
	mpfr_d_sub(t, less, t, MPFR_RNDN);
	if (mpfr_zero_p(t)) {
		mpfr_log(to, s, MPFR_RNDN);
		return;
	}
	mpfr_pow(to, s, t, MPFR_RNDN);
	mpfr_sub_ui(to, to, 1, MPFR_RNDN);
	mpfr_div(to, to, t, MPFR_RNDN);
}

/* A of the ABC distribution: 1/A = 2 pi ((1 + B) I(1 - C) - I(2 - C))/B^2. */
static long double reference_low_A(double B, double C)
{
	struct work w;
	work_begin(&w, 4000);
	mpfr_ptr s = w.at[0], t = w.at[1], one = w.at[2], two = w.at[3];
	mpfr_set_d(s, B, MPFR_RNDN);
	mpfr_add_ui(s, s, 1, MPFR_RNDN);
	set_power_integral(one, s, C, 1.0, t);
	set_power_integral(two, s, C, 2.0, t);
	mpfr_mul(one, one, s, MPFR_RNDN);
	mpfr_sub(one, one, two, MPFR_RNDN);
	mpfr_div_d(one, one, B, MPFR_RNDN);
	mpfr_div_d(one, one, B, MPFR_RNDN);
	mpfr_const_pi(t, MPFR_RNDN);
	mpfr_mul_ui(t, t, 2, MPFR_RNDN);
	mpfr_mul(one, one, t, MPFR_RNDN);
	mpfr_ui_div(one, 1, one, MPFR_RNDN);
	return work_end(&w, one);
}

/* ((a - p)^2 + (b - q)^2) / ((a + p)^2 + (b + q)^2), into `to` */
static void set_reflectance(mpfr_ptr to, mpfr_srcptr a, mpfr_srcptr b, mpfr_srcptr p, mpfr_srcptr q, mpfr_ptr t,
			    mpfr_ptr below)
{
	mpfr_sub(to, a, p, MPFR_RNDN);
	mpfr_sqr(to, to, MPFR_RNDN);
	mpfr_sub(t, b, q, MPFR_RNDN);
	mpfr_sqr(t, t, MPFR_RNDN);
	mpfr_add(to, to, t, MPFR_RNDN);
	mpfr_add(below, a, p, MPFR_RNDN);
	mpfr_sqr(below, below, MPFR_RNDN);
	mpfr_add(t, b, q, MPFR_RNDN);
	mpfr_sqr(t, t, MPFR_RNDN);
	mpfr_add(below, below, t, MPFR_RNDN);
	mpfr_div(to, to, below, MPFR_RNDN);
}

/* The textbook form, for the index eta + i k: g = p + i q = sqrt(m^2 - sin^2). */
static long double reference_fresnel(double cos_d, double eta, double k)
{
	struct work w;
	work_begin(&w, 5000);
	mpfr_ptr c = w.at[0], p = w.at[1], q = w.at[2], A = w.at[3], B = w.at[4], t = w.at[5], size = w.at[6],
		 re = w.at[7], zero = w.at[8], r_s = w.at[9], below = w.at[10], r_p = w.at[11];
	mpfr_set_d(c, cos_d, MPFR_RNDN);
	/* m^2 = A + i B */
	mpfr_set_d(A, eta, MPFR_RNDN);
	mpfr_mul_d(B, A, k, MPFR_RNDN);
	mpfr_mul_ui(B, B, 2, MPFR_RNDN);
	mpfr_sqr(A, A, MPFR_RNDN);
	mpfr_set_d(t, k, MPFR_RNDN);
	mpfr_sqr(t, t, MPFR_RNDN);
	mpfr_sub(A, A, t, MPFR_RNDN);
	/* g^2 = re + i B */
	mpfr_sqr(re, c, MPFR_RNDN);
	mpfr_sub_ui(re, re, 1, MPFR_RNDN);
	mpfr_add(re, re, A, MPFR_RNDN);
	mpfr_hypot(size, re, B, MPFR_RNDN);
	mpfr_add(p, size, re, MPFR_RNDN);
	mpfr_div_ui(p, p, 2, MPFR_RNDN);
	mpfr_sqrt(p, p, MPFR_RNDN);
	mpfr_sub(q, size, re, MPFR_RNDN);
	mpfr_div_ui(q, q, 2, MPFR_RNDN);
	mpfr_sqrt(q, q, MPFR_RNDN);
	if (mpfr_zero_p(c)) {
		mpfr_set_ui(re, 1, MPFR_RNDN);
		return work_end(&w, re);
	}
	set_reflectance(r_s, c, zero, p, q, t, below);
	mpfr_mul(A, A, c, MPFR_RNDN);
	mpfr_mul(B, B, c, MPFR_RNDN);
	set_reflectance(r_p, A, B, p, q, t, below);
	mpfr_add(re, r_s, r_p, MPFR_RNDN);
	mpfr_div_ui(re, re, 2, MPFR_RNDN);
	return work_end(&w, re);
}
#else
static const bool have_mpfr = false;

static long double reference_K(double gamma)
{
	(void)gamma;
	return NAN;
}
static long double reference_lambda_student(double gamma, double a, double sigma_x, double sigma_y, struct vec3 dir)
{
	(void)gamma, (void)a, (void)sigma_x, (void)sigma_y, (void)dir;
	return NAN;
}
static long double reference_lambda_beckmann(double sigma_x, double sigma_y, struct vec3 dir)
{
	(void)sigma_x, (void)sigma_y, (void)dir;
	return NAN;
}
static long double reference_low_A(double B, double C)
{
	(void)B, (void)C;
	return NAN;
}
static long double reference_fresnel(double cos_d, double eta, double k)
{
	(void)cos_d, (void)eta, (void)k;
	return NAN;
}
#endif

/* A direction in more digits; of any length where only its slopes count. */
struct vec3_long {
	long double x, y, z;
};

static struct vec3_long lengthen(struct vec3 m)
{
	return (struct vec3_long){(long double)m.x, (long double)m.y, (long double)m.z};
}

/* D of Student-t slopes; of Beckmann for gamma infinite. */
static long double reference_D_student(double gamma, double a, double sigma_x, double sigma_y, struct vec3_long m)
{
	const long double x = m.x / m.z / (long double)sigma_x, y = m.y / m.z / (long double)sigma_y;
	const long double q = x * x + y * y, z2 = m.z * m.z;
	const long double area = pi_l * (long double)sigma_x * (long double)sigma_y * z2 * z2;
	if (isinf(gamma))
		return expl(-q) / area;
	return ((long double)gamma - 1) / (long double)a * expl(-(long double)gamma * log1pl(q / (long double)a)) /
	       area;
}

/* D of GTR, c such that the integral of D cos is 1: pi c (sigma^2(1-gamma) - 1)/((gamma-1) (1 - sigma^2)) = 1. */
static long double reference_D_gtr(double sigma, double gamma, struct vec3_long m)
{
	const long double s = (long double)sigma, g = (long double)gamma, log_s2 = 2 * logl(s);
	const long double above = log_s2 != 0 ? expm1l(log_s2) / log_s2 : 1;
	const long double power = (1 - g) * log_s2, below = power != 0 ? expm1l(power) / power : 1;
	return above / below / pi_l * expl(-g * logl(s * s * m.z * m.z + m.x * m.x + m.y * m.y));
}

/* D of the ABC distribution, A as above. */
static long double reference_D_low(double B, double C, long double A, struct vec3_long m)
{
	return A * expl(-(long double)C * log1pl((long double)B * (m.x * m.x + m.y * m.y) / (1 + m.z)));
}

/* Lambda of an isotropic distribution by quadrature [smith_quadrature.h]: the trapezoid rule in y as it is, with many
 * small steps. */
static long double reference_lambda_quadrature(long double (*D)(const void *context, struct vec3_long m),
					       const void *context, double gamma, long double mu)
{
	const long double step = 1 / (24 + (long double)gamma / 4);
	long double sum = 0;
	for (int i = 1; i < 100000; i++) {
		const long double y = i * step, e = expl(y), s = (e - 1 / e) / 2, t = mu * (e + 1 / e) / 2;
		const long double z2 = 1 / (1 + t * t), z = sqrtl(z2);
		const long double term =
			D(context, (struct vec3_long){t * z, 0, z}) * z2 * z2 * t * mu * s * (s - atanl(s));
		sum += term;
		if (term < 1e-24L * sum)
			break;
	}
	return 2 * sum * step;
}

#endif
