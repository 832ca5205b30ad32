/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/measurement_read.h"
#include "data_readers/alta.h"
#include "data_readers/cornell.h"
#include "data_readers/foreign_file.h"
#include "data_readers/merl.h"
#include "data_readers/regular_file.h"
#include "data_readers/rgl.h"
#include "data_readers/samples_csv.h"
#include "data_readers/text_quote.h"
#include "data_readers/zemax.h"
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

enum { HEAD = 1 << 15 }; /* bytes that tell the format */

/* struct format - a row of the table: a text format, or a reader of its own. */
struct format {
	struct {
		const char *name, *extensions, *what; /* extensions: each with its point, between blanks */
	} text;
	const char *magic; /* how a binary file begins; NULL: `read` is asked by extension only */
	size_t magic_size;
	enum status (*read)(const char *path, const struct read_options *options, struct measurement *measurement,
			    struct error *error);
	const struct text_format *lines;
};

static enum status read_merl(const char *path, const struct read_options *options, struct measurement *measurement,
			     struct error *error)
{
	return merl_read(path, options->threads, measurement, error);
}

static enum status read_rgl(const char *path, const struct read_options *options, struct measurement *measurement,
			    struct error *error)
{
	return rgl_read(path, options->gamut, measurement, error);
}

/* The first that is sure, else the first that may be, has it. A format behind another with the same extension tells
 * what is wrong only where the content points to it. */
static const struct format formats[] = {
	{{"merl", ".binary", "MERL table, 90 x 90 x 180 or 360"}, "\x5a\0\0\0\x5a\0\0\0", 8, read_merl, NULL},
	{{"rgl", ".bsdf", "RGL material database"}, "tensor_file", 12, read_rgl, NULL},
	{{"csv", ".csv", "samples as CSV"}, NULL, 0, NULL, &samples_csv},
	{{"alta", ".dat .alta .data", "ALTA text"}, NULL, 0, NULL, &alta},
	{{"cornell", ".brdf", "Cornell light measurement laboratory, text"}, NULL, 0, NULL, &cornell},
	{{"zemax", ".bsdf", "Zemax BSDF text"}, NULL, 0, NULL, &zemax},
};

enum { FORMATS = sizeof formats / sizeof *formats };

/* The extension of this format that the name ends with: its length, or 0. */
static size_t extension_of(const struct format *format, const char *name)
{
	const size_t length = strlen(name);
	for (const char *at = format->text.extensions; *at;) {
		const size_t n = strcspn(at, " ");
		if (length > n && name[length - n - 1] != '/' && !strncasecmp(name + length - n, at, n))
			return n;
		at += n + (at[n] == ' ');
	}
	return 0;
}

size_t measurement_extension(const char *name)
{
	size_t found = 0;
	for (int i = 0; i < FORMATS && !found; i++)
		found = extension_of(&formats[i], name);
	return found;
}

/* The beginning of a file. */
struct head {
	char bytes[HEAD + 1];
	size_t n;
};

/* Without the mark that some programs put before UTF-8. */
static const char *text_of(const struct head *head)
{
	static const char mark[] = "\xef\xbb\xbf";
	return head->bytes + (strncmp(head->bytes, mark, sizeof mark - 1) ? 0 : sizeof mark - 1);
}

static enum match match_of(const struct format *format, const struct head *head)
{
	if (format->lines)
		return memchr(head->bytes, '\0', head->n) ? MATCH_NONE : format->lines->detect(text_of(head));
	return format->magic && head->n >= format->magic_size && !memcmp(head->bytes, format->magic, format->magic_size)
		       ? MATCH_SURE
		       : MATCH_NONE;
}

static const struct format *find(const struct head *head, enum match wanted)
{
	for (enum match match = MATCH_SURE; match >= wanted && match > MATCH_NONE; match--)
		for (int i = 0; i < FORMATS; i++)
			if (match_of(&formats[i], head) == match)
				return &formats[i];
	return NULL;
}

