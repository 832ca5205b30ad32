/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plot_files - the data and the gnuplot script of each kind of plot: NAME.gp and the CSV files that it reads, in one
 * directory, which drawing (gnuplot.h) turns into NAME.png and NAME.svg.
 *     ndf      D of each fit against the NDF read off the data (measured_ndf.h), and G1 that follows from either
 *     slices   measured and fitted values along theta_h, phi_d = 90 degrees, per channel and for six theta_d
 *     slices_0 the same at phi_d = 0; both read slices.csv
 *     map      the error over (theta_h, theta_d), one panel a fit
 *     errors   the errors of many materials, sorted, points of one shape an NDF (the STD paper's Fig. 11)
 *     trace    error against time
 * Errors of all: STATUS_IO, STATUS_NO_MEMORY. What is written is written whole. */
#ifndef PLOT_FILES_H
#define PLOT_FILES_H

#include "fit/results/trace.h"
#include "fit/sources/materials.h"

MUST_CHECK enum status plot_ndf(const char *directory, const struct material_data *data, struct error *error);
MUST_CHECK enum status plot_slices(const char *directory, const struct material_data *data, struct error *error);
MUST_CHECK enum status plot_map(const char *directory, const struct material_data *data, struct error *error);

/* plot_material - those above. */
extern const char *const plot_material_names[];
enum { PLOT_MATERIAL_PICTURES = 4 };
/* Their CSV files. */
extern const char *const plot_material_tables[];
enum { PLOT_MATERIAL_TABLES = 4 };
MUST_CHECK enum status plot_material(const char *directory, const struct material_data *data, struct error *error);

/* plot_errors - STATUS_NO_DATA when no row has an error. */
MUST_CHECK enum status plot_errors(const char *directory, const struct materials *materials, struct error *error);

/* plot_trace - of a table with trace_columns. STATUS_NO_DATA when it has no points. */
MUST_CHECK enum status plot_trace(const char *directory, const struct csv_table *trace, struct error *error);

#endif
