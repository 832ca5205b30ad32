/* SPDX-License-Identifier: GPL-3.0-or-later */
/* GGX (Trowbridge-Reitz): slopes with Student-t marginals of 2 degrees of freedom. At the horizon D tends to
 * 1/(pi sigma_x sigma_y ((m.x/sigma_x)^2 + (m.y/sigma_y)^2)^2), sigma^2/pi when isotropic. */
#include "src/ndf_class.h"
#include "src/ndf_formulas.h"

const struct ndf_class ndf_class_ggx = {
	.name = "ggx",
	.n_params = 1,
	.param = {NDF_PARAM_SIGMA},
	.gamma = 2.0,
	.ggx_at_2 = true,
	.D = ggx_D,
	.lambda = ggx_lambda,
	.P2 = ggx_P2,
	.tilt = ggx_tilt,
	.share = ggx_share,
};
