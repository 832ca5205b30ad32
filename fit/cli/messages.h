/* SPDX-License-Identifier: GPL-3.0-or-later */
/* messages - what the program says on standard error. */
#ifndef MESSAGES_H
#define MESSAGES_H

/* report_error - "stdfit: <text>" and a newline on standard error; control characters of the text, also those of the
 * direction of writing, as \xNN. */
void report_error(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
