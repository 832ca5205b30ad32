/* SPDX-License-Identifier: GPL-3.0-or-later */
/* json - reads JSON (RFC 8259) into a tree. */
#ifndef JSON_H
#define JSON_H

#include "src/status.h"
#include <stdbool.h>
#include <stddef.h>

enum json_type { JSON_NULL, JSON_FALSE, JSON_TRUE, JSON_NUMBER, JSON_STRING, JSON_ARRAY, JSON_OBJECT };

/* struct json - one value; the tree is freed through its root. */
struct json {
	enum json_type type;
	char *name;        /* of a member of an object; else NULL */
	double number;     /* JSON_NUMBER */
	char *text;        /* JSON_STRING: UTF-8, terminated; a \u0000 in it is refused */
	struct json *item; /* JSON_ARRAY, JSON_OBJECT: what it has, in order */
	size_t n;
};

/* json_parse - the one value that `text` holds, with white space around it.
 * Errors: STATUS_FORMAT (line, expected, found; nesting beyond 64; a number beyond a double's range), STATUS_NO_MEMORY.
 * *json then holds nothing. */
MUST_CHECK enum status json_parse(const char *text, struct json *json, struct error *error);
/* json_read - the same of a file of at most 64 MB; errors name it. Also STATUS_IO. */
MUST_CHECK enum status json_read(const char *path, struct json *json, struct error *error);
/* json_free - releases a tree; harmless on a zeroed one. */
void json_free(struct json *json);

/* json_member - the member of this name of an object, the first if there are more; NULL: none, or no object. */
const struct json *json_member(const struct json *json, const char *name);

#endif
