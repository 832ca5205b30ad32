/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/terminal.h"
#include <limits.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { NARROWEST = 40, USUAL = 80 };

/* 0: not known. */
static int told_width(FILE *stream)
{
	struct winsize size = {0};

	if (isatty(fileno(stream)) && ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
		return size.ws_col < NARROWEST ? NARROWEST : size.ws_col;
	const char *columns = getenv("COLUMNS");
	char *end = NULL;
	const long n = columns ? strtol(columns, &end, 10) : 0;

	if (n <= 0 || n > INT_MAX || *end)
		return 0;
	return n < NARROWEST ? NARROWEST : (int)n;
}

int terminal_width(FILE *stream)
{
	const int told = told_width(stream);

	return told ? told : USUAL;
}

int terminal_table_width(FILE *stream)
{
	const int told = told_width(stream);

	return told ? told : isatty(fileno(stream)) ? USUAL : INT_MAX;
}

bool terminal_reader_is_gone(void)
{
	struct pollfd out = {STDOUT_FILENO, 0, 0};

	return poll(&out, 1, 0) == 1 && (out.revents & POLLERR);
}

int terminal_columns(const char *text, size_t n)
{
	int count = 0;

	for (size_t i = 0; i < n && text[i]; i++)
		count += (text[i] & 0xc0) != 0x80;
	return count;
}

char *terminal_cut(char *text, int columns)
{
	if (terminal_columns(text, strlen(text)) <= columns)
		return text;
	char *at = text;

	/* Whole characters only; ".." takes no more bytes than the two that go. */
	for (int n = 0; n < columns - 2; n++)
		do
			at++;
		while ((*at & 0xc0) == 0x80);
	memcpy(at, "..", 3);
	return text;
}

int terminal_wrap(FILE *file, const char *text, int at, int indent, int width)
{
	const char *gap = "";

	while (*text) {
		const size_t n = strcspn(text, " ");
		const int word = terminal_columns(text, n);

		if (*gap && at + 1 + word > width) {
			fprintf(file, "\n%*s", indent, "");
			at = indent;
		} else {
			fputs(gap, file);
			at += *gap != '\0';
		}
		fwrite(text, 1, n, file);
		at += word;
		text += n + (text[n] == ' ');
		gap = " ";
	}
	return at;
}
