/* SPDX-License-Identifier: GPL-3.0-or-later */
/* hostile_names - names of materials that nobody expects, and what may be shown of them. */
#ifndef HOSTILE_NAMES_H
#define HOSTILE_NAMES_H

#include "data_readers/text_quote.h"
#include "run_program.h"

/* What markup, gnuplot or a shell would take for its own. */
#define HOSTILE_NAMES                                                                                                  \
	"\"; system(\"touch pwned\"); \"", "'.system('touch pwned').'\n`touch pwned`", "{}_^@~%s\\n$(touch pwned)",    \
		"<script>alert(1)<script>&amp;&\xff\"'"

static const char *const names[] = {
	"plain",   " space ",     "comma,comma",  "\"quoted\"", "a\"b",     "new\nline", "cr\r",
	"tab\t",   "-dash",       "--ndf",        "=1+1",       "\xff\xfe", "\xc3(",     "\xe2\x80\xa8 line",
	"\x1b[2J", "back\\slash", "h\xc3\xa4rte", "%s%n",       "'",        ";",         "a;b=c",
	"$(exit)", "null",        "1e5",          HOSTILE_NAMES};
enum { NAMES = sizeof names / sizeof *names };

static inline void expect_printable(const char *text, int line)
{
	for (const char *at = text; *at;) {
		const size_t length = *at == '\n' ? 1 : text_printable(at);
		if (length == 0)
			fail_msg("line %d: expected printable text, found byte %02x in: %s", line, (uint8_t)*at, text);
		at += length;
	}
}

#endif
