/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The piecewise-linear NDF (pwl.h) as one of the distributions. It has no parameters to search: it is made of a table
 * of node values by ndf_from_pwl(). */
#include "src/ndf_class.h"
#include "src/pwl.h"
#include "src/quadrature.h"

static double pl_D(const struct ndf *ndf, struct vec3 m)
{
	return pwl_D(ndf->pwl, m);
}

static double pl_lambda(const struct ndf *ndf, struct vec3 w)
{
	return pwl_lambda(ndf->pwl, w);
}

/* The integral of P22 across the slope q along phi. With t^2 = q^2 + p^2 and p = c tan v, c^2 = 1 + q^2, it is
 *     P2 = 2/c^3 int_0^{pi/2} D cos^2 v dv,
 * D at theta = atan t, the mean of the azimuths of p and -p; smooth between the v of two nodes. */
struct across {
	const struct ndf *ndf;
	double q, c, cos_phi, sin_phi;
};

static double across_at(double v, void *params)
{
	const struct across *across = params;
	const double cosine = cos(v);
	/* 1/cos(theta) is c/cos v */
	const double z = cosine / across->c, along = across->q * z, beside = sin(v);
	const double x = across->cos_phi * along, x_p = across->sin_phi * beside;
	const double y = across->sin_phi * along, y_p = across->cos_phi * beside;
	const struct pwl *pwl = across->ndf->pwl;

	return 0.5 * (pwl_D(pwl, (struct vec3){x - x_p, y + y_p, z}) + pwl_D(pwl, (struct vec3){x + x_p, y - y_p, z})) *
	       cosine * cosine;
}

static double pl_P2(const struct ndf *ndf, double phi, double q)
{
	const struct pwl *pwl = ndf->pwl;
	const double turn = pwl->anisotropic ? phi : 0;
	struct across across = {ndf, fabs(q), hypot(1, q), cos(turn), sin(turn)};
	double sum = 0, low = 0;

	if (isnan(q) || isinf(q))
		return isnan(q) ? q : 0;
	for (int n = 0; n + 1 < pwl->n_nodes; n++) {
		const bool last = n + 2 == pwl->n_nodes;
		const double t = tan(pwl->nodes[n + 1].theta), p2 = (t - across.q) * (t + across.q);
		const double high = last ? M_PI_2 : p2 > 0 ? atan(sqrt(p2) / across.c) : 0;
		const double largest =
			pwl->nodes[n].Fx + pwl->nodes[n + 1].Fx + pwl->nodes[n].Fy + pwl->nodes[n + 1].Fy;

		if (!(high > low))
			continue;
		sum += quadrature_adaptive(across_at, &across, low, high, 1e-15 * largest * (high - low));
		low = high;
	}
	return 2 * sum / (across.c * across.c * across.c);
}

const struct ndf_class ndf_class_pl = {
	.name = "pl",
	.isotropic = true,
	.gamma = NAN,
	.D = pl_D,
	.lambda = pl_lambda,
	.P2_along = pl_P2,
};

void ndf_from_pwl(struct ndf *ndf, const struct pwl *pwl)
{
	*ndf = (struct ndf){.class = &ndf_class_pl, .sigma_x = 1, .sigma_y = 1, .gamma = NAN, .stretch = 1, .pwl = pwl};
}
