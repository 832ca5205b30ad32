/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/output.h"
#include "data_readers/text_quote.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/magic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/vfs.h>
#include <time.h>
#include <unistd.h>

enum {
	LINKS_MAX = 40,
	TEMP_NAME_SIZE = 64,
	TEMP_ATTEMPTS = 10000,
	LOCK_ATTEMPTS = 1000,
	LOCK_WAITS = 50,
	LOCK_WAIT_NS = 20000000, /* times LOCK_WAITS: a second */
	COPY_SIZE = 1 << 16
};

/* Names */

/* Length of the directory part of a path, with its slash; 0 if there is none. */
static size_t directory_length(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? (size_t)(slash - path) + 1 : 0;
}

/* The same with a dot behind it; false: it is too long for any file. Needs no memory: without that a link to a
 * descriptor must not pass for one to a file. */
static bool get_directory(const char *path, char directory[PATH_MAX])
{
	const size_t length = directory_length(path);
	if (length + sizeof "." > PATH_MAX)
		return false;
	memcpy(directory, path, length);
	strcpy(directory + length, ".");
	return true;
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

/* Whether a name is one of /proc itself. Its links to open files do not lead to a name that could be replaced,
 * though readlink() shows one. The directory is asked, not its name: /proc/self/cwd/x is an ordinary file, /dev/fd/1
 * is not. */
static bool is_in_proc(const char *path)
{
	char directory[PATH_MAX];
	struct statfs info;
	return get_directory(path, directory) && !statfs(directory, &info) && info.f_type == PROC_SUPER_MAGIC;
}

/* The number of the descriptor of this process that a name in /proc stands for; -1: none. */
static int own_descriptor(const char *path)
{
	const char *digits = path + directory_length(path);
	char directory[PATH_MAX], *end;
	struct stat named, own;
	const bool is_own = get_directory(path, directory) && !stat(directory, &named) &&
			    !stat("/proc/self/fd", &own) && named.st_dev == own.st_dev && named.st_ino == own.st_ino;
	errno = 0;
	const long number = strtol(digits, &end, 10);
	return is_own && *digits >= '0' && *digits <= '9' && !*end && !errno && number <= INT_MAX ? (int)number : -1;
}

/* The target of `path` once links in its last part are followed, even if it does not exist; NULL and errno on failure.
 * realpath() does not work here: it rejects a link to a file that does not exist yet. */
static char *follow_links(const char *path)
{
	char *at = strdup(path), link[PATH_MAX];
	for (int links = 0; at && strcmp(path, "-") && !is_in_proc(at); links++) {
		const ssize_t length = readlink(at, link, sizeof link - 1);
		if (length < 0)
			break; /* not a link: the target; opening it reports any other problem */
		link[length] = '\0';
		char *next = links < LINKS_MAX ? beside(at, link) : NULL;
		const int errnum = links < LINKS_MAX ? errno : ELOOP;
		free(at);
		at = next;
		errno = errnum;
	}
	return at;
}

/* Given as "-". */
static bool is_dash(const struct output *output)
{
	return !strcmp(output->path, "-");
}

bool output_is_standard(const struct output *output)
{
	return output->in_order && (is_dash(output) || own_descriptor(output->target) == STDOUT_FILENO);
}

/* Locks */

static int open_again(const char *path, int flags)
{
	int fd;
	do
		fd = open(path, flags | O_CLOEXEC | O_NOCTTY, 0666);
	while (fd < 0 && errno == EINTR);
	return fd;
}

static bool is_file(const char *path, int fd)
{
	struct stat named, open_one;
	return !stat(path, &named) && !fstat(fd, &open_one) && named.st_dev == open_one.st_dev &&
	       named.st_ino == open_one.st_ino;
}

bool output_is_there(const struct output *output)
{
	return output->fd >= 0 && is_file(output->target, output->fd);
}

/* Locks an open file; false: another process has the lock. A process that was killed has it until the system has
 * cleaned up, so this waits a moment. Where the file system has no locks, all is well. */
static bool lock(int fd)
{
	for (int wait = 0; flock(fd, LOCK_EX | LOCK_NB) && errno == EWOULDBLOCK; wait++) {
		if (wait == LOCK_WAITS)
			return false;
		nanosleep(&(struct timespec){.tv_nsec = LOCK_WAIT_NS}, NULL);
	}
	return true;
}

/* Opens the file of this name and locks it. A writer that was faster may have given the name to another file before the
 * lock was had: then that one is tried. Returns -1 and errno; EWOULDBLOCK: another process has the lock. */
static int open_locked(const char *path, int flags)
{
	for (int attempt = 0;; attempt++) {
		const int fd = open_again(path, flags);
		if (fd < 0)
			return -1;
		if (!lock(fd)) {
			close(fd);
			errno = EWOULDBLOCK;
			return -1;
		}
		if (is_file(path, fd) || attempt == LOCK_ATTEMPTS)
			return fd;
		close(fd);
	}
}

/* The process that has the lock on a file, as /proc/locks tells it; 0: it does not. */
static long lock_holder(const char *path)
{
	struct stat info;
	FILE *locks = fopen("/proc/locks", "re");
	char line[256];
	long holder = 0;
	while (locks && !stat(path, &info) && !holder && fgets(line, sizeof line, locks)) {
		long pid;
		unsigned device_major, device_minor;
		unsigned long inode;
		if (sscanf(line, "%*d: %*s %*s WRITE %ld %x:%x:%lu", &pid, &device_major, &device_minor, &inode) == 4 &&
		    inode == info.st_ino && makedev(device_major, device_minor) == info.st_dev && pid > 0)
			holder = pid;
	}
	if (locks)
		fclose(locks);
	return holder;
}

enum status output_failed(const struct output *output, int errnum, struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	const enum status status = errnum == ENOMEM ? STATUS_NO_MEMORY : STATUS_IO;
	if (is_dash(output))
		return error_set(error, status, "cannot write standard output: %s", strerror(errnum));
	text_quote(output->path, name, sizeof name);
	if (errnum != EWOULDBLOCK || output->in_order)
		return error_set(error, status, "cannot write '%s': %s", name, strerror(errnum));
	const long holder = lock_holder(output->target);
	return holder ? error_set(error, status, "cannot write '%s': process %ld is writing it", name, holder)
		      : error_set(error, status, "cannot write '%s': another process is writing it", name);
}

enum status output_find(struct output *output, const char *path, struct error *error)
{
	struct stat info;
	*output = (struct output){.path = strdup(path), .target = follow_links(path), .fd = -1};
	if (!output->path || !output->target) {
		const struct output named = {.path = (char *)path, .in_order = true};
		const enum status status = output_failed(&named, errno, error);
		output_close(output);
		return status;
	}
	output->in_order = is_dash(output) || is_in_proc(output->target) ||
			   (!stat(output->target, &info) && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode));
	return STATUS_OK;
}

