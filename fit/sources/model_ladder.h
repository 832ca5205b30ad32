/* SPDX-License-Identifier: GPL-3.0-or-later */
/* model_ladder - every model of the ladder fitted to each file, as a table. */
#ifndef MODEL_LADDER_H
#define MODEL_LADDER_H

#include "fit/cli/files.h"
#include "fit/cli/options.h"

/* model_ladder - fits the rungs under the options one after the other, each to all files, and renders them and the measurement in
 * studio light. *table receives the lines of each material, in the order of their names, or of how much the best model
 * gains over the paper's (options->sort_by_gain). A file that fails is reported and tried no more.
 * Returns the exit code. */
int model_ladder(const struct options *options, const struct files *files, struct csv_table *table);

#endif
