/* SPDX-License-Identifier: GPL-3.0-or-later */
/* smith - masking and shadowing: how G of two directions follows from one NDF. */
#ifndef SMITH_H
#define SMITH_H

#include "src/ndf.h"

enum gaf {
	GAF_UNCORRELATED, /* 1 / ((1 + Lambda(wi)) (1 + Lambda(wo))) */
	GAF_CORRELATED,   /* 1 / (1 + Lambda(wi) + Lambda(wo)), height-correlated */
	GAF_V_GROOVE,     /* min(1, 2 cos_h cos_o / cos_d, 2 cos_h cos_i / cos_d), Torrance-Sparrow; reads no NDF */
	GAF_COUNT
};

/* gaf_name - "uncorrelated", "correlated", "v-groove"; "unknown" for any other value. */
const char *gaf_name(enum gaf gaf);
/* gaf_find - the form called `name`. Returns STATUS_DOMAIN, *gaf untouched, when there is none. */
MUST_CHECK enum status gaf_find(const char *name, enum gaf *gaf);

/* gaf_smith - G of the first two from the Lambda of either direction, >= 0 or INFINITY; NaN for GAF_V_GROOVE. */
double gaf_smith(enum gaf gaf, double lambda_i, double lambda_o);

/* gaf_smith_through - G of two directions on opposite sides of the surface, which is all that a refracted ray sees of it:
 *     uncorrelated   as gaf_smith()
 *     correlated     B(1 + Lambda_i, 1 + Lambda_o), Euler's beta function: the mean of u^Lambda_i (1 - u)^Lambda_o, as a
 *                    share u of the surface lies below a facet, and what is high for one side is low for the other
 *                    [Heitz et al. 2016]
 * Given:   as gaf_smith(); lambda_o that of the direction mirrored through the origin
 * Returns: in [0, 1], symmetric; relative error 5e-15 + 3e-16 |ln G|, 0 below 1e-100; NaN for GAF_V_GROOVE. */
double gaf_smith_through(enum gaf gaf, double lambda_i, double lambda_o);

/* gaf_G_over_cosines - G/(cos_i cos_o), which does not underflow at grazing angles before it has to. */
double gaf_G_over_cosines(enum gaf gaf, const struct ndf *ndf, struct vec3 wi, struct vec3 wo);

/* gaf_G - geometric attenuation of light direction wi and view direction wo, unit vectors, in [0, 1];
 * symmetric in the two; 0 when either lies at or below the horizon. Relative error below 2e-15. */
double gaf_G(enum gaf gaf, const struct ndf *ndf, struct vec3 wi, struct vec3 wo);

#endif
