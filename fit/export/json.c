/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/export/json.h"
#include "data_readers/text_file.h"
#include "data_readers/text_quote.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH_MAX = 64, FILE_SIZE_MAX = 64 << 20 };

struct parser {
	const char *start, *at;
	int depth;
	struct error *error;
};

static enum status expected(const struct parser *p, const char *what)
{
	size_t line = 1;
	char found[16], quoted[TEXT_QUOTE_SIZE];
	for (const char *c = p->start; c < p->at; c++)
		line += *c == '\n';
	snprintf(found, sizeof found, "%.*s", (int)strcspn(p->at, "\r\n"), p->at);
	text_quote(found, quoted, sizeof quoted);
	return error_set(p->error, STATUS_FORMAT, "line %zu: expected %s, found '%s'", line, what, quoted);
}

static enum status no_memory(const struct parser *p)
{
	return error_set(p->error, STATUS_NO_MEMORY, "out of memory");
}

static void skip_space(struct parser *p)
{
	p->at += strspn(p->at, " \t\r\n");
}

static bool take(struct parser *p, char c)
{
	if (*p->at != c)
		return false;
	p->at++;
	return true;
}

/* Four hexadecimal digits; -1: they are none. */
static long hex4(const char *at)
{
	char digits[5] = "";
	if (strspn(at, "0123456789abcdefABCDEF") < 4)
		return -1;
	memcpy(digits, at, 4);
	return strtol(digits, NULL, 16);
}

static char *put_utf8(char *out, unsigned long code)
{
	if (code < 0x80) {
		*out++ = (char)code;
	} else if (code < 0x800) {
		*out++ = (char)(0xc0 | code >> 6);
		*out++ = (char)(0x80 | (code & 0x3f));
	} else if (code < 0x10000) {
		*out++ = (char)(0xe0 | code >> 12);
		*out++ = (char)(0x80 | (code >> 6 & 0x3f));
		*out++ = (char)(0x80 | (code & 0x3f));
	} else {
		*out++ = (char)(0xf0 | code >> 18);
		*out++ = (char)(0x80 | (code >> 12 & 0x3f));
		*out++ = (char)(0x80 | (code >> 6 & 0x3f));
		*out++ = (char)(0x80 | (code & 0x3f));
	}
	return out;
}

/* What stands behind \u, two of them for a character beyond 16 bits. Returns false where that is none. */
static bool take_unicode(struct parser *p, char **out)
{
	long code = hex4(p->at);
	if (code <= 0 || (code >= 0xdc00 && code <= 0xdfff))
		return false;
	p->at += 4;
	if (code >= 0xd800 && code <= 0xdbff) {
		const long low = p->at[0] == '\\' && p->at[1] == 'u' ? hex4(p->at + 2) : -1;
		if (low < 0xdc00 || low > 0xdfff)
			return false;
		code = 0x10000 + ((code - 0xd800) << 10) + (low - 0xdc00);
		p->at += 6;
	}
	*out = put_utf8(*out, (unsigned long)code);
	return true;
}

static bool take_escape(struct parser *p, char **out)
{
	static const char from[] = "\"\\/bfnrt", to[] = "\"\\/\b\f\n\r\t";
	const char c = *p->at;
	const char *found = c ? strchr(from, c) : NULL;
	if (found) {
		*(*out)++ = to[found - from];
		p->at++;
		return true;
	}
	return take(p, 'u') && take_unicode(p, out);
}

/* Bytes up to the quote that ends a string. */
static size_t string_length(const char *at)
{
	size_t n = 0;
	while (at[n] && at[n] != '"')
		n += at[n] == '\\' && at[n + 1] ? 2 : 1;
	return n;
}

/* A string, newly allocated; no escape makes text longer. */
static enum status parse_string(struct parser *p, char **text)
{
	if (!take(p, '"'))
		return expected(p, "a string");
	char *out = *text = malloc(string_length(p->at) + 1);
	if (!out)
		return no_memory(p);
	while (*p->at != '"') {
		if ((unsigned char)*p->at < 0x20)
			return expected(p, "the end of a string");
		if (*p->at != '\\') {
			*out++ = *p->at++;
			continue;
		}
		p->at++;
		if (!take_escape(p, &out))
			return expected(p, "an escape sequence");
	}
	p->at++;
	*out = '\0';
	return STATUS_OK;
}

