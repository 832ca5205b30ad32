/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/ndf_cdf.h"
#include "src/ndf_class.h"
#include "src/pwl.h"
#include "src/quadrature.h"

/* The share from the axis of sigma_x on. With t = 2 pi times the share, tan(phi) = sigma_y/sigma_x tan(t). */
static double from_axis(const struct ndf *ndf, double phi)
{
	const double turns = nearbyint(phi / (2.0 * M_PI)), rest = phi - 2.0 * M_PI * turns;
	return turns + atan2(ndf->sigma_x * sin(rest), ndf->sigma_y * cos(rest)) / (2.0 * M_PI);
}

double ndf_cdf_phi(const struct ndf *ndf, double phi)
{
	if (ndf_is_tilted(ndf))
		return NAN;
	const double axis = ndf->angle * (M_PI / 180.0);
	if (ndf->pwl)
		return pwl_cdf_phi(ndf->pwl, phi - axis) - pwl_cdf_phi(ndf->pwl, -axis);
	return from_axis(ndf, phi - axis) - from_axis(ndf, -axis);
}

/* Share below the slope tan(theta) where the roughness is s; rounding may lead out of [0, 1]. */
static double below(const struct ndf *ndf, double theta, double s)
{
	if (theta <= 0.0)
		return 0.0;
	return theta >= 0.5 * M_PI ? 1.0 : fmin(fmax(ndf->class->share(ndf, tan(theta) / s), 0.0), 1.0);
}

double ndf_cdf_theta(const struct ndf *ndf, double theta, double phi)
{
	if (ndf_is_tilted(ndf))
		return NAN;
	phi -= ndf->angle * (M_PI / 180.0);
	if (ndf->pwl)
		return pwl_cdf_theta(ndf->pwl, theta, phi);
	return below(ndf, theta, 1.0 / hypot(cos(phi) / ndf->sigma_x, sin(phi) / ndf->sigma_y));
}

struct joint {
	const struct ndf *ndf;
	double theta;
};

/* At the azimuth of the share t/(2 pi) the roughness is that of the ellipse at its own parameter t. */
static double by_share(double t, void *params)
{
	const struct joint *joint = params;
	return below(joint->ndf, joint->theta, hypot(joint->ndf->sigma_x * cos(t), joint->ndf->sigma_y * sin(t)));
}

static double by_azimuth(double phi, void *params)
{
	const struct joint *joint = params;
	const double axis = joint->ndf->angle * (M_PI / 180.0);
	const double density = (1.0 + joint->ndf->pwl->blend * cos(2.0 * (phi - axis))) / (2.0 * M_PI);
	return density * ndf_cdf_theta(joint->ndf, joint->theta, phi);
}

/* From 0 to x > 0, an eighth of a turn at a time. */
static double integral(double (*f)(double x, void *params), struct joint *joint, double x)
{
	double sum = 0.0;
	for (double low = 0.0; low < x; low += 0.25 * M_PI)
		sum += quadrature_adaptive(f, joint, low, fmin(low + 0.25 * M_PI, x), 1e-13);
	return sum;
}

/* Even in x but for its sign. */
static double signed_integral(double (*f)(double x, void *params), struct joint *joint, double x)
{
	return copysign(integral(f, joint, fabs(x)), x);
}

double ndf_cdf(const struct ndf *ndf, double theta, double phi)
{
	if (ndf_is_tilted(ndf))
		return NAN;
	struct joint joint = {ndf, theta};
	if (ndf->pwl)
		return signed_integral(by_azimuth, &joint, phi);
	if (ndf->sigma_x == ndf->sigma_y)
		return ndf_cdf_phi(ndf, phi) * ndf_cdf_theta(ndf, theta, phi);
	const double axis = ndf->angle * (M_PI / 180.0);
	return (signed_integral(by_share, &joint, 2.0 * M_PI * from_axis(ndf, phi - axis)) -
		signed_integral(by_share, &joint, 2.0 * M_PI * from_axis(ndf, -axis))) /
	       (2.0 * M_PI);
}
