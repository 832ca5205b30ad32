/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/files.h"
#include "data_readers/measurement_read.h"
#include "data_readers/text_quote.h"
#include "fit/cli/messages.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
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
	return name[0] != '.' && measurement_extension(name);
}

/* A file or directory by what it is, not by its name. */
struct id {
	dev_t device;
	ino_t inode;
};

static int id_order(const void *a, const void *b)
{
	const struct id *x = a, *y = b;
	const int order = (x->device > y->device) - (x->device < y->device);
	return order ? order : (x->inode > y->inode) - (x->inode < y->inode);
}

/* The directories that a walk has seen: links can lead to the same one in more ways than could ever be followed. A hash
 * table, whose size is a power of two, at least half of it free (inode 0). */
struct seen {
	struct id *entry;
	size_t n, capacity;
};

static struct id *seen_entry(const struct seen *seen, struct id id)
{
	size_t at = (size_t)(((uint64_t)id.inode * 0x9e3779b97f4a7c15u) >> 32);
	for (;; at++) {
		struct id *entry = &seen->entry[at & (seen->capacity - 1)];
		if (!entry->inode || !id_order(entry, &id))
			return entry;
	}
}

static bool seen_grow(struct seen *seen)
{
	struct seen grown = {.n = seen->n, .capacity = seen->capacity ? 2 * seen->capacity : 64};
	grown.entry = calloc(grown.capacity, sizeof(*grown.entry));
	if (!grown.entry)
		return false;
	for (size_t i = 0; i < seen->capacity; i++)
		if (seen->entry[i].inode)
			*seen_entry(&grown, seen->entry[i]) = seen->entry[i];
	free(seen->entry);
	*seen = grown;
	return true;
}

/* Records a directory; 1 if it is new, 0 if it was seen before, -1 when out of memory. */
static int seen_add(struct seen *seen, const struct stat *info)
{
	const struct id id = {info->st_dev, info->st_ino};
	if (2 * seen->n >= seen->capacity && !seen_grow(seen))
		return -1;
	struct id *entry = seen_entry(seen, id);
	if (entry->inode)
		return 0;
	*entry = id;
	seen->n++;
	return 1;
}

static void cannot_read(const char *path, const char *problem)
{
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	report_error("cannot read '%s': %s", name, problem);
}

/* struct walk - through one directory and, perhaps, those below it. The C library's fts would follow the links of a web of
 * directories in every order, and crash when out of memory. */
struct walk {
	struct files *files;
	bool recursive;
	const atomic_bool *cancel;
	struct seen seen;
	int problems; /* already reported; the walk goes on */
	bool probing; /* only to see whether there is a file: ends with the first, and reports nothing */
};

/* Directories that a probe goes into at most. */
enum { PROBED_MAX = 1000 };

static bool is_over(const struct walk *walk)
{
	return *walk->cancel || (walk->probing && (walk->files->n || walk->seen.n > PROBED_MAX));
}

static void walk_problem(struct walk *walk, const char *path, const char *problem)
{
	walk->problems++;
	if (!walk->probing)
		cannot_read(path, problem);
}

static int name_order(const struct dirent **a, const struct dirent **b)
{
	return strcmp((*a)->d_name, (*b)->d_name);
}

static int is_visible(const struct dirent *entry)
{
	return entry->d_name[0] != '.';
}

/* directory/name, newly allocated; NULL when out of memory. */
static char *join(const char *directory, const char *name)
{
	const size_t length = strlen(directory);
	const bool slash = length && directory[length - 1] == '/';
	char *path = NULL;
	return asprintf(&path, "%s%s%s", directory, slash ? "" : "/", name) < 0 ? NULL : path;
}

static bool walk_directory(struct walk *walk, const char *path);

/* Adds the file of this name in a directory, or walks the directory. False when out of memory. */
static bool walk_entry(struct walk *walk, const char *path, const char *name)
{
	struct stat info;
	if (!walk->recursive && !is_material(name))
		return true;
	const bool known = !stat(path, &info);
	if (known && S_ISDIR(info.st_mode)) {
		const int is_new = walk->recursive ? seen_add(&walk->seen, &info) : 0;
		return is_new > 0 ? walk_directory(walk, path) : is_new == 0;
	}
	if (is_material(name) && measurement_is_known(path))
		return files_add(walk->files, path);
	/* It may be a directory, unless it is a link that leads nowhere. */
	if (!known && errno != ENOENT && errno != ELOOP)
		walk_problem(walk, path, strerror(errno));
	return true;
}

