/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/balance.h"
#include "src/energy.h"
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

double balance_furnace(const struct cook_torrance *model)
{
	double balance;

	return energy_furnace(model, &balance) == STATUS_OK ? balance : NAN;
}
