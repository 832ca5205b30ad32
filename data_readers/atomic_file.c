/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/atomic_file.h"
#include "data_readers/text_quote.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { LINKS_MAX = 40, TEMP_NAME_SIZE = 64, TEMP_ATTEMPTS = 10000 };

static enum status cannot_write(struct error *error, const char *path, int errnum)
{
	char name[TEXT_QUOTE_SIZE];

	text_quote(path, name, sizeof name);
	return error_set(error, errnum == ENOMEM ? STATUS_NO_MEMORY : STATUS_IO, "cannot write '%s': %s", name,
			 strerror(errnum));
}

/* Length of the directory part of a path, with its slash; 0 if there is none. */
static size_t directory_length(const char *path)
{
	const char *slash = strrchr(path, '/');

	return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The directory of `path` followed by `name`, newly allocated; NULL when out of memory. */
static char *beside(const char *path, const char *name)
{
	const size_t length = name[0] == '/' ? 0 : directory_length(path);
	char *joined = malloc(length + strlen(name) + 1);

	if (joined) {
		memcpy(joined, path, length);
		memcpy(joined + length, name, strlen(name) + 1);
	}
	return joined;
}

/* Names of open descriptors are links to the open file. Replacing it would lose what other programs write to it. */
static bool names_descriptor(const char *path)
{
	return strncmp(path, "/proc/", 6) == 0 || strncmp(path, "/dev/fd/", 8) == 0;
}

/* The target of `path` once links in its last part are followed, even if it does not exist; NULL and errno on failure.
 * realpath() does not work here: it rejects a link to a file that does not exist yet. */
static char *follow_links(const char *path)
{
	char *at = strdup(path), link[PATH_MAX];

	for (int links = 0; at && !names_descriptor(at); links++) {
		const ssize_t length = readlink(at, link, sizeof link - 1);
		if (length < 0)
			break; /* not a link: the target; opening it reports any other problem */
		link[length] = '\0';
		char *next = links < LINKS_MAX ? beside(at, link) : NULL;
		if (links >= LINKS_MAX)
			errno = ELOOP;
		const int errnum = errno;
		free(at);
		at = next;
		errno = errnum;
	}
	return at;
}

static FILE *open_stream(const char *path, int flags)
{
	int fd;

	do
		fd = open(path, O_WRONLY | O_CLOEXEC | O_NOCTTY | flags, 0666);
	while (fd < 0 && errno == EINTR);
	if (fd < 0)
		return NULL;
	FILE *stream = fdopen(fd, "w");
	if (!stream) {
		const int errnum = errno;
		close(fd);
		if (flags & O_CREAT)
			unlink(path);
		errno = errnum;
	}
	return stream;
}

/* Makes a new file beside the target. The name does not grow with the target's, which may be as long as names can be,
 * and O_EXCL, unlike mkstemp(), lets the kernel apply the umask. */
static int open_temp(struct atomic_file *file)
{
	char name[TEMP_NAME_SIZE];

	for (int attempt = 0; attempt < TEMP_ATTEMPTS; attempt++) {
		snprintf(name, sizeof name, ".stdfit-%ld-%d.tmp", (long)getpid(), attempt);
		free(file->temp);
		file->temp = beside(file->target, name);
		if (!file->temp)
			return ENOMEM;
		file->stream = open_stream(file->temp, O_CREAT | O_EXCL);
		if (file->stream)
			return 0;
		if (errno != EEXIST)
			break;
	}
	return errno;
}

/* Gives the new file the mode and, where permitted, the owner of the one it is to replace. */
static int inherit(const struct atomic_file *file, const struct stat *old)
{
	const int fd = fileno(file->stream);

	if (fchown(fd, old->st_uid, old->st_gid) != 0 && fchown(fd, (uid_t)-1, old->st_gid) != 0) {
		/* The old file had another owner, and its owner cannot be set: the new file stays ours. */
	}
	return fchmod(fd, old->st_mode & 0777) == 0 ? 0 : errno;
}

/* Opens file->stream for file->target; 0 or errno. */
static int open_output(struct atomic_file *file)
{
	struct stat old;
	const bool exists = stat(file->target, &old) == 0;

	if (!exists && errno != ENOENT)
		return errno;
	if (names_descriptor(file->target) || (exists && !S_ISREG(old.st_mode))) {
		file->stream = open_stream(file->target, O_APPEND);
		return file->stream ? 0 : errno;
	}
	if (file->target[0] == '\0')
		return ENOENT;
	if (file->target[directory_length(file->target)] == '\0')
		return EISDIR; /* ends in a slash */
	/* rename() replaces a read-only file too, but its owner meant it to stay. */
	if (exists && faccessat(AT_FDCWD, file->target, W_OK, AT_EACCESS) != 0)
		return errno;
	const int errnum = open_temp(file);
	return errnum || !exists ? errnum : inherit(file, &old);
}

enum status atomic_file_open(struct atomic_file *file, const char *path, struct error *error)
{
	*file = (struct atomic_file){.path = strdup(path), .target = follow_links(path)};
	const int errnum = file->path && file->target ? open_output(file) : errno;

	if (errnum == 0)
		return STATUS_OK;
	if (!file->stream) { /* a file with the temporary name is not ours */
		free(file->temp);
		file->temp = NULL;
	}
	atomic_file_abort(file);
	return cannot_write(error, path, errnum);
}

/* Flushes and closes the stream; 0 or the first errno. Pipes and terminals cannot be synced: no error. */
static int finish_stream(struct atomic_file *file)
{
	int errnum = file->errnum;

	if (fflush(file->stream) != 0 && errnum == 0)
		errnum = errno;
	if (ferror(file->stream) && errnum == 0)
		errnum = EIO; /* something written earlier was lost */
	while (errnum == 0 && file->temp && fsync(fileno(file->stream)) != 0)
		if (errno != EINTR)
			errnum = errno;
	if (fclose(file->stream) != 0 && errnum == 0)
		errnum = errno;
	file->stream = NULL;
	return errnum;
}

/* Makes the rename last through a power cut, where the file system can. The output is complete either way. */
static void sync_directory(const char *target)
{
	char *directory = beside(target, ".");
	const int fd = directory ? open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC) : -1;

	if (fd >= 0) {
		fsync(fd);
		close(fd);
	}
	free(directory);
}

enum status atomic_file_commit(struct atomic_file *file, struct error *error)
{
	enum status status = STATUS_OK;
	int errnum = finish_stream(file);

	if (errnum == 0 && file->temp) {
		if (rename(file->temp, file->target) != 0) {
			errnum = errno;
		} else {
			sync_directory(file->target);
			free(file->temp);
			file->temp = NULL;
		}
	}
	if (errnum != 0)
		status = cannot_write(error, file->path, errnum);
	atomic_file_abort(file);
	return status;
}

void atomic_file_abort(struct atomic_file *file)
{
	if (file->stream)
		fclose(file->stream);
	if (file->temp)
		unlink(file->temp);
	free(file->temp);
	free(file->target);
	free(file->path);
	*file = (struct atomic_file){0};
}
