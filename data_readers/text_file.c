/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/text_file.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static FILE *open_text(const char *path)
{
	/* With O_NONBLOCK, opening a pipe without a writer does not block. Reading one that has a writer waits for its
	 * data. */
	const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
	if (fd < 0)
		return NULL;
	const int flags = fcntl(fd, F_GETFL);
	FILE *file = flags >= 0 && !fcntl(fd, F_SETFL, flags & ~O_NONBLOCK) ? fdopen(fd, "rb") : NULL;
	if (!file) {
		const int errnum = errno;
		close(fd);
		errno = errnum;
	}
	return file;
}

static enum status no_memory(struct error *why)
{
	return error_set(why, STATUS_NO_MEMORY, "out of memory");
}

/* Makes room for that many bytes. */
static bool reserve(char **text, size_t *capacity, size_t size)
{
	if (size <= *capacity)
		return true;
	const size_t grown = *capacity ? 2 * *capacity : 65536;
	char *more = realloc(*text, grown);
	if (!more)
		return false;
	*text = more;
	*capacity = grown;
	return true;
}

static enum status read_stream(FILE *file, const char *what, size_t max_size, char **text, size_t *size,
			       struct error *why)
{
	size_t capacity = 0, got;
	*size = 0;
	do {
		if (!reserve(text, &capacity, *size + 2))
			return no_memory(why);
		char *to = *text + *size;
		got = fread(to, 1, capacity - *size - 1, file);
		if (memchr(to, '\0', got))
			return error_set(why, STATUS_FORMAT, "expected text, found a zero byte");
		*size += got;
	} while (got && *size <= max_size);
	if (ferror(file))
		return error_set(why, STATUS_IO, "%s", strerror(errno));
	if (*size > max_size)
		return error_set(why, STATUS_FORMAT, "too large for %s", what);
	(*text)[*size] = '\0';
	return STATUS_OK;
}

enum status text_file_read(const char *path, const char *what, size_t max_size, char **text, size_t *size,
			   struct error *why)
{
	FILE *file = open_text(path);
	*text = NULL;
	if (!file)
		return errno == ENOMEM ? no_memory(why) : error_set(why, STATUS_IO, "%s", strerror(errno));
	const enum status status = read_stream(file, what, max_size, text, size, why);
	fclose(file);
	if (status != STATUS_OK) {
		free(*text);
		*text = NULL;
	}
	return status;
}
