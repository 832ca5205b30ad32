/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plot_common - what the files of all plots share. Private to plot_*.c. */
#ifndef PLOT_COMMON_H
#define PLOT_COMMON_H

#include "data_readers/atomic_file.h"

/* plot_open - DIRECTORY/NAME, see atomic_file_open(). */
MUST_CHECK enum status plot_open(struct atomic_file *file, const char *directory, const char *name,
				 struct error *error);

/* plot_number - a cell of a CSV: a comma and the number. NaN is written as NaN: gnuplot skips an empty cell, and then
 * draws a line across the gap and shifts the pixels of an image. */
void plot_number(FILE *file, double x);
/* plot_text - a name as a cell that gnuplot reads: in quotes, without any inside, on one line. */
void plot_text(FILE *file, const char *text);

/* plot_colour - of an NDF's curve, the same in all plots; i: number of the curve, for NDFs without a colour of their own. */
const char *plot_colour(const char *ndf, int i);

/* plot_dash - number of its dashes, which tell curves apart where colours do not: 1 is a solid line. */
int plot_dash(const char *ndf, int i);

/* struct plot_range - the range of a logarithmic axis, grown value by value; a zeroed one is empty. */
struct plot_range {
	double low, high;
};
/* plot_range_add - values that are not positive and finite are left out. */
void plot_range_add(struct plot_range *range, double x);
/* plot_log_range - the y axis, from a factor `below` under the range to a factor `above` over it. */
void plot_log_range(FILE *file, const struct plot_range *range, double below, double above);

#endif
