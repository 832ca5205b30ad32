/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run_fit - a whole fit of a table in memory. */
#ifndef RUN_FIT_H
#define RUN_FIT_H

#include "check.h"
#include "fit/search/fit.h"

/* The default options, for one NDF, on two threads. */
static inline struct fit_options options_for(const char *ndf)
{
	struct fit_options o = fit_options_default();

	o.ndf[0] = ndf_find(ndf);
	o.n_ndf = 1;
	o.threads = 2;
	return o;
}

/* The fit has to succeed. */
static inline void run_fit(const struct measurement *measurement, const struct fit_options *options,
			   struct fit_result *results)
{
	struct fit_context *context;
	struct error error = {""};

	assert_int_equal(fit_context_new(&context, measurement->n_phi_d, options), STATUS_OK);
	if (fit_run(context, measurement, options, results, &error) != STATUS_OK)
		fail_msg("fit: %s", error.text);
	fit_context_free(context);
}

#endif
