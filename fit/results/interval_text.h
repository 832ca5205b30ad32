/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interval_text - how certain the parameters of a row are, for people. */
#ifndef INTERVAL_TEXT_H
#define INTERVAL_TEXT_H

#include "fit/results/result.h"

enum { INTERVAL_TEXT_SIZE = 256 };

/* interval_text - those of one parameter with four digits, as "0.04787 to 0.05164 or 0.1043 to 0.1543"; an end that the data
 * do not set as "<=1" or ">=100". "" where the row has none. What does not fit is left out from the end, interval by
 * interval. */
const char *interval_text(char text[INTERVAL_TEXT_SIZE], char *const *row, enum interval_parameter parameter);

enum { OTHER_BINS_SIZE = 512 };

/* other_bins_text - how far the parameters of a row move when the entries stand at the centres of their bins (column other_bins):
 * "E 0.3301, sigma +22.1 %, gamma -1.3 %, n +37 %, ks -4.02 %"; kd, ks and what else has three channels by their sums. An infinite or
 * vanishing one as "gamma inf to 30.1". "" where the row does not say. */
const char *other_bins_text(char text[OTHER_BINS_SIZE], char *const *row);

#endif
