/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "files.h"
#include "report.h"
#include "text_quote.h"

#include <errno.h>
#include <fts.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

static bool files_add(struct files *files, const char *path)
{
	if (files->n == files->capacity) {
		const size_t capacity = files->capacity ? 2 * files->capacity : 64;
		char **grown = realloc(files->path, capacity * sizeof(*grown));
		if (!grown)
			return false;
		files->path = grown;
		files->capacity = capacity;
	}
	files->path[files->n] = strdup(path);
	return files->path[files->n] && ++files->n;
}

static bool is_material(const char *name)
{
	static const char suffix[] = ".binary";
	const size_t length = strlen(name), n = sizeof suffix - 1;
	return name[0] != '.' && length > n && !strcmp(name + length - n, suffix);
}

static int name_order(const FTSENT **a, const FTSENT **b)
{
	return strcmp((*a)->fts_name, (*b)->fts_name);
}

/* What is wrong with a directory, or NULL. */
static const char *walk(struct files *files, FTS *tree, bool recursive)
{
	for (FTSENT *entry; errno = 0, (entry = fts_read(tree));) {
		const bool below = entry->fts_level > 0;
		switch (entry->fts_info) {
		case FTS_D:
			if (below && (!recursive || entry->fts_name[0] == '.'))
				fts_set(tree, entry, FTS_SKIP);
			break;
		case FTS_DNR:
		case FTS_ERR:
			if (!below || recursive)
				return strerror(entry->fts_errno);
			break;
		case FTS_DC:
		case FTS_DP:
			break;
		default:
			if (is_material(entry->fts_name) && !files_add(files, entry->fts_path))
				return strerror(ENOMEM);
		}
	}
	return errno ? strerror(errno) : NULL;
}

static bool add_directory(struct files *files, char *path, bool recursive)
{
	char *const roots[] = {path, NULL};
	const size_t before = files->n;
	FTS *tree = fts_open(roots, FTS_LOGICAL | FTS_NOCHDIR, name_order);
	const char *problem = tree ? walk(files, tree, recursive) : strerror(errno);
	if (tree)
		fts_close(tree);
	if (!problem && files->n == before)
		problem = "no *.binary in this directory";
	if (problem) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(path, name, sizeof name);
		report_error("cannot read '%s': %s", name, problem);
	}
	return !problem;
}

struct place {
	char *path;
	size_t index;
};

static int place_order(const void *a, const void *b)
{
	const struct place *x = a, *y = b;
	const int order = strcmp(x->path, y->path);
	return order ? order : (x->index > y->index) - (x->index < y->index);
}

/* Leaves the first of equal paths. */
static bool drop_repeated(struct files *files)
{
	struct place *place = calloc(files->n + 1, sizeof(*place));
	if (!place)
		return false;
	for (size_t i = 0; i < files->n; i++)
		place[i] = (struct place){files->path[i], i};
	qsort(place, files->n, sizeof(*place), place_order);
	for (size_t i = files->n; i-- > 1;) {
		if (strcmp(place[i].path, place[i - 1].path))
			continue;
		files->path[place[i].index] = NULL;
		free(place[i].path);
	}
	size_t kept = 0;
	for (size_t i = 0; i < files->n; i++)
		if (files->path[i])
			files->path[kept++] = files->path[i];
	files->n = kept;
	free(place);
	return true;
}

int files_collect(struct files *files, char *const *path, int n_paths, bool recursive)
{
	int bad = 0;
	bool stored = true;
	*files = (struct files){0};
	for (int i = 0; i < n_paths && stored; i++) {
		struct stat info;
		if (!stat(path[i], &info) && S_ISDIR(info.st_mode))
			bad += !add_directory(files, path[i], recursive);
		else
			stored = files_add(files, path[i]);
	}
	if (stored && drop_repeated(files))
		return bad;
	report_error("out of memory");
	files_free(files);
	return -1;
}

static int path_order(const void *a, const void *b)
{
	return strcmp(*(char *const *)a, *(char *const *)b);
}

void files_sort(struct files *files)
{
	if (files->n)
		qsort(files->path, files->n, sizeof(*files->path), path_order);
}

void files_keep_shard(struct files *files, struct shard shard)
{
	const size_t n = (size_t)shard.n;
	size_t kept = 0;
	files_sort(files);
	for (size_t i = 0; i < files->n; i++) {
		if (i % n == (size_t)shard.i - 1)
			files->path[kept++] = files->path[i];
		else
			free(files->path[i]);
	}
	files->n = kept;
}

void files_free(struct files *files)
{
	for (size_t i = 0; i < files->n; i++)
		free(files->path[i]);
	free(files->path);
	*files = (struct files){0};
}
