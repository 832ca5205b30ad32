/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/smith.h"
#include "src/names.h"
#include <gsl/gsl_sf_gamma.h>

static const char *const names[GAF_COUNT] = {"uncorrelated", "correlated", "v-groove"};

const char *gaf_name(enum gaf gaf)
{
	return names_at(names, GAF_COUNT, (int)gaf);
}

enum status gaf_find(const char *name, enum gaf *gaf)
{
	const int i = names_find(names, GAF_COUNT, name);
	if (i < 0)
		return STATUS_DOMAIN;
	*gaf = (enum gaf)i;
	return STATUS_OK;
}

static double v_groove(struct vec3 wi, struct vec3 wo)
{
	const struct vec3 sum = vec3_add(wi, wo);
	const double length = vec3_length(sum); /* 2 cos_d */
	const double cos_h = sum.z / length;
	return fmin(1.0, 4.0 * cos_h * (fmin(wi.z, wo.z) / length));
}

double gaf_smith(enum gaf gaf, double lambda_i, double lambda_o)
{
	if (gaf == GAF_UNCORRELATED)
		return 1.0 / (1.0 + lambda_i) * (1.0 / (1.0 + lambda_o));
	return gaf == GAF_CORRELATED ? 1.0 / (1.0 + lambda_i + lambda_o) : NAN;
}

double gaf_smith_through(enum gaf gaf, double lambda_i, double lambda_o)
{
	if (gaf != GAF_CORRELATED)
		return gaf_smith(gaf, lambda_i, lambda_o);
	if (isnan(lambda_i) || isnan(lambda_o))
		return NAN;
	return fmax(lambda_i, lambda_o) < 1e100 ? exp(gsl_sf_lnbeta(1.0 + lambda_i, 1.0 + lambda_o)) : 0.0;
}

double gaf_G_over_cosines(enum gaf gaf, const struct ndf *ndf, struct vec3 wi, struct vec3 wo)
{
	if (!(wi.z > 0.0 && wo.z > 0.0))
		return 0.0;
	if (gaf == GAF_UNCORRELATED)
		return ndf_G1(ndf, wi) / wi.z * (ndf_G1(ndf, wo) / wo.z);
	return gaf_G(gaf, ndf, wi, wo) / fmin(wi.z, wo.z) / fmax(wi.z, wo.z);
}

double gaf_G(enum gaf gaf, const struct ndf *ndf, struct vec3 wi, struct vec3 wo)
{
	if (!(wi.z > 0.0 && wo.z > 0.0))
		return 0.0;
	if (gaf == GAF_V_GROOVE)
		return v_groove(wi, wo);
	return gaf_smith(gaf, ndf_lambda(ndf, wi), ndf_lambda(ndf, wo));
}
