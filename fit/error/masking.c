/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/masking.h"
#include <math.h>
#include <stdlib.h>

enum { MARGIN = 3 }; /* nodes beyond the range on either side, for the six-point interpolation */

int32_t masking_q(struct vec3 w)
{
	const double sin2 = w.x * w.x + w.y * w.y;
	const double q = sin2 > 0 ? log2(w.z / sqrt(sin2)) : MASKING_Q_MAX;

	return (int32_t)lrint((q < MASKING_Q_MAX ? q : MASKING_Q_MAX) * (1 << MASKING_Q_BITS));
}

void six_weights(double t, double weight[6])
{
	const double a = t + 2, b = t + 1, c = t, d = t - 1, e = t - 2, f = t - 3;

	weight[0] = -b * c * d * e * f / 120;
	weight[1] = a * c * d * e * f / 24;
	weight[2] = -a * b * d * e * f / 12;
	weight[3] = a * b * c * e * f / 12;
	weight[4] = -a * b * c * d * f / 24;
	weight[5] = a * b * c * d * e / 120;
}

static int entries_per_node(const struct masking *m)
{
	return 1 << (m->entry_bits - m->node_bits);
}

enum status masking_init(struct masking *m, int32_t q_min, enum masking_density density)
{
	const int q_floor = q_min >> MASKING_Q_BITS, octaves = MASKING_Q_MAX - q_floor;

	*m = (struct masking){.q_floor = q_floor,
			      .node_bits = density == MASKING_FINE ? 4 : 2,
			      .entry_bits = density == MASKING_FINE ? 12 : 7};
	m->n_nodes = (octaves << m->node_bits) + 1 + 2 * MARGIN;
	m->n_entries = (octaves << m->entry_bits) + 2;
	m->node = malloc((size_t)m->n_nodes * sizeof *m->node);
	m->between = malloc((size_t)entries_per_node(m) * sizeof *m->between);
	m->entry = malloc((size_t)m->n_entries * sizeof *m->entry);
	if (!m->node || !m->between || !m->entry) {
		masking_free(m);
		return STATUS_NO_MEMORY;
	}
	for (int n = 0; n < entries_per_node(m); n++)
		six_weights((double)n / entries_per_node(m), m->between[n]);
	return STATUS_OK;
}

void masking_free(struct masking *m)
{
	free(m->node);
	free(m->between);
	free(m->entry);
	*m = (struct masking){0};
}

void masking_fill_function(struct masking *m, double (*function)(double cot, const void *data), const void *data,
			   double normal)
{
	const int per_node = entries_per_node(m);

	for (int n = 0; n < m->n_nodes; n++) {
		const double cot = exp2(m->q_floor + (double)(n - MARGIN) / (1 << m->node_bits));

		m->node[n] = function(cot, data);
	}
	for (int n = 0; n < m->n_entries - 2; n += per_node) {
		const double *node = m->node + n / per_node + MARGIN - 2;

		for (int t = 0; t < per_node; t++) {
			const double *w = m->between[t];

			m->entry[n + t] = (float)(w[0] * node[0] + w[1] * node[1] + w[2] * node[2] + w[3] * node[3] +
						  w[4] * node[4] + w[5] * node[5]);
		}
	}
	/* The last entry stands for the normal itself. */
	m->entry[m->n_entries - 2] = m->entry[m->n_entries - 1] = (float)normal;
}

static double G1_of(double cot, const void *ndf)
{
	const double sine = 1 / sqrt(1 + cot * cot);

	return ndf_G1(ndf, (struct vec3){sine, 0, cot * sine});
}

void masking_fill(struct masking *m, const struct ndf *ndf)
{
	masking_fill_function(m, G1_of, ndf, 1);
}

struct kernel_g1 masking_kernel(const struct masking *m)
{
	return (struct kernel_g1){m->entry, m->q_floor * (1 << MASKING_Q_BITS), MASKING_Q_BITS - m->entry_bits};
}
