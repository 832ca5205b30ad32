/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Hyper-Cauchy: Student-t slopes with f = 1 (B = 1/sigma^2). GGX at gamma = 2; as gamma grows the surface gets
 * smoother, without ever becoming Beckmann's [STD supplement, eq. 8]. */
#include "src/ndf_class.h"
#include "src/student_t.h"

static bool hyper_cauchy_prepare(struct ndf *ndf)
{
	return student_t_prepare(ndf, 1.0);
}

const struct ndf_class ndf_class_hyper_cauchy = {
	.name = "hyper-cauchy",
	.n_params = 2,
	.param = {NDF_PARAM_SIGMA,
		  {.name = "gamma",
		   .role = NDF_ROLE_GAMMA,
		   .min = 1.5,
		   .max = 1e6,
		   .search_min = 1.5001,
		   .search_max = 1000.0}},
	.student_t = true,
	.ggx_at_2 = true,
	.prepare = hyper_cauchy_prepare,
	.D = student_t_D,
	.lambda = student_t_lambda,
	.P2 = student_t_P2,
	.tilt = student_t_tilt,
	.share = student_t_share,
};
