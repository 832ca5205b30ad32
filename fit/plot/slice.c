/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/plot/slice.h"
#include <math.h>

void slice_measured(const struct measurement *measurement, enum slice_phi_d phi_d, int i, int j,
		    double m[MERL_CHANNELS])
{
	const size_t at = measurement_at(measurement->n_phi_d, i, j, (int)phi_d);

	for (int c = 0; c < MERL_CHANNELS; c++)
		m[c] = (double)measurement->value[c][at];
}

void slice_model(const struct cook_torrance *model, enum bins bins, enum slice_phi_d phi_d, int i, int j,
		 double f[MERL_CHANNELS])
{
	struct vec3 wi, wo;

	halfdiff_trig_dirs(bins_trig(bins, i, j, (int)phi_d), &wi, &wo);
	if (wi.z > 0 && wo.z > 0)
		cook_torrance_f(model, wi, wo, f);
	else
		f[0] = f[1] = f[2] = NAN;
}