/* Opening */

static int open_in_order(const struct output *output)
{
	const int own = is_dash(output) ? STDOUT_FILENO : own_descriptor(output->target);
	if (own < 0)
		return open_again(output->target, O_WRONLY | O_APPEND);
	const int flags = fcntl(own, F_GETFL);
	if (flags >= 0 && (flags & O_ACCMODE) == O_RDONLY) {
		errno = EBADF;
		return -1;
	}
	return fcntl(own, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
}

static int open_file(struct output *output, enum output_use use)
{
	const char *target = output->target;
	struct stat info;
	if (!target[0]) {
		errno = ENOENT;
		return -1;
	}
	/* It ends in a slash, or is one. */
	if (!target[directory_length(target)] || (!stat(target, &info) && S_ISDIR(info.st_mode))) {
		errno = EISDIR;
		return -1;
	}
	const int access_mode = use == OUTPUT_GO_ON ? O_RDWR : O_WRONLY;
	for (;;) {
		int fd = open_locked(target, access_mode | O_APPEND);
		if (fd >= 0 || errno != ENOENT || use == OUTPUT_REPLACE)
			return fd;
		fd = open_locked(target, O_RDWR | O_APPEND | O_CREAT | O_EXCL);
		output->created = fd >= 0;
		if (fd >= 0 || errno != EEXIST)
			return fd;
	}
}

enum status output_open(struct output *output, enum output_use use, struct error *error)
{
	errno = 0;
	output->fd = output->in_order ? open_in_order(output) : open_file(output, use);
	const bool absent = output->fd < 0 && errno == ENOENT && output->target[0] && !output->in_order;
	if (output->fd >= 0 || (absent && use == OUTPUT_REPLACE))
		return STATUS_OK;
	const enum status status = output_failed(output, errno, error);
	output_close(output);
	return status;
}

void output_close(struct output *output)
{
	if (output->path && output->fd >= 0)
		close(output->fd);
	free(output->path);
	free(output->target);
	*output = (struct output){.fd = -1};
}

/* New files in the place of old ones */

/* Gives the new file the mode and, where permitted, the owner of the one it is to replace. */
static int inherit(int fd, const struct stat *old)
{
	if (fchown(fd, old->st_uid, old->st_gid) != 0 && fchown(fd, (uid_t)-1, old->st_gid) != 0) {
		/* The old file had another owner, and its owner cannot be set: the new file stays ours. */
	}
	return fchmod(fd, old->st_mode & 0777) == 0 ? 0 : errno;
}

/* What attempt() makes under a name that is not taken, as 0 or a descriptor. The name does not grow with the
 * target's, which may be as long as names can be. */
static int make_beside(const char *target, int (*attempt)(const char *target, const char *name), char **name)
{
	char text[TEMP_NAME_SIZE];
	for (int i = 0; i < TEMP_ATTEMPTS; i++) {
		snprintf(text, sizeof text, ".stdfit-%ld-%d.tmp", (long)getpid(), i);
		*name = beside(target, text);
		if (!*name) {
			errno = ENOMEM;
			return -1;
		}
		const int made = attempt(target, *name);
		if (made >= 0)
			return made;
		const int errnum = errno;
		free(*name); /* what has this name is not ours */
		*name = NULL;
		errno = errnum;
		if (errnum != EEXIST)
			break;
	}
	return -1;
}

/* O_EXCL, unlike mkstemp(), lets the kernel apply the umask. */
static int make_file(const char *target, const char *name)
{
	(void)target;
	return open_again(name, O_RDWR | O_APPEND | O_CREAT | O_EXCL);
}

static int make_link(const char *target, const char *name)
{
	return link(target, name);
}

int output_new_file(const struct output *output, char **name)
{
	struct stat old;
	const bool exists = !stat(output->target, &old);
	const int fd = make_beside(output->target, make_file, name);
	if (fd < 0)
		return -1;
	const int errnum = exists ? inherit(fd, &old) : 0;
	if (!errnum)
		return fd;
	close(fd);
	unlink(*name);
	free(*name);
	*name = NULL;
	errno = errnum;
	return -1;
}

/* 0 or errno. */
static int write_all(int fd, const char *bytes, size_t size)
{
	while (size) {
		const ssize_t n = write(fd, bytes, size);
		if (n < 0 && errno != EINTR)
			return errno;
		if (n == 0)
			return ENOSPC;
		if (n > 0) {
			bytes += n;
			size -= (size_t)n;
		}
	}
	return 0;
}

/* 0 or errno. */
static int copy_bytes(int from, int to)
{
	char *bytes = malloc(COPY_SIZE);
	int errnum = bytes ? 0 : ENOMEM;
	for (ssize_t n = 1; !errnum && n;) {
		n = read(from, bytes, COPY_SIZE);
		if (n > 0)
			errnum = write_all(to, bytes, (size_t)n);
		else if (n < 0 && errno != EINTR)
			errnum = errno;
	}
	free(bytes);
	return errnum ? errnum : fsync(to) ? errno : 0;
}

/* A copy of the target under a name of its own; 0 or errno. */
static int copy(const struct output *output, char **name)
{
	const int from = open_again(output->target, O_RDONLY);
	if (from < 0)
		return errno;
	const int to = output_new_file(output, name);
	int errnum = to < 0 ? errno : copy_bytes(from, to);
	close(from);
	if (to >= 0 && close(to) && !errnum)
		errnum = errno;
	if (errnum && to >= 0) {
		unlink(*name);
		free(*name);
		*name = NULL;
	}
	return errnum;
}

char *output_backup_name(const struct output *output)
{
	const size_t size = strlen(output->target) + sizeof "~";
	char *name = malloc(size);
	if (name)
		snprintf(name, size, "%s~", output->target);
	return name;
}

bool output_is_backup(const struct output *output)
{
	char *name = output_backup_name(output);
	const bool same = name && output->fd >= 0 && is_file(name, output->fd);
	free(name);
	return same;
}

/* 0 or errno. */
static int back_up(const struct output *output)
{
	struct stat info;
	if (output->in_order || stat(output->target, &info))
		return 0;
	char *backup = output_backup_name(output), *name = NULL;
	if (!backup)
		return ENOMEM;
	int errnum = make_beside(output->target, make_link, &name) < 0 ? errno : 0;
	if (errnum && errnum != ENOMEM)
		errnum = copy(output, &name);
	if (!errnum && rename(name, backup))
		errnum = errno;
	/* rename() between two links of one file does nothing, and says that all is well. */
	if (name)
		unlink(name);
	free(name);
	free(backup);
	return errnum;
}

enum status output_back_up(const struct output *output, struct error *error)
{
	const int errnum = back_up(output);
	if (!errnum)
		return STATUS_OK;
	char name[TEXT_QUOTE_SIZE];
	text_quote(output->path, name, sizeof name);
	return error_set(error, errnum == ENOMEM ? STATUS_NO_MEMORY : STATUS_IO, "cannot keep '%s' as FILE~: %s", name,
			 strerror(errnum));
}

/* Renames, but not over a file that is there. */
static int rename_to_nothing(const char *name, const char *target)
{
	if (!renameat2(AT_FDCWD, name, AT_FDCWD, target, RENAME_NOREPLACE))
		return 0;
	/* Some file systems cannot. */
	return errno == EINVAL || errno == ENOSYS ? rename(name, target) : -1;
}

int output_replace(struct output *output, const char *name, int fd)
{
	for (;;) {
		/* The name may stand for another file by now, or for none. */
		if (!output_is_there(output)) {
			const int other = open_locked(output->target, O_WRONLY | O_APPEND);
			if (other < 0 && errno != ENOENT)
				return errno;
			if (output->fd >= 0)
				close(output->fd);
			output->fd = other;
		}
		if (fd >= 0)
			flock(fd, LOCK_EX | LOCK_NB); /* before others can know it by this name */
		if (!(output->fd >= 0 ? rename(name, output->target) : rename_to_nothing(name, output->target)))
			break;
		if (output->fd >= 0 || errno != EEXIST)
			return errno;
	}
	if (output->fd >= 0)
		close(output->fd);
	output->fd = fd;
	return 0;
}
