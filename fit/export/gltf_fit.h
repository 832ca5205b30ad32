/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gltf_fit - a material of glTF fitted in its own terms. Private to fit/export/. */
#ifndef GLTF_FIT_H
#define GLTF_FIT_H

#include "fit/search/fit.h"

/* struct gltf_material - a dielectric of glTF with a lobe of GGX, correlated G, specularFactor 1:
 *     f_c = (1 - max F) base_c / pi + F_c D G / (4 cos_i cos_o),   F_c = F0_c + (1 - F0_c) (1 - cos_d)^5 */
struct gltf_material {
	struct ndf ndf;
	bool specular;         /* false: no lobe, F = 0 */
	double base[3], F0[3]; /* [0, 1] */
};

/* gltf_material_f - its values; wi, wo above the horizon. */
void gltf_material_f(const struct gltf_material *material, struct vec3 wi, struct vec3 wo, double f[3]);

/* gltf_fit - moves a material to where E under the criterion is small: the roughness, by one factor for both axes, by a scan
 * and golden sections; base and F0 for each of these by iterated weighted least squares, to which L1 is the limit; on 16 000 of
 * the entries. `gray`: one base and one F0 for all channels. The material stays as it is where E of all entries is not below that of
 * the start. STATUS_NO_MEMORY. */
MUST_CHECK enum status gltf_fit(const struct measurement *measurement, const struct criterion *criterion, int threads,
				bool gray, struct gltf_material *material);

#endif
