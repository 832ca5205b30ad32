/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Student-t distribution of slopes (STD): GGX at gamma = 2, Beckmann at gamma = infinity, longer tails below 2.
 * At the horizon D -> 0 for gamma > 2, stays finite at 2 and grows without bound as cos^(2 gamma - 4) for gamma < 2. */
#include "src/ndf_class.h"
#include "src/student_t.h"

static bool std_prepare(struct ndf *ndf)
{
	return student_t_prepare(ndf, ndf->gamma - 1.0);
}

const struct ndf_class ndf_class_std = {
	.name = "std",
	.n_params = 2,
	.param = {NDF_PARAM_SIGMA,
		  {.name = "gamma",
		   .role = NDF_ROLE_GAMMA,
		   .min = 1.5,
		   .max = INFINITY,
		   .search_min = 1.5001,
		   .search_max = 1000.0}},
	.student_t = true,
	.ggx_at_2 = true,
	.prepare = std_prepare,
	.D = student_t_D,
	.lambda = student_t_lambda,
	.P2 = student_t_P2,
	.tilt = student_t_tilt,
	.share = student_t_share,
};
