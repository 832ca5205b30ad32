/* SPDX-License-Identifier: GPL-3.0-or-later */
/* octave_table - a function of one number x >= 0, tabulated over the octaves of x for scattered entries: the distribution of slopes over
 * (slope/sigma)^2, G1 over (sigma tan theta)^2, F over cos theta_d.
 *
 * The kernel finds its entry by the bits of x as a float, whose exponent counts octaves and whose mantissa is linear within one:
 * no logarithm is taken. Entries are filled from a few nodes an octave, at which the function is exact, by the polynomial through
 * six of them in log2 x; between entries the kernel interpolates linearly. */
#ifndef OCTAVE_TABLE_H
#define OCTAVE_TABLE_H

#include "fit/error/kernel.h"
#include "src/status.h"

enum octave_kind {
	OCTAVES_PLAIN, /* the polynomial is one of the values; the last node is at the end of the range, none beyond it */
	OCTAVES_LOG,   /* of their logarithms: values >= 0 that fall by many orders of magnitude */
	OCTAVES_EXACT, /* no polynomial: a function with kinks, evaluated at every entry */
};

struct octave_table {
	int node_bits, entry_bits; /* nodes and entries an octave, as powers of two */
	int low, octaves;          /* entries begin at x = 2^low and end at 2^(low + octaves); 0 octaves: not filled */
	double *node;
	struct octave_between *between; /* of the entries from one octave to the next */
	float *entry;
};

/* octave_table_init - room for any range, at most 2^11 entries an octave. STATUS_NO_MEMORY. */
MUST_CHECK enum status octave_table_init(struct octave_table *table, int node_bits, int entry_bits);
void octave_table_free(struct octave_table *table);

/* octave_table_fill - tabulates f(data, x) for x from x_min to x_max, 0 < x_min <= x_max, and whole octaves around.
 * at_zero: what all x below half of x_min stand for; not used for OCTAVES_PLAIN. Where a OCTAVES_LOG is below the range of floats for
 * good, the table ends: f must not rise again. */
void octave_table_fill(struct octave_table *table, enum octave_kind kind, double x_min, double x_max, double at_zero,
		       double (*f)(const void *data, double x), const void *data);

/* octave_table_kernel - the table as the kernel reads it. */
struct kernel_curve octave_table_kernel(const struct octave_table *table);

#endif
