/* SPDX-License-Identifier: GPL-3.0-or-later */
/* energy_conservation - what a model does with the light that falls on it, as cells of tables. */
#ifndef ENERGY_CONSERVATION_H
#define ENERGY_CONSERVATION_H

#include "src/cook_torrance.h"

/* More than this is more light than comes in, beyond any doubt: the albedo is good to 1e-5 of kd + ks. */
#define ENERGY_GAIN (1 + 1e-4)

/* struct energy_conservation - the largest directional albedo, NaN where energy.h has none. */
struct energy_conservation {
	double albedo[3];
};

struct energy_conservation energy_conservation_of(const struct cook_torrance *model);

/* energy_conservation_name - "gain" if a channel sends back more than it gets, else "ok"; "" where the albedo is not
 * known. */
const char *energy_conservation_name(const struct energy_conservation *energy);

/* energy_conservation_furnace - the white-furnace balance, NaN where energy.h has none. */
double energy_conservation_furnace(const struct cook_torrance *model);

#endif
