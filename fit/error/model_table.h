/* SPDX-License-Identifier: GPL-3.0-or-later */
/* model_table - the table that an ideal measurement of a model would give. */
#ifndef MODEL_TABLE_H
#define MODEL_TABLE_H

#include "data_readers/measurement.h"
#include "src/cook_torrance.h"

/* model_table - makes *samples, to be freed with measurement_free(): the model's value at each entry whose directions are
 * both above the horizon and within max_theta degrees, rounded to float; the others masked. Returns as measurement_alloc(). */
MUST_CHECK enum status model_table(const struct cook_torrance *model, enum bins bins, int n_phi_d, double max_theta,
				   int threads, struct measurement *measurement);

#endif
