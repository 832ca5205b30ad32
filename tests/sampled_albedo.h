/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sampled_albedo - a directional albedo by another way than quadrature: from visible normals. */
#ifndef SAMPLED_ALBEDO_H
#define SAMPLED_ALBEDO_H

#include "src/cook_torrance.h"
#include "src/vndf.h"

/* The mean of F G / G1(wi), by n evenly spread numbers. Angles in degrees. */
static inline double sampled_albedo(const struct cook_torrance *model, double theta_i, double phi_i, int n)
{
	const struct vec3 wi = vec3_from_spherical_deg(theta_i, phi_i);
	double sum = 0, u = 0.5, v = 0.5;
	for (int i = 0; i < n; i++) {
		u += 0.7548776662466927;
		v += 0.5698402909980532;
		u -= floor(u);
		v -= floor(v);
		const struct vec3 m = vndf_sample(&model->ndf, wi, u, v);
		const double cos_d = vec3_dot(wi, m);
		const struct vec3 wo = vec3_sub(vec3_scale(m, 2.0 * cos_d), wi);
		if (cos_d > 0.0 && wo.z > 0.0)
			sum += fresnel_F(model->fresnel, cos_d, model->n, model->k) *
			       gaf_G(model->gaf, &model->ndf, wi, wo) / ndf_G1(&model->ndf, wi);
	}
	return sum / n;
}

#endif
