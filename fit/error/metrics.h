/* SPDX-License-Identifier: GPL-3.0-or-later */
/* metrics - how far a model is from a table, in double, under every weight and metric at once. */
#ifndef METRICS_H
#define METRICS_H

#include "fit/error/sample_set.h"

/* struct fit_metrics - how far a model is from the table. */
struct fit_metrics {
	double error[WEIGHT_COUNT]; /* E under each weight */
	double rms_cosine;          /* RMS of c (m - f), c = cos_i cos_o */
	double rms_cube_root;       /* RMS of cbrt(c m) - cbrt(c f) */
	double log_error;           /* mean |ln((c m + 1e-3)/(c f + 1e-3))| */
	size_t samples;             /* table entries (of three channels) compared */
};

/* metrics_compute - of scattered entries, those within the criterion of `geometry`, without tables; of a table, it compares `model` with the entries of `samples` that `geometry` has and that are valid.
 * Accuracy: relative error below 1e-7 of each metric against a sum of exact model values.
 * Errors: STATUS_NO_DATA when no entry is valid or all are zero, STATUS_NO_MEMORY. */
MUST_CHECK enum status metrics_compute(const struct geometry *geometry, const struct measurement *measurement,
				       const struct cook_torrance *model, int threads, struct fit_metrics *metrics);

/* struct metrics_row - the entries of one (theta_h, theta_d), over phi_d and the channels, under the geometry's weight w.
 */
struct metrics_row {
	double difference; /* sum of w |m - f| */
	double measured;   /* sum of w m */
	size_t samples;    /* valid entries of three channels; 0: nothing is known here */
};

/* metrics_rows - scattered entries count to the nearest node of a table; row[theta_d index + 90 theta_h index]: the sums that E is made of. The sum of all differences over that
 * of all measured is E as metrics_compute() gives it, to rounding. STATUS_NO_MEMORY. */
MUST_CHECK enum status metrics_rows(const struct geometry *geometry, const struct measurement *measurement,
				    const struct cook_torrance *model, int threads, struct metrics_row row[MERL_ROWS]);

#endif
