/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json_check - whether text is JSON (RFC 8259) in UTF-8, and nothing else. */
#ifndef JSON_CHECK_H
#define JSON_CHECK_H

#include "data_readers/text_quote.h"
#include <ctype.h>
#include <stdbool.h>
#include <string.h>

static inline void json_skip_space(const char **at)
{
	*at += strspn(*at, " \t\r\n");
}

static inline bool json_take(const char **at, const char *token)
{
	const bool there = strncmp(*at, token, strlen(token)) == 0;
	*at += there ? strlen(token) : 0;
	return there;
}

static inline bool json_digits(const char **at)
{
	const size_t n = strspn(*at, "0123456789");
	*at += n;
	return n > 0;
}

static inline bool json_number(const char **at)
{
	json_take(at, "-");
	if (!json_take(at, "0") && !json_digits(at))
		return false;
	if (json_take(at, ".") && !json_digits(at))
		return false;
	if (**at != 'e' && **at != 'E')
		return true;
	++*at;
	*at += **at == '+' || **at == '-';
	return json_digits(at);
}

static inline bool json_escape(const char **at)
{
	if (!json_take(at, "u")) {
		const bool known = **at && strchr("\"\\/bfnrt", **at);
		*at += known;
		return known;
	}
	for (int i = 0; i < 4; i++, ++*at)
		if (!isxdigit((unsigned char)**at))
			return false;
	return true;
}

/* Line separators, which text_printable() knows not, are allowed in JSON; the program escapes them. */
static inline bool json_string(const char **at)
{
	if (!json_take(at, "\""))
		return false;
	while (**at != '"') {
		const size_t length = text_printable(*at);
		if (length == 0)
			return false; /* the end of the text, a control character, or no UTF-8 */
		const bool escape = **at == '\\';
		*at += length;
		if (escape && !json_escape(at))
			return false;
	}
	++*at;
	return true;
}

static inline bool json_value(const char **at, int depth);

/* What stands between the brackets of an array, or of an object, whose values have a name each. */
static inline bool json_members(const char **at, const char *end, bool named, int depth)
{
	json_skip_space(at);
	if (json_take(at, end))
		return true;
	do {
		json_skip_space(at);
		if (named && !json_string(at))
			return false;
		json_skip_space(at);
		if (named && !json_take(at, ":"))
			return false;
		if (!json_value(at, depth))
			return false;
	} while (json_take(at, ","));
	return json_take(at, end);
}

static inline bool json_value(const char **at, int depth)
{
	bool sound;
	json_skip_space(at);
	if (depth > 64)
		return false;
	if (json_take(at, "{"))
		sound = json_members(at, "}", true, depth + 1);
	else if (json_take(at, "["))
		sound = json_members(at, "]", false, depth + 1);
	else if (**at == '"')
		sound = json_string(at);
	else
		sound = json_take(at, "null") || json_take(at, "true") || json_take(at, "false") || json_number(at);
	json_skip_space(at);
	return sound;
}

static inline bool json_is_valid(const char *text)
{
	return json_value(&text, 0) && *text == '\0';
}

#endif
