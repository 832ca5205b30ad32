/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/plot/error_map.h"
#include "fit/error/error_sum.h"

enum status error_map_make(const struct measurement *measurement, const struct cook_torrance *model,
			   const struct fit_options *options, struct metrics_row row[MERL_ROWS])
{
	struct fit_options own = *options;
	struct geometry geometry;

	own.criterion.gaf = model->gaf;
	enum status status = geometry_init(&geometry, measurement->n_phi_d, &own);
	if (status == STATUS_OK)
		status = metrics_rows(&geometry, measurement, model, options->threads, row);
	geometry_free(&geometry);
	return status;
}

double error_map_error(const struct metrics_row *row)
{
	if (row->samples == 0)
		return NAN;
	return row->difference > 0 ? error_ratio(row->difference, row->measured) : 0;
}
