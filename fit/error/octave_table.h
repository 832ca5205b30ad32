/* SPDX-License-Identifier: GPL-3.0-or-later */
/* octave_table - a function of one number x >= 0, tabulated over octaves for scattered entries: the distribution of slopes
 * over (slope/sigma)^2, G1 over (sigma tan theta)^2, F over cos theta_d.
 *
 * The kernel finds its entry by the bits of y = x + offset as a float, whose exponent counts octaves and whose mantissa is linear
 * within one: no logarithm is taken. Entries are filled from a few nodes an octave, at which the function is exact, by the
 * polynomial through six of them in log2 y; between entries the kernel interpolates linearly. */
#ifndef OCTAVE_TABLE_H
#define OCTAVE_TABLE_H

#include "fit/error/kernel.h"
#include "src/status.h"

enum octave_kind {
	OCTAVES_PLAIN, /* the polynomial is one of the values */
	OCTAVES_ENDED, /* the same, and no value beyond the upper end is asked for */
	OCTAVES_LOG, /* of their logarithms: values >= 0 that fall by many orders of magnitude; none below the lower end */
	OCTAVES_EXACT, /* no polynomial: a function with kinks, evaluated at every entry */
};

struct octave_table {
	int node_bits, entry_bits; /* nodes and entries an octave, as powers of two */
	int low, octaves;          /* entries begin at y = 2^low and end at 2^(low + octaves) */
	double offset;
	double *node;
	double *weight; /* of the six nodes for each entry of an octave: six times as many numbers as entries */
	float *entry;
};

/* octave_table_init - room for any range, at most 2^11 entries an octave. STATUS_NO_MEMORY. */
MUST_CHECK enum status octave_table_init(struct octave_table *table, int node_bits, int entry_bits);
void octave_table_free(struct octave_table *table);

/* octave_table_fill - tabulates f(data, x) for y from y_min to y_max, 0 < y_min <= y_max, and whole octaves around. Where
 * OCTAVES_LOG is below the range of floats for good, the table ends: f must not rise again. */
void octave_table_fill(struct octave_table *table, enum octave_kind kind, double offset, double y_min, double y_max,
		       double (*f)(const void *data, double x), const void *data);

/* octave_table_kernel - the table as the kernel reads it. */
struct kernel_curve octave_table_kernel(const struct octave_table *table);

#endif
