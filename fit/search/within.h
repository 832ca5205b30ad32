/* SPDX-License-Identifier: GPL-3.0-or-later */
/* within - the simplest model that is good enough: what a material does not need is left out. */
#ifndef WITHIN_H
#define WITHIN_H

#include "fit/search/fit.h"

/* What a model may have beyond what the options ask for. */
enum within_richer {
	WITHIN_BURLEY = 1 << 0,    /* a grazing term */
	WITHIN_F82 = 1 << 1,       /* f82 in the place of F */
	WITHIN_TWO_LOBES = 1 << 2, /* a second lobe */
};

/* within_run - fits the model with the fewest parameters whose error is at most (1 + percent/100) times the lowest of its family:
 * the model of the options, simpler ones (gray, with coloured kd but one ks, without diffuse or specular term, without Fresnel,
 * isotropic, other NDFs of the list) and those with terms of `richer` besides, as far as fit_options_rule() lets them. Of
 * models with as many parameters, one that keeps the options' own terms. Estimates from samples of the measurement tell
 * first which ones are out of the question, with all that lie inside them; only what may be chosen is fitted in full, and the
 * best of the family where its estimate, 0.3 %, leaves a choice open. *chosen, which may be *options, receives the options of the
 * result: one NDF. Errors as of fit_run(). */
MUST_CHECK enum status within_run(const struct fit_context *context, const struct measurement *measurement,
				  const struct fit_options *options, unsigned richer, double percent,
				  struct fit_options *chosen, struct fit_result *result, struct error *error);

#endif
