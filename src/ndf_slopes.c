/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/ndf_slopes.h"
#include "src/ndf_class.h"

double ndf_P22(const struct ndf *ndf, double p, double q)
{
	const struct vec3 m = vec3_unit((struct vec3){-p, -q, 1.0});
	return ndf_D(ndf, m) * (m.z * m.z) * (m.z * m.z);
}

static double from_axis(const struct ndf *ndf, double phi)
{
	return phi - ndf->angle * (M_PI / 180.0);
}

static double sigma_along(const struct ndf *ndf, double phi)
{
	phi = from_axis(ndf, phi);
	return hypot(ndf->sigma_x * cos(phi), ndf->sigma_y * sin(phi));
}

double ndf_P2(const struct ndf *ndf, double phi, double q)
{
	if (ndf->class->P2_along)
		return ndf->class->P2_along(ndf, from_axis(ndf, phi), q);
	return ndf->class->P2(ndf, sigma_along(ndf, phi), q);
}

/* 2 C, where P22 falls as the power -2 C of the slope; at the horizon D of gtr and low is finite. */
static double tail_exponent(const struct ndf *ndf)
{
	return ndf->class->isotropic ? 4.0 : 2.0 * ndf->gamma;
}

enum status ndf_moment(const struct ndf *ndf, double phi, int order, double *moment)
{
	if (order < 0 || !(order + 2.0 < tail_exponent(ndf)))
		return STATUS_DOMAIN;
	if (order % 2 == 1) {
		phi = from_axis(ndf, phi);
		/* a tilted one has no other */
		*moment = ndf_is_tilted(ndf) ? -(ndf->lean_x * cos(phi) + ndf->lean_y * sin(phi)) : 0.0;
		return STATUS_OK;
	}
	const double s = sigma_along(ndf, phi);
	const double C = ndf->gamma;
	double product = 1.0;
	/* 0 and infinity stay what they are: high orders end early */
	for (int k = 1; k <= order / 2 && product > 0 && isfinite(product); k++) {
		/* a/(C - 1 - k), in terms of std where a is C - 1; 1 for Gaussian slopes */
		const double widening = isinf(C) ? 1.0 : (C - 1.0) / (C - 1.0 - k);
		product *= (k - 0.5) * widening * (s / ndf->stretch) * (s / ndf->stretch);
	}
	*moment = product;
	return STATUS_OK;
}

enum status ndf_excess_kurtosis(const struct ndf *ndf, double *kurtosis)
{
	if (!(tail_exponent(ndf) > 6.0))
		return STATUS_DOMAIN;
	*kurtosis = 3.0 / (ndf->gamma - 3.0);
	return STATUS_OK;
}
