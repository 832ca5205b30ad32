/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/export/gray_specular.h"
#include "fit/error/entry_at.h"
#include "fit/error/weighted_median.h"

#include <stdlib.h>

/* The lobe and the weight at each entry that takes part, the lobe as the value of *wanted; at[] says which entries. */
static size_t lobe_and_weight(const struct measurement *measurement, const struct fit_options *fit,
			      const struct cook_torrance *model, struct weighted_value *wanted, size_t *at)
{
	const struct entries entries = entries_make(fit->criterion.bins, measurement->n_phi_d);
	size_t n = 0;
	for (size_t e = 0; e < measurement_count(measurement); e++) {
		struct entry_at entry;
		if (!entry_at(measurement, &entries, &fit->criterion, e, &entry))
			continue;
		wanted[n] = (struct weighted_value){(float)cook_torrance_lobe(model, entry.wi, entry.wo),
						    (float)entry.weight};
		at[n++] = e;
	}
	return n;
}

enum status gray_specular(const struct measurement *measurement, const struct fit_options *fit,
			  struct cook_torrance *model)
{
	const double ks = (model->ks[0] + model->ks[1] + model->ks[2]) / 3;
	struct weighted_value *lobe = calloc(measurement_count(measurement), sizeof *lobe);
	struct weighted_value *wanted = calloc(measurement_count(measurement), sizeof *wanted);
	size_t *at = calloc(measurement_count(measurement), sizeof *at);
	float *const *plane = measurement->scattered ? measurement->scattered->value : measurement->value;
	const bool ready = lobe && wanted && at;
	const size_t n = ready ? lobe_and_weight(measurement, fit, model, lobe, at) : 0;
	for (int c = 0; c < MERL_CHANNELS && ready; c++) {
		for (size_t i = 0; i < n; i++) {
			const double rest = (double)plane[c][at[i]] - ks * (double)lobe[i].value;
			wanted[i] = (struct weighted_value){(float)(M_PI * rest), lobe[i].weight};
		}
		model->ks[c] = ks;
		model->kd[c] = fmin(weighted_median(wanted, n, 0), fmax(1 - ks, 0));
	}
	free(lobe);
	free(wanted);
	free(at);
	return ready ? STATUS_OK : STATUS_NO_MEMORY;
}
