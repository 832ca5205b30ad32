/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/messages.h"
#include "data_readers/text_quote.h"

#include <stdarg.h>
#include <stdio.h>

void report_error(const char *format, ...)
{
	enum { LONGEST = 4096 };
	char text[LONGEST], shown[LONGEST];
	va_list list;
	va_start(list, format);
	vsnprintf(text, sizeof text, format, list);
	va_end(list);
	/* Names are quoted where a message is made; this is for what was forgotten. */
	text_quote(text, shown, sizeof shown);
	fprintf(stderr, "stdfit: %s\n", shown);
}
