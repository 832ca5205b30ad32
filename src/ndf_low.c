/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The ABC distribution of Low et al. 2012 for microfacets, D = A / (1 + B (1 - cos))^C, which the STD paper compares
 * with. A follows from the normalisation. Isotropic. Small C: a long tail; large C at constant B C: Gaussian.
 *
 * With v = 1 - cos, in [0, 1]: D cos dm = 2 pi A (1 - v) (1 + B v)^-C dv. */
#include "src/ndf_class.h"
#include "src/smith_quadrature.h"

/* Below this B max(1, C) the closed form of the share loses digits, and a Gauss rule has them all. */
#define GAUSS_BELOW 1.0

/* (s^p - 1)/p for s = exp(log_s), ln s at p = 0 */
static double power_integral(double p, double log_s)
{
	return p == 0.0 ? log_s : expm1(p * log_s) / p;
}

/* Integral from 0 to v of (1 - v) (1 + B v)^-C dv for small B C: ten points of Gauss-Legendre. */
static double share_gauss(double B, double C, double v)
{
	static const double node[] = {0.14887433898163122, 0.43339539412924719, 0.67940956829902441,
				      0.86506336668898451, 0.97390652851717172};
	static const double weight[] = {0.29552422471475287, 0.26926671930999636, 0.21908636251598204,
					0.14945134915058059, 0.06667134430868814};
	double sum = 0.0;
	for (int i = 0; i < 10; i++) {
		const double at = 0.5 * v * (1.0 + (i < 5 ? node[i] : -node[i - 5]));
		sum += weight[i % 5] * (1.0 - at) * exp(-C * log1p(B * at));
	}
	return 0.5 * v * sum;
}

/* The same for all B and C, as a function of ln(1 + B v): (1 - v) B = (1 + B) - (1 + B v) splits it in two powers. */
static double share(double B, double C, double log_s)
{
	if (B * fmax(1.0, C) < GAUSS_BELOW)
		return share_gauss(B, C, expm1(log_s) / B);
	return ((1.0 + B) * power_integral(1.0 - C, log_s) - power_integral(2.0 - C, log_s)) / B / B;
}

/* tan(theta) for v = 1 - cos. */
static double slope_of(double v)
{
	return v < 1.0 ? sqrt(v * (2.0 - v)) / (1.0 - v) : INFINITY;
}

/* ln(1 + B v) below which the fraction u of the normals lies. The share without its factor cos has an inverse, which is
 * too large; from there Newton's method inside a bracket. */
static double log_s_below(double B, double C, double u)
{
	const double end = log1p(B), target = u * share(B, C, end), p = 1.0 - C;
	const double part = u * expm1(p * end);
	double low = 0.0, high = u > 0.0 ? end : 0.0;
	double at = p == 0.0 ? u * end : part > -1.0 ? log1p(part) / p : end;
	for (int i = 0; i < 100 && low < high; i++) {
		const double excess = share(B, C, at) - target;
		if (excess > 0.0)
			high = at;
		else
			low = at;
		const double cosine = 1.0 - expm1(at) / B;
		const double slope = cosine * exp(p * at);
		const double next = slope > 0.0 ? at - excess * B / slope : -1.0;
		const double before = at;
		at = next > low && next < high ? next : 0.5 * (low + high);
		if (fabs(at - before) <= 1e-15 * at)
			break;
	}
	return at;
}

static double low_tilt(const struct ndf *ndf, double u)
{
	const double B = ndf->param[0];
	return fmin(slope_of(expm1(log_s_below(B, ndf->param[1], u)) / B), 1e150) / ndf->sigma_x;
}

static double low_share(const struct ndf *ndf, double s)
{
	const double B = ndf->param[0], C = ndf->param[1];
	const double tangent = s * ndf->sigma_x, root = hypot(1.0, tangent);
	/* v = 1 - cos = tan^2 / (root (1 + root)) */
	const double v = isinf(tangent) ? 1.0 : tangent / root * (tangent / (1.0 + root));
	return share(B, C, log1p(B * v)) / share(B, C, log1p(B));
}

/* B = 2/(C sigma^2): for large C the peak is Beckmann's of roughness sigma. */
static void low_to_params(struct ndf *ndf)
{
	ndf->param[0] = 2.0 / ndf->gamma / ndf->sigma_x / ndf->sigma_x;
	ndf->param[1] = ndf->gamma;
}

static void low_from_params(struct ndf *ndf)
{
	ndf->sigma_x = ndf->sigma_y = sqrt(2.0 / ndf->param[1] / ndf->param[0]);
	ndf->gamma = ndf->param[1];
}

static bool low_prepare(struct ndf *ndf)
{
	const double B = ndf->param[0], C = ndf->param[1];
	ndf->A = 0.5 * M_1_PI / share(B, C, log1p(B));
	ndf->log_width = log(low_tilt(ndf, 0.5) * ndf->sigma_x);
	ndf->far = 1.0;
	return true;
}

static double low_D(const struct ndf *ndf, struct vec3 m)
{
	const double v = (m.x * m.x + m.y * m.y) / (1.0 + m.z);
	return ndf->A * pow(1.0 + ndf->param[0] * v, -ndf->param[1]);
}

const struct ndf_class ndf_class_low = {
	.name = "low",
	.n_params = 2,
	.param = {{.name = "B", .min = 0.0, .max = 1e120, .search_min = 1e-2, .search_max = 1e10},
		  {.name = "C", .min = 0.0, .max = 1e3, .search_min = 0.05, .search_max = 1e3}},
	.isotropic = true,
	.to_params = low_to_params,
	.from_params = low_from_params,
	.prepare = low_prepare,
	.D = low_D,
	.lambda = smith_quadrature_lambda,
	.P2 = smith_quadrature_P2,
	.tilt = low_tilt,
	.share = low_share,
};
