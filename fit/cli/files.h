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

/* files_collect - takes every path that is no directory as it is, and for a directory its *.binary in the order of
 * their names; `recursive` takes those below it too, each directory once, by whatever links it can be reached. Hidden
 * files and directories are left alone. A directory that cannot be read is told on standard error; what is beside it is
 * taken all the same. Setting *cancel ends it with what was found so far.
 * Returns how many of the paths gave nothing or not all, each told; -1 when out of memory, told as well. */
int files_collect(struct files *files, char *const *path, int n_paths, bool recursive, const atomic_bool *cancel);
void files_free(struct files *files);

/* files_same - whether two names are, or would when written to be, one regular file. */
bool files_same(const char *a, const char *b);
/* files_has - whether `path` is one of the files, by whatever name. */
bool files_has(const struct files *files, const char *path);

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
