/* SPDX-License-Identifier: GPL-3.0-or-later */
/* line_reader - the lines of a text file one after the other, with a hash of its bytes. */
#ifndef LINE_READER_H
#define LINE_READER_H

#include "data_readers/measurement.h"
#include <sys/stat.h>

enum { LINE_LENGTH_MAX = 1 << 20 }; /* bytes; a longer line is refused */

/* struct line_reader - an open file. Memory holds a block of it, whatever its size. */
struct line_reader {
	int fd;
	struct stat st; /* as it was when opened */
	void *hash;
	char *block;
	size_t begin, end; /* of what is left in the block */
	bool at_end;       /* of the file: the block has the rest */
	size_t number;     /* of the line given last, from 1 */
};

/* line_reader_open - `what` is what the file should be, "a file of samples". Errors do not name the file: STATUS_IO,
 * STATUS_FORMAT (no regular file, or empty), STATUS_NO_MEMORY. Close it in any case. */
MUST_CHECK enum status line_reader_open(struct line_reader *reader, const char *path, const char *what,
					struct error *why);

/* line_reader_next - the next line into *line, terminated, without its end ("\n" or "\r\n"), valid until the next call;
 * NULL at the end of the file. The mark that some programs put before UTF-8 is left out. STATUS_FORMAT: a zero byte, a
 * line that is too long; STATUS_IO. */
MUST_CHECK enum status line_reader_next(struct line_reader *reader, char **line, struct error *why);

/* line_reader_finish - reads what is left, and puts the size and the hash of the whole file into the measurement.
 * STATUS_IO: also when the file changed meanwhile. */
MUST_CHECK enum status line_reader_finish(struct line_reader *reader, struct measurement *measurement,
					  struct error *why);
void line_reader_close(struct line_reader *reader);

/* line_skip_space - past blanks and tabs. */
static inline char *line_skip_space(char *text)
{
	while (*text == ' ' || *text == '\t')
		text++;
	return text;
}

/* line_error - error_set() with STATUS_FORMAT and "line N: " before the words. */
enum status line_error(const struct line_reader *reader, struct error *why, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
