/* SPDX-License-Identifier: GPL-3.0-or-later */
/* model_samples - what an ideal goniometer would measure of a model, anisotropic ones too. */
#ifndef MODEL_SAMPLES_H
#define MODEL_SAMPLES_H

#include "data_readers/measurement.h"
#include "src/cook_torrance.h"

/* model_samples - makes *measurement, to be freed with measurement_free(): samples on a grid of wi and of half vectors, which
 * puts them where the highlight is; each with the solid angle of its cell, whose sides lie half way between neighbours.
 *     isotropic      theta_i 0, 5 ... 85 degrees; azimuth of h from wi's plane 0, 10 ... 180 degrees; theta_h 90 (t/40)^2
 *     anisotropic    theta_i 0, 10 ... 80; phi_i 0, 20 ... 340; azimuth of h 0, 15 ... 345; theta_h 90 (t/24)^2
 * What a direction has below the horizon is left out. wi = z and h = z count once.
 * Returns: STATUS_OK, STATUS_NO_MEMORY. */
MUST_CHECK enum status model_samples(const struct cook_torrance *model, int threads, struct measurement *measurement);

#endif
