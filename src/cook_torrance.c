/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/cook_torrance.h"

double cook_torrance_F(const struct cook_torrance *model, int c, double cos_d)
{
	if (model->fresnel == FRESNEL_F82)
		return fresnel_f82(cos_d, model->reflectance[c]);
	return model->per_channel_ior ? fresnel_F(model->fresnel, cos_d, model->channel_n[c], model->channel_k[c])
				      : fresnel_F(model->fresnel, cos_d, model->n, model->k);
}

double cook_torrance_facets(const struct ndf *ndf, enum gaf gaf, struct vec3 wi, struct vec3 wo, double *cos_d)
{
	*cos_d = 0.0;
	if (!(wi.z > 0.0 && wo.z > 0.0))
		return 0.0;
	const struct vec3 sum = vec3_add(wi, wo);
	/* |wi + wo| = 2 cos_d, with no cancellation at grazing angles. */
	*cos_d = fmin(0.5 * vec3_length(sum), 1.0);
	const double D = ndf_D(ndf, vec3_unit(sum));
	const double G_over_cosines = gaf_G_over_cosines(gaf, ndf, wi, wo);
	/* Where D has underflown the other factor may have overflown. */
	return D == 0.0 ? 0.0 : 0.25 * (D * G_over_cosines);
}

double cook_torrance_grazing(double exponent, double cos_i, double cos_o, double cos_d)
{
	return cos_d * cos_d * (pow(1.0 - cos_i, exponent) + pow(1.0 - cos_o, exponent)) * M_1_PI;
}

double cook_torrance_lobe(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo)
{
	double cos_d;
	const double facets = cook_torrance_facets(&model->ndf, model->gaf, wi, wo, &cos_d);
	const double F = model->fresnel == FRESNEL_F82 ? 1.0 : cook_torrance_F(model, 0, cos_d);
	return facets == 0.0 ? 0.0 : F * facets;
}

void cook_torrance_f(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo, double f[3])
{
	double cos_d, unused;
	const bool above = wi.z > 0.0 && wo.z > 0.0;
	const double facets = cook_torrance_facets(&model->ndf, model->gaf, wi, wo, &cos_d);
	const double second = cook_torrance_has_second(model)
				      ? cook_torrance_facets(&model->second, model->gaf, wi, wo, &unused)
				      : 0.0;
	const double grazing = above && cook_torrance_has_grazing(model)
				       ? cook_torrance_grazing(model->grazing, wi.z, wo.z, cos_d)
				       : 0.0;
	for (int c = 0; c < 3; c++) {
		const double facets_c = model->ks[c] * facets + model->ks_second[c] * second;
		f[c] = above ? model->kd[c] * M_1_PI + model->kg[c] * grazing : 0.0;
		if (facets_c != 0.0)
			f[c] += cook_torrance_F(model, c, cos_d) * facets_c;
	}
}
