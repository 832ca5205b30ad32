/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/plot/slice.h"

enum { MIDDLE = 90 }; /* index of phi_d, in the 360 table too */

void slice_measured(const struct measurement *measurement, int i, int j, double m[MERL_CHANNELS])
{
	const size_t at = measurement_at(measurement->n_phi_d, i, j, MIDDLE);

	for (int c = 0; c < MERL_CHANNELS; c++)
		m[c] = (double)measurement->value[c][at];
}

void slice_model(const struct cook_torrance *model, enum bins bins, int i, int j, double f[MERL_CHANNELS])
{
	struct vec3 wi, wo;

	halfdiff_trig_dirs(bins_trig(bins, i, j, MIDDLE), &wi, &wo);
	cook_torrance_f(model, wi, wo, f);
}
