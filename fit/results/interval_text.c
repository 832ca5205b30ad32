/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/interval_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *sign(char *const *row, enum result_column end, const char *when_open)
{
	return strstr(row[RESULT_OPEN_ENDS], result_columns[end].name) ? when_open : "";
}

/* Appends one "LO:HI" of the column of other intervals. */
static void add_other(char text[INTERVAL_TEXT_SIZE], const char *ends)
{
	char one[64], *rest;
	const double lo = strtod(ends, &rest);
	if (*rest != ':')
		return;
	const double hi = strtod(rest + 1, NULL);
	snprintf(one, sizeof one, " or %.4g to %.4g", lo, hi);
	if (strlen(text) + strlen(one) < INTERVAL_TEXT_SIZE)
		strcat(text, one);
}

const char *interval_text(char text[INTERVAL_TEXT_SIZE], char *const *row, enum interval_parameter parameter)
{
	const enum result_column lo = result_interval_column(parameter), hi = lo + 1;
	const char *name = interval_parameter_name(parameter);
	const size_t length = strlen(name);
	*text = '\0';
	if (isnan(result_number(row, lo)) || isnan(result_number(row, hi)))
		return text;
	snprintf(text, INTERVAL_TEXT_SIZE, "%s%.4g to %s%.4g", sign(row, lo, "<="), result_number(row, lo),
		 sign(row, hi, ">="), result_number(row, hi));
	for (const char *other = row[RESULT_OTHER_INTERVALS]; other && *other;) {
		if (!strncmp(other, name, length) && other[length] == '=')
			add_other(text, other + length + 1);
		other = strchr(other, ';');
		other += other ? 1 : 0;
	}
	return text;
}
