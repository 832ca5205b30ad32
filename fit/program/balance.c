/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "balance.h"
#include "energy.h"
#include "quadrature.h"
#include <math.h>

struct balance balance_of(const struct cook_torrance *model)
{
	struct balance balance = {{NAN, NAN, NAN}};
	double theta_i;

	if (energy_albedo_max(model, balance.albedo, &theta_i) != STATUS_OK)
		return (struct balance){{NAN, NAN, NAN}};
	return balance;
}

const char *balance_name(const struct balance *balance)
{
	bool gain = false;

	if (isnan(balance->albedo[0]))
		return "";
	for (int c = 0; c < 3; c++)
		gain |= balance->albedo[c] > BALANCE_GAIN;
	return gain ? "gain" : "ok";
}

static double at_theta(double theta, void *params)
{
	double albedo;

	return energy_lobe(params, cos(theta), &albedo) == STATUS_OK ? albedo * sin(2 * theta) : NAN;
}

double balance_furnace(const struct cook_torrance *model)
{
	struct cook_torrance mirror = *model;

	mirror.fresnel = FRESNEL_NONE;
	if (isnan(at_theta(0, &mirror)))
		return NAN;
	return quadrature_adaptive(at_theta, &mirror, 0, M_PI / 2, 1e-5);
}
