/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_number - decimal numbers in a text, whatever the locale. */
#ifndef TEXT_NUMBER_H
#define TEXT_NUMBER_H

#include <stdbool.h>

/* text_number - the number that *text begins with, to *value, and steps over it: a sign, digits with a point, an
 * exponent; or nan, inf, infinity in any case. Within 2 ulp of the decimal number, exact for up to 15 digits and
 * exponents to 22. Beyond the range of double it becomes 0 or infinite. False: there is no number, and nothing is
 * changed. No space is skipped. */
bool text_number(const char **text, double *value);

#endif
