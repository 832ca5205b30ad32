/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/text_quote.h"
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { ESCAPE_LENGTH = 4 };

size_t text_character(const char *text, uint32_t *code)
{
	const unsigned char *s = (const unsigned char *)text;
	static const uint32_t smallest[] = {0, 0, 0x80, 0x800, 0x10000};
	size_t length = 0;

	*code = s[0];
	if (s[0] < 0x80)
		return s[0] != 0;
	while (s[0] & (0x80u >> length)) /* the leading ones of the first byte give the length */
		length++;
	if (length < 2 || length > 4)
		return 0;
	*code = s[0] & (0x7fu >> length);
	for (size_t i = 1; i < length; i++) {
		if ((s[i] & 0xc0) != 0x80)
			return 0;
		*code = *code << 6 | (s[i] & 0x3fu);
	}
	if (*code < smallest[length] || *code > 0x10ffff || (*code >= 0xd800 && *code <= 0xdfff))
		return 0;
	return length;
}

/* What moves the cursor, ends a line, or changes the order in which the text around it is shown. */
static bool is_control(uint32_t code)
{
	static const struct {
		uint32_t first, last;
	} controls[] = {
		{0, 0x1f},        /* C0 */
		{0x7f, 0x9f},     /* delete and C1 */
		{0x61c, 0x61c},   /* the Arabic letter mark, */
		{0x200e, 0x200f}, /* those of both directions, */
		{0x2028, 0x202e}, /* separators of lines and paragraphs, embeddings and overrides of direction, */
		{0x2066, 0x2069}, /* and isolates */
	};

	for (size_t c = 0; c < sizeof controls / sizeof *controls; c++)
		if (code >= controls[c].first && code <= controls[c].last)
			return true;
	return false;
}

size_t text_printable(const char *text)
{
	uint32_t code;
	const size_t length = text_character(text, &code);

	return length && !is_control(code) ? length : 0;
}

/* Quotes the character at *s into piece, steps over it and returns the length of the piece. */
static size_t quote_next(const unsigned char **s, char piece[ESCAPE_LENGTH + 1])
{
	const size_t length = text_printable((const char *)*s);

	if (length == 0) {
		snprintf(piece, ESCAPE_LENGTH + 1, "\\x%02x", (unsigned)**s);
		*s += 1;
		return ESCAPE_LENGTH;
	}
	memcpy(piece, *s, length);
	*s += length;
	return length;
}

void text_quote(const char *restrict s, char *restrict out, size_t size)
{
	static const char ellipsis[] = "...";
	const unsigned char *from = (const unsigned char *)s;
	char piece[ESCAPE_LENGTH + 1];
	size_t total = 0, used = 0;

	for (const unsigned char *at = from; *at;)
		total += quote_next(&at, piece);
	if (total >= size) {
		used = sizeof ellipsis - 1;
		memcpy(out, ellipsis, used);
		while (total + used >= size)
			total -= quote_next(&from, piece);
	}
	while (*from) {
		const size_t length = quote_next(&from, piece);
		memcpy(out + used, piece, length);
		used += length;
	}
	out[used] = '\0';
}
