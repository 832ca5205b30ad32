/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/page/html.h"
#include "data_readers/text_quote.h"

#include <errno.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Writes the first character; returns how many bytes it takes. */
static size_t put_character(FILE *page, const char *text)
{
	const size_t length = text_printable(text);
	if (strchr("&<>\"'", *text))
		fprintf(page, "&#%d;", *text);
	else if (length)
		fwrite(text, 1, length, page);
	else
		fprintf(page, "\\x%02x", (unsigned)(unsigned char)*text);
	return length ? length : 1;
}

void html_text(FILE *page, const char *text)
{
	while (*text)
		text += put_character(page, text);
}

/* Greek letters are two bytes in UTF-8, the first of which is one of these. */
static bool is_greek(const char *text, size_t length)
{
	return length == 2 && (*text == '\xce' || *text == '\xcf');
}

void html_typeset(FILE *page, const char *text)
{
	bool greek = false;
	while (*text) {
		const bool index = greek && text[0] == '_' && text[1] >= 'a' && text[1] <= 'z';
		size_t length = 2;
		if (index)
			fprintf(page, "<sub>%c</sub>", text[1]);
		else
			length = put_character(page, text);
		greek = !index && is_greek(text, length);
		text += length;
	}
}

/* RFC 4648, section 4: three bytes become four characters; = fills up the end. */
static void put_base64(FILE *page, const unsigned char *byte, size_t n)
{
	static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	for (size_t left = n; left > 0; byte += 3) {
		const unsigned second = left > 1 ? byte[1] : 0, third = left > 2 ? byte[2] : 0;
		const unsigned bits = (unsigned)byte[0] << 16 | second << 8 | third;
		fputc(digit[bits >> 18], page);
		fputc(digit[bits >> 12 & 63], page);
		fputc(left > 1 ? digit[bits >> 6 & 63] : '=', page);
		fputc(left > 2 ? digit[bits & 63] : '=', page);
		left -= left < 3 ? left : 3;
	}
}

enum status html_file(FILE *page, const char *path, const char *type, struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	unsigned char *bytes = NULL;
	long size = -1;
	text_quote(path, name, sizeof name);
	FILE *file = fopen(path, "rb");
	if (!file)
		return error_set(error, STATUS_IO, "cannot read '%s': %s", name, strerror(errno));
	if (!fseek(file, 0, SEEK_END))
		size = ftell(file);
	rewind(file);
	if (size >= 0)
		bytes = malloc((size_t)size + 1);
	const bool whole = bytes && fread(bytes, 1, (size_t)size, file) == (size_t)size;
	fclose(file);
	if (whole) {
		fprintf(page, "data:%s;base64,", type);
		put_base64(page, bytes, (size_t)size);
	}
	free(bytes);
	return whole ? STATUS_OK : error_set(error, STATUS_IO, "cannot read '%s' as a whole", name);
}
