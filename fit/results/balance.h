/* SPDX-License-Identifier: GPL-3.0-or-later */
/* balance - what a model does with the light that falls on it, as cells of tables. */
#ifndef BALANCE_H
#define BALANCE_H

#include "src/cook_torrance.h"

/* More than this is more light than comes in, beyond any doubt: the albedo is good to 1e-5 of kd + ks. */
#define BALANCE_GAIN (1 + 1e-4)

/* struct balance - the largest directional albedo, NaN where energy.h has none. */
struct balance {
	double albedo[3];
};

struct balance balance_of(const struct cook_torrance *model);

/* balance_name - "gain" if a channel sends back more than it gets, else "ok"; "" where the albedo is not known. */
const char *balance_name(const struct balance *balance);

/* balance_furnace - the white-furnace balance, NaN where energy.h has none. */
double balance_furnace(const struct cook_torrance *model);

#endif
