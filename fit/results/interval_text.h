/* SPDX-License-Identifier: GPL-3.0-or-later */
/* interval_text - the intervals of a row, for people. */
#ifndef INTERVAL_TEXT_H
#define INTERVAL_TEXT_H

#include "fit/results/result.h"

enum { INTERVAL_TEXT_SIZE = 256 };

/* interval_text - those of one parameter with four digits, as "0.04787 to 0.05164 or 0.1043 to 0.1543"; an end that the data
 * do not set as "<=1" or ">=100". "" where the row has none. What does not fit is left out from the end, interval by
 * interval. */
const char *interval_text(char text[INTERVAL_TEXT_SIZE], char *const *row, enum interval_parameter parameter);

#endif
