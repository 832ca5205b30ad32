/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/text_format.h"
#include "data_readers/spectrum.h"
#include "data_readers/text_number.h"
#include "data_readers/text_quote.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum status channels_spectrum(struct channels *channels, double *nm, size_t n)
{
	*channels = (struct channels){.n = n, .spectral = true, .nm = nm};
	channels->weight = calloc(3 * n, sizeof *channels->weight);
	return channels->weight ? spectrum_weights(nm, n, channels->weight) : STATUS_NO_MEMORY;
}

void channels_free(struct channels *channels)
{
	free(channels->weight);
	free(channels->nm);
	*channels = (struct channels){0};
}

static bool is_gray(const struct channels *channels)
{
	return channels->spectral ? !spectrum_has_colour(channels->nm, channels->n) : channels->n == 1;
}

void channels_note(const struct channels *channels, struct entry_list *list)
{
	list->gray = is_gray(channels);
	list->n_channels = (int)channels->n;
}

/* What is wrong with the values as they stand in the file: the count that it adds to, or NULL. */
static size_t *fault_of(const struct channels *channels, const double *value, struct entry_list *list)
{
	bool negative = false, zero = true, finite = true;
	for (size_t j = 0; j < channels->n; j++) {
		negative = negative || value[j] < 0;
		zero = zero && value[j] == 0;
		finite = finite && isfinite(value[j]);
	}
	if (!channels->spectral)
		return NULL;
	return !finite ? &list->n_nonfinite : negative ? &list->n_negative : zero ? &list->n_missing : NULL;
}

enum status channels_add(const struct channels *channels, enum quantity quantity, struct vec3 wi, struct vec3 wo,
			 const double *value, double solid_angle, struct entry_list *list)
{
	struct entry entry = {.wi = wi, .wo = wo, .solid_angle = solid_angle};
	const double factor = quantity_factor(quantity, wo.z);
	const bool above = wi.z > ENTRY_HORIZON && wo.z > ENTRY_HORIZON;
	size_t *fault = above ? fault_of(channels, value, list) : NULL;
	if (fault) {
		++*fault;
		return STATUS_OK;
	}
	if (channels->spectral)
		spectrum_rgb(channels->weight, value, channels->n, entry.value);
	for (size_t c = 0; c < MERL_CHANNELS; c++)
		entry.value[c] = factor * (channels->spectral ? entry.value[c] : value[channels->n == 1 ? 0 : c]);
	return entry_list_add(list, &entry, channels->spectral || channels->derived);
}

struct vec3 direction(double theta, double phi)
{
	double sin_theta, cos_theta, sin_phi, cos_phi;
	sincos(theta, &sin_theta, &cos_theta);
	sincos(phi, &sin_phi, &cos_phi);
	return (struct vec3){sin_theta * cos_phi, sin_theta * sin_phi, cos_theta};
}

bool text_line(const char **text, char *line, size_t size)
{
	if (!**text)
		return false;
	const size_t length = strcspn(*text, "\n"), kept = length < size - 1 ? length : size - 1;
	memcpy(line, *text, kept);
	line[kept] = '\0';
	line[strcspn(line, "\r")] = '\0';
	*text += length + ((*text)[length] == '\n');
	return true;
}

bool line_is_comment(const char *line)
{
	line = line_skip_space((char *)line);
	return !*line || *line == '#';
}

enum status line_next_used(struct line_reader *lines, char **line, struct error *why)
{
	enum status status;
	do
		status = line_reader_next(lines, line, why);
	while (status == STATUS_OK && *line && line_is_comment(*line));
	return status;
}

enum status line_numbers(const struct line_reader *lines, const char *line, double *to, size_t max, size_t *n,
			 struct error *why)
{
	*n = 0;
	for (line = line_skip_space((char *)line); *line; ++*n) {
		double number;
		const char *start = line;
		if (!text_number(&line, &number) || (*line && *line != ' ' && *line != '\t')) {
			char word[32], shown[64];
			snprintf(word, sizeof word, "%.*s", (int)strcspn(start, " \t"), start);
			text_quote(word, shown, sizeof shown);
			return line_error(lines, why, "expected a number, found '%s'", shown);
		}
		if (*n < max)
			to[*n] = number;
		line = line_skip_space((char *)line);
	}
	return STATUS_OK;
}
