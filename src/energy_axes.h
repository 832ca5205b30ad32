/* SPDX-License-Identifier: GPL-3.0-or-later */
/* energy_axes - the integral of energy.h for an anisotropic lobe. Private to energy.c. */
#ifndef ENERGY_AXES_H
#define ENERGY_AXES_H

#include "src/cook_torrance.h"
#include "src/smith_table.h"

/* struct energy_axes - the lobe in terms of an isotropic one whose slopes are stretched along both axes. */
struct energy_axes {
	const struct cook_torrance *model;
	int channel;       /* whose F it is */
	struct ndf round;  /* the isotropic distribution of roughness sqrt(sigma_x sigma_y) */
	double stretch[2]; /* of its slopes, along the first axis and across */
	double median;     /* of its slopes */
	struct smith_table G1;
};

/* energy_axes_init - of a model whose distribution can be anisotropic; *axes must stay where it is. STATUS_DOMAIN;
 * STATUS_UNSUPPORTED for GAF_V_GROOVE, whose kinks are found for isotropic lobes only. */
MUST_CHECK enum status energy_axes_init(struct energy_axes *axes, const struct cook_torrance *model, double median);

/* energy_axes_lobe - directional albedo of the lobe for ks = 1, from a direction in the plane of the first axis (0) or the other
 * (1). tolerance: absolute, aimed at. */
double energy_axes_lobe(struct energy_axes *axes, int axis, double cos_i, double tolerance);

#endif
