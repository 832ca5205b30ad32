/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/lambda_form.h"
#include "src/names.h"
#include <gsl/gsl_sf_gamma.h>
#include <gsl/gsl_sf_hyperg.h>
#include <math.h>
#include <string.h>

/* Where GSL's 2F1 and, for the sums, the cancellation in double precision end. */
#define GAMMA_MAX_2F1 1e5
#define GAMMA_MAX_SUM 15.5
/* Beyond this z nothing changes, and cubes of z stay finite. */
#define Z_MAX 1e50

static const char *const names[LAMBDA_FORM_COUNT] = {"exact", "2f1", "integer", "half-integer", "rational"};

const char *lambda_form_name(enum lambda_form form)
{
	if (form == LAMBDA_TRAPEZOID)
		return "trapezoid";
	return names_at(names, LAMBDA_FORM_COUNT, (int)form);
}

enum status lambda_form_find(const char *name, enum lambda_form *form)
{
	const bool trapezoid = name && strcmp(name, "trapezoid") == 0;
	const int i = trapezoid ? LAMBDA_TRAPEZOID : names_find(names, LAMBDA_FORM_COUNT, name);
	if (i < 0)
		return STATUS_DOMAIN;
	*form = (enum lambda_form)i;
	return STATUS_OK;
}

bool lambda_form_takes(enum lambda_form form, double gamma)
{
	if (!(gamma > 1.5))
		return false;
	switch (form) {
	case LAMBDA_EXACT:
	case LAMBDA_RATIONAL:
		return true;
	case LAMBDA_2F1:
		return gamma <= GAMMA_MAX_2F1;
	case LAMBDA_INTEGER:
		return gamma <= GAMMA_MAX_SUM && gamma == floor(gamma);
	case LAMBDA_HALF_INTEGER:
		return gamma <= GAMMA_MAX_SUM && gamma - 0.5 == floor(gamma);
	case LAMBDA_FORM_COUNT:
	case LAMBDA_TRAPEZOID:
		break;
	}
	return false;
}

static double gsl_2f1(double a, double b, double c, double x)
{
	gsl_sf_result result = {NAN, NAN};
	(void)gsl_sf_hyperg_2F1_e(a, b, c, x, &result);
	return result.val;
}

/* The terms of 15.3.7 of Abramowitz and Stegun: the first has a 2F1 of 1, the second is none where its power is. */
static double far_2f1(double gamma, double K, double x)
{
	const double first = 0.5 / (K * sqrt(-x));
	const double power = pow(-x, 0.5 - gamma) / (2.0 * (gamma - 1.0));
	if (power < 1e-20 * first)
		return first;
	return first - power * gsl_2f1(gamma - 0.5, gamma - 1.0, gamma, 1.0 / x);
}

double lambda_form_2f1(double gamma, double K, double x)
{
	if (x > -1.0)
		return gsl_2f1(0.5, gamma - 0.5, 1.5, x);
	const double pfaff = x / (x - 1.0);
	if (gamma >= 12.0 || pfaff >= 0.99)
		return far_2f1(gamma, K, x);
	return gsl_2f1(0.5, 2.0 - gamma, 1.5, pfaff) / sqrt(1.0 - x);
}

/* The integral of cos^(2 gamma-3) from atan(u) to pi/2, gamma an integer: expand (1 - sin^2)^(gamma-2). */
static double integer_integral(unsigned gamma, double u)
{
	const double sine = u / sqrt(1.0 + u * u);
	double sum = 0.0, power = sine;
	for (unsigned k = 0; k <= gamma - 2; k++) {
		const double sign = k % 2 ? -1.0 : 1.0;
		sum += sign * gsl_sf_choose(gamma - 2, k) / (2.0 * k + 1.0) * (1.0 - power);
		power *= sine * sine;
	}
	return sum;
}

/* The same for 2 gamma odd, n = 2 gamma - 3: a Fourier sum of the even power of the cosine. */
static double half_integer_integral(unsigned n, double u)
{
	const double angle = atan(u);
	double sum = 0.5 * gsl_sf_choose(n, n / 2) * (0.5 * M_PI - angle);
	for (unsigned k = 0; 2 * k < n; k++)
		sum -= gsl_sf_choose(n, k) * sin((n - 2.0 * k) * angle) / (n - 2.0 * k);
	return ldexp(sum, 1 - (int)n);
}

static double ratio(const double p[4], const double q[4], double x)
{
	return (p[0] + x * (p[1] + x * (p[2] + x * p[3]))) / (q[0] + x * (q[1] + x * (q[2] + x * q[3])));
}

const double lambda_form_p21[4] = {0.0, 1.066, 2.655, 4.892}, lambda_form_q21[4] = {1.038, 2.969, 4.305, 4.418};
const double lambda_form_p24[4] = {6.537, 6.074, -0.623, 5.223}, lambda_form_q24[4] = {6.538, 6.103, -3.218, 6.347};

/* The polynomials in gamma are written in 1/gamma, which takes infinity; (gamma-1)^gamma is taken into S1, and
 * K/sqrt(gamma-1) tends to 1/sqrt(pi). */
struct lambda_rational lambda_form_rational(double gamma, double K)
{
	static const double p22[] = {-2.745, 20.574, -27.145, 14.402}, q22[] = {29.938, -84.341, 86.567, -30.612};
	static const double p23[] = {93.268, -299.305, 324.987, -129.404}, q23[] = {86.064, -245.663, 256.006, -92.609};
	const double g = 1.0 / gamma;
	return (struct lambda_rational){
		.factor = isinf(gamma) ? 1.0 / sqrt(M_PI) : K / sqrt(gamma - 1.0),
		.S1 = isinf(gamma) ? 0.5 : (gamma - 1.0) / (2.0 * gamma - 3.0), /* 1 - g has no digits near 1.5 */
		.S22 = ratio(p22, q22, g),
		.S23 = ratio(p23, q23, g),
	};
}

static double rational_lambda(double gamma, double K, double z)
{
	const struct lambda_rational r = lambda_form_rational(gamma, K);
	const double power = isinf(gamma) ? z * z : (gamma - 1.5) * log1p(z * z / (gamma - 1.0));
	const double S2 = ratio(lambda_form_p21, lambda_form_q21, z) *
			  (r.S22 + r.S23 * ratio(lambda_form_p24, lambda_form_q24, z));
	return r.factor * (r.S1 * exp(-power) / z + S2) - 0.5;
}

double lambda_form_lambda(enum lambda_form form, double gamma, double K, double z)
{
	if (isnan(z))
		return z;
	if (z > Z_MAX)
		z = Z_MAX;
	if (form == LAMBDA_RATIONAL)
		return fmax(rational_lambda(gamma, K, z), 0.0);
	const double u = z / sqrt(gamma - 1.0);
	const double front = exp(-(gamma - 1.5) * log1p(u * u)) / ((2.0 * gamma - 3.0) * u);
	double lambda = NAN;
	switch (form) {
	case LAMBDA_2F1:
		lambda = K * (front + u * lambda_form_2f1(gamma, K, -u * u)) - 0.5;
		break;
	case LAMBDA_INTEGER:
		lambda = K * (front - integer_integral((unsigned)gamma, u));
		break;
	case LAMBDA_HALF_INTEGER:
		lambda = K * (front - half_integer_integral((unsigned)(2.0 * gamma - 3.0), u));
		break;
	case LAMBDA_RATIONAL:
	case LAMBDA_EXACT:
	case LAMBDA_FORM_COUNT:
	case LAMBDA_TRAPEZOID:
		break;
	}
	return lambda < 0.0 ? 0.0 : lambda;
}
