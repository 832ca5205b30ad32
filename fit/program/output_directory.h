/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output_directory - a place for a command's files. */
#ifndef OUTPUT_DIRECTORY_H
#define OUTPUT_DIRECTORY_H

#include "status.h"

/* output_directory_make - makes the directory `path`, or path/below unless below is NULL, where there is none yet; not
 * those above it. Errors: STATUS_IO: it cannot be made, or is something else, or cannot be written to;
 * STATUS_NO_MEMORY. Returns its path in *made (newly allocated; NULL on failure), unless made is NULL. */
MUST_CHECK enum status output_directory_make(const char *path, const char *below, char **made, struct error *error);

#endif
