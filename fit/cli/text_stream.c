/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/text_stream.h"

#include <stdbool.h>
#include <stdlib.h>

char *text_stream_close(FILE *stream, char **text)
{
	const bool failed = ferror(stream);
	if (!fclose(stream) && !failed)
		return *text;
	free(*text);
	return NULL;
}
