/* SPDX-License-Identifier: GPL-3.0-or-later */
/* cornell - text files of the Cornell light measurement laboratory, as pbrt-v2 reads them.
 *
 * Lines that begin with # are comments. First the number of wavelengths, then the wavelengths (nm, rising), then a line
 * per sample: theta_i, phi_i, theta_s, phi_s (radians; s is the scattered direction) and a value of the BRDF (1/sr) for
 * each wavelength. */
#ifndef CORNELL_H
#define CORNELL_H

#include "data_readers/text_format.h"

extern const struct text_format cornell;

#endif
