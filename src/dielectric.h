/* SPDX-License-Identifier: GPL-3.0-or-later */
/* dielectric - a rough interface between two transparent media: light is reflected and refracted once by its facets.
 *
 *     reflection     f = F D(m) G / (4 |cos_i cos_o|),                                m along wi + wo
 *     transmission   f = (1 - F) D(m) G n^2 |wi.m wo.m| / (|cos_i cos_o| |wi + n wo|^2),      m along wi + n wo
 * [Walter et al. 2007, Eq. 20 and 21 with the half vector of Eq. 16; n is the index on the side of wo over that on the
 * side of wi, F the exact reflectance of the facet at wi.m]. As wi + n wo is a multiple of m, the sum in the paper's
 * denominator is its length. G of a transmission is gaf_smith_through().
 *
 * Conventions: unit vectors pointing away from the surface, wi to the light; each may lie above (z > 0) or below. f is a
 * ratio of radiances, so it has the n^2 by which radiance grows as light enters the denser medium. f |cos_o| over all wo
 * therefore adds up to the share of the light from wi that one event with a facet sends on, and reciprocity is
 *     f(wi, wo) / n_o^2 = f(wo, wi) / n_i^2
 * with the indices on the two sides. A surface looked at from below is the same one mirrored through the origin. */
#ifndef DIELECTRIC_H
#define DIELECTRIC_H

#include "src/cook_torrance.h"
#include "src/sampling.h"

/* Domain of the relative index, either way. */
#define DIELECTRIC_INDEX_MAX 1e50

/* dielectric_takes - whether n is a relative index for dielectric_init(). */
bool dielectric_takes(double n);

/* struct dielectric - filled by dielectric_init(), then only read. */
struct dielectric {
	struct cook_torrance side[2]; /* the reflecting model as seen from above, and from below */
};

/* dielectric_init - an interface with facets *ndf, any distribution of ndf.h.
 * Given:   n, index of the medium below over that of the medium above, 1/DIELECTRIC_INDEX_MAX to DIELECTRIC_INDEX_MAX
 * Returns: STATUS_OK; STATUS_DOMAIN, *dielectric untouched, for n out of range, NaN, or exactly 1, where light passes
 *          straight on and f is no function; STATUS_UNSUPPORTED for GAF_V_GROOVE, which is of reflection alone. */
MUST_CHECK enum status dielectric_init(struct dielectric *dielectric, const struct ndf *ndf, enum gaf gaf, double n);

/* dielectric_f - the sum of the two terms above, 1/sr, of which one is not 0 at most.
 * Returns: >= 0; 0 where either direction lies in the horizon, or where no facet that both see joins the two; NaN in
 *          gives NaN out or 0. Relative error as cook_torrance_lobe() and that of G; in transmission also some
 *          1e-15 (1 + |d ln D/d ln tan^2(theta_m)|) / (|wi + n wo| m.z), and 1e-16/(1 - F) where little passes. */
double dielectric_f(const struct dielectric *dielectric, struct vec3 wi, struct vec3 wo);

/* struct dielectric_sample - where light from wi goes. */
struct dielectric_sample {
	struct vec3 wo; /* a unit vector */
	double weight;  /* f |cos_o| over the density of wo; 0 where wo is on the wrong side of the horizon */
};

/* dielectric_sample - draws a facet by u[0] and u[1], then reflects with the probability F or refracts by u[2].
 * Given:   |wi.z| > 1e-90; u[] in [0, 1)
 * Returns: wo with the density dielectric_pdf(). The mean of the weight is the share of light that one event sends on;
 *          with visible normals it is G/G1(wi) <= 1, else unbounded. What misses has been sent on to other facets.
 *          NaN where sampler_init() says STATUS_UNSUPPORTED.
 * Note:    who follows a path from the viewer draws the light's direction by giving the viewer's for wi. The weight then
 *          lacks, in transmission, the factor 1/n^2 of reciprocity. */
struct dielectric_sample dielectric_sample(const struct dielectric *dielectric, enum sampling sampling, struct vec3 wi,
					   const double u[3]);

/* dielectric_pdf - density of the wo of dielectric_sample(), 1/sr, among those whose weight is not 0. It adds up to 1 less
 * the share of the samples that miss. 0 where dielectric_f() is. */
double dielectric_pdf(const struct dielectric *dielectric, enum sampling sampling, struct vec3 wi, struct vec3 wo);

/* dielectric_refract - the direction in which light from wi goes on beyond a smooth facet.
 * Given:   wi.m >= 0, m a unit vector; n > 0, index on the far side over that on the near side
 * Returns: false, *wo untouched, under total internal reflection. Else *wo, a unit vector, wo.m <= 0; components within
 *          4e-16 (1 + 1/n), absolute. */
bool dielectric_refract(struct vec3 wi, struct vec3 m, double n, struct vec3 *wo);

/* struct dielectric_half - the normal m of the facets that refract wi to wo, m.z >= 0, a multiple of wi + n wo, whose
 * length is kept, too. */
struct dielectric_half {
	struct vec3 m;
	double length; /* 0, and m without meaning, where there is none: wi.m > 0 > wo.m does not hold */
};

/* dielectric_half - n as above. */
struct dielectric_half dielectric_half(struct vec3 wi, struct vec3 wo, double n);

/* dielectric_jacobian - solid angle of facets per solid angle of transmitted directions, n^2 |wo.m| / |wi + n wo|^2 [Eq. 17].
 * Given:   a *half with length > 0 */
double dielectric_jacobian(const struct dielectric_half *half, struct vec3 wo, double n);

#endif
