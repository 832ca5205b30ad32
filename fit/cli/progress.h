/* SPDX-License-Identifier: GPL-3.0-or-later */
/* progress - one line on standard error that reports the progress of a long run. */
#ifndef PROGRESS_H
#define PROGRESS_H

#include <stdbool.h>
#include <stddef.h>

struct progress {
	bool shown; /* there is one: standard error is a terminal, and nobody asked for quiet */
	size_t done, n;
	size_t kept;         /* of those done: no work, so they do not count in the time left */
	const char *unit;    /* what they are, "files" */
	double start, drawn; /* seconds; when the batch began, when the line was last drawn */
};

struct progress progress_start(size_t n, const char *unit, bool quiet);
/* progress_draw - draws the line anew, at most six times a second. */
void progress_draw(struct progress *progress);
/* progress_erase - clears the line so that something else can be written. */
void progress_erase(struct progress *progress);

#endif
