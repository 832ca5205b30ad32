/* SPDX-License-Identifier: GPL-3.0-or-later */
/* csv_number - numbers as text that reads back exactly. */
#ifndef CSV_NUMBER_H
#define CSV_NUMBER_H

#include <stdbool.h>

/* csv_number - x in the fewest of 15, 16 or 17 digits that read back exactly; "" for NaN; "inf", "-inf". */
enum { CSV_NUMBER_SIZE = 32 };
const char *csv_number(char text[CSV_NUMBER_SIZE], double x);
/* csv_parse_number - the reverse: decimal notation, "inf" or "-inf", nothing before or after it. "" gives NaN.
 * Returns false, *x untouched, for anything else, numbers beyond a double's range among them. */
bool csv_parse_number(const char *text, double *x);

#endif
