/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/angles.h"
#include "data_readers/text_quote.h"
#include "fit/results/csv_number.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The number before the next `between` or the end; *text then points behind that, or is NULL at the end. */
static bool next_number(const char **text, char between, double *x)
{
	char word[CSV_NUMBER_SIZE];
	const char *end = strchr(*text, between);
	const size_t length = end ? (size_t)(end - *text) : strlen(*text);
	if (!length || length >= sizeof word)
		return false;
	memcpy(word, *text, length);
	word[length] = '\0';
	*text = end ? end + 1 : NULL;
	return csv_parse_number(word, x) && isfinite(*x);
}

static bool parse_range(const char *text, struct angles *angles)
{
	double x[3];
	for (int i = 0; i < 3; i++)
		if (!text || !next_number(&text, ':', &x[i]))
			return false;
	/* If decimal rounding leaves the last step just short of the end, the end is included. */
	const double steps = floor((x[1] - x[0]) / x[2] * (1 + 1e-12) + 1e-9);
	if (text || !(x[2] > 0) || !(steps >= 0 && steps < ANGLES_MAX))
		return false;
	angles->n = (size_t)steps + 1;
	angles->deg = malloc(angles->n * sizeof *angles->deg);
	for (size_t i = 0; angles->deg && i < angles->n; i++)
		angles->deg[i] = fmin(x[0] + (double)i * x[2], x[1]);
	return true;
}

static bool parse_list(const char *text, struct angles *angles)
{
	size_t room = 1;
	for (const char *at = text; *at; at++)
		room += *at == ',';
	if (room > ANGLES_MAX)
		return false;
	angles->deg = malloc(room * sizeof *angles->deg);
	while (angles->deg && text)
		if (!next_number(&text, ',', &angles->deg[angles->n++]))
			return false;
	return true;
}

enum status angles_parse(const char *text, double min, double max, struct angles *angles, struct error *error)
{
	char shown[TEXT_QUOTE_SIZE];
	*angles = (struct angles){0};
	bool valid = strchr(text, ':') ? parse_range(text, angles) : parse_list(text, angles);
	if (valid && !angles->deg)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	for (size_t i = 0; valid && i < angles->n; i++)
		valid = angles->deg[i] >= min && angles->deg[i] <= max;
	if (valid)
		return STATUS_OK;
	angles_free(angles);
	text_quote(text, shown, sizeof shown);
	return error_set(error, STATUS_DOMAIN,
			 "bad angles '%s': expected START:END:STEP or A,B,..., degrees from %g to %g", shown, min, max);
}

void angles_free(struct angles *angles)
{
	free(angles->deg);
	*angles = (struct angles){0};
}
