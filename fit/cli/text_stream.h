/* SPDX-License-Identifier: GPL-3.0-or-later */
/* text_stream - text built by writing to a stream of open_memstream(). */
#ifndef TEXT_STREAM_H
#define TEXT_STREAM_H

#include <stdio.h>

/* text_stream_close - closes the stream; `text` is what open_memstream() was given.
 * Returns the text, for the caller to free. Returns NULL when a write failed for want of memory: the text is freed then. */
char *text_stream_close(FILE *stream, char **text);

#endif
