/* SPDX-License-Identifier: GPL-3.0-or-later */
/* masking - Smith's G1 of one shape, tabulated over q = log2 cot theta.
 *
 * G1 is exact at nodes, a few to an octave of cot theta; a polynomial through six of them fills a denser table of
 * entries, between which one interpolates linearly. In q, G1 is smooth however sharp the distribution: grazing and
 * normal directions have as many nodes as the rest. */
#ifndef MASKING_H
#define MASKING_H

#include "fit/error/kernel.h"
#include "src/ndf.h"
#include <stdint.h>

enum {
	MASKING_Q_BITS = 24, /* fixed-point bits of q after the point */
	MASKING_Q_MAX = 14,  /* beyond cot theta = 2^14 a direction counts as the normal itself */
};

/* masking_q - the fixed-point q of a direction above the horizon. */
int32_t masking_q(struct vec3 w);

/* How dense the table is. Largest relative error of G1 against the exact value, sigma 1e-4 .. 4, gamma 1.5001 .. inf:
 * coarse 8e-6, fine 1e-8 (tests/test_masking.c). */
enum masking_density { MASKING_COARSE, MASKING_FINE };

struct masking {
	int q_floor;               /* whole octave at which the table begins */
	int node_bits, entry_bits; /* nodes and entries an octave, as powers of two */
	int n_nodes, n_entries;
	double *node;
	double (*between)[6]; /* weights of six nodes for each entry from one node to the next */
	float *entry;
};

/* masking_init - room for directions down to the fixed-point `q_min`. */
MUST_CHECK enum status masking_init(struct masking *masking, int32_t q_min, enum masking_density density);
void masking_free(struct masking *masking);

/* masking_fill - tabulates an isotropic distribution. */
void masking_fill(struct masking *masking, const struct ndf *ndf);

/* masking_fill_function - the same of any smooth function of cot theta, 0 <= cot < inf, that is `normal` at the normal. */
void masking_fill_function(struct masking *masking, double (*function)(double cot, const void *data), const void *data,
			   double normal);

/* six_weights - Lagrange's weights of six equidistant nodes for the point t, 0 <= t < 1, between the third and the fourth. */
void six_weights(double t, double weight[6]);

/* masking_kernel - the table as the kernel reads it. */
struct kernel_g1 masking_kernel(const struct masking *masking);

/* masking_at - G1 at a fixed-point q of at least q_min and at most that of MASKING_Q_MAX. */
static inline double masking_at(const struct masking *masking, int32_t q)
{
	const int shift = MASKING_Q_BITS - masking->entry_bits;
	const int32_t at = q - masking->q_floor * (1 << MASKING_Q_BITS), index = at >> shift;
	const double fraction = (double)(at & ((1 << shift) - 1)) / (1 << shift);
	const double low = (double)masking->entry[index], high = (double)masking->entry[index + 1];

	return low + fraction * (high - low);
}

#endif
