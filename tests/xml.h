/* SPDX-License-Identifier: GPL-3.0-or-later */
/* xml - a strict reader of the XML that `stdfit export` writes: comments, elements, attributes, white space. Anything
 * else, or anything badly nested, fails the test. */
#ifndef XML_H
#define XML_H

#include "check.h"

enum { XML_ATTRIBUTES = 4, XML_CHILDREN = 16 };

struct xml {
	char tag[32];
	char name[XML_ATTRIBUTES][32], value[XML_ATTRIBUTES][256];
	int n_attributes;
	struct xml *child[XML_CHILDREN];
	int n_children;
};

static inline void xml_space(const char **at)
{
	for (;;) {
		*at += strspn(*at, " \t\n");
		if (strncmp(*at, "<!--", 4) != 0)
			return;
		const char *end = strstr(*at + 4, "--"); /* which is not allowed inside */
		if (!end || end[2] != '>')
			fail_msg("XML: a comment with -- inside: %.60s", *at);
		*at = end + 3;
	}
}

static inline void xml_word(const char **at, char *word, size_t size)
{
	const size_t n = strspn(*at, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789");
	if (!n || n >= size)
		fail_msg("XML: expected a name: %.60s", *at);
	memcpy(word, *at, n);
	word[n] = '\0';
	*at += n;
}

static inline void xml_expect(const char **at, const char *text)
{
	if (strncmp(*at, text, strlen(text)) != 0)
		fail_msg("XML: expected %s: %.60s", text, *at);
	*at += strlen(text);
}

static inline void xml_attribute(const char **at, struct xml *xml)
{
	const int i = xml->n_attributes++;
	assert_true(i < XML_ATTRIBUTES);
	xml_word(at, xml->name[i], sizeof xml->name[i]);
	for (int k = 0; k < i; k++)
		assert_string_not_equal(xml->name[i], xml->name[k]);
	xml_expect(at, "=\"");
	const size_t n = strcspn(*at, "\"<&");
	assert_true((*at)[n] == '"' && n < sizeof xml->value[i]);
	memcpy(xml->value[i], *at, n);
	xml->value[i][n] = '\0';
	*at += n + 1;
}

static inline struct xml *xml_element(const char **at)
{
	struct xml *xml = calloc(1, sizeof *xml);
	char closing[40];
	assert_non_null(xml);
	xml_expect(at, "<");
	xml_word(at, xml->tag, sizeof xml->tag);
	while (**at == ' ') {
		++*at;
		xml_attribute(at, xml);
	}
	if (!strncmp(*at, "/>", 2)) {
		*at += 2;
		return xml;
	}
	xml_expect(at, ">");
	for (xml_space(at); strncmp(*at, "</", 2) != 0; xml_space(at)) {
		assert_true(xml->n_children < XML_CHILDREN);
		xml->child[xml->n_children++] = xml_element(at);
	}
	snprintf(closing, sizeof closing, "</%s>", xml->tag);
	xml_expect(at, closing);
	return xml;
}

/* xml_parse - the root element of a document. */
static inline struct xml *xml_parse(const char *text)
{
	xml_space(&text);
	struct xml *xml = xml_element(&text);
	xml_space(&text);
	if (*text)
		fail_msg("XML: something behind the root: %.60s", text);
	return xml;
}

static inline void xml_free(struct xml *xml)
{
	for (int i = 0; i < xml->n_children; i++)
		xml_free(xml->child[i]);
	free(xml);
}

/* xml_get - the value of an attribute; "" if it is not there. */
static inline const char *xml_get(const struct xml *xml, const char *name)
{
	for (int i = 0; i < xml->n_attributes; i++)
		if (!strcmp(xml->name[i], name))
			return xml->value[i];
	return "";
}

/* xml_named - the child whose attribute `name` has this value; NULL: none. */
static inline const struct xml *xml_named(const struct xml *xml, const char *value)
{
	for (int i = 0; i < xml->n_children; i++)
		if (!strcmp(xml_get(xml->child[i], "name"), value))
			return xml->child[i];
	return NULL;
}

#endif
