/* SPDX-License-Identifier: GPL-3.0-or-later */
/* vndf - sampling of the normals that are visible from a direction.
 *
 *     D_wi(m) = G1(wi) max(0, wi.m) D(m) / cos_i                                  [Heitz and d'Eon 2014]
 * is a density per solid angle. Its samples come from that paper's procedure: stretch wi so that the roughness is 1,
 * sample the slope x along wi, then the slope y across given x, turn, unstretch.
 *     ggx        x by the closed inverse of its CDF, y by the quantile of Student's t with 3 degrees of freedom
 *     beckmann   x by splitting the CDF into invertible parts, y by the normal quantile
 *     std        x by inverting its CDF, y by the quantile of Student's t with 2 gamma - 1 degrees of freedom
 *     ellipsoid  as ggx, from a direction that sees it without its tilt as wi does with it
 * hyper-cauchy and t-family are std at another roughness, and std is ggx or beckmann where gamma makes it so. The maps
 * of all but beckmann increase in u1 and u2 and have no jumps, as stratified samples want; that of beckmann jumps.
 *
 * Conventions: wi a unit vector, u1 and u2 uniform in [0, 1). Slopes are those of the surface height: the normal is
 * along (-x, -y, 1), and a facet with slope x along wi is seen under an area proportional to cos_i - x sin_i. */
#ifndef VNDF_H
#define VNDF_H

#include "src/ndf.h"
#include "src/smith.h"

/* vndf_supports - whether vndf_sample() can sample this distribution: all above; gtr and low it cannot. */
bool vndf_supports(const struct ndf *ndf);

/* vndf_sample - a normal m with density D_wi.
 * Given:   wi.z > 0; wi.z <= 0 counts as grazing incidence along the same azimuth; u1, u2 in [0, 1)
 * Returns: a unit vector with m.z > 0 and wi.m >= -2^-52, which is the rounding of m; NaN where vndf_supports() says no
 *          or wi has a NaN. The CDF of each slope differs from u1 or u2 by at most 1e-13. */
struct vec3 vndf_sample(const struct ndf *ndf, struct vec3 wi, double u1, double u2);

/* vndf_pdf - D_wi(m), 1/sr, of any distribution, its form of Lambda included; 0 for wi.m <= 0 and for wi or m at or
 * below the horizon. Relative error that of D and G1, plus 2^-52 / (wi.m). */
double vndf_pdf(const struct ndf *ndf, struct vec3 wi, struct vec3 m);

/* vndf_sample_inside, vndf_pdf_inside - the same from a direction within the surface, which may point below the horizon:
 * light that rises between the facets meets those that lean over it. There
 *     D_wi(m) = max(0, wi.m) D(m) / vndf_area(wi)                                 [Heitz et al. 2016]
 * Given:   wi.z of any sign, else as above; for wi.z >= 0 the samples are those of vndf_sample(), to the bit
 * Returns: as above, but with wi.m > 0 wherever wi.z < 0 has facets to face; NaN where vndf_area() is 0. The CDF of the slope
 *          along wi is within 1e-13 (1 + 1/Lambda(-wi)) for wi.z < 0. */
struct vec3 vndf_sample_inside(const struct ndf *ndf, struct vec3 wi, double u1, double u2);
double vndf_pdf_inside(const struct ndf *ndf, struct vec3 wi, struct vec3 m);

/* vndf_area - area of the facets that face wi, as wi sees it without those that mask them, per macroscopic area: the integral
 * of max(0, wi.m) D(m) dm. wi.z (1 + Lambda(wi)) above the horizon, |wi.z| Lambda(-wi) below, in it the common limit, from
 * |wi.z| = 1e-100 on. */
double vndf_area(const struct ndf *ndf, struct vec3 wi);

/* vndf_cdf - where a normal stands among those visible from wi: the CDFs of its two slopes at unit roughness, which are
 * what vndf_sample() inverts [STD supplement, section 7.1].
 *     *along    of the slope x along wi, as the facets are seen       C_wi(x)
 *     *across   of the slope y across wi, among facets of that x     C(y|x)
 * Both are uniform and independent when m has the density D_wi; the map of all but beckmann is (u1, u2) itself.
 * Given:   unit vectors; wi.z <= 0 counts as grazing incidence, m.z <= 0 as the horizon
 * Returns: absolute error 1e-13; NaN where vndf_supports() says no, for NaN, and where tilted facets face away from wi on
 *          average. */
