/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Evaluates the STD distribution, and estimates from visible normals how much of the light from wi a rough mirror sends
 * back. Build: cc sample_ndf.c $(pkg-config --cflags --libs stdfit) */
#include <stdfit/stdfit.h>
#include <stdio.h>

enum { SIDE = 200, COUNT = SIDE * SIDE };

static double u[2 * COUNT], normal[3 * COUNT], pdf[COUNT], weight[COUNT];

int main(void)
{
	const double up[3] = {0, 0, 1}, wi[3] = {0.6, 0, 0.8};
	struct stdfit_model mirror = stdfit_model_default();
	double sum = 0, exact[3], D, lambda, G1;
	stdfit_ndf *ndf;

	mirror.fresnel = "none";
	if (stdfit_ndf_new(&ndf, "std", 0.3, 0.3, 1.8, NULL, NULL) || /* sigma_x, sigma_y, gamma */
	    stdfit_ndf_evaluate(ndf, STDFIT_D, 1, up, &D, NULL) ||
	    stdfit_ndf_evaluate(ndf, STDFIT_LAMBDA, 1, wi, &lambda, NULL) ||
	    stdfit_ndf_evaluate(ndf, STDFIT_G1, 1, wi, &G1, NULL))
		return 1;
	printf("D %.6f, Lambda %.6f, G1 %.6f\n", D, lambda, G1);
	for (int i = 0; i < COUNT; i++) {
		u[2 * i] = (i / SIDE + 0.5) / SIDE; /* NOLINT: whole steps */
		u[2 * i + 1] = (i % SIDE + 0.5) / SIDE;
	}
	if (stdfit_ndf_sample_visible(ndf, wi, COUNT, u, normal, NULL) ||
	    stdfit_ndf_pdf_visible(ndf, wi, COUNT, normal, pdf, NULL) ||
	    stdfit_ndf_weight(ndf, NULL, wi, COUNT, normal, pdf, weight, NULL) ||
	    stdfit_model_albedo(&mirror, ndf, wi[2], exact, NULL))
		return 1;
	for (int i = 0; i < COUNT; i++)
		sum += weight[i];
	printf("albedo %.4f, by quadrature %.4f\n", sum / COUNT, exact[0]);
	stdfit_ndf_free(ndf);
	return 0;
}
