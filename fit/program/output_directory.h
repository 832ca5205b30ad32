/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output_directory - a place for a command's files. */
#ifndef OUTPUT_DIRECTORY_H
#define OUTPUT_DIRECTORY_H

#include "status.h"

/* output_directory_make - makes the directory `path`, or path/below unless below is NULL, where there is none yet; not
 * those above it. Errors: STATUS_IO: it cannot be made, or is something else, or cannot be written to;
 * STATUS_NO_MEMORY. Returns its path in *made (newly allocated; NULL on failure), unless made is NULL. */
MUST_CHECK enum status output_directory_make(const char *path, const char *below, char **made, struct error *error);

/* scratch_make - a new directory inside `path` for files that are needed for a while; its path is newly allocated.
 * Errors: STATUS_IO, STATUS_NO_MEMORY; *scratch is NULL then. */
MUST_CHECK enum status scratch_make(const char *path, char **scratch, struct error *error);
/* scratch_remove - removes the directory with the files in it, and frees its path; NULL is left alone. */
void scratch_remove(char *scratch);

#endif
