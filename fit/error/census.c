/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/census.h"
#include "fit/error/entries.h"
#include "fit/error/sample_set.h"

#include <gsl/gsl_statistics_float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A cosine nearer to 0 is that of an entry on the horizon, to rounding; a measurement there is nothing strange. */
#define HORIZON 1e-9

/* Counts, and picks out the valid entries above the horizon into value[channel]. */
static void count_entries(const struct measurement *measurement, enum bins bins, float *const value[],
			  struct census *census)
{
	const struct entries entries = entries_make(bins, measurement->n_phi_d);
	size_t at = 0;
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < measurement->n_phi_d; k++, at++) {
				struct vec3 wi, wo;
				entries_dirs(&entries, i, j, k, &wi, &wo);
				const bool above = entry_in_range(wi, wo, 0), valid = !isnan(measurement->value[0][at]);
				census->above += above;
				census->valid += valid;
				census->valid_below += valid && fmin(wi.z, wo.z) < -HORIZON;
				if (!above || !valid)
					continue;
				for (int c = 0; c < MERL_CHANNELS; c++)
					value[c][census->valid_above] = measurement->value[c][at];
				census->valid_above++;
			}
}

/* Scattered entries are valid and above the horizon, all of them. */
static void copy_entries(const struct measurement *measurement, float *const value[], struct census *census)
{
	census->valid = census->above = census->valid_above = measurement_count(measurement);
	for (int c = 0; c < MERL_CHANNELS; c++)
		memcpy(value[c], measurement->scattered->value[c], census->valid * sizeof *value[c]);
}

/* In double: the sum of two floats may be none. Reorders the values. */
static double median(float *value, size_t n)
{
	const double below = (double)gsl_stats_float_select(value, 1, n, (n - 1) / 2);
	return below / 2 + (double)gsl_stats_float_select(value, 1, n, n / 2) / 2;
}

enum status census_take(const struct measurement *measurement, enum bins bins, struct census *census)
{
	const size_t n = measurement_count(measurement);
	float *values = malloc(MERL_CHANNELS * n * sizeof(*values));
	if (!values)
		return STATUS_NO_MEMORY;
	float *const value[MERL_CHANNELS] = {values, values + n, values + 2 * n};
	*census = (struct census){0};
	if (measurement->scattered)
		copy_entries(measurement, value, census);
	else
		count_entries(measurement, bins, value, census);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		struct census_range *range = &census->range[c];
		*range = (struct census_range){NAN, NAN, NAN};
		if (!census->valid_above)
			continue;
		range->min = (double)gsl_stats_float_min(value[c], 1, census->valid_above);
		range->max = (double)gsl_stats_float_max(value[c], 1, census->valid_above);
		range->median = median(value[c], census->valid_above);
	}
	free(values);
	return STATUS_OK;
}
