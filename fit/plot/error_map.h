/* SPDX-License-Identifier: GPL-3.0-or-later */
/* error_map - where in a table a model fails. */
#ifndef ERROR_MAP_H
#define ERROR_MAP_H

#include "fit/error/metrics.h"
#include "fit/search/fit.h"

/* error_map_make - the sums of E row by row, under the options' weight, bins, max_theta and the model's own G.
 * Returns: row[theta_d index + 90 theta_h index], see metrics.h
 * Errors:  STATUS_NO_MEMORY */
MUST_CHECK enum status error_map_make(const struct measurement *measurement, const struct cook_torrance *model,
				      const struct fit_options *options, struct metrics_row row[MERL_ROWS]);

/* error_map_error - E of one row alone: 0 where the model is perfect, 1 where a black model would be as good, infinite
 * where nothing but zeros was measured and the model is not zero; NaN without data. */
double error_map_error(const struct metrics_row *row);

#endif
