/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options_check - the rules that the options of a fit have to keep. */
#ifndef OPTIONS_CHECK_H
#define OPTIONS_CHECK_H

#include "fit/error/options.h"

/* The most starts that may be asked for; of threads, FIT_THREADS_MAX. */
enum { FIT_STARTS_MAX = 100000 };
#define FIT_TIME_MAX_S 1e6

/* Rules that take more than one option to break. */
enum fit_rule {
	FIT_RULE_KEPT,      /* all are kept */
	FIT_RULE_RANGE,     /* one option alone is out of its range */
	FIT_RULE_TERMS,     /* neither a diffuse nor a specular term */
	FIT_RULE_BLEND,     /* a blend without bounds */
	FIT_RULE_TABULATED, /* pl without a specular term, or by another algorithm than the default */
	FIT_RULE_ANISOTROPIC, /* an NDF of the list is isotropic, or one roughness is fixed, or another algorithm; or sigma_y or angle
				without `anisotropic` */
	FIT_RULE_RICHER, /* f82, two lobes, a grazing term or an index for each channel beside what they do not go with */
	FIT_RULE_GAMMA, /* a fixed gamma that some NDF of the list does not take in the form of Lambda asked for */
};

/* fit_options_rule - the first rule that is broken, with a text that says what was expected and what was found.
 * Ranges: 1 .. FIT_NDFS_MAX NDFs, none of them NULL; every enum one of its values; max_theta in (0, 90]; threads in 1 ..
 * FIT_THREADS_MAX; starts in 0 .. FIT_STARTS_MAX; blend in [0, 1); sigma, sigma_y, ior NaN or in the domain of the fit; angle NaN or finite; gamma NaN
 * or above 0; time_s in (0, FIT_TIME_MAX_S]. A fixed value that no NDF of the list reads is no fault. */
enum fit_rule fit_options_rule(const struct fit_options *options, struct error *error);

/* fit_options_check - STATUS_OK, or STATUS_DOMAIN with a text where a rule is broken. In constant time. */
MUST_CHECK enum status fit_options_check(const struct fit_options *options, struct error *error);

/* fit_criterion_check - the same of the criterion and the threads alone, all that the geometry and the metrics read. */
MUST_CHECK enum status fit_criterion_check(const struct fit_options *options, struct error *error);

#endif
