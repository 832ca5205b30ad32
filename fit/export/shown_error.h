/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shown_error - E of any function of two directions. Private to fit/export/. */
#ifndef SHOWN_ERROR_H
#define SHOWN_ERROR_H

#include "data_readers/measurement.h"
#include "fit/error/options.h"

/* shown_error - E of f under the criterion; NaN: no entry takes part. f is called by several threads, with directions
 * above the horizon. */
double shown_error(const struct measurement *measurement, const struct criterion *criterion, int threads,
		   void (*f)(const void *context, struct vec3 wi, struct vec3 wo, double f[3]), const void *context);

#endif
