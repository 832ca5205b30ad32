/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/cook_torrance.h"

double cook_torrance_lobe(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo)
{
	if (!(wi.z > 0.0 && wo.z > 0.0))
		return 0.0;
	const struct vec3 sum = vec3_add(wi, wo);
	/* |wi + wo| = 2 cos_d, with no cancellation at grazing angles. */
	const double cos_d = fmin(0.5 * vec3_length(sum), 1.0);
	const double F = fresnel_F(model->fresnel, cos_d, model->n, model->k);
	const double D = ndf_D(&model->ndf, vec3_unit(sum));
	const double G_over_cosines = gaf_G_over_cosines(model->gaf, &model->ndf, wi, wo);
	/* Where D has underflown the other factor may have overflown. */
	return D == 0.0 ? 0.0 : 0.25 * F * (D * G_over_cosines);
}

void cook_torrance_f(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo, double f[3])
{
	const double lobe = cook_torrance_lobe(model, wi, wo);
	const bool above = wi.z > 0.0 && wo.z > 0.0;
	for (int c = 0; c < 3; c++)
		f[c] = above ? model->kd[c] * M_1_PI + model->ks[c] * lobe : 0.0;
}