void vndf_cdf(const struct ndf *ndf, struct vec3 wi, struct vec3 m, double *along, double *across);

/* vndf_rational_sample, vndf_rational_pdf - visible normals of ggx, and of what is ggx at gamma = 2, with the slope across
 * wi by VNDF_GGX_FIT below; and the density of just those, which is D_wi times the ratio of the two densities of that
 * slope: within 1 % over most of them, 0 beyond the end of the fit.
 * Given and returns: as vndf_sample() and vndf_pdf(). */
bool vndf_rational_supports(const struct ndf *ndf);
struct vec3 vndf_rational_sample(const struct ndf *ndf, struct vec3 wi, double u1, double u2);
double vndf_rational_pdf(const struct ndf *ndf, struct vec3 wi, struct vec3 m);

/* The two slopes at unit roughness. */
struct vndf_slopes {
	double x, y;
};

/* How the slope across wi is drawn for ggx. */
enum vndf_ggx {
	VNDF_GGX_EXACT, /* the quantile itself, to 1e-14 */
	VNDF_GGX_FIT,   /* the paper's rational fit: its CDF is off by up to 5.4e-4, |y| <= 7.26 sqrt(1 + x^2) */
};

/* vndf_ggx_slopes, vndf_beckmann_slopes - the slopes seen from polar angle theta at unit roughness.
 * Given:   cos_i, sin_i >= 0, their squares adding up to 1; u1, u2 in [0, 1)
 * Returns: slopes, finite, x at most cot(theta); Beckmann's in the order of branches of the paper's program. */
struct vndf_slopes vndf_ggx_slopes(double cos_i, double sin_i, double u1, double u2, enum vndf_ggx how);
struct vndf_slopes vndf_beckmann_slopes(double cos_i, double sin_i, double u1, double u2);

/* vndf_weight - what a sample contributes to the integral of f cos_o over wo, Fresnel factor apart:
 *     G(wi, wo) D(m) wi.m / (cos_i pdf(m)),   wo = wi reflected at m
 * Its mean over samples m with that pdf is the directional albedo, whatever the pdf [the supplement's Eq. 43, G/G1(wi),
 * is the case pdf = D_wi of the same D].
 * Given:   pdf > 0, per solid angle of m
 * Returns: >= 0; 0 where wo is at or below the horizon or the facet faces away. */
double vndf_weight(const struct ndf *ndf, enum gaf gaf, struct vec3 wi, struct vec3 m, double pdf);

/* struct vndf_pseudo - the STD supplement's substitute for visible normals [Algorithm 1]: those of GGX or Beckmann of the
 * same roughness where gamma is near enough, else all normals, with density D(m) m.z.
 * For anisotropic roughness its sigma is sqrt(sigma_x sigma_y). At the thresholds themselves the text decides: they
 * belong to GGX and Beckmann. Where GGX stands for gamma < 1.75, and Beckmann for any finite gamma, the weights are
 * unbounded with infinite variance, though unbiased: kept for comparison, vndf_sample() has no such defect. */
struct vndf_pseudo {
	struct ndf proposal;
	bool visible;
};

/* vndf_pseudo_init - returns STATUS_OK, or STATUS_DOMAIN where vndf_supports() says no, or its std roughness is outside
 * the domain of ndf_init(). */
MUST_CHECK enum status vndf_pseudo_init(struct vndf_pseudo *pseudo, const struct ndf *ndf);
/* vndf_pseudo_sample, vndf_pseudo_pdf - as vndf_sample() and vndf_pdf(), of the proposal. */
struct vec3 vndf_pseudo_sample(const struct vndf_pseudo *pseudo, struct vec3 wi, double u1, double u2);
double vndf_pseudo_pdf(const struct vndf_pseudo *pseudo, struct vec3 wi, struct vec3 m);

#endif
