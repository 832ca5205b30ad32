/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/cornell.h"
#include "data_readers/text_number.h"
#include <stdlib.h>
#include <string.h>

enum {
	ANGLES = 4,
	WAVELENGTHS_MAX = 4096,
};

static enum status read_count(struct line_reader *lines, size_t *count, struct error *why)
{
	char *line;
	double number = 0;
	size_t n = 0;
	enum status status = line_next_used(lines, &line, why);
	if (status == STATUS_OK && line)
		status = line_numbers(lines, line, &number, 1, &n, why);
	if (status != STATUS_OK)
		return status;
	if (n != 1 || !(number >= 1 && number <= WAVELENGTHS_MAX) || number != floor(number))
		return line_error(lines, why, "expected the number of wavelengths, 1 to %d, alone", WAVELENGTHS_MAX);
	*count = (size_t)number;
	return STATUS_OK;
}

static enum status read_wavelengths(struct line_reader *lines, double *nm, size_t count, struct error *why)
{
	for (size_t got = 0, n; got < count; got += n) {
		char *line;
		enum status status = line_next_used(lines, &line, why);
		if (status == STATUS_OK && line)
			status = line_numbers(lines, line, nm + got, count - got, &n, why);
		if (status != STATUS_OK)
			return status;
		if (!line || n > count - got)
			return line_error(lines, why, "expected %zu wavelengths, found %s", count,
					  line ? "more" : "fewer");
	}
	return STATUS_OK;
}

static enum status read_rows(struct line_reader *lines, const struct channels *channels, enum quantity quantity,
			     double *row, struct entry_list *list, struct error *why)
{
	const size_t wanted = ANGLES + channels->n;
	for (;;) {
		char *line;
		size_t n;
		enum status status = line_next_used(lines, &line, why);
		if (status != STATUS_OK || !line)
			return status;
		status = line_numbers(lines, line, row, wanted, &n, why);
		if (status != STATUS_OK)
			return status;
		if (n != wanted)
			return line_error(lines, why, "expected %zu values, found %zu", wanted, n);
		if (channels_add(channels, quantity, direction(row[0], row[1]), direction(row[2], row[3]), row + ANGLES,
				 0, list) != STATUS_OK)
			return error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	}
}

static enum status parse(struct line_reader *lines, const struct read_options *options, struct entry_list *list,
			 struct error *why)
{
	struct channels channels = {0};
	size_t count = 0;
	enum status status = read_count(lines, &count, why);
	if (status != STATUS_OK)
		return status;
	double *nm = calloc(count, sizeof *nm), *row = calloc(ANGLES + count, sizeof *row);
	status = nm && row ? read_wavelengths(lines, nm, count, why)
			   : error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	if (status == STATUS_OK) {
		status = channels_spectrum(&channels, nm, count);
		nm = NULL;
		if (status == STATUS_DOMAIN)
			status = line_error(lines, why, "expected wavelengths that rise");
		else if (status != STATUS_OK)
			error_set(why, status, "%s", status_str(status));
	}
	if (status == STATUS_OK) {
		channels_note(&channels, list);
		status = read_rows(lines, &channels, options->quantity, row, list, why);
	}
	channels_free(&channels);
	free(nm);
	free(row);
	return status;
}

/* A number alone, then wavelengths. */
static enum match detect(const char *text)
{
	char line[1024];
	int numbers_seen = 0;
	while (text_line(&text, line, sizeof line)) {
		const char *at = line_skip_space(line);
		double number;
		if (line_is_comment(line))
			continue;
		if (!text_number(&at, &number))
			return MATCH_NONE;
		const bool alone = !*line_skip_space((char *)at);
		if (numbers_seen++ == 0 && (!alone || !(number >= 1) || number != floor(number)))
			return MATCH_NONE;
		if (numbers_seen == 2)
			return number >= 100 && number <= 20000 && strspn(at, " \t") ? MATCH_SURE
			       : number >= 100 && number <= 20000 && !*at            ? MATCH_MAYBE
										     : MATCH_NONE;
	}
	return MATCH_NONE;
}

const struct text_format cornell = {detect, parse};
