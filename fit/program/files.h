/* SPDX-License-Identifier: GPL-3.0-or-later */
/* files - which files the paths of a command line stand for. */
#ifndef FILES_H
#define FILES_H

#include <stdbool.h>
#include <stddef.h>

struct files {
	char **path; /* owned, none twice */
	size_t n, capacity;
};

/* files_collect - takes every path that is no directory as it is, and for a directory its *.binary in the order of
 * their names; `recursive` takes those below it too, each directory once. Hidden files and directories are left alone.
 * Returns how many of the paths gave nothing, each told on standard error; -1 when out of memory, told as well. */
int files_collect(struct files *files, char *const *path, int n_paths, bool recursive);
void files_free(struct files *files);

#endif
