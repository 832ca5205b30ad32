/* SPDX-License-Identifier: GPL-3.0-or-later */
/* files - which files the paths of a command line stand for. */
#ifndef FILES_H
#define FILES_H

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>

struct files {
	char **path; /* owned, none twice */
	size_t n, capacity;
};

/* files_collect - the files that the paths stand for. A path that is not a directory stands for itself; a directory for
 * the measurements in it (measurement_is_known()) in the order of their names, with `recursive` also for those in the directories below, each of which is
 * read once, however many links lead to it. Hidden files and directories are skipped. A directory that cannot be read is
 * reported on standard error, and the collection goes on. Setting *cancel ends it with what was found so far.
 * Returns how many of the paths gave nothing or not all, each reported; -1 when out of memory, reported as well. */
int files_collect(struct files *files, char *const *path, int n_paths, bool recursive, const atomic_bool *cancel);
void files_free(struct files *files);

/* files_same - whether two names are one regular file, or would be one once written. */
bool files_same(const char *a, const char *b);

/* files_sort - puts them in the order of their bytes, whatever the locale and the command line's order. */
void files_sort(struct files *files);

/* struct shard - share i of n, i = 1 .. n. */
struct shard {
	int i, n;
};
/* files_keep_shard - leaves the files i, i + n, i + 2n ... of the sorted list. So the shares depend on nothing but the
 * names, differ by one file at most in size, and together are all files, each once. A file that is added or removed
 * moves others to another share; a hash of the names would not, but some shares would have twice as many files as
 * others. May leave none. */
void files_keep_shard(struct files *files, struct shard shard);

#endif
