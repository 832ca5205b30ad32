/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Beckmann: Gaussian slopes of standard deviation sigma/sqrt(2). D -> 0 at the horizon. */
#include "src/ndf_class.h"
#include "src/ndf_formulas.h"

const struct ndf_class ndf_class_beckmann = {
	.name = "beckmann",
	.n_params = 1,
	.param = {NDF_PARAM_SIGMA},
	.gamma = INFINITY,
	.D = beckmann_D,
	.lambda = beckmann_lambda,
	.P2 = beckmann_P2,
	.tilt = beckmann_tilt,
	.share = beckmann_share,
};
