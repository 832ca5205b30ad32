/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/store.h"
#include "data_readers/atomic_file.h"
#include "data_readers/text_quote.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static enum status cannot(struct error *error, const char *what, const char *path, int errnum)
{
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	return error_set(error, errnum == ENOMEM ? STATUS_NO_MEMORY : STATUS_IO, "cannot %s '%s': %s", what, name,
			 strerror(errnum));
}

static bool is_regular(const char *path)
{
	struct stat info;
	return !stat(path, &info) && S_ISREG(info.st_mode);
}

enum status store_probe(const char *path, struct error *error)
{
	struct stat info;
	struct atomic_file file;
	/* Opening a pipe is seen at its other end. */
	if (!stat(path, &info) && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode))
		return STATUS_OK;
	const enum status status = atomic_file_open(&file, path, error);
	if (status == STATUS_OK)
		atomic_file_abort(&file);
	return status;
}

static bool is_link(const char *path)
{
	struct stat info;
	return !lstat(path, &info) && S_ISLNK(info.st_mode);
}

/* Gives a regular file the name with ~ behind it, in place of its own or (`both`) beside it. */
static enum status back_up(const char *path, bool both, struct error *error)
{
	if (!is_regular(path))
		return STATUS_OK;
	const size_t size = strlen(path) + sizeof "~";
	char *backup = malloc(size);
	if (!backup)
		return cannot(error, "write", path, ENOMEM);
	snprintf(backup, size, "%s~", path);
	/* Where hard links are not to be had, the file is away for the moment until the new one takes its place. A
	 * symbolic link stays, and so does the name of what it points to: that is what gets replaced. */
	bool done = both && (!unlink(backup) || errno == ENOENT) &&
		    !linkat(AT_FDCWD, path, AT_FDCWD, backup, AT_SYMLINK_FOLLOW);
	if (!done && !(both && is_link(path)))
		done = !rename(path, backup);
	const enum status status = done ? STATUS_OK : cannot(error, "write", backup, errno);
	free(backup);
	return status;
}

enum status store_write(const char *path, const struct csv_table *table,
			void (*write)(FILE *file, const struct csv_table *table), struct error *error)
{
	struct atomic_file file;
	enum status status = atomic_file_open(&file, path, error);
	if (status != STATUS_OK)
		return status;
	write(file.stream, table);
	/* A full disk shows before the older file is touched. */
	if (fflush(file.stream))
		file.errnum = errno;
	else
		status = back_up(path, true, error);
	if (status == STATUS_OK)
		return atomic_file_commit(&file, error);
	atomic_file_abort(&file);
	return status;
}

/* The line of a row, or the header line for NULL, newly allocated; NULL when out of memory. */
static char *row_text(char *const *row, size_t *size)
{
	char *text = NULL;
	FILE *file = open_memstream(&text, size);
	if (!file)
		return NULL;
	if (row)
		csv_write_row(file, row, RESULT_COLUMNS);
	else
		csv_write_header(file, result_columns, RESULT_COLUMNS);
	const bool failed = ferror(file);
	if (fclose(file) || failed) {
		free(text);
		return NULL;
	}
	return text;
}

/* How an existing file begins. */
enum beginning { HEADER_FOREIGN, HEADER_CUT, HEADER_WHOLE };

static enum status look_at_header(int fd, enum beginning *beginning)
{
	size_t size;
	char *header = row_text(NULL, &size);
	char *found = calloc(1, header ? size : 1);
	const ssize_t n = header && found ? pread(fd, found, size, 0) : -1;
	if (n >= 0)
		*beginning = memcmp(header, found, (size_t)n) ? HEADER_FOREIGN
			     : (size_t)n < size               ? HEADER_CUT
							      : HEADER_WHOLE;
	const int errnum = header && found ? errno : ENOMEM;
	free(found);
	free(header);
	errno = errnum;
	return n >= 0 ? STATUS_OK : STATUS_IO;
}

static int path_order(const void *a, const void *b)
{
	char *const *row_a = *(char **const *)a, *const *row_b = *(char **const *)b;
	return strcmp(row_a[RESULT_PATH], row_b[RESULT_PATH]);
}

