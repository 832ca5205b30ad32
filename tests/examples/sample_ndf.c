/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evaluates the STD distribution, and estimates from visible normals how much of the light from wi a rough mirror sends
 * back. Build: cc sample_ndf.c $(pkg-config --cflags --libs stdfit) */
#include <stdfit/stdfit.h>
#include <stdio.h>

enum { SIDE = 200 };

int main(void)
{
	const struct vec3 normal = {0, 0, 1}, wi = {0.6, 0, 0.8};
	struct cook_torrance mirror = {.fresnel = FRESNEL_NONE, .ks = {1, 1, 1}};
	struct ndf *ndf = &mirror.ndf;
	double sum = 0, exact;

	if (ndf_init(ndf, ndf_find("std"), 0.3, 0.3, 1.8)) /* sigma_x, sigma_y, gamma */
		return 1;
	printf("D %.6f, Lambda %.6f, G1 %.6f\n", ndf_D(ndf, normal), ndf_lambda(ndf, wi), ndf_G1(ndf, wi));
	for (int i = 0; i < SIDE * SIDE; i++) {
		const double u = (i / SIDE + 0.5) / SIDE, v = (i % SIDE + 0.5) / SIDE; /* NOLINT: whole steps */
		const struct vec3 m = vndf_sample(ndf, wi, u, v);

		sum += vndf_weight(ndf, GAF_UNCORRELATED, wi, m, vndf_pdf(ndf, wi, m));
	}
	if (energy_lobe(&mirror, wi.z, &exact))
		return 1;
	printf("albedo %.4f, by quadrature %.4f\n", sum / (SIDE * SIDE), exact);
	return 0;
}
