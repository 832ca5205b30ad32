/* SPDX-License-Identifier: GPL-3.0-or-later */
/* within - the simplest model that is good enough: what a material does not need is left out. */
#ifndef WITHIN_H
#define WITHIN_H

#include "fit/search/fit.h"

/* within_run - fits simpler variants of the model in `options` (gray, with coloured kd but one ks, without diffuse or specular term, without
 * Fresnel, other NDFs of the list) until the one with the fewest parameters is known whose error is at most (1 +
 * percent/100) times the lowest error of the whole model. Of variants with as many parameters, one that keeps the
 * options' own terms. Variants that lie inside one that failed are not fitted: they cannot do better. *chosen receives
 * the options of the result: one NDF. Errors as of fit_run(). */
MUST_CHECK enum status within_run(const struct fit_context *context, const struct measurement *measurement,
				  const struct fit_options *options, double percent, struct fit_options *chosen,
				  struct fit_result *result, struct error *error);

#endif
