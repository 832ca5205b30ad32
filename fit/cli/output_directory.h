/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output_directory - the directory for the files that a command writes. */
#ifndef OUTPUT_DIRECTORY_H
#define OUTPUT_DIRECTORY_H

#include "src/status.h"
#include <dirent.h>

/* output_directory_make - makes the directory `path`, or path/below unless below is NULL, where there is none yet; not
 * those above it. Errors: STATUS_IO: it cannot be made, or is something else, or cannot be written to;
 * STATUS_NO_MEMORY. Returns its path in *made (newly allocated; NULL on failure), unless made is NULL. */
MUST_CHECK enum status output_directory_make(const char *path, const char *below, char **made, struct error *error);

/* output_directory_spares - whether none of the n input paths is NAME in the directory, which is about to be written.
 * Errors: STATUS_DOMAIN: one of them is; STATUS_NO_MEMORY. */
MUST_CHECK enum status output_directory_spares(const char *directory, const char *name, char *const *path, int n,
					       struct error *error);

/* output_directory_path - "directory/name" in *path, newly allocated, if output_directory_accepts() that name; else NULL. */
MUST_CHECK enum status output_directory_path(const char *directory, const char *name, char **path, struct error *error);
/* output_directory_accepts - whether NAME in the directory can become a file: nothing is there, or a regular file. A pipe
 * is refused: writing to it would block until it has a reader, with the other files unwritten.
 * Errors: STATUS_IO: something else is there; STATUS_NO_MEMORY. */
MUST_CHECK enum status output_directory_accepts(const char *directory, const char *name, struct error *error);
/* output_file_problem - the same for a name in the directory that is open as `at`. Returns NULL, or the reason why not.
 * Allocates nothing. */
const char *output_file_problem(int at, const char *name);

/* struct scratch - a directory for temporary files. */
struct scratch {
	char *path;
	DIR *directory; /* open from the start: later there might be no memory for it */
};

/* scratch_make - a new directory inside `path`. Errors: STATUS_IO, STATUS_NO_MEMORY; *scratch is zeroed then. */
MUST_CHECK enum status scratch_make(const char *path, struct scratch *scratch, struct error *error);
/* scratch_remove - removes the directory with the files in it; harmless on a zeroed one. */
void scratch_remove(struct scratch *scratch);

#endif
