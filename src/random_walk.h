/* SPDX-License-Identifier: GPL-3.0-or-later */
/* random_walk - light that meets several facets before it leaves: the Smith model's own multiple scattering, as a random
 * walk between the facets [Heitz, Hanika, d'Eon and Dachsbacher 2016, "Multiple-scattering microfacet BSDFs with the Smith
 * model"]. Single scattering (cook_torrance.h, dielectric.h) takes what does not leave at once as lost.
 *
 * A ray in direction w, at a point above which the share 1 - u of the surface lies, gets away with the probability
 * u^Lambda(w), whatever the distribution of heights [Eq. 18]; a ray that goes down comes as deep as one that goes up, with
 * -1 - Lambda(-w) for Lambda. In x = -ln u the free path of a ray is so exponential, with a change of x by -e/Lambda(w) when
 * it rises and by e/(1 + Lambda(-w)) when it falls, e a standard exponential number; it leaves at x < 0. On the other side
 * of the surface u counts from below. At its end the ray meets a facet with the density of those that it sees,
 * vndf_pdf_inside(), and is reflected or refracted there [Sec. 5, 6].
 *
 * The estimates below are without bias: their mean over the random numbers is the BSDF. It keeps energy: with facets that
 * lose nothing, all light comes back. Conventions as in dielectric.h: unit vectors away from the surface, wi to the light;
 * f is 1/sr; for a dielectric either may lie below. */
#ifndef RANDOM_WALK_H
#define RANDOM_WALK_H

#include "src/fresnel.h"
#include "src/ndf.h"
#include "src/status.h"

/* A walk that has met so many facets is given up and counts as absorbed. The number grows as Lambda, and so towards gamma =
 * 1.5: at sigma = 2 it is 90 in the mean for gamma = 1.51, at most 450 in 20000 walks; some 10 times that for 1.501. */
#define RANDOM_WALK_EVENTS_MAX 100000

/* struct random_walk - a surface; filled by random_walk_init_*(), then only read. */
struct random_walk {
	struct ndf ndf; /* with the exact Lambda */
	bool refracts;
	enum fresnel fresnel; /* of the facets, one index for each channel */
	double n[3], k[3];    /* of a dielectric n[0], below over above, is that of all channels */
};

/* struct random_numbers - next(state) is called for each number, uniform in [0, 1). */
struct random_numbers {
	double (*next)(void *state);
	void *state;
};

/* random_walk_init_mirror - facets that reflect the share fresnel_F(fresnel, cos_d, n[c], k[c]) in channel c and absorb the
 * rest: metals in colour, and any other F; FRESNEL_NONE loses nothing.
 * Given:   n[c] > 0, k[c] >= 0 up to 1e75, where that form reads them
 * Returns: STATUS_OK; STATUS_DOMAIN for n or k out of range, NaN; STATUS_UNSUPPORTED for a distribution whose visible
 *          normals cannot be sampled (vndf_supports()). *walk is untouched then. */
MUST_CHECK enum status random_walk_init_mirror(struct random_walk *walk, const struct ndf *ndf, enum fresnel fresnel,
					       const double n[3], const double k[3]);

/* random_walk_init_dielectric - facets between two transparent media. n and what is returned as by dielectric_init() and
 * above. */
MUST_CHECK enum status random_walk_init_dielectric(struct random_walk *walk, const struct ndf *ndf, double n);

/* struct random_walk_exit - where a walk ends. */
struct random_walk_exit {
	struct vec3 wo; /* a unit vector */
	double weight
		[3]; /* f |cos_o| over the density of wo, in each channel; all 0 where the light has been absorbed */
	int events;  /* facets met */
};

/* random_walk_sample - follows light from wi until it leaves.
 * Given:   |wi.z| > 1e-90; wi.z > 0 unless the surface is a dielectric
 * Returns: wo. The mean of the weight is the share of light that the surface sends back, and on. A dielectric's weights are
 *          1, those of a mirror at most 1 but for rounding; where little is left of the light, the walk is ended at random
 *          and the others count for it. For a viewer's path: the note in dielectric.h. */
struct random_walk_exit random_walk_sample(const struct random_walk *walk, struct vec3 wi,
					   const struct random_numbers *numbers);

/* random_walk_f - estimates f(wi, wo): the walk of light from wi, and at each facet the light that it sends to wo. What the
 * first facet sends is exact: cook_torrance_lobe() or dielectric_f() with GAF_CORRELATED.
 * Given:   wi as above; events: only light that has met at most so many facets; 0: all; 1 draws no numbers
 * Returns: f[], >= 0; 0 for wo.z = 0, or below the horizon of a mirror.
 * Note:    steep facets keep a ray's elevation nearly: towards gamma = 1.5, where most are all but vertical, the light of a
 *          ray goes to a narrow cone. For gamma <= 1.75 the variance of f is infinite, at 1.51 that is felt; the samples have
 *          no such defect. */
void random_walk_f(const struct random_walk *walk, struct vec3 wi, struct vec3 wo, int events,
		   const struct random_numbers *numbers, double f[3]);

#endif
