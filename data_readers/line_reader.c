/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/line_reader.h"
#include "data_readers/regular_file.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

enum { BLOCK = 2 * LINE_LENGTH_MAX };

enum status line_reader_open(struct line_reader *reader, const char *path, const char *what, struct error *why)
{
	*reader = (struct line_reader){.fd = -1};
	const enum status status = regular_file_open(path, what, &reader->fd, &reader->st, why);
	if (status != STATUS_OK)
		return status;
	reader->block = malloc(BLOCK + 1);
	reader->hash = XXH3_createState();
	if (!reader->block || !reader->hash)
		return error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	XXH3_64bits_reset(reader->hash);
	return STATUS_OK;
}

void line_reader_close(struct line_reader *reader)
{
	if (reader->fd >= 0)
		close(reader->fd);
	free(reader->block);
	XXH3_freeState(reader->hash);
	*reader = (struct line_reader){.fd = -1};
}

/* Moves what is left to the front of the block and fills it up. */
static enum status fill(struct line_reader *reader, struct error *why)
{
	memmove(reader->block, reader->block + reader->begin, reader->end - reader->begin);
	reader->end -= reader->begin;
	reader->begin = 0;
	while (reader->end < BLOCK && !reader->at_end) {
		const ssize_t got = read(reader->fd, reader->block + reader->end, BLOCK - reader->end);
		if (got < 0 && errno != EINTR)
			return error_set(why, STATUS_IO, "%s", strerror(errno));
		if (got < 0)
			continue;
		XXH3_64bits_update(reader->hash, reader->block + reader->end, (size_t)got);
		reader->end += (size_t)got;
		reader->at_end = got == 0;
	}
	return STATUS_OK;
}

static bool has_mark(const struct line_reader *reader)
{
	return reader->number == 1 && reader->end - reader->begin >= 3 &&
	       !memcmp(reader->block + reader->begin, "\xef\xbb\xbf", 3);
}

enum status line_reader_next(struct line_reader *reader, char **line, struct error *why)
{
	char *start = reader->block + reader->begin;
	char *newline = memchr(start, '\n', reader->end - reader->begin);
	*line = NULL;
	if (!newline && !reader->at_end) {
		const enum status status = fill(reader, why);
		if (status != STATUS_OK)
			return status;
		start = reader->block;
		newline = memchr(start, '\n', reader->end);
	}
	if (reader->begin == reader->end)
		return STATUS_OK;
	reader->number++;
	size_t length = newline ? (size_t)(newline - start) : reader->end - reader->begin;
	if (length > LINE_LENGTH_MAX)
		return line_error(reader, why, "expected at most %d bytes in a line", LINE_LENGTH_MAX);
	if (memchr(start, '\0', length))
		return line_error(reader, why, "expected text, found a zero byte");
	start += has_mark(reader) && length >= 3 ? 3 : 0;
	reader->begin = newline ? (size_t)(newline - reader->block) + 1 : reader->end;
	char *last = newline ? newline : reader->block + reader->end;
	if (last > start && last[-1] == '\r')
		last--;
	*last = '\0';
	*line = start;
	return STATUS_OK;
}

enum status line_reader_finish(struct line_reader *reader, struct measurement *measurement, struct error *why)
{
	struct stat now;
	while (!reader->at_end) {
		reader->begin = reader->end;
		const enum status status = fill(reader, why);
		if (status != STATUS_OK)
			return status;
	}
	if (fstat(reader->fd, &now) != 0)
		return error_set(why, STATUS_IO, "%s", strerror(errno));
	if (now.st_size != reader->st.st_size || now.st_mtim.tv_sec != reader->st.st_mtim.tv_sec ||
	    now.st_mtim.tv_nsec != reader->st.st_mtim.tv_nsec)
		return error_set(why, STATUS_IO, "it changed while being read");
	measurement->file_size = (uint64_t)reader->st.st_size;
	measurement->file_hash = XXH3_64bits_digest(reader->hash);
	return STATUS_OK;
}

enum status line_error(const struct line_reader *reader, struct error *why, const char *format, ...)
{
	struct error text;
	va_list list;
	va_start(list, format);
	vsnprintf(text.text, sizeof text.text, format, list);
	va_end(list);
	return error_set(why, STATUS_FORMAT, "line %zu: %.450s", reader->number, text.text);
}
