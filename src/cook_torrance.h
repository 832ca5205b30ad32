/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cook_torrance - Lambert plus a microfacet lobe: the model that is fitted, as a scalar reference.
 *
 *     f_c = kd_c / pi + ks_c F(cos_d) D(h) G(wi, wo) / (4 cos_i cos_o)        c = red, green, blue
 *
 * Richer models add terms, each 0 where its coefficients are:
 *
 *     + kg_c g(wi, wo)                                                      grazing: see cook_torrance_grazing()
 *     + ks_second_c F(cos_d) D(h) G(wi, wo) / (4 cos_i cos_o)               a second lobe, D and G of another distribution
 *
 * and FRESNEL_F82, or an index for each channel, has an F for each channel.
 *
 * wi to the light, wo to the viewer, unit vectors; h = (wi + wo)/|wi + wo|; cos_d = wi.h, cos_i = wi.z,
 * cos_o = wo.z. */
#ifndef COOK_TORRANCE_H
#define COOK_TORRANCE_H

#include "src/fresnel.h"
#include "src/ndf.h"
#include "src/smith.h"

struct cook_torrance {
	struct ndf ndf;
	enum gaf gaf;
	enum fresnel fresnel;
	double n, k;                       /* index of refraction; k only for FRESNEL_CONDUCTOR */
	bool per_channel_ior;              /* FRESNEL_CONDUCTOR: each channel has an n and k of its own, */
	double channel_n[3], channel_k[3]; /* these, and those above mean nothing */
	double kd[3], ks[3];               /* >= 0 */
	double reflectance[3][F82_PARTS];  /* FRESNEL_F82: F0, F82 and F90 of each channel */
	double kg[3], grazing;             /* >= 0; exponent of the grazing term, >= 1 */
	double ks_second[3];
	struct ndf second; /* read only where some ks_second is above 0 */
};

/* cook_torrance_has_second, cook_torrance_has_grazing - whether the model has these terms. */
static inline bool cook_torrance_has_second(const struct cook_torrance *model)
{
	return model->ks_second[0] > 0 || model->ks_second[1] > 0 || model->ks_second[2] > 0;
}

static inline bool cook_torrance_has_grazing(const struct cook_torrance *model)
{
	return model->kg[0] > 0 || model->kg[1] > 0 || model->kg[2] > 0;
}

/* cook_torrance_has_channel_F - whether F of the channels differs. */
static inline bool cook_torrance_has_channel_F(const struct cook_torrance *model)
{
	return model->fresnel == FRESNEL_F82 || model->per_channel_ior;
}

/* cook_torrance_is_rich - whether the model is more than kd and a lobe whose F all channels share. */
static inline bool cook_torrance_is_rich(const struct cook_torrance *model)
{
	return cook_torrance_has_channel_F(model) || cook_torrance_has_second(model) ||
	       cook_torrance_has_grazing(model);
}

/* cook_torrance_F - F of channel c, 0 .. 2; channels differ where cook_torrance_has_channel_F() says so. */
double cook_torrance_F(const struct cook_torrance *model, int c, double cos_d);

/* cook_torrance_facets - D G / (4 cos_i cos_o) of one distribution, 1/sr, and cos_d of the half vector: what F is a factor of.
 * Accuracy and edges are those of cook_torrance_lobe(). */
double cook_torrance_facets(const struct ndf *ndf, enum gaf gaf, struct vec3 wi, struct vec3 wo, double *cos_d);

/* cook_torrance_grazing - the diffuse term of grazing directions for kg = 1, 1/sr: with the exponent p,
 *
 *     g = cos_d^2 ((1 - cos_i)^p + (1 - cos_o)^p) / pi,
 *
 * what roughness adds to Burley's diffuse term [Burley 2012, section 5.3, there p = 5] where it is small. */
double cook_torrance_grazing(double exponent, double cos_i, double cos_o, double cos_d);

/* cook_torrance_lobe - F D G / (4 cos_i cos_o), 1/sr: the specular term for ks = 1, with F = 1 for FRESNEL_F82 and that of the
 * first channel where channels have an index each. Symmetric in wi and wo to rounding;
 * 0 unless cos_i, cos_o > 0. Relative error at most 1e-14 + 2e-15 |d ln D/d ln tan^2(theta_h)| beside that of G1
 * [ndf.h], for cosines above 1e-270 down to values of 1e-300; D underflows to 0 first. Closer to the horizon 1/cos
 * overflows, and so may this. */
double cook_torrance_lobe(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo);

/* cook_torrance_from_G, cook_torrance_from_G1 - the same term put together by callers that have its factors in tables, for
 * cosines above 1e-9: from D F and G, or from D F and G1 of either direction (not for GAF_V_GROOVE).
 * cosines: cos_i cos_o. */
static inline double cook_torrance_from_G(double DF, double G, double cosines)
{
	return DF * G / (4 * cosines);
}

static inline double cook_torrance_from_G1(enum gaf gaf, double DF, double G1_i, double G1_o, double cosines)
{
	if (gaf == GAF_UNCORRELATED)
		return DF * G1_i * G1_o / (4 * cosines);
	return G1_i > 0 && G1_o > 0 ? DF / (4 * cosines * (1 / G1_i + 1 / G1_o - 1)) : 0;
}

/* cook_torrance_f - the BRDF in three channels, 1/sr; all 0 unless cos_i, cos_o > 0. */
void cook_torrance_f(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo, double f[3]);

#endif
