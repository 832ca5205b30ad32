/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/output_directory.h"
#include "data_readers/text_quote.h"
#include "fit/cli/files.h"

#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* 0 or errno. */
static int make(const char *path)
{
	struct stat info;
	if (mkdir(path, 0777) && errno != EEXIST)
		return errno;
	if (stat(path, &info))
		return errno;
	if (!S_ISDIR(info.st_mode))
		return ENOTDIR;
	return access(path, W_OK | X_OK) ? errno : 0;
}

enum status output_directory_make(const char *path, const char *below, char **made, struct error *error)
{
	char *whole = NULL;
	if (made)
		*made = NULL;
	if (asprintf(&whole, "%s%s%s", path, below ? "/" : "", below ? below : "") < 0)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	const int errnum = make(whole);
	if (!errnum && made) {
		*made = whole;
		return STATUS_OK;
	}
	char name[TEXT_QUOTE_SIZE];
	text_quote(whole, name, sizeof name);
	free(whole);
	return errnum ? error_set(error, STATUS_IO, "cannot write to directory '%s': %s", name, strerror(errnum))
		      : STATUS_OK;
}

enum status output_directory_spares(const char *directory, const char *name, char *const *path, int n,
				    struct error *error)
{
	char *written;
	if (asprintf(&written, "%s/%s", directory, name) < 0)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	bool same = false;
	for (int i = 0; i < n; i++)
		same |= files_same(path[i], written);
	free(written);
	return same ? error_set(error, STATUS_DOMAIN, "expected another directory: %s in this one is to be read", name)
		    : STATUS_OK;
}

const char *output_file_problem(int at, const char *name)
{
	struct stat info;
	if (fstatat(at, name, &info, 0) || S_ISREG(info.st_mode))
		return NULL;
	return S_ISDIR(info.st_mode) ? "expected a file or nothing there, found a directory"
				     : "expected a file or nothing there, found a pipe or device";
}

enum status output_directory_path(const char *directory, const char *name, char **path, struct error *error)
{
	char shown[TEXT_QUOTE_SIZE];
	if (asprintf(path, "%s/%s", directory, name) < 0) {
		*path = NULL;
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	}
	const char *problem = output_file_problem(AT_FDCWD, *path);
	if (!problem)
		return STATUS_OK;
	text_quote(*path, shown, sizeof shown);
	free(*path);
	*path = NULL;
	return error_set(error, STATUS_IO, "cannot write '%s': %s", shown, problem);
}

enum status output_directory_accepts(const char *directory, const char *name, struct error *error)
{
	char *path;
	const enum status status = output_directory_path(directory, name, &path, error);
	free(path);
	return status;
}

enum status scratch_make(const char *path, struct scratch *scratch, struct error *error)
{
	char *made;
	*scratch = (struct scratch){0};
	if (asprintf(&made, "%s/.stdfit-XXXXXX", path) < 0)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	const bool there = mkdtemp(made);
	DIR *directory = there ? opendir(made) : NULL;
	if (directory) {
		*scratch = (struct scratch){made, directory};
		return STATUS_OK;
	}
	char name[TEXT_QUOTE_SIZE];
	const int errnum = errno;
	if (there)
		rmdir(made);
	free(made);
	text_quote(path, name, sizeof name);
	return error_set(error, STATUS_IO, "cannot write to directory '%s': %s", name, strerror(errnum));
}

void scratch_remove(struct scratch *scratch)
{
	if (!scratch->path)
		return;
	rewinddir(scratch->directory);
	for (struct dirent *entry; (entry = readdir(scratch->directory));)
		unlinkat(dirfd(scratch->directory), entry->d_name, 0);
	closedir(scratch->directory);
	rmdir(scratch->path);
	free(scratch->path);
	*scratch = (struct scratch){0};
}
