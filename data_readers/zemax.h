/* SPDX-License-Identifier: GPL-3.0-or-later */
/* zemax - BSDF files of Zemax and of Radiant's imaging spheres (the "BSDF data interchange file format").
 *
 * Lines that begin with # are comments. Lines of a word and its value: Source, Symmetry (PlaneSymmetrical,
 * Asymmetrical, Asymmetrical4D), SpectralContent (Monochrome, XYZ), ScatterType (BRDF; BTDF is refused). Then
 * SampleRotation, AngleOfIncidence, ScatterAzimuth, ScatterRadial: each with a number and, on the next line, so many
 * angles (degrees). Then a block, or for XYZ three, between DataBegin and DataEnd: for each rotation and incidence a
 * line "TIS number" and a row of values (1/sr) over the radial angles for each azimuth.
 *
 * The scattered direction is given about the mirror direction: `radial` is the angle to it, `azimuth` is 0 towards the
 * normal and counted counter-clockwise. The format has no mark for what was not measured; instruments write 0 there,
 * which is counted as missing. At radial 0 all azimuths are one direction, of which the first is taken. XYZ becomes
 * linear sRGB, one channel gray. The solid angles are those of the grid. */
#ifndef ZEMAX_H
#define ZEMAX_H

#include "data_readers/text_format.h"

extern const struct text_format zemax;

#endif
