/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/smith_quadrature.h"

/* At cot beyond this no facet is turned away; below the other end Lambda is proportional to 1/mu to all digits. */
#define MU_NORMAL 1e100
#define MU_GRAZING 1e-120
/* Slopes below width * exp(this) add less than 1e-17 to an integral that reaches beyond width. */
#define LOG_START (-17.0)
/* -ln of the relative error of the trapezoid rule that is aimed at. */
#define LOG_ERROR 29.0
/* A term this much smaller than the sum ends it: terms fall at least as exp(-exp(x)) there. */
#define END 1e-15

enum { NODES_MAX = 10000 };

/* Hyperbolic functions, the sine with all digits near 0. */
struct hyperbolic {
	double cosh, sinh;
};

static struct hyperbolic hyperbolic(double y)
{
	const double e = expm1(y), part = e / (e + 1.0);
	return (struct hyperbolic){1.0 + 0.5 * e * part, 0.5 * (e + part)};
}

/* s - atan(s), s >= 0; below 0.25 the series, whose terms left out are less than 1e-16 of the sum. */
static double minus_atan(double s)
{
	if (s > 0.25)
		return s - atan(s);
	const double s2 = s * s;
	static const double inverse[] = {1.0 / 25, 1.0 / 23, 1.0 / 21, 1.0 / 19, 1.0 / 17, 1.0 / 15,
					 1.0 / 13, 1.0 / 11, 1.0 / 9,  1.0 / 7,  1.0 / 5,  1.0 / 3};
	double sum = 0.0;
	for (int i = 0; i < 12; i++)
		sum = inverse[i] - s2 * sum;
	return s * s2 * sum;
}

/* Density of slopes at tan(theta) = t. */
static double P22(const struct ndf *ndf, double t)
{
	const double z = 1.0 / sqrt(1.0 + t * t);
	return ndf_D(ndf, (struct vec3){t * z, 0.0, z}) * (z * z) * (z * z);
}

/* The variable of the sum. y = x + bend sinh(x) turns the decay of the far end, a plain exponential beyond all features
 * of D, into a double one; symmetric, so that the integrand stays even. */
struct mesh {
	double bend, step;
	int first;
};

/* ln of the growth of (1 + t^2)^-gamma t^3 from the real t to those at the angle d. */
static double growth_off_axis(double gamma, double d)
{
	if (d < 0.25 * M_PI)
		return -1.5 * log(cos(2.0 * d));
	return 1.5 * log1p(gamma) - gamma * log(sin(2.0 * d));
}

/* The trapezoid rule errs by exp(-2 pi d/step) times the growth of the integrand from the real y to those of imaginary
 * part d, on the imaginary axis or off it: take the d that allows the largest step. */
static double step_for(const struct ndf *ndf, double t0, double bend)
{
	const double P22_t0 = P22(ndf, t0);
	double best = 0.0;
	for (double d = 1.1; d > 1e-3; d *= 0.8) {
		const double on_axis = log(P22(ndf, t0 * cos(d + bend * sin(d))) / P22_t0);
		const double growth = fmax(on_axis, growth_off_axis(ndf->gamma, d));
		const double step = 2.0 * M_PI * d / (LOG_ERROR + growth);
		if (step > best)
			best = step;
		else if (best > 0.0)
			break;
	}
	return best;
}

/* For slopes t0 cosh(y). */
static struct mesh mesh_for(const struct ndf *ndf, double t0)
{
	struct mesh mesh = {.bend = 0.5 * t0 / (2.0 * ndf->far + t0)};
	mesh.step = step_for(ndf, t0, mesh.bend);
	const double start = (ndf->log_width + LOG_START - log(t0)) / mesh.step;
	mesh.first = start > 1.0 ? (int)start : 0;
	return mesh;
}

/* Integral over y > 0 of f(y), f even and growing before it falls; `f` is given cosh(y) and sinh(y). */
static double even_integral(const struct ndf *ndf, double t0,
			    double (*f)(const struct ndf *ndf, double t0, struct hyperbolic y))
{
	const struct mesh mesh = mesh_for(ndf, t0);
	double sum = mesh.first == 0 ? 0.5 * (1.0 + mesh.bend) * f(ndf, t0, (struct hyperbolic){1.0, 0.0}) : 0.0;
	const double ratio = exp(mesh.step);
	double growing = exp(mesh.first * mesh.step);
	for (int i = mesh.first + 1; i < mesh.first + NODES_MAX; i++) {
		growing *= ratio; /* exp(x) */
		const double bend_sinh = 0.5 * mesh.bend * (growing - 1.0 / growing);
		const double bend_cosh = 0.5 * mesh.bend * (growing + 1.0 / growing);
		const double term = f(ndf, t0, hyperbolic(i * mesh.step + bend_sinh)) * (1.0 + bend_cosh);
		sum += term;
		if (!(term > END * sum))
			break;
	}
	return sum * mesh.step;
}

static double turned_away(const struct ndf *ndf, double mu, struct hyperbolic y)
{
	const double t = mu * y.cosh;
	return 2.0 * P22(ndf, t) * t * (mu * y.sinh) * minus_atan(y.sinh);
}

double smith_quadrature_lambda(const struct ndf *ndf, struct vec3 w)
{
	const double r = hypot(w.x, w.y);
	if (r * MU_NORMAL <= w.z)
		return 0.0;
	const double mu = w.z / r;
	if (isnan(mu))
		return mu;
	if (P22(ndf, mu) == 0.0)
		return 0.0;
	if (mu < MU_GRAZING)
		return even_integral(ndf, MU_GRAZING, turned_away) * (MU_GRAZING / mu);
	return even_integral(ndf, mu, turned_away);
}

static double across(const struct ndf *ndf, double q, struct hyperbolic y)
{
	const double t = q * y.cosh;
	return 2.0 * P22(ndf, t) * t;
}

double smith_quadrature_P2(const struct ndf *ndf, double s, double q)
{
	(void)s;
	/* P2 is flat to 1e-15 below. */
	const double flat = exp(ndf->log_width + LOG_START);
	const double at = fmax(fabs(q), flat);
	if (isnan(q) || at > MU_NORMAL)
		return isnan(q) ? q : 0.0;
	return P22(ndf, at) == 0.0 ? 0.0 : even_integral(ndf, at, across);
}
