/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "output_directory.h"
#include "text_quote.h"

#include <dirent.h>
#include <errno.h>
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

enum status scratch_make(const char *path, char **scratch, struct error *error)
{
	*scratch = NULL;
	if (asprintf(scratch, "%s/.stdfit-XXXXXX", path) < 0) {
		*scratch = NULL;
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	}
	if (mkdtemp(*scratch))
		return STATUS_OK;
	char name[TEXT_QUOTE_SIZE];
	const int errnum = errno;
	text_quote(path, name, sizeof name);
	free(*scratch);
	*scratch = NULL;
	return error_set(error, STATUS_IO, "cannot write to directory '%s': %s", name, strerror(errnum));
}

void scratch_remove(char *scratch)
{
	DIR *directory = scratch ? opendir(scratch) : NULL;
	for (struct dirent *entry; directory && (entry = readdir(directory));)
		unlinkat(dirfd(directory), entry->d_name, 0);
	if (directory)
		closedir(directory);
	if (scratch)
		rmdir(scratch);
	free(scratch);
}