static bool walk_directory(struct walk *walk, const char *path)
{
	struct dirent **entry;
	const int n = scandir(path, &entry, is_visible, name_order);
	bool stored = true;
	if (n < 0)
		walk_problem(walk, path, strerror(errno));
	for (int i = 0; i < n; i++) {
		char *below = stored && !is_over(walk) ? join(path, entry[i]->d_name) : NULL;
		stored = stored && (is_over(walk) || (below && walk_entry(walk, below, entry[i]->d_name)));
		free(below);
		free(entry[i]);
	}
	if (n >= 0)
		free(entry);
	return stored;
}

/* Whether there are files in the directories below. */
static bool has_files_below(const char *path, const struct stat *info, const atomic_bool *cancel)
{
	struct files files = {0};
	struct walk walk = {.files = &files, .recursive = true, .cancel = cancel, .probing = true};
	const bool found = seen_add(&walk.seen, info) >= 0 && walk_directory(&walk, path) && files.n;
	free(walk.seen.entry);
	files_free(&files);
	return found;
}

/* Returns how many problems there were; -1 when out of memory. */
static int add_directory(struct files *files, const char *path, const struct stat *info, bool recursive,
			 const atomic_bool *cancel)
{
	const size_t before = files->n;
	struct walk walk = {.files = files, .recursive = recursive, .cancel = cancel};
	const bool stored = seen_add(&walk.seen, info) >= 0 && walk_directory(&walk, path);
	free(walk.seen.entry);
	if (stored && !walk.problems && files->n == before && !*cancel) {
		const bool below = !recursive && has_files_below(path, info, cancel);
		walk_problem(&walk, path,
			     below ? "no measurement in this directory itself: -r takes those in the directories below"
				   : "no measurement of a known format in this directory");
	}
	return stored ? walk.problems : -1;
}

struct indexed_path {
	char *path;
	size_t index;
};

static int indexed_path_order(const void *a, const void *b)
{
	const struct indexed_path *x = a, *y = b;
	const int order = strcmp(x->path, y->path);
	return order ? order : (x->index > y->index) - (x->index < y->index);
}

/* Keeps the first of equal paths. */
static bool drop_repeated(struct files *files)
{
	struct indexed_path *indexed = calloc(files->n + 1, sizeof(*indexed));
	if (!indexed)
		return false;
	for (size_t i = 0; i < files->n; i++)
		indexed[i] = (struct indexed_path){files->path[i], i};
	qsort(indexed, files->n, sizeof(*indexed), indexed_path_order);
	for (size_t i = files->n; i-- > 1;) {
		if (strcmp(indexed[i].path, indexed[i - 1].path))
			continue;
		files->path[indexed[i].index] = NULL;
		free(indexed[i].path);
	}
	size_t kept = 0;
	for (size_t i = 0; i < files->n; i++)
		if (files->path[i])
			files->path[kept++] = files->path[i];
	files->n = kept;
	free(indexed);
	return true;
}

int files_collect(struct files *files, char *const *path, int n_paths, bool recursive, const atomic_bool *cancel)
{
	int bad = 0;
	bool stored = true;
	*files = (struct files){0};
	for (int i = 0; i < n_paths && stored && !*cancel; i++) {
		struct stat info;
		const bool is_directory = !stat(path[i], &info) && S_ISDIR(info.st_mode);
		const int problems = is_directory ? add_directory(files, path[i], &info, recursive, cancel) : 0;
		bad += problems > 0;
		stored = is_directory ? problems >= 0 : files_add(files, path[i]);
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

/* False if nothing is there. */
static bool find_id(const char *path, struct id *id, bool *regular)
{
	struct stat info;
	if (stat(path, &info))
		return false;
	*id = (struct id){info.st_dev, info.st_ino};
	*regular = S_ISREG(info.st_mode);
	return true;
}

/* Returns the part after the last slash; the part before it goes to `directory`. */
static const char *split(const char *path, char directory[PATH_MAX])
{
	const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
	const size_t length = (size_t)(name - path);
	snprintf(directory, PATH_MAX, "%.*s.", length < PATH_MAX ? (int)length : 0, path);
	return name;
}

bool files_same(const char *a, const char *b)
{
	struct id x, y;
	bool regular;
	const bool a_is_there = find_id(a, &x, &regular), b_is_there = find_id(b, &y, &regular);
	if (a_is_there || b_is_there)
		return a_is_there && b_is_there && regular && !id_order(&x, &y);
	char in_a[PATH_MAX], in_b[PATH_MAX];
	return !strcmp(split(a, in_a), split(b, in_b)) && find_id(in_a, &x, &regular) && find_id(in_b, &y, &regular) &&
	       !id_order(&x, &y);
}
