/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generalised Trowbridge-Reitz (GTR) [STD paper, eq. 8]: D = c / (sigma^2 cos^2 + sin^2)^gamma. GGX at gamma = 2.
 * Isotropic: it is not a function of tan/sigma. sigma may exceed 1; D then grows towards the horizon.
 *
 * Divided by the smaller of its two ends the bracket becomes v >= 1, with v - 1 = (S - 1) x, where S = max(sigma^2,
 * sigma^-2), and x = sin^2 for sigma <= 1, cos^2 above. As x is uniform in the measure cos dm = pi dx, everything
 * follows from v^-gamma on [1, S]. */
#include "src/ndf_class.h"
#include "src/smith_quadrature.h"

/* (exp(x) - 1)/x, 1 at 0 */
static double expm1_ratio(double x)
{
	return x == 0.0 ? 1.0 : expm1(x) / x;
}

/* ln S */
static double log_span(const struct ndf *ndf)
{
	return 2.0 * fabs(log(ndf->sigma_x));
}

/* Beyond this gamma ln S, for sigma > 1, D of the normal would be lost to underflow. */
#define LOG_RANGE_MAX 600.0

/* D cos dm = A v^-gamma pi dx. */
static bool gtr_prepare(struct ndf *ndf)
{
	const double span = log_span(ndf);
	if (ndf->sigma_x > 1.0 && ndf->gamma * span > LOG_RANGE_MAX)
		return false;
	ndf->A = expm1_ratio(span) / expm1_ratio((1.0 - ndf->gamma) * span) * M_1_PI;
	const double width = ndf->class->tilt(ndf, 0.5) * ndf->sigma_x;
	ndf->log_width = log(width);
	ndf->far = fmax(1.0, fmax(width, ndf->sigma_x));
	return true;
}

static double gtr_D(const struct ndf *ndf, struct vec3 m)
{
	const double sigma = ndf->sigma_x;
	const double s2 = m.x * m.x + m.y * m.y, z2 = m.z * m.z;
	const double v = sigma > 1.0 ? sigma * sigma * z2 + s2 : z2 + s2 / sigma / sigma;
	return ndf->A * pow(v, -ndf->gamma);
}

/* The x below which the share u of v^-gamma lies. */
static double x_below(const struct ndf *ndf, double u)
{
	const double span = log_span(ndf), power = 1.0 - ndf->gamma;
	if (span == 0.0)
		return u;
	const double part = u * expm1(power * span);
	if (part <= -1.0)
		return 1.0;
	const double log_v = power == 0.0 ? u * span : log1p(part) / power;
	return fmin(expm1(log_v) / expm1(span), 1.0);
}

static double gtr_tilt(const struct ndf *ndf, double u)
{
	const double x = x_below(ndf, ndf->sigma_x > 1.0 ? 1.0 - u : u);
	const double tan2 = ndf->sigma_x > 1.0 ? (1.0 - x) / x : x / (1.0 - x);
	return fmin(sqrt(tan2) / ndf->sigma_x, 1e150 / ndf->sigma_x);
}

static double gtr_share(const struct ndf *ndf, double s)
{
	const double span = log_span(ndf), power = 1.0 - ndf->gamma;
	const double tangent = s * ndf->sigma_x;
	const double cos2 = 1.0 / (1.0 + tangent * tangent);
	const double sin2 = tangent < 1.0 ? tangent * tangent * cos2 : 1.0 / (1.0 + 1.0 / tangent / tangent);
	const double x = ndf->sigma_x > 1.0 ? cos2 : sin2;
	const double log_v = log1p(expm1(span) * x);
	const double below = span == 0.0 ? x : power == 0.0 ? log_v / span : expm1(power * log_v) / expm1(power * span);
	return ndf->sigma_x > 1.0 ? 1.0 - below : below;
}

const struct ndf_class ndf_class_gtr = {
	.name = "gtr",
	.n_params = 2,
	.param = {NDF_PARAM_SIGMA,
		  {.name = "gamma",
		   .role = NDF_ROLE_GAMMA,
		   .min = 0.0,
		   .max = 1e3,
		   .search_min = 0.05,
		   .search_max = 1e3}},
	.isotropic = true,
	.ggx_at_2 = true,
	.prepare = gtr_prepare,
	.D = gtr_D,
	.lambda = smith_quadrature_lambda,
	.P2 = smith_quadrature_P2,
	.tilt = gtr_tilt,
	.share = gtr_share,
};
