/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/text_stream.h"

#include <stdlib.h>

bool text_stream_open(struct text_stream *stream)
{
	*stream = (struct text_stream){0};
	stream->file = open_memstream(&stream->text, &stream->size);
	return stream->file;
}

char *text_stream_close(struct text_stream *stream)
{
	const bool failed = ferror(stream->file);
	if (!fclose(stream->file) && !failed)
		return stream->text;
	free(stream->text);
	return NULL;
}
