/* SPDX-License-Identifier: GPL-3.0-or-later */
/* regular_file - opens input files, and never waits on a pipe or a device. */
#ifndef REGULAR_FILE_H
#define REGULAR_FILE_H

#include "src/status.h"
#include <stddef.h>
#include <sys/stat.h>

/* regular_file_open - opens a regular file that is not empty for reading; `what` is what it should be, "a MERL file".
 * Returns STATUS_IO or STATUS_FORMAT, *fd then being -1 or to be closed by the caller. */
MUST_CHECK enum status regular_file_open(const char *path, const char *what, int *fd, struct stat *st,
					 struct error *why);

/* regular_file_read - the whole of a file of at most `max_size` bytes, newly allocated, into *bytes and *size.
 * Returns STATUS_IO, STATUS_FORMAT, STATUS_NO_MEMORY; *bytes is then NULL. */
MUST_CHECK enum status regular_file_read(const char *path, const char *what, size_t max_size, unsigned char **bytes,
					 size_t *size, struct error *why);

#endif
