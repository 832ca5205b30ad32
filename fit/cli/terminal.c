/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/terminal.h"
#include <poll.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { NARROWEST = 40, USUAL = 80 };

int terminal_width(FILE *stream)
{
	struct winsize size = {0};

	if (!isatty(fileno(stream)) || ioctl(fileno(stream), TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
		return USUAL;
	return size.ws_col < NARROWEST ? NARROWEST : size.ws_col;
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
