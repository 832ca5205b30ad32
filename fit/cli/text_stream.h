/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_stream - text built by writing to a stream in memory. */
#ifndef TEXT_STREAM_H
#define TEXT_STREAM_H

#include <stdbool.h>
#include <stdio.h>

/* struct text_stream - write to `file`; the struct must not move while it is open. */
struct text_stream {
	FILE *file;
	char *text;
	size_t size;
};

/* text_stream_open - false when out of memory. */
bool text_stream_open(struct text_stream *stream);
/* text_stream_close - returns the text, for the caller to free; NULL when a write failed for want of memory. */
char *text_stream_close(struct text_stream *stream);

#endif
