/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output_directory - a place for a command's files. */
#ifndef OUTPUT_DIRECTORY_H
#define OUTPUT_DIRECTORY_H

#include "src/status.h"
#include <dirent.h>

/* output_directory_make - makes the directory `path`, or path/below unless below is NULL, where there is none yet; not
 * those above it. Errors: STATUS_IO: it cannot be made, or is something else, or cannot be written to;
 * STATUS_NO_MEMORY. Returns its path in *made (newly allocated; NULL on failure), unless made is NULL. */
MUST_CHECK enum status output_directory_make(const char *path, const char *below, char **made, struct error *error);

/* output_directory_spares - whether none of the n paths is NAME in the directory, which is about to be written there.
 * Errors: STATUS_DOMAIN: one of them is; STATUS_NO_MEMORY. */
MUST_CHECK enum status output_directory_spares(const char *directory, const char *name, char *const *path, int n,
					       struct error *error);

/* output_directory_path - "directory/name" in *path, newly allocated, if output_directory_takes() that name; else NULL. */
MUST_CHECK enum status output_directory_path(const char *directory, const char *name, char **path, struct error *error);
/* output_directory_takes - whether NAME in the directory can become a file: nothing stands there, or a regular file. Who
 * writes to a pipe waits for its reader; that is no place for one file of several.
 * Errors: STATUS_IO: something else is there; STATUS_NO_MEMORY. */
MUST_CHECK enum status output_directory_takes(const char *directory, const char *name, struct error *error);
/* output_place_trouble - the same for a name in the directory that is open as `at`: NULL, or why not. Allocates nothing. */
const char *output_place_trouble(int at, const char *name);

/* struct scratch - a directory for files that are needed for a while. */
struct scratch {
	char *path;
	DIR *directory; /* open from the start: later there might be no memory for it */
};

/* scratch_make - a new directory inside `path`. Errors: STATUS_IO, STATUS_NO_MEMORY; *scratch is zeroed then. */
MUST_CHECK enum status scratch_make(const char *path, struct scratch *scratch, struct error *error);
/* scratch_remove - removes the directory with the files in it; harmless on a zeroed one. */
void scratch_remove(struct scratch *scratch);

#endif
