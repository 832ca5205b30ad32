/* SPDX-License-Identifier: GPL-3.0-or-later */
/* substitute - the model that a target can express, in the place of one that it cannot. Private to fit/export/. */
#ifndef SUBSTITUTE_H
#define SUBSTITUTE_H

#include "fit/export/export.h"

/* struct target - what a renderer's own microfacet lobe can be. All have GGX. */
struct target {
	const char *name;     /* of the renderer, in messages */
	bool beckmann;        /* has Beckmann, too */
	enum gaf gaf;         /* its G */
	unsigned fresnel;     /* its forms of F, bits 1 << enum fresnel */
	enum fresnel instead; /* the one for all others */
	double sigma_min;     /* smaller roughness counts as a mirror */
	double sigma_max;     /* larger one cannot be said; 0: any can */
	bool blend;           /* adds up two lobes by weights, so that kd + ks may not exceed 1 */
	const char *itself;   /* the format of ours that shows every model there; NULL: none */
	bool channel_ior;     /* takes a conductor's index for each channel */
};

/* substitute_needed - whether the target cannot express the lobe as it is; `why` (may be NULL) receives what is amiss. */
bool substitute_needed(const struct target *target, const struct cook_torrance *model, char why[EXPORT_TEXT]);

/* substitute_prepare - fills export->model, ->substitute, ->why and ->cost for this target. Errors as export_prepare(). */
MUST_CHECK enum status substitute_prepare(struct export *export, const struct target *target, struct error *error);

/* substitute_measurement - what errors are measured against: the source's samples, or the model's own table, which is then
 * *own, to be freed by the caller; NULL and no memory otherwise. */
const struct measurement *substitute_measurement(const struct export_source *source, struct measurement *own);

/* substitute_report - export->cost: the errors of the model, and of what the target shows of export->model, under each
 * weight. Errors as fit_eval(). */
MUST_CHECK enum status substitute_report(struct export *export, const struct measurement *measurement,
					 struct error *error);

/* substitute_add_why - adds "; " and the text to export->why. */
void substitute_add_why(struct export *export, const char *text);

#endif
