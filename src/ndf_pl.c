/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The piecewise-linear NDF (pwl.h) as one of the distributions. It has no parameters to search: it is made of a table
 * of node values by ndf_from_pwl(). */
#include "src/ndf_class.h"
#include "src/pwl.h"

static double pl_D(const struct ndf *ndf, struct vec3 m)
{
	return pwl_D(ndf->pwl, m);
}

static double pl_lambda(const struct ndf *ndf, struct vec3 w)
{
	return pwl_lambda(ndf->pwl, w);
}

/* The density of slopes has no closed form here. */
static double pl_P2(const struct ndf *ndf, double s, double q)
{
	(void)ndf;
	(void)s;
	(void)q;
	return NAN;
}

const struct ndf_class ndf_class_pl = {
	.name = "pl",
	.isotropic = true,
	.gamma = NAN,
	.D = pl_D,
	.lambda = pl_lambda,
	.P2 = pl_P2,
};

void ndf_from_pwl(struct ndf *ndf, const struct pwl *pwl)
{
	*ndf = (struct ndf){.class = &ndf_class_pl, .sigma_x = 1, .sigma_y = 1, .gamma = NAN, .stretch = 1, .pwl = pwl};
}
