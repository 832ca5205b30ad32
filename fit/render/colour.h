/* SPDX-License-Identifier: GPL-3.0-or-later */
/* colour - from linear light to what a screen shows, and how different two colours look.
 *
 * rgb are linear components with the primaries and the white (D65) of sRGB, 1 the white of the screen; lab is CIELAB for
 * that white. */
#ifndef COLOUR_H
#define COLOUR_H

/* srgb_encode, srgb_decode - the transfer function of sRGB [IEC 61966-2-1] and its inverse, [0, 1] to [0, 1]; what is
 * outside counts as the nearer end, NaN as 0. The two pieces join to 3e-8 in the value, as the standard has them. */
double srgb_encode(double linear);
double srgb_decode(double encoded);

/* colour_luminance - Y of CIE 1931, 1 for white. */
double colour_luminance(const double rgb[3]);

/* colour_lab - L*, a*, b* [CIE 15]. Components below 0 or above 1 are taken as they are; white gives 100, 0, 0 within
 * 1e-12. */
void colour_lab(const double rgb[3], double lab[3]);

/* delta_e_2000 - CIEDE2000 with unit weights [CIE 142; Sharma, Wu and Dalal 2005]: 1 is about what one can just see.
 * Symmetric; 0 for equal colours. Jumps a little (below 1 %) where two hues are opposite, as the formula does. */
double delta_e_2000(const double lab_1[3], const double lab_2[3]);

/* false_colour - a colour scale for t in [0, 1], what is outside counting as the nearer end, NaN as 0: from near black
 * over blue, red and yellow to near white. Its lightness L* rises in proportion to t, from 5 to 95. */
void false_colour(double t, double rgb[3]);

#endif
