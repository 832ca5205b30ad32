/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/store.h"
#include "data_readers/atomic_file.h"
#include "data_readers/text_quote.h"
#include "fit/results/contradiction.h"

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

enum status store_probe(const char *path, struct error *error)
{
	struct output output;
	struct atomic_file file;
	enum status status = output_find(&output, path, error);
	const bool in_order = status == STATUS_OK && output.in_order;
	output_close(&output);
	/* Opening a pipe is seen at its other end. */
	if (status != STATUS_OK || in_order)
		return status;
	status = atomic_file_open(&file, path, error);
	if (status == STATUS_OK)
		atomic_file_abort(&file);
	return status;
}

enum status store_write(const char *path, const struct csv_table *table,
			void (*write)(FILE *file, const struct csv_table *table), struct error *error)
{
	struct atomic_file file;
	const enum status status = atomic_file_open(&file, path, error);
	if (status != STATUS_OK)
		return status;
	file.keeps = true;
	write(file.stream, table);
	if (fflush(file.stream))
		file.errnum = errno;
	return atomic_file_commit(&file, error);
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

/* Puts the old rows in order and finds out which of them count. */
static enum status sort_old(struct store *store)
{
	struct contradiction found, again;
	store->stale = calloc(store->old.n_rows + 1, sizeof(*store->stale));
	store->doubtful = calloc(store->old.n_rows + 1, sizeof(*store->doubtful));
	if (!store->stale || !store->doubtful)
		return STATUS_NO_MEMORY;
	/* The rows' numbers are those of the file, the flags those of the order. */
	enum status status = contradiction_find(&store->old, SAME_RUN, &found, NULL, NULL);
	if (store->old.n_rows)
		qsort(store->old.row, store->old.n_rows, sizeof(*store->old.row), path_order);
	if (status == STATUS_OK)
		status = contradiction_find(&store->old, SAME_RUN, &again, store->doubtful, store->stale);
	if (status == STATUS_OK && found.first) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(store->path, name, sizeof name);
		error_set(&store->doubt, STATUS_FORMAT,
			  "'%s' rows %zu and %zu, of the same fit, differ in %s: such fits are made again", name,
			  found.first, found.second, result_columns[found.column].name);
	}
	return status;
}

/* Reads what an earlier run left and cuts off the rest of an interrupted write. */
static enum status resume_old(struct store *store, struct error *error)
{
	const int fd = store->output.fd;
	enum beginning beginning = HEADER_FOREIGN;
	size_t complete = 0;
	if (look_at_header(fd, &beginning))
		return cannot(error, "read", store->path, errno);
	if (beginning == HEADER_FOREIGN)
		return foreign_columns(store->path, "resume", error);
	store->headed = beginning == HEADER_WHOLE;
	if (store->headed) {
		const enum status status = csv_table_read(&store->old, store->path, RESULT_LATER, &complete, error);
		if (status != STATUS_OK)
			return status;
	}
	if (sort_old(store) != STATUS_OK)
		return cannot(error, "read", store->path, ENOMEM);
	/* The last run was killed when it had made the backup: what is appended must not appear there. */
	char *backup = output_is_backup(&store->output) ? output_backup_name(&store->output) : NULL;
	if (backup)
		unlink(backup);
	free(backup);
	return ftruncate(fd, (off_t)complete) ? cannot(error, "write", store->path, errno) : STATUS_OK;
}

enum status store_open(struct store *store, const char *path, bool resume, struct error *error)
{
	*store = (struct store){.path = path, .old = csv_table_make(result_columns, RESULT_COLUMNS)};
	enum status status = output_find(&store->output, path, error);
	if (status == STATUS_OK && resume && store->output.in_order) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(path, name, sizeof name);
		status = error_set(error, STATUS_IO,
				   "cannot resume '%s': expected a file, found a pipe, a device or a descriptor", name);
	}
	if (status == STATUS_OK)
		status = output_open(&store->output, resume ? OUTPUT_GO_ON : OUTPUT_BEGIN, error);
	const bool exists = status == STATUS_OK && !store->output.in_order && !store->output.created;
	store->replaces = exists && !resume;
	if (exists && resume)
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
	       result_same_options(row[RESULT_OPTIONS], source->options) &&
	       !strcmp(row[RESULT_VERSION], STDFIT_VERSION);
}

bool store_has(const struct store *store, const struct result_source *source, const char *ndf)
{
	for (size_t i = first_old(store, source->path); i < store->old.n_rows; i++) {
		char *const *row = store->old.row[i];
		if (strcmp(row[RESULT_PATH], source->path))
			break;
		if (is_current(row, source) && !store->doubtful[i] && (!ndf || !strcmp(row[RESULT_NDF], ndf)))
			return true;
	}
	return false;
}

