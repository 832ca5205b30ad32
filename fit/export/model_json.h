/* SPDX-License-Identifier: GPL-3.0-or-later */
/* model_json - a model as JSON, with all that it takes to make it again, to the bit.
 *
 *     {
 *       "format": "stdfit-model-1",
 *       "comment": [...],                        for people
 *       "material": "name",                      or null
 *       "kd": [r, g, b], "ks": [r, g, b],        f_c = kd_c / pi + ks_c F D G / (4 cos_i cos_o)
 *       "ndf": "std",                            a name of ndf.h
 *       "parameters": {"sigma": s, ...},         as ndf_param_at() names them; infinity is "inf"
 *                                                anisotropic: sigma along the first axis, "sigma_y", "angle" in degrees, too;
 *                                                tilted: "tilt_x", "tilt_y" of ndf_tilt()
 *       "nodes": {"theta": [...], "D": [...]},   pl instead: D, 1/sr, linear in theta, radians, from 0 to pi/2
 *                                                anisotropic: "Dy" and "angle", degrees, too, and D is along the first axis
 *       "lambda": "exact",                       a name of lambda_form.h
 *       "gaf": "uncorrelated", "fresnel": "dielectric", "ior": n, "k": k,     [r, g, b] where channels have their own
 *       "fitted": {"path": ..., "weight": ..., "bins": ..., "max_theta": ..., "error": E}     path and E may be null;
 *                 with "zero_is_missing": true where the fit left zeros out
 *     } */
#ifndef MODEL_JSON_H
#define MODEL_JSON_H

#include "fit/export/export.h"
#include "src/pwl.h"

/* struct model_json - a model that was read; what it owns is freed by model_json_free(). */
struct model_json {
	struct cook_torrance model;
	struct pwl *pwl; /* the table of model.ndf, if that is pl */
	char *material, *path;
	double error; /* NaN: not known */
};

/* model_json_read - reads `path`, of at most 64 MB; weight, bins, max_theta, gaf and fresnel go to *fit, too.
 * Errors: STATUS_IO, STATUS_NO_MEMORY, STATUS_FORMAT (the line of a syntax error, which includes a member given twice,
 * a number beyond a double's range and nesting beyond 2048; or which member, what was expected). *json holds nothing then. */
MUST_CHECK enum status model_json_read(const char *path, struct model_json *json, struct fit_options *fit,
				       struct error *error);
void model_json_free(struct model_json *json);

#endif
