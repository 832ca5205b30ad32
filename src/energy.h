/* SPDX-License-Identifier: GPL-3.0-or-later */
/* energy - how much of the light from one direction a surface sends back: the white-furnace balance of the STD paper
 * (eq. 24), per incident direction,
 *     integral over wo of f(wi, wo) cos_o,
 * which is 1 for a lossless surface; single scattering between mirror facets (no Fresnel) falls short of it by the
 * light that would have been scattered again. */
#ifndef ENERGY_H
#define ENERGY_H

#include "src/cook_torrance.h"

/* energy_lobe - directional albedo of the microfacet lobe for ks = 1; of FRESNEL_NONE, the furnace balance.
 * Given:   an isotropic model, pl included; cos_i in [0, 1]: at 0 the limit at grazing incidence
 * Returns: STATUS_OK and *albedo, absolute error at most 1e-7, as a rule 1e-9 (pl: 1e-6); STATUS_DOMAIN for cos_i out of
 *          range, STATUS_UNSUPPORTED for sigma_x != sigma_y; *albedo is untouched then.
 * Note:    0.2 to 5 ms by nested quadrature, the longest for very sharp lobes at grazing incidence; gtr and low twice
 *          that. */
MUST_CHECK enum status energy_lobe(const struct cook_torrance *model, double cos_i, double *albedo);

/* energy_grazing - directional albedo of the diffuse term of grazing directions [cook_torrance_grazing()] for kg = 1, exactly;
 * exponent >= 1, cos_i in [0, 1]. */
double energy_grazing(double exponent, double cos_i);

/* energy_albedo - directional albedo of the whole model, kd_c + ks_c times that of the lobe, and what richer models add, c = red,
 * green, blue. */
MUST_CHECK enum status energy_albedo(const struct cook_torrance *model, double cos_i, double albedo[3]);

/* energy_albedo_max - the largest directional albedo of the whole model over all directions of incidence, c = red, green,
 * blue. More than 1 is more light than comes in, which no surface sends back.
 * Given:   as energy_lobe(), but that it may be anisotropic; ks >= 0
 * Returns: STATUS_OK; albedo[], absolute error 1e-5 for kd, ks up to 1; *theta_i, radians in [0, pi/2], where that is:
 *          one direction for all channels, as their lobes are alike; of a richer model, whose are not, that of the largest. Of an anisotropic lobe, the larger one of both axes'
 *          planes: between them it is not larger. STATUS_UNSUPPORTED for such a lobe with GAF_V_GROOVE.
 * Note:    evaluates about thirty directions and refines around the largest: 5 to 20 ms for STD, GGX and Beckmann, 60 ms
 *          for anisotropic ones; sharp lobes of gtr and low ten times as much. */
MUST_CHECK enum status energy_albedo_max(const struct cook_torrance *model, double albedo[3], double *theta_i);

/* energy_furnace - the white-furnace balance (eq. 24, over pi, which makes it 1 for a lossless surface) of a model's
 * distribution and G: the share of light from everywhere that comes back after one reflection on facets that lose nothing.
 * Given:   as energy_lobe(); F, kd and ks are taken as 1, 0 and 1
 * Returns: STATUS_OK; *balance, absolute error 1e-5. STATUS_UNSUPPORTED as above. */
MUST_CHECK enum status energy_furnace(const struct cook_torrance *model, double *balance);

#endif
