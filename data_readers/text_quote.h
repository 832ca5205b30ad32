/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_quote - makes file names safe to print on one line. */
#ifndef TEXT_QUOTE_H
#define TEXT_QUOTE_H

#include <stddef.h>
#include <stdint.h>

enum { TEXT_QUOTE_SIZE = 256 }; /* room for a name inside a struct error, with the reason after it */

/* text_quote - copies `s` into out[size], terminated: control characters, those of the direction of writing and bytes
 * that are not UTF-8 become \xNN, so that a message stays one line and leaves the terminal alone; of a text that does
 * not fit the end is kept, after "...". For people to read, not to be read back: a backslash stands for itself. size >=
 * 16. `out` may not be `s` itself: the text grows. Never fails. */
void text_quote(const char *restrict s, char *restrict out, size_t size);

/* text_character - length of the UTF-8 sequence at text, whose character is *code; 0 if there is none (end, overlong
 * form, surrogate, cut short). */
size_t text_character(const char *text, uint32_t *code);
/* text_printable - the same of a printable one: 0 for control characters, line separators, and what changes the order
 * in which the text around it is shown, too. */
size_t text_printable(const char *text);

#endif
