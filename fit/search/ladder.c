/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/ladder.h"
#include "fit/search/options_check.h"
#include <math.h>

/* The free parameters of F: an index, that of a conductor with its k. */
static int parameters_of_F(const struct fit_options *o)
{
	if (o->per_channel_ior)
		return 2 * MERL_CHANNELS;
	return (fresnel_has_ior(o->fresnel) && isnan(o->ior)) + (o->fresnel == FRESNEL_CONDUCTOR);
}

static int parameters_of_lobes(const struct fit_options *o)
{
	const int channels = o->gray || o->gray_specular ? 1 : MERL_CHANNELS;
	const bool free_gamma = ndf_has_gamma(o->ndf[0]) && isnan(o->gamma);
	int n = channels * (o->fresnel == FRESNEL_F82 ? F82_PARTS : 1) + parameters_of_F(o);

	n += isnan(o->sigma) + free_gamma;
	if (o->anisotropic)
		n += isnan(o->sigma_y) + isnan(o->angle) + (ndf_has_tilt(o->ndf[0]) ? 2 : 0);
	if (o->lobes > 1)
		n += channels + 1 + free_gamma;
	return n;
}

int ladder_parameters(const struct fit_options *o)
{
	const int channels = o->gray ? 1 : MERL_CHANNELS;
	int n = o->diffuse ? channels : 0;

	if (o->diffuse && o->grazing)
		n += channels + isnan(o->grazing_exponent);
	return o->specular ? n + parameters_of_lobes(o) : n;
}

int ladder_rungs(const struct fit_options *options, struct ladder_rung rung[LADDER_RUNGS])
{
	static const struct {
		const char *name;
		bool specular, gray, gray_specular, grazing, f82;
		int lobes;
	} model[LADDER_RUNGS] = {
		{"gray-lambert", false, true, false, false, false, 1},
		{"lambert", false, false, false, false, false, 1},
		{"gray-lobe", true, true, false, false, false, 1},
		{"gray-specular", true, false, true, false, false, 1},
		{"gray-two-lobes", true, true, false, false, false, 2},
		{LADDER_LOBE, true, false, false, false, false, 1},
		{"burley", true, false, false, true, false, 1},
		{"two-lobes", true, false, false, false, false, 2},
		{"f82", true, false, false, false, true, 1},
		{"burley+two-lobes", true, false, false, true, false, 2},
		{"burley+f82", true, false, false, true, true, 1},
	};
	int n = 0;

	for (int m = 0; m < LADDER_RUNGS; m++) {
		struct ladder_rung r = {.name = model[m].name, .options = *options};
		struct fit_options *o = &r.options;
		struct error why;

		o->n_ndf = 1;
		o->specular = model[m].specular;
		o->gray = model[m].gray;
		o->gray_specular = model[m].gray_specular;
		o->grazing = model[m].grazing;
		o->lobes = model[m].lobes;
		if (model[m].f82)
			o->fresnel = FRESNEL_F82;
		if (fit_options_rule(o, &why) != FIT_RULE_KEPT)
			continue;
		r.parameters = ladder_parameters(o);
		int at = n++;

		for (; at > 0 && rung[at - 1].parameters > r.parameters; at--)
			rung[at] = rung[at - 1];
		rung[at] = r;
	}
	return n;
}
