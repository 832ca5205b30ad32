/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ladder - models of one NDF from a gray Lambert term to two coloured lobes. */
#ifndef LADDER_H
#define LADDER_H

#include "fit/error/options.h"

enum { LADDER_RUNGS = 11 };

/* The rung of the paper's model: Lambert and a lobe, coloured. */
#define LADDER_LOBE "lobe"

/* struct ladder_rung - what a model is called, the options that fit it, and how many free parameters it has. */
struct ladder_rung {
	const char *name;
	struct fit_options options;
	int parameters;
};

/* ladder_rungs - the models of the ladder that go together with the rest of the options (fit_options_rule()), fewest parameters first;
 * of the options' NDFs the first. Returns how many there are, LADDER_RUNGS at most. */
int ladder_rungs(const struct fit_options *options, struct ladder_rung rung[LADDER_RUNGS]);

/* ladder_parameters - how many numbers a fit is free to choose for the first NDF of the options, factors and shape. */
int ladder_parameters(const struct fit_options *options);

#endif
