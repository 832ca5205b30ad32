/* SPDX-License-Identifier: GPL-3.0-or-later */
/* t-family: Student-t slopes with f = 1/(gamma - x) (B = f/sigma^2) [STD supplement, section 1.1]. At x = 2, the
 * default, the variance of the slopes is sigma^2/2 for every gamma (eq. 9); x = 1 is std. */
#include "src/ndf_class.h"
#include "src/student_t.h"

/* Closer to x, 1 + q/(gamma-x) could overflow within the domain of sigma. */
#define GAMMA_ABOVE_X 1e-6

static void t_family_to_params(struct ndf *ndf)
{
	ndf->param[2] = 2.0;
}

static bool t_family_prepare(struct ndf *ndf)
{
	const double a = ndf->gamma - ndf->param[2];
	return a >= GAMMA_ABOVE_X && student_t_prepare(ndf, a);
}

const struct ndf_class ndf_class_t_family = {
	.name = "t-family",
	.n_params = 3,
	.param = {NDF_PARAM_SIGMA,
		  {.name = "gamma",
		   .role = NDF_ROLE_GAMMA,
		   .min = 1.5,
		   .max = INFINITY,
		   .search_min = 2.000002,
		   .search_max = 1000.0},
		  {.name = "x", .min = -1e6, .max = 1e6, .min_included = true, .search_min = 2.0, .search_max = 2.0}},
	.student_t = true,
	.ggx_at_2 = true,
	.to_params = t_family_to_params,
	.prepare = t_family_prepare,
	.D = student_t_D,
	.lambda = student_t_lambda,
	.P2 = student_t_P2,
	.tilt = student_t_tilt,
	.share = student_t_share,
};