static enum status foreign_columns(const char *path, const char *what, struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	return error_set(error, STATUS_FORMAT, "cannot %s '%s': expected the columns of stdfit %s in line 1", what,
			 name, STDFIT_VERSION);
}

enum status store_check_columns(const char *path, struct error *error)
{
	enum beginning beginning = HEADER_FOREIGN;
	const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY);
	if (fd < 0)
		return cannot(error, "read", path, errno);
	const enum status status = look_at_header(fd, &beginning);
	const int errnum = errno;
	close(fd);
	if (status != STATUS_OK)
		return cannot(error, "read", path, errnum);
	return beginning == HEADER_WHOLE ? STATUS_OK : foreign_columns(path, "merge", error);
}

/* Reads what an earlier run left and cuts off the rest of an interrupted write. */
static enum status resume_old(struct store *store, struct error *error)
{
	enum beginning beginning = HEADER_FOREIGN;
	size_t complete = 0;
	if (look_at_header(store->fd, &beginning))
		return cannot(error, "read", store->path, errno);
	if (beginning == HEADER_FOREIGN)
		return foreign_columns(store->path, "resume", error);
	store->headed = beginning == HEADER_WHOLE;
	if (store->headed) {
		const enum status status = csv_table_read(&store->old, store->path, RESULT_COLUMNS, &complete, error);
		if (status != STATUS_OK)
			return status;
	}
	store->stale = calloc(store->old.n_rows + 1, sizeof(*store->stale));
	if (!store->stale)
		return cannot(error, "read", store->path, ENOMEM);
	if (store->old.n_rows)
		qsort(store->old.row, store->old.n_rows, sizeof(*store->old.row), path_order);
	return ftruncate(store->fd, (off_t)complete) ? cannot(error, "write", store->path, errno) : STATUS_OK;
}

static enum status open_table(struct store *store, int flags, struct error *error)
{
	store->fd = open(store->path, flags | O_APPEND | O_CLOEXEC | O_NOCTTY, 0666);
	return store->fd < 0 ? cannot(error, "write", store->path, errno) : STATUS_OK;
}

enum status store_open(struct store *store, const char *path, bool resume, struct error *error)
{
	*store = (struct store){.path = path, .fd = -1, .old = csv_table_make(result_columns, RESULT_COLUMNS)};
	struct stat info;
	const bool exists = !stat(path, &info);
	store->regular = !exists || S_ISREG(info.st_mode);
	store->replaces = exists && store->regular && !resume;
	store->created = !exists;
	/* A pipe opened for reading too would be its own reader and swallow the rows. */
	const bool resumes = exists && store->regular && resume;
	enum status status = open_table(store, exists ? (resumes ? O_RDWR : O_WRONLY) : O_WRONLY | O_CREAT, error);
	if (status == STATUS_OK && resumes)
		status = resume_old(store, error);
	if (status != STATUS_OK)
		store_close(store);
	return status;
}