static bool is_current_for_any(char *const *row, const struct result_source *source, int n)
{
	for (int i = 0; i < n; i++)
		if (is_current(row, &source[i]))
			return true;
	return false;
}

void store_drop_stale(struct store *store, const struct result_source *source, int n)
{
	for (size_t i = first_old(store, source->path); i < store->old.n_rows; i++) {
		if (strcmp(store->old.row[i][RESULT_PATH], source->path))
			break;
		store->stale[i] |= store->doubtful[i] || !is_current_for_any(store->old.row[i], source, n);
	}
}

/* Appends a line with one write, or nothing of it. */
static enum status append_line(const struct store *store, int fd, char *const *row, struct error *error)
{
	size_t size;
	char *text = row_text(row, &size);
	if (!text)
		return cannot(error, "write", store->path, ENOMEM);
	const off_t before = store->output.in_order ? -1 : lseek(fd, 0, SEEK_END);
	size_t written = 0;
	int errnum = 0;
	while (written < size && !errnum) {
		const ssize_t n = write(fd, text + written, size - written);
		if (n > 0)
			written += (size_t)n;
		else if (errno != EINTR)
			errnum = n ? errno : ENOSPC;
	}
	free(text);
	if (!errnum)
		return STATUS_OK;
	if (before >= 0 && ftruncate(fd, before)) {
		/* What is left of the line is what a kill would leave: --resume cuts it off. */
	}
	return cannot(error, "write", store->path, errnum);
}

/* Puts a new table, of a header and perhaps a row, in the place of an older file, which becomes FILE~: at no moment is
 * there none, and where there is no room for a row the older one stays. */
static enum status replace_old(struct store *store, char *const *row, struct error *error)
{
	char *name;
	const int fd = output_new_file(&store->output, &name);
	if (fd < 0)
		return output_failed(&store->output, errno, error);
	enum status status = append_line(store, fd, NULL, error);
	if (status == STATUS_OK && row)
		status = append_line(store, fd, row, error);
	if (status == STATUS_OK)
		status = output_back_up(&store->output, error);
	if (status == STATUS_OK) {
		const int errnum = output_replace(&store->output, name, fd);
		if (errnum)
			status = output_failed(&store->output, errnum, error);
	}
	if (status != STATUS_OK) {
		close(fd);
		unlink(name);
	}
	free(name);
	store->replaces = store->replaces && status != STATUS_OK;
	store->headed = status == STATUS_OK;
	return status;
}

enum status store_begin(struct store *store, struct error *error)
{
	if (store->replaces)
		return replace_old(store, NULL, error);
	if (store->headed)
		return STATUS_OK;
	const enum status status = append_line(store, store->output.fd, NULL, error);
	store->headed = status == STATUS_OK;
	return status;
}

enum status store_append(struct store *store, const struct csv_table *rows, struct error *error)
{
	size_t i = 0;
	enum status status = STATUS_OK;
	if (rows->n_rows && store->replaces)
		status = replace_old(store, rows->row[i++], error);
	else if (rows->n_rows)
		status = store_begin(store, error);
	for (; i < rows->n_rows && status == STATUS_OK; i++)
		status = append_line(store, store->output.fd, rows->row[i], error);
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
	if (store->output.in_order || !store->headed)
		return STATUS_OK;
	size_t n;
	char ***merged = merged_rows(store, rows, &n);
	if (!merged)
		return cannot(error, "write", store->path, ENOMEM);
	struct csv_table table = csv_table_make(result_columns, RESULT_COLUMNS);
	table.row = merged;
	table.n_rows = n;
	struct atomic_file file;
	enum status status = atomic_file_take(&file, &store->output, error);
	if (status == STATUS_OK) {
		file.keeps = n < store->old.n_rows + rows->n_rows;
		csv_write(file.stream, &table);
		if (fflush(file.stream))
			file.errnum = errno;
		status = atomic_file_commit(&file, error);
	}
	free(merged);
	return status;
}

void store_close(struct store *store)
{
	struct stat info;
	const struct output *output = &store->output;
	const bool empty = output->path && output->created && !store->headed && output_is_there(output) &&
			   !fstat(output->fd, &info) && !info.st_size;
	if (empty)
		unlink(output->target);
	output_close(&store->output);
	csv_table_free(&store->old);
	free(store->stale);
	free(store->doubtful);
	*store = (struct store){.output = {.fd = -1}};
}