static enum status read_head(const char *path, struct head *head, struct error *why)
{
	struct stat st;
	int fd;
	ssize_t got = 0;
	enum status status = regular_file_open(path, "a measurement", &fd, &st, why);
	head->n = 0;
	while (status == STATUS_OK && head->n < HEAD && (got = read(fd, head->bytes + head->n, HEAD - head->n)) != 0) {
		if (got > 0)
			head->n += (size_t)got;
		else if (errno != EINTR)
			status = error_set(why, STATUS_IO, "%s", strerror(errno));
	}
	if (fd >= 0)
		close(fd);
	head->bytes[head->n] = '\0';
	return status;
}

bool measurement_is_known(const char *path)
{
	struct error why;
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	if (!measurement_extension(name))
		return false;
	if (extension_of(&formats[0], name))
		return true;
	struct head *head = malloc(sizeof *head);
	const bool known = head && read_head(path, head, &why) == STATUS_OK && find(head, MATCH_SURE);
	free(head);
	return known;
}

/* Reads the lines of a text format. */
static enum status read_lines(const char *path, const struct format *format, const struct read_options *options,
			      struct measurement *measurement, struct error *why)
{
	struct line_reader lines;
	struct entry_list list = {.gamut = options->gamut};
	struct measurement file = {0};
	enum status status = line_reader_open(&lines, path, format->text.what, why);
	if (status == STATUS_OK)
		status = format->lines->parse(&lines, options, &list, why);
	if (status == STATUS_OK)
		status = line_reader_finish(&lines, &file, why);
	line_reader_close(&lines);
	if (status == STATUS_OK)
		status = entry_list_finish(&list, measurement, why);
	entry_list_free(&list);
	measurement->file_size = file.file_size;
	measurement->file_hash = file.file_hash;
	return status;
}

static enum status unknown(struct error *why)
{
	char known[256] = "";
	for (int i = 0; i < FORMATS; i++) {
		const size_t used = strlen(known);
		snprintf(known + used, sizeof known - used, "%s%s (%s)", i ? ", " : "", formats[i].text.what,
			 formats[i].text.extensions);
	}
	return error_set(why, STATUS_FORMAT, "its format is not known: expected %s", known);
}

/* Of two formats with an extension, the binary one does not get what is text. */
static const struct format *by_name(const char *path, const struct head *head)
{
	const bool text = head->n && !memchr(head->bytes, '\0', head->n);
	const struct format *found = NULL;
	for (int i = 0; i < FORMATS; i++)
		if (extension_of(&formats[i], path) && (!found || (text && formats[i].lines)))
			found = &formats[i];
	return found;
}

/* The format of a file: by its content, else by its name. */
static enum status choose(const char *path, const struct head *head, const struct format **format, struct error *why)
{
	*format = find(head, MATCH_MAYBE);
	const char *foreign = *format ? NULL : foreign_file(head->bytes, head->n);
	if (foreign)
		return error_set(why, STATUS_FORMAT, "it %s", foreign);
	if (!*format)
		*format = by_name(path, head);
	return *format ? STATUS_OK : unknown(why);
}

enum status measurement_read(const char *path, const struct read_options *options, struct measurement *measurement,
			     struct error *error)
{
	static const struct read_options plain = {.threads = 1};
	const struct read_options *how = options ? options : &plain;
	const struct format *format = NULL;
	struct error why = {""};
	struct head *head = malloc(sizeof *head);
	*measurement = (struct measurement){0};
	enum status status = head ? read_head(path, head, &why) : STATUS_NO_MEMORY;
	if (status == STATUS_OK)
		status = choose(path, head, &format, &why);
	free(head);
	if (status == STATUS_OK && format->read) {
		status = format->read(path, how, measurement, error);
		measurement->format = status == STATUS_OK ? format->text.name : NULL;
		return status;
	}
	if (status == STATUS_OK)
		status = read_lines(path, format, how, measurement, &why);
	if (status == STATUS_OK) {
		measurement->format = format->text.name;
		return STATUS_OK;
	}
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	*measurement = (struct measurement){0};
	return error_set(error, status, "cannot read '%s': %s", name, why.text[0] ? why.text : status_str(status));
}
