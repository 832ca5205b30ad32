/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/measured.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static float *entry_at(const struct measured *m, int i, int j, int k)
{
	return m->value + MERL_CHANNELS * measurement_at(m->n_phi_d, i, j, k);
}

static void fill_row(struct measured *m, const struct measurement *measurement, int i, int j)
{
	for (int k = 0; k < m->n_phi_d; k++) {
		const size_t at = measurement_at(m->n_phi_d, i, j, k);
		float *entry = entry_at(m, i, j, k);
		if (!isnan(measurement->value[0][at]))
			for (int c = 0; c < MERL_CHANNELS; c++)
				entry[c] = measurement->value[c][at];
		else if (i || j)
			memcpy(entry, j ? entry_at(m, i, j - 1, k) : entry_at(m, i - 1, j, k),
			       MERL_CHANNELS * sizeof *entry);
	}
}

enum status measured_init(struct measured *m, const struct measurement *measurement, enum bins bins, int threads)
{
	*m = (struct measured){.bins = bins};
	if (measurement->scattered)
		return interpolant_init(&m->turned, measurement, 180, true, threads);
	*m = (struct measured){.bins = bins,
			       .n_phi_d = measurement->n_phi_d,
			       .value = calloc(measurement_count(measurement), MERL_CHANNELS * sizeof(float))};
	if (!m->value)
		return STATUS_NO_MEMORY;
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			fill_row(m, measurement, i, j);
	return STATUS_OK;
}

void measured_free(struct measured *m)
{
	interpolant_free(&m->turned);
	free(m->value);
	*m = (struct measured){0};
}

/* The entries on either side of a point, and the share of the second. */
struct bracket {
	int low, high;
	double share;
};

static struct bracket bracket_clamped(double at, int n)
{
	const double inside = fmin(fmax(at, 0), n - 1);
	const int low = inside < n - 1 ? (int)inside : n - 2;
	return (struct bracket){low, low + 1, inside - low};
}

static struct bracket bracket_around(double at, int n)
{
	const double low = floor(at);
	const int index = (int)low % n;
	const int positive = index < 0 ? index + n : index;
	return (struct bracket){positive, positive + 1 < n ? positive + 1 : 0, at - low};
}

void measured_f(const struct measured *m, struct vec3 wi, struct vec3 wo, double f[3])
{
	if (m->turned.scattered) {
		interpolant_f(&m->turned, wi, wo, f);
		return;
	}
	f[0] = f[1] = f[2] = 0;
	if (!(wi.z > 0 && wo.z > 0))
		return;
	const struct bins_indices at = bins_indices(m->bins, halfdiff_from_dirs(wi, wo));
	const struct bracket h = bracket_clamped(at.i, MERL_THETA_H), d = bracket_clamped(at.j, MERL_THETA_D);
	const struct bracket phi = bracket_around(at.k, m->n_phi_d);
	for (int corner = 0; corner < 8; corner++) {
		const double weight = (corner & 1 ? h.share : 1 - h.share) * (corner & 2 ? d.share : 1 - d.share) *
				      (corner & 4 ? phi.share : 1 - phi.share);
		const float *entry = entry_at(m, corner & 1 ? h.high : h.low, corner & 2 ? d.high : d.low,
					      corner & 4 ? phi.high : phi.low);
		for (int c = 0; c < MERL_CHANNELS; c++)
			f[c] += weight * (double)entry[c];
	}
}
