/* SPDX-License-Identifier: GPL-3.0-or-later */
/* energy - how much of the light from one direction a surface sends back: the white-furnace balance of the STD paper
 * (eq. 24), per incident direction,
 *     integral over wo of f(wi, wo) cos_o,
 * which is 1 for a lossless surface; single scattering between mirror facets (no Fresnel) falls short of it by the
 * light that would have been scattered again. */
#ifndef ENERGY_H
#define ENERGY_H

#include "cook_torrance.h"

/* energy_lobe - directional albedo of the microfacet lobe for ks = 1; of FRESNEL_NONE, the furnace balance.
 * Given:   an isotropic model; cos_i in (0, 1]
 * Returns: STATUS_OK and *albedo, absolute error at most 1e-8 (the kinks of the V-groove: 1e-6); STATUS_DOMAIN for
 * cos_i out of range, STATUS_UNSUPPORTED for sigma_x != sigma_y; *albedo is untouched then. Note:    by nested
 * quadrature: 1 to 10 ms, 30 ms for the V-groove, 70 ms for gtr and low. */
MUST_CHECK enum status energy_lobe(const struct cook_torrance *model, double cos_i, double *albedo);

/* energy_albedo - directional albedo of the whole model, kd_c + ks_c times that of the lobe, c = red, green, blue. */
MUST_CHECK enum status energy_albedo(const struct cook_torrance *model, double cos_i, double albedo[3]);

#endif