/* The first old row whose path is not less than `path`. */
static size_t first_old(const struct store *store, const char *path)
{
	size_t low = 0, high = store->old.n_rows;
	while (low < high) {
		const size_t middle = low + (high - low) / 2;
		if (strcmp(store->old.row[middle][RESULT_PATH], path) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	return low;
}

static bool is_current(char *const *row, const struct result_source *source)
{
	return !result_failed(row) && (!source->input || !strcmp(row[RESULT_INPUT], source->input)) &&
	       !strcmp(row[RESULT_OPTIONS], source->options) && !strcmp(row[RESULT_VERSION], STDFIT_VERSION);
}

bool store_has(const struct store *store, const struct result_source *source, const char *ndf)
{
	for (size_t i = first_old(store, source->path); i < store->old.n_rows; i++) {
		char *const *row = store->old.row[i];
		if (strcmp(row[RESULT_PATH], source->path))
			break;
		if (is_current(row, source) && (!ndf || !strcmp(row[RESULT_NDF], ndf)))
			return true;
	}
	return false;
}

void store_drop_stale(struct store *store, const struct result_source *source)
{
	for (size_t i = first_old(store, source->path); i < store->old.n_rows; i++) {
		if (strcmp(store->old.row[i][RESULT_PATH], source->path))
			break;
		store->stale[i] = !is_current(store->old.row[i], source);
	}
}

/* Appends a line with one write, or nothing of it. */
static enum status append_line(struct store *store, char *const *row, struct error *error)
{
	size_t size;
	char *text = row_text(row, &size);
	if (!text)
		return cannot(error, "write", store->path, ENOMEM);
	const off_t before = store->regular ? lseek(store->fd, 0, SEEK_END) : -1;
	size_t written = 0;
	int errnum = 0;
	while (written < size && !errnum) {
		const ssize_t n = write(store->fd, text + written, size - written);
		if (n > 0)
			written += (size_t)n;
		else if (errno != EINTR)
			errnum = n ? errno : ENOSPC;
	}
	free(text);
	if (!errnum)
		return STATUS_OK;
	if (before >= 0 && ftruncate(store->fd, before)) {
		/* What is left of the line is what a kill would leave: --resume cuts it off. */
	}
	return cannot(error, "write", store->path, errnum);
}

/* Moves an older table out of the way, for the first row. */
static enum status replace_old(struct store *store, struct error *error)
{
	close(store->fd);
	store->fd = -1;
	store->replaces = false;
	const enum status status = back_up(store->path, false, error);
	store->created = status == STATUS_OK;
	return status != STATUS_OK ? status : open_table(store, O_WRONLY | O_CREAT, error);
}

enum status store_begin(struct store *store, struct error *error)
{
	enum status status = store->replaces ? replace_old(store, error) : STATUS_OK;
	if (!store->headed && status == STATUS_OK) {
		status = append_line(store, NULL, error);
		store->headed = status == STATUS_OK;
	}
	return status;
}

enum status store_append(struct store *store, const struct csv_table *rows, struct error *error)
{
	enum status status = rows->n_rows ? store_begin(store, error) : STATUS_OK;
	for (size_t i = 0; i < rows->n_rows && status == STATUS_OK; i++)
		status = append_line(store, rows->row[i], error);
	return status;
}

/* Kept old rows and the new ones, all borrowed, in order; NULL when out of memory. */
static char ***merged_rows(const struct store *store, const struct csv_table *rows, size_t *n)
{
	char ***merged = calloc(store->old.n_rows + rows->n_rows + 1, sizeof(*merged));
	*n = 0;
	for (size_t i = 0; merged && i < store->old.n_rows; i++)
		if (!store->stale[i])
			merged[(*n)++] = store->old.row[i];
	for (size_t i = 0; merged && i < rows->n_rows; i++)
		merged[(*n)++] = rows->row[i];
	if (merged)
		qsort(merged, *n, sizeof(*merged), result_order);
	return merged;
}

enum status store_rewrite(struct store *store, const struct csv_table *rows, struct error *error)
{
	if (!store->regular || !store->headed)
		return STATUS_OK;
	size_t n;
	char ***merged = merged_rows(store, rows, &n);
	if (!merged)
		return cannot(error, "write", store->path, ENOMEM);
	struct csv_table table = csv_table_make(result_columns, RESULT_COLUMNS);
	table.row = merged;
	table.n_rows = n;
	struct atomic_file file;
	enum status status = atomic_file_open(&file, store->path, error);
	if (status == STATUS_OK) {
		csv_write(file.stream, &table);
		status = n < store->old.n_rows + rows->n_rows ? back_up(store->path, true, error) : STATUS_OK;
		if (status != STATUS_OK)
			atomic_file_abort(&file);
		else
			status = atomic_file_commit(&file, error);
	}
	free(merged);
	return status;
}

void store_close(struct store *store)
{
	struct stat info;
	const bool open = store->path && store->fd >= 0;
	if (open && store->created && !store->headed && !fstat(store->fd, &info) && !info.st_size)
		unlink(store->path);
	if (open)
		close(store->fd);
	csv_table_free(&store->old);
	free(store->stale);
	*store = (struct store){.fd = -1};
}