static enum status parse_number(struct parser *p, struct json *json)
{
	const char *at = p->at + (*p->at == '-');
	const size_t digits = strspn(at, "0123456789");
	if (!digits || (*at == '0' && digits > 1))
		return expected(p, "a value");
	at += digits;
	if (*at == '.') {
		const size_t fraction = strspn(at + 1, "0123456789");
		if (!fraction)
			return expected(p, "a number");
		at += 1 + fraction;
	}
	if (*at == 'e' || *at == 'E') {
		const char *exponent = at + 1 + (at[1] == '+' || at[1] == '-');
		if (!strspn(exponent, "0123456789"))
			return expected(p, "a number");
		at = exponent + strspn(exponent, "0123456789");
	}
	char *end;
	json->type = JSON_NUMBER;
	json->number = strtod(p->at, &end);
	if (end != at || isinf(json->number))
		return expected(p, "a number in range");
	p->at = at;
	return STATUS_OK;
}

static enum status parse_value(struct parser *p, struct json *json);

static struct json *add_item(struct json *json)
{
	if ((json->n & (json->n - 1)) == 0) { /* full at powers of two, and at none */
		struct json *items = realloc(json->item, (json->n ? 2 * json->n : 1) * sizeof *items);
		if (!items)
			return NULL;
		json->item = items;
	}
	json->item[json->n] = (struct json){0};
	return &json->item[json->n++];
}

static enum status parse_items(struct parser *p, struct json *json, char end)
{
	if (++p->depth > DEPTH_MAX)
		return expected(p, "no deeper nesting");
	skip_space(p);
	for (bool first = true; !take(p, end); first = false) {
		if (!first && !take(p, ','))
			return expected(p, end == ']' ? "',' or ']'" : "',' or '}'");
		struct json *item = add_item(json);
		if (!item)
			return no_memory(p);
		skip_space(p);
		if (end == '}') {
			const enum status status = parse_string(p, &item->name);
			if (status)
				return status;
			skip_space(p);
			if (!take(p, ':'))
				return expected(p, "':'");
		}
		const enum status status = parse_value(p, item);
		if (status)
			return status;
		skip_space(p);
	}
	p->depth--;
	return STATUS_OK;
}

static bool take_word(struct parser *p, const char *word)
{
	if (strncmp(p->at, word, strlen(word)) != 0)
		return false;
	p->at += strlen(word);
	return true;
}

static enum status parse_value(struct parser *p, struct json *json)
{
	skip_space(p);
	if (*p->at == '{' || *p->at == '[') {
		json->type = *p->at++ == '{' ? JSON_OBJECT : JSON_ARRAY;
		return parse_items(p, json, json->type == JSON_OBJECT ? '}' : ']');
	}
	if (*p->at == '"') {
		json->type = JSON_STRING;
		return parse_string(p, &json->text);
	}
	static const char *const word[] = {[JSON_NULL] = "null", [JSON_FALSE] = "false", [JSON_TRUE] = "true"};
	for (enum json_type type = JSON_NULL; type <= JSON_TRUE; type++)
		if (take_word(p, word[type])) {
			json->type = type;
			return STATUS_OK;
		}
	return parse_number(p, json);
}

enum status json_parse(const char *text, struct json *json, struct error *error)
{
	struct parser p = {.start = text, .at = text, .error = error};
	*json = (struct json){0};
	enum status status = parse_value(&p, json);
	skip_space(&p);
	if (!status && *p.at)
		status = expected(&p, "the end");
	if (status)
		json_free(json);
	return status;
}

enum status json_read(const char *path, struct json *json, struct error *error)
{
	char *text, name[TEXT_QUOTE_SIZE];
	struct error why;
	size_t size;
	*json = (struct json){0};
	enum status status = text_file_read(path, "a model", FILE_SIZE_MAX, &text, &size, &why);
	if (!status)
		status = json_parse(text, json, &why);
	free(text);
	if (!status)
		return STATUS_OK;
	text_quote(path, name, sizeof name);
	return error_set(error, status, "cannot read '%s': %.200s", name, why.text);
}

void json_free(struct json *json)
{
	for (size_t i = 0; i < json->n; i++)
		json_free(&json->item[i]);
	free(json->item);
	free(json->name);
	free(json->text);
	*json = (struct json){0};
}

const struct json *json_member(const struct json *json, const char *name)
{
	for (size_t i = 0; json && json->type == JSON_OBJECT && i < json->n; i++)
		if (!strcmp(json->item[i].name, name))
			return &json->item[i];
	return NULL;
}
