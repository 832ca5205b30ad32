/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/octave_table.h"
#include "fit/error/masking.h"
#include <math.h>
#include <stdlib.h>

enum {
	OCTAVES_MAX = 160, /* more than any range of a double's y that is within a float's */
	MARGIN = 3,        /* nodes beyond the range on either side, for the six-point interpolation */
	NODES = 6,
	ENTRY_BITS_MAX = 11
};

/* Where an entry of an octave stands among its nodes. */
static double node_of(const struct octave_table *t, int n)
{
	return log2(1 + (double)n / (1 << t->entry_bits)) * (1 << t->node_bits);
}

enum status octave_table_init(struct octave_table *t, int node_bits, int entry_bits)
{
	*t = (struct octave_table){.node_bits = node_bits, .entry_bits = entry_bits};
	const size_t per_octave = (size_t)1 << entry_bits, nodes = (size_t)1 << node_bits;

	t->node = malloc((OCTAVES_MAX * nodes + 1 + 2 * MARGIN) * sizeof *t->node);
	t->weight = malloc(NODES * per_octave * sizeof *t->weight);
	t->entry = malloc((OCTAVES_MAX * per_octave + 2) * sizeof *t->entry);
	if (!t->node || !t->weight || !t->entry) {
		octave_table_free(t);
		return STATUS_NO_MEMORY;
	}
	for (size_t n = 0; n < per_octave; n++) {
		const double at = node_of(t, (int)n);
		double weight[NODES];

		six_weights(at - floor(at), weight);
		for (size_t k = 0; k < NODES; k++)
			t->weight[k * per_octave + n] = weight[k];
	}
	return STATUS_OK;
}

void octave_table_free(struct octave_table *t)
{
	free(t->node);
	free(t->weight);
	free(t->entry);
	*t = (struct octave_table){0};
}

/* 2^x for x up to 127, to 1e-9, in a form that vectorises; 0 below 2^-126, where floats end. */
static inline double power_of_two(double x)
{
	const double least = -126, bounded = x > least ? x : least;
	const int32_t whole = (int32_t)(bounded + 1024.5) - 1024;
	const double t = (bounded - whole) * M_LN2;
	const union {
		int64_t i;
		double d;
	} scale = {((int64_t)whole + 1023) * ((int64_t)1 << 52)};
	const double sum =
		1 + t * (1 + t * (1.0 / 2 +
				  t * (1.0 / 6 +
				       t * (1.0 / 24 + t * (1.0 / 120 +
							    t * (1.0 / 720 + t * (1.0 / 5040 + t * (1.0 / 40320))))))));

	return x > least ? sum * scale.d : 0;
}

/* log2 of a value that may be 0 or too small for a float. */
static double bounded_log(double value)
{
	return value > 1e-300 ? log2(value) : -1000;
}

/* Below this log2 an entry is 0. */
#define NOTHING (-150)

/* The polynomial through six nodes in a row, at the node that stands `step` before them. */
static double extrapolate(const double *node, int step)
{
	return 6 * node[step] - 15 * node[2 * step] + 20 * node[3 * step] - 15 * node[4 * step] + 6 * node[5 * step] -
	       node[6 * step];
}

static void fill_nodes(struct octave_table *t, enum octave_kind kind, double (*f)(const void *data, double x),
		       const void *data)
{
	const int begin = kind == OCTAVES_LOG ? MARGIN : 0, after = kind == OCTAVES_ENDED ? 0 : MARGIN;
	int end = (t->octaves << t->node_bits) + MARGIN + 1;

	for (int n = begin; n < end + after; n++) {
		const double y = exp2(t->low + (double)(n - MARGIN) / (1 << t->node_bits));
		const double value = f(data, fmax(y - t->offset, 0));

		t->node[n] = kind == OCTAVES_LOG ? bounded_log(value) : value;
		if (kind == OCTAVES_LOG && t->node[n] < NOTHING) {
			const int octaves = ((n - MARGIN) >> t->node_bits) + 1;

			t->octaves = octaves < t->octaves ? octaves : t->octaves;
			end = (t->octaves << t->node_bits) + MARGIN + 1;
		}
	}
	for (int n = begin - 1; n >= 0; n--)
		t->node[n] = extrapolate(t->node + n, 1);
	for (int n = end; n < end + MARGIN - after; n++)
		t->node[n] = extrapolate(t->node + n, -1);
}

/* Those from one node to the next, entries from .. to - 1 of an octave. */
static void fill_entries(const struct octave_table *t, enum octave_kind kind, const double *node, int from, int to,
			 float *entry)
{
	const size_t per_octave = (size_t)1 << t->entry_bits;
	const double *a = t->weight, *b = a + per_octave, *c = b + per_octave, *d = c + per_octave, *e = d + per_octave,
		     *f = e + per_octave;
	const double va = node[0], vb = node[1], vc = node[2], vd = node[3], ve = node[4], vf = node[5];

	if (kind == OCTAVES_LOG)
		for (int n = from; n < to; n++)
			entry[n] = (float)power_of_two(a[n] * va + b[n] * vb + c[n] * vc + d[n] * vd + e[n] * ve +
						       f[n] * vf);
	else
		for (int n = from; n < to; n++)
			entry[n] = (float)(a[n] * va + b[n] * vb + c[n] * vc + d[n] * vd + e[n] * ve + f[n] * vf);
}

static void fill_all(const struct octave_table *t, enum octave_kind kind)
{
	const int nodes = 1 << t->node_bits, per_octave = 1 << t->entry_bits;
	int from = 0;

	for (int k = 0; k < nodes; k++) {
		int to = from;

		while (to < per_octave && node_of(t, to) < k + 1)
			to++;
		for (int octave = 0; octave < t->octaves; octave++)
			fill_entries(t, kind, t->node + octave * nodes + k + MARGIN - 2, from, to,
				     t->entry + octave * per_octave);
		from = to;
	}
}

void octave_table_fill(struct octave_table *t, enum octave_kind kind, double offset, double y_min, double y_max,
		       double (*f)(const void *data, double x), const void *data)
{
	const int per_octave = 1 << t->entry_bits, high = (int)ceil(log2(y_max));

	t->offset = offset;
	t->low = (int)floor(log2(y_min));
	t->octaves = high > t->low ? high - t->low : 1;
	if (t->octaves > OCTAVES_MAX)
		t->octaves = OCTAVES_MAX;
	if (kind == OCTAVES_EXACT) {
		for (int n = 0; n < t->octaves * per_octave; n++) {
			const double y = ldexp(1 + (double)(n % per_octave) / per_octave, t->low + n / per_octave);

			t->entry[n] = (float)f(data, fmax(y - offset, 0));
		}
	} else {
		fill_nodes(t, kind, f, data);
		fill_all(t, kind);
	}
	const int last = t->octaves * per_octave;

	t->entry[last] = t->entry[last + 1] = (float)f(data, exp2(t->low + t->octaves) - offset);
}

struct kernel_curve octave_table_kernel(const struct octave_table *t)
{
	const union {
		float f;
		int32_t i;
	} first = {ldexpf(1, t->low)};

	return (struct kernel_curve){.value = t->entry,
				     .offset = (float)t->offset,
				     .first = first.f,
				     .last = ldexpf(1, t->low + t->octaves),
				     .first_bits = first.i,
				     .shift = 23 - t->entry_bits};
}
