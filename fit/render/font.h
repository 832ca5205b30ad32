/* SPDX-License-Identifier: GPL-3.0-or-later */
/* font - small labels on pictures: the printable characters of ASCII in 5 x 9 dots. */
#ifndef FONT_H
#define FONT_H

#include "fit/render/image.h"

enum { FONT_ADVANCE = 6, FONT_HEIGHT = 9 }; /* dots from one character to the next; dots of a line */

/* font_draw - writes `text` with its upper left corner at (x, y), `scale` pixels a dot, no wider than `width` pixels:
 * what does not fit is left out and its end becomes "..". Other characters than ASCII's appear as ?, what is outside
 * the picture not at all. Returns the width in pixels. */
int font_draw(const struct image *image, int x, int y, int scale, int width, const char *text, const float rgb[3]);

#endif
