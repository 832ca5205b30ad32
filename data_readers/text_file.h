/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_file - reads a whole text from a file, or from a pipe that has a writer. */
#ifndef TEXT_FILE_H
#define TEXT_FILE_H

#include "src/status.h"
#include <stddef.h>

/* text_file_read - the text of a file of at most `max_size` bytes, newly allocated, terminated, into *text, its length
 * into *size. A pipe without a writer counts as empty; the call does not wait for one. Errors, which do not name the
 * file: STATUS_IO, STATUS_NO_MEMORY, STATUS_FORMAT (a zero byte; too large, `what` being what it should be, "a result
 * table"); *text is NULL then. */
MUST_CHECK enum status text_file_read(const char *path, const char *what, size_t max_size, char **text, size_t *size,
				      struct error *why);

#endif
