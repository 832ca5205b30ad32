/* SPDX-License-Identifier: GPL-3.0-or-later */
/* terminal - text that fits where it is shown. */
#ifndef TERMINAL_H
#define TERMINAL_H

#include <stdbool.h>
#include <stdio.h>

/* terminal_width - columns of the terminal behind a stream, at least 40. Where none tells them: those of the environment's
 * COLUMNS, else 80. */
int terminal_width(FILE *stream);
/* terminal_table_width - the same for a table, which is not made narrower for a file: INT_MAX where neither a terminal nor COLUMNS
 * is there. */
int terminal_table_width(FILE *stream);

/* terminal_reader_is_gone - whether standard output is a pipe that nobody reads any more, as behind `| head`. */
bool terminal_reader_is_gone(void);

/* terminal_columns - columns that the first n bytes of a text occupy, at most those before its end: one per character. */
int terminal_columns(const char *text, size_t n);

/* terminal_cut - shortens a text to so many columns, at least 2, and then ends it with "..". Returns it. */
char *terminal_cut(char *text, int columns);

/* terminal_wrap - a text, broken at blanks into lines of at most `width` columns. The first begins at column `at`; the
 * others are indented by `indent`. No newline at the end. Returns the column reached. */
int terminal_wrap(FILE *file, const char *text, int at, int indent, int width);

#endif
