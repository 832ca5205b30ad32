/* SPDX-License-Identifier: GPL-3.0-or-later */
/* make_table - tables of a model, in memory, for tests. */
#ifndef MAKE_TABLE_H
#define MAKE_TABLE_H

#include "data_readers/measurement.h"
#include "src/cook_torrance.h"
#include <stdlib.h>

static inline double random_unit(unsigned *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return (*seed >> 8) / (double)(1 << 24);
}

static inline struct cook_torrance make_model(const char *ndf, double sigma, double gamma, double n)
{
	struct cook_torrance model = {.gaf = GAF_UNCORRELATED,
				      .fresnel = FRESNEL_DIELECTRIC,
				      .n = n,
				      .kd = {0.31, 0.12, 0.047},
				      .ks = {0.42, 0.63, 0.77}};

	if (ndf_init(&model.ndf, ndf_find(ndf), sigma, sigma, gamma) != STATUS_OK)
		abort();
	return model;
}

/* The model's values at every entry above the horizon whose phi_d index divides by `step`, times
 * 1 + noise * uniform(-1, 1); the others are masked. */
static inline struct measurement make_sparse_table(const struct cook_torrance *model, int n_phi_d, enum bins bins,
						   double noise, int step)
{
	struct measurement measurement;

	if (measurement_alloc(&measurement, n_phi_d) != STATUS_OK)
		abort();
#pragma omp parallel for
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++) {
			unsigned seed = (unsigned)(i * 91 + j);

			for (int k = 0; k < n_phi_d; k += step) {
				const size_t at = measurement_at(n_phi_d, i, j, k);
				struct vec3 wi, wo;
				double f[3];

				halfdiff_trig_dirs(bins_trig(bins, i, j, k), &wi, &wo);
				cook_torrance_f(model, wi, wo, f);
				for (int c = 0; c < 3; c++) {
					f[c] *= 1 + noise * (2 * random_unit(&seed) - 1);
					if (wi.z > 1e-9 && wo.z > 1e-9)
						measurement.value[c][at] = (float)f[c];
				}
			}
		}
	return measurement;
}

static inline struct measurement make_table(const struct cook_torrance *model, int n_phi_d, enum bins bins,
					    double noise)
{
	return make_sparse_table(model, n_phi_d, bins, noise, 1);
}

#endif
