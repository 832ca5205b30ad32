/* SPDX-License-Identifier: GPL-3.0-or-later */
/* alta - text files of ALTA, the "Analysis of Bidirectional Reflectance Distribution Functions".
 *
 * Lines "#KEY words": DIM (numbers of coordinates and of values in a row), PARAM_IN (what the coordinates are),
 * PARAM_OUT (what the values are), VS (how many columns of confidence follow for each value: 0, 1 or 2; they are not
 * used). Then a row of numbers, between blanks, per sample. Angles are in radians. Understood are, of L the light and V
 * the view direction:
 *   SPHERICAL_TL_PL_TV_PV       theta_L, phi_L, theta_V, phi_V
 *   ISOTROPIC_TV_TL_DPHI        theta_V, theta_L, phi_V - phi_L
 *   ISOTROPIC_TL_TV_PROJ_DPHI   theta_L, theta_V cos(phi_V - phi_L), theta_V sin(phi_V - phi_L)
 *   RUSIN_TH_TD_PD              theta_h, theta_d, phi_d
 *   RUSIN_TH_PH_TD_PD           theta_h, phi_h, theta_d, phi_d
 *   CARTESIAN                   the vectors V and L
 * and the values INV_STERADIAN, INV_STERADIAN_COSINE_FACTOR (times the cosine of theta_V), RGB_COLOR, XYZ_COLOR; one
 * value is gray, three are linear sRGB but for XYZ_COLOR. */
#ifndef ALTA_H
#define ALTA_H

#include "data_readers/text_format.h"

extern const struct text_format alta;

#endif
