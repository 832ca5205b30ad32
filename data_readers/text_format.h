/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_format - what the readers of text formats share: the steps from the values of a row to an entry. */
#ifndef TEXT_FORMAT_H
#define TEXT_FORMAT_H

#include "data_readers/entry_list.h"
#include "data_readers/line_reader.h"
#include "data_readers/quantity.h"

/* How sure a format is that a file is its own. */
enum match {
	MATCH_NONE,
	MATCH_MAYBE, /* it looks like it: to be read if it is named, not if it lies in a directory */
	MATCH_SURE
};

/* struct text_format - a reader. Both take text; `parse` adds the entries to the list. Its errors name the line but not
 * the file: STATUS_FORMAT, STATUS_UNSUPPORTED, STATUS_IO, STATUS_NO_MEMORY. */
struct text_format {
	enum match (*detect)(const char *text); /* the beginning of the file, terminated */
	enum status (*parse)(struct line_reader *lines, const struct read_options *options, struct entry_list *list,
			     struct error *why);
};

/* struct channels - how the values of a row become three: n = 1, gray; 3, red, green, blue; or a spectrum. */
struct channels {
	size_t n;
	bool spectral;
	bool derived;   /* the three were computed from something else */
	double *weight; /* of spectrum.h; owned; NULL if not spectral */
	double *nm;     /* owned, likewise */
};

/* channels_spectrum - takes over nm[0 .. n-1], in the order of the values; STATUS_DOMAIN unless they rise. */
MUST_CHECK enum status channels_spectrum(struct channels *channels, double *nm, size_t n);
void channels_free(struct channels *channels);

/* channels_add - adds an entry from directions and n values of a quantity. An entry whose spectrum is 0
 * everywhere is counted as missing, one with a negative value in its spectrum as negative. STATUS_NO_MEMORY. */
MUST_CHECK enum status channels_add(const struct channels *channels, enum quantity quantity, struct vec3 wi,
				    struct vec3 wo, const double *value, double solid_angle, struct entry_list *list);

/* channels_note - puts what the list needs to know about the channels into it. */
void channels_note(const struct channels *channels, struct entry_list *list);

/* direction - the unit vector of a polar angle and an azimuth, radians. */
struct vec3 direction(double theta, double phi);

/* line_is_comment - whether a line is blank or begins with #. line_next_used - the next line that is not; NULL at the
 * end. */
bool line_is_comment(const char *line);
MUST_CHECK enum status line_next_used(struct line_reader *lines, char **line, struct error *why);

/* line_numbers - the numbers of a line, between blanks and tabs: the first `max` of them into to[], how many there are
 * into *n. STATUS_FORMAT: something that is no number. */
MUST_CHECK enum status line_numbers(const struct line_reader *lines, const char *line, double *to, size_t max,
				    size_t *n, struct error *why);

/* text_line - copies the next line of *text, at most size - 1 bytes, without its end, and steps behind it; false at the
 * end. */
bool text_line(const char **text, char *line, size_t size);

#endif
