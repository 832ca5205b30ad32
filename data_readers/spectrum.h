/* SPDX-License-Identifier: GPL-3.0-or-later */
/* spectrum - reflectance spectra as linear sRGB.
 *
 * A spectrum is linear between its wavelengths and constant beyond them. It is summed from 380 to 780 nm in steps of 1
 * nm with the colour matching functions of the CIE 1931 standard observer (2 degrees) and the illuminant D65, both
 * tabulated at 5 nm [CIE 15:2004] and linear between; then to linear sRGB [IEC 61966-2-1]. Each channel is divided by
 * its own sum, so that a reflectance of 1 at all wavelengths is 1, 1, 1. */
#ifndef SPECTRUM_H
#define SPECTRUM_H

#include "src/status.h"
#include <stdbool.h>
#include <stddef.h>

/* spectrum_has_colour - whether wavelengths nm[0 .. n-1], rising, reach far enough for a colour: from 450 nm or below
 * to 650 nm or above, with at least three. Of others only a gray value is known. */
bool spectrum_has_colour(const double *nm, size_t n);

/* spectrum_weights - weight[c * n + j], by which the value at nm[j] counts in channel c. Where the wavelengths have no
 * colour the three weights are 1 / n: the mean, gray. STATUS_DOMAIN: not n >= 1 finite wavelengths above 0 that
 * rise. */
MUST_CHECK enum status spectrum_weights(const double *nm, size_t n, double *weight);

/* spectrum_rgb - the sums of the n values with these weights. */
void spectrum_rgb(const double *weight, const double *value, size_t n, double rgb[3]);

/* spectrum_xyz_to_rgb - linear sRGB of tristimulus values, whose white is that of D65 with Y = 1. */
void spectrum_xyz_to_rgb(const double xyz[3], double rgb[3]);

/* struct spectrum_bands - spectra of three flat bands with steps at 495 and 590 nm: the channels of one, and the bands of a
 * colour. With these limits the spectrum of every colour of sRGB is nowhere negative; bands of other limits, or spectra
 * linear between three wavelengths, lack that. A gray one is flat. */
enum { SPECTRUM_BANDS = 3 };

struct spectrum_bands {
	double to_rgb[3][SPECTRUM_BANDS];   /* channel c = sum of to_rgb[c][b] band b */
	double from_rgb[SPECTRUM_BANDS][3]; /* the inverse */
};

/* spectrum_band_nm - where band b begins, [2 b], and ends, [2 b + 1]; linear between them. */
extern const double spectrum_band_nm[2 * SPECTRUM_BANDS];

MUST_CHECK enum status spectrum_bands(struct spectrum_bands *bands);

#endif
