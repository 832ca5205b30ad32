/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/csv_number.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char *csv_number(char text[CSV_NUMBER_SIZE], double x)
{
	text[0] = '\0';
	for (int digits = 15; digits <= 17 && !isnan(x); digits++) {
		snprintf(text, CSV_NUMBER_SIZE, "%.*g", digits, x);
		if (strtod(text, NULL) == x)
			break;
	}
	return text;
}

bool csv_parse_number(const char *text, double *x)
{
	if (!*text) {
		*x = NAN;
		return true;
	}
	const bool infinite = !strcmp(text, "inf") || !strcmp(text, "-inf");
	if (!infinite && text[strspn(text, "+-.0123456789eE")])
		return false;
	char *end;
	const double value = strtod(text, &end);
	if (end == text || *end || (isinf(value) && !infinite))
		return false;
	*x = value;
	return true;
}
