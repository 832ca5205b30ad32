/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/model_table.h"
#include "fit/error/entries.h"
#include "fit/error/sample_set.h"

/* The values of one row (i, j) of the table; masked entries are left as they are. */
static void fill_row(struct measurement *measurement, const struct cook_torrance *model, const struct entries *entries,
		     double min_cos, int i, int j)
{
	const size_t at = measurement_at(measurement->n_phi_d, i, j, 0);
	for (int k = 0; k < measurement->n_phi_d; k++) {
		struct vec3 wi, wo;
		double f[MERL_CHANNELS];
		entries_dirs(entries, i, j, k, &wi, &wo);
		if (!entry_in_range(wi, wo, min_cos))
			continue;
		cook_torrance_f(model, wi, wo, f);
		for (int c = 0; c < MERL_CHANNELS; c++)
			measurement->value[c][at + (size_t)k] = (float)f[c];
	}
}

enum status model_table(const struct cook_torrance *model, enum bins bins, int n_phi_d, double max_theta, int threads,
			struct measurement *measurement)
{
	const struct entries entries = entries_make(bins, n_phi_d);
	const double min_cos = max_theta_cos(max_theta);
	const enum status status = measurement_alloc(measurement, n_phi_d);
	if (status != STATUS_OK)
		return status;
#pragma omp parallel for collapse(2) schedule(dynamic, 64) num_threads(threads)
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			fill_row(measurement, model, &entries, min_cos, i, j);
	return STATUS_OK;
}
