/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sampling - which normals are drawn, and their density. */
#ifndef SAMPLING_H
#define SAMPLING_H

#include "src/ndf.h"

enum sampling {
	SAMPLING_VISIBLE,  /* those seen from a direction, vndf.h */
	SAMPLING_NDF,      /* all, with density D(m) m.z */
	SAMPLING_PSEUDO,   /* a substitute for the visible ones: vndf_pseudo_init() */
	SAMPLING_RATIONAL, /* the visible ones of GGX by a rational fit: vndf_rational_sample() */
	SAMPLING_COUNT
};

/* sampling_name - "visible", "ndf", "pseudo", "rational"; "unknown" for any other value. */
const char *sampling_name(enum sampling sampling);
/* sampling_find - the one called `name`. Returns STATUS_DOMAIN, *sampling untouched, when there is none. */
MUST_CHECK enum status sampling_find(const char *name, enum sampling *sampling);

/* struct sampler - one way to draw the normals of one distribution; filled by sampler_init(), then only read. */
struct sampler {
	struct ndf proposal;     /* whose normals are drawn, with its exact Lambda; pl stays borrowed */
	enum sampling procedure; /* and how; never SAMPLING_PSEUDO */
};

/* sampler_init - STATUS_UNSUPPORTED where the distribution cannot be sampled so: visible and pseudo as vndf_supports()
 * says, rational as vndf_rational_supports(). */
MUST_CHECK enum status sampler_init(struct sampler *sampler, const struct ndf *ndf, enum sampling sampling);
/* sampler_init_near - the same, but where the distribution cannot be sampled so, visible normals take its place, or else all.
 * Returns which are drawn. */
enum sampling sampler_init_near(struct sampler *sampler, const struct ndf *ndf, enum sampling sampling);
/* sampler_sample - a normal seen from wi, as vndf_sample(); SAMPLING_NDF does not read wi. */
struct vec3 sampler_sample(const struct sampler *sampler, struct vec3 wi, double u1, double u2);
/* sampler_pdf - the density with which sampler_sample() draws m, 1/sr. */
double sampler_pdf(const struct sampler *sampler, struct vec3 wi, struct vec3 m);

#endif
