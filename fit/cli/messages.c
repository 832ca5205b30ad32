/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/messages.h"

#include <stdarg.h>
#include <stdio.h>

void report_error(const char *format, ...)
{
	va_list list;
	va_start(list, format);
	fputs("stdfit: ", stderr);
	vfprintf(stderr, format, list);
	fputc('\n', stderr);
	va_end(list);
}
