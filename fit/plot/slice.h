/* SPDX-License-Identifier: GPL-3.0-or-later */
/* slice - lines through a table at phi_d = 90 degrees, where light and view are symmetric and all theta_h are above the
 * horizon: measured and modelled values side by side. */
#ifndef SLICE_H
#define SLICE_H

#include "data_readers/measurement.h"
#include "src/cook_torrance.h"

/* slice_measured - entry (i, j) at phi_d = 90 (90.5 at centres) degrees into m[3], 1/sr; NaN where masked. */
void slice_measured(const struct measurement *measurement, int i, int j, double m[MERL_CHANNELS]);

/* slice_model - the model there, 1/sr. */
void slice_model(const struct cook_torrance *model, enum bins bins, int i, int j, double f[MERL_CHANNELS]);

#endif
