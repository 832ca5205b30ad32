/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/regular_file.h"
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum status regular_file_open(const char *path, const char *what, int *fd, struct stat *st, struct error *why)
{
	/* Without O_NONBLOCK opening a pipe without a writer would block here. */
	do
		*fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
	while (*fd < 0 && errno == EINTR);
	if (*fd < 0 || fstat(*fd, st) != 0)
		return error_set(why, STATUS_IO, "%s", strerror(errno));
	if (S_ISDIR(st->st_mode))
		return error_set(why, STATUS_FORMAT, "expected %s, found a directory", what);
	if (!S_ISREG(st->st_mode))
		return error_set(why, STATUS_FORMAT, "expected a regular file, found a pipe or device");
	if (st->st_size == 0)
		return error_set(why, STATUS_FORMAT, "the file is empty");
	return STATUS_OK;
}

/* Reads up to `size` bytes; *size becomes how many there were. Returns 0 or errno. */
static int read_bytes(int fd, unsigned char *bytes, size_t *size)
{
	size_t done = 0;
	while (done < *size) {
		const ssize_t got = read(fd, bytes + done, *size - done);
		if (got < 0 && errno != EINTR)
			return errno;
		if (got == 0)
			break;
		done += got > 0 ? (size_t)got : 0;
	}
	*size = done;
	return 0;
}

enum status regular_file_read(const char *path, const char *what, size_t max_size, unsigned char **bytes, size_t *size,
			      struct error *why)
{
	struct stat st;
	int fd;
	*bytes = NULL;
	enum status status = regular_file_open(path, what, &fd, &st, why);
	if (status == STATUS_OK && (unsigned long long)st.st_size > max_size)
		status = error_set(why, STATUS_FORMAT, "expected at most %zu bytes, found %lld", max_size,
				   (long long)st.st_size);
	if (status == STATUS_OK) {
		*size = (size_t)st.st_size;
		*bytes = malloc(*size);
		if (!*bytes)
			status = error_set(why, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	}
	const int problem = status != STATUS_OK ? 0 : read_bytes(fd, *bytes, size);
	if (problem) {
		free(*bytes);
		*bytes = NULL;
		status = error_set(why, STATUS_IO, "%s", strerror(problem));
	}
	if (fd >= 0)
		close(fd);
	return status;
}
