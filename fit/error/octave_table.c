/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/octave_table.h"
#include "fit/error/masking.h"
#include <math.h>
#include <stdlib.h>

enum {
	OCTAVE_COUNT_MAX = 160, /* more than any range of a double's x that is within a float's */
	MARGIN = 3,             /* nodes beyond the range on either side, for the six-point interpolation */
	ENTRY_BITS_MAX = 11
};

/* Where an entry of an octave stands among its nodes: the third of six, and their weights. */
struct octave_between {
	int node;
	double weight[6];
};

enum status octave_table_init(struct octave_table *table, int node_bits, int entry_bits)
{
	*table = (struct octave_table){.node_bits = node_bits, .entry_bits = entry_bits};
	const int per_octave = 1 << table->entry_bits, nodes = 1 << table->node_bits;

	table->node = malloc((size_t)(OCTAVE_COUNT_MAX * nodes + 1 + 2 * MARGIN) * sizeof *table->node);
	table->between = malloc((size_t)per_octave * sizeof *table->between);
	table->entry = malloc((size_t)(OCTAVE_COUNT_MAX * per_octave + 2) * sizeof *table->entry);
	if (!table->node || !table->between || !table->entry) {
		octave_table_free(table);
		return STATUS_NO_MEMORY;
	}
	for (int n = 0; n < per_octave; n++) {
		const double at = log2(1 + (double)n / per_octave) * nodes;

		table->between[n].node = (int)at;
		six_weights(at - floor(at), table->between[n].weight);
	}
	return STATUS_OK;
}

void octave_table_free(struct octave_table *table)
{
	free(table->node);
	free(table->between);
	free(table->entry);
	*table = (struct octave_table){0};
}

/* 2^x for x <= 1000, to 1e-11, in a form that vectorises; 0 below 2^-126, where floats end. */
static inline double power_of_two(double x)
{
	const double least = -126, bounded = x > least ? x : least;
	const double whole = (double)(int32_t)(bounded - 0.5), t = (bounded - whole) * M_LN2;
	union {
		int64_t i;
		double d;
	} scale = {((int64_t)(int32_t)whole + 1023) * ((int64_t)1 << 52)};
	double sum = 1;

	for (int n = 11; n > 0; n--)
		sum = 1 + sum * t / n;
	return x > least ? sum * scale.d : 0;
}

/* log2 of a value that may be 0 or too small for a float. */
static double bounded_log(double value)
{
	return value > 1e-300 ? log2(value) : -1000;
}

static double node_x(const struct octave_table *c, int n)
{
	return exp2(c->low + (double)(n - MARGIN) / (1 << c->node_bits));
}

/* Below this log2 an entry is 0. */
#define NOTHING (-150)

static void fill_nodes(struct octave_table *c, enum octave_kind kind, double (*f)(const void *data, double x),
		       const void *data)
{
	int end = (c->octaves << c->node_bits) + MARGIN + 1;

	for (int n = 0; n < (kind == OCTAVES_PLAIN ? end : end + MARGIN); n++) {
		const double value = f(data, node_x(c, n));

		c->node[n] = kind == OCTAVES_LOG ? bounded_log(value) : value;
		if (kind == OCTAVES_LOG && n >= MARGIN && c->node[n] < NOTHING) {
			const int octaves = ((n - MARGIN) >> c->node_bits) + 1;

			c->octaves = octaves < c->octaves ? octaves : c->octaves;
			end = (c->octaves << c->node_bits) + MARGIN + 1;
		}
	}
	/* Beyond the end the function may have a kink: the polynomial through the last six nodes goes on. */
	for (int n = end; kind == OCTAVES_PLAIN && n < end + MARGIN; n++) {
		const double *b = c->node + n;

		c->node[n] = 6 * b[-1] - 15 * b[-2] + 20 * b[-3] - 15 * b[-4] + 6 * b[-5] - b[-6];
	}
}

static inline double interpolate(const double *node, const struct octave_between *between)
{
	const double *v = node + between->node, *w = between->weight;

	return w[0] * v[0] + w[1] * v[1] + w[2] * v[2] + w[3] * v[3] + w[4] * v[4] + w[5] * v[5];
}

static void fill_octave(const struct octave_table *c, enum octave_kind kind, int octave)
{
	const int per_octave = 1 << c->entry_bits;
	const double *node = c->node + (octave << c->node_bits) + MARGIN - 2;
	float *entry = c->entry + octave * per_octave;
	double value[1 << ENTRY_BITS_MAX];

	for (int n = 0; n < per_octave; n++)
		value[n] = interpolate(node, &c->between[n]);
	if (kind == OCTAVES_LOG)
		for (int n = 0; n < per_octave; n++)
			value[n] = power_of_two(value[n]);
	for (int n = 0; n < per_octave; n++)
		entry[n] = (float)value[n];
}

void octave_table_fill(struct octave_table *c, enum octave_kind kind, double x_min, double x_max, double at_zero,
		       double (*f)(const void *data, double x), const void *data)
{
	const int per_octave = 1 << c->entry_bits;
	/* An octave more below: its first entry is the one that stands for 0. */
	const int low = (int)floor(log2(x_min)) - (kind == OCTAVES_PLAIN ? 0 : 1), high = (int)ceil(log2(x_max));

	c->low = low;
	c->octaves = high > low ? high - low : 1;
	if (c->octaves > OCTAVE_COUNT_MAX)
		c->octaves = OCTAVE_COUNT_MAX;
	if (kind != OCTAVES_EXACT)
		fill_nodes(c, kind, f, data);
	const int last = c->octaves * per_octave;

	if (kind == OCTAVES_EXACT) {
		for (int n = 0; n <= last; n++)
			c->entry[n] =
				(float)f(data, ldexp(1 + (double)(n % per_octave) / per_octave, low + n / per_octave));
	} else {
		for (int octave = 0; octave < c->octaves; octave++)
			fill_octave(c, kind, octave);
		c->entry[last] = (float)f(data, exp2(low + c->octaves));
	}
	c->entry[last + 1] = c->entry[last];
	if (kind != OCTAVES_PLAIN)
		c->entry[0] = (float)at_zero;
}

struct kernel_curve octave_table_kernel(const struct octave_table *c)
{
	union {
		float f;
		int32_t i;
	} first = {ldexpf(1, c->low)};

	return (struct kernel_curve){c->entry, first.f, ldexpf(1, c->low + c->octaves), first.i, 23 - c->entry_bits};
}
