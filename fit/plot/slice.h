/* SPDX-License-Identifier: GPL-3.0-or-later */
/* slice - lines through a table, measured and modelled values side by side: at phi_d = 90 degrees, where light and view are
 * symmetric and all theta_h are above the horizon, or at phi_d = 0, where light, view and normal lie in one plane. */
#ifndef SLICE_H
#define SLICE_H

#include "data_readers/measurement.h"
#include "src/cook_torrance.h"

/* Where a slice lies: index of phi_d, in the 360 table too; at centres half a degree more. */
enum slice_phi_d { SLICE_IN_PLANE = 0, SLICE_ACROSS = 90 };

/* slice_measured - entry (i, j) of the slice into m[3], 1/sr; NaN where masked. */
void slice_measured(const struct measurement *measurement, enum slice_phi_d phi_d, int i, int j,
		    double m[MERL_CHANNELS]);

/* slice_model - the model there, 1/sr; NaN below the horizon. */
void slice_model(const struct cook_torrance *model, enum bins bins, enum slice_phi_d phi_d, int i, int j,
		 double f[MERL_CHANNELS]);

#endif
