/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/export/shown_error.h"
#include "fit/error/entry_at.h"
#include "fit/error/error_sum.h"

enum { PARTS = 90 }; /* each summed by one thread, in its order */

double shown_error(const struct measurement *measurement, const struct criterion *criterion, int threads,
		   void (*f)(const void *context, struct vec3 wi, struct vec3 wo, double f[3]), const void *context)
{
	const struct entries entries = entries_make(criterion->bins, measurement->n_phi_d);
	const size_t n = measurement_count(measurement);
	double sum[PARTS][2] = {{0}}, difference = 0, all = 0;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
	for (size_t i = 0; i < PARTS; i++)
		for (size_t at = i * n / PARTS; at < (i + 1) * n / PARTS; at++) {
			struct entry_at entry;
			double value[3];
			if (!entry_at(measurement, &entries, criterion, at, &entry))
				continue;
			f(context, entry.wi, entry.wo, value);
			for (int c = 0; c < MERL_CHANNELS; c++) {
				sum[i][0] += error_term(entry.weight, entry.value[c], value[c]);
				sum[i][1] += entry.weight * entry.value[c];
			}
		}
	for (size_t i = 0; i < PARTS; i++) {
		difference += sum[i][0];
		all += sum[i][1];
	}
	return error_ratio(difference, all);
}
