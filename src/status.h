/* SPDX-License-Identifier: GPL-3.0-or-later */
/* status - what a function that can fail returns, and the text that goes with it. */
#ifndef STATUS_H
#define STATUS_H

enum status {
	STATUS_OK = 0,
	STATUS_DOMAIN,      /* an argument lies outside the documented domain */
	STATUS_NO_MEMORY,   /* an allocation failed */
	STATUS_IO,          /* the operating system refused to open, read or write */
	STATUS_FORMAT,      /* a file is not what it should be */
	STATUS_NO_DATA,     /* nothing left to work on: every entry masked, or all zero */
	STATUS_UNSUPPORTED, /* valid, but this build or this combination cannot do it */
	STATUS_INTERRUPTED, /* stopped by the caller */
};

/* Marks a function whose status must be read. */
#define MUST_CHECK __attribute__((warn_unused_result))

/* struct error - the words for a failure. Filled only when something fails; one line, no newline,
 * lower case, naming the thing (file, option), what was expected and what was found. */
struct error {
	char text[512];
};

/* status_str - a short constant English phrase for a status; never NULL. */
const char *status_str(enum status status);

/* error_set - writes a formatted text into `error` (ignored when NULL), truncating it to fit.
 * Returns: `status`, so that `return error_set(error, STATUS_IO, ...)` reads well. */
enum status error_set(struct error *error, enum status status, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

#endif
