/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/energy_conservation.h"
#include "src/energy.h"
#include <math.h>

struct energy_conservation energy_conservation_of(const struct cook_torrance *model)
{
	struct energy_conservation energy = {{NAN, NAN, NAN}};
	double theta_i;

	if (energy_albedo_max(model, energy.albedo, &theta_i) != STATUS_OK)
		return (struct energy_conservation){{NAN, NAN, NAN}};
	return energy;
}

const char *energy_conservation_name(const struct energy_conservation *energy)
{
	bool gain = false;

	if (isnan(energy->albedo[0]))
		return "";
	for (int c = 0; c < 3; c++)
		gain |= energy->albedo[c] > ENERGY_GAIN;
	return gain ? "gain" : "ok";
}

double energy_conservation_furnace(const struct cook_torrance *model)
{
	double reflected;

	return energy_furnace(model, &reflected) == STATUS_OK ? reflected : NAN;
}
