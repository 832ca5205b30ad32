/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output - what the name of an output means, for all commands, and the lock on it.
 *
 * "-" is standard output. Symbolic links are followed. What the last one leads to is
 *   - a descriptor (/dev/stdout, /dev/fd/N, /proc/self/fd/N and the like), a device, a pipe or a socket: it is written
 *     in order, as it is, without a backup. A descriptor of this process is written through itself, so that its
 *     position is the one of whoever else writes to it.
 *   - a regular file, or nothing yet: a file is replaced by a rename of a new one beside it; its backup, FILE~, stands
 *     beside it, too. No link is ever renamed or replaced, nor anything below /proc. */
#ifndef OUTPUT_H
#define OUTPUT_H

#include "src/status.h"
#include <stdbool.h>

struct output {
	char *path;    /* as given, for messages */
	char *target;  /* what the links lead to */
	bool in_order; /* a descriptor, device or pipe */
	bool created;  /* the file was made by output_open() */
	int fd;        /* in order: open for writing; else the file that is there, open and locked, -1: none is */
};

/* What is done with a file that is there. */
enum output_use {
	OUTPUT_REPLACE, /* it is replaced; where there is none, none is made */
	OUTPUT_BEGIN,   /* the same, but an empty one is made */
	OUTPUT_GO_ON,   /* read, and written at its end; made where there is none */
};

/* output_find - finds out what `path` means; opens nothing. Errors: STATUS_IO (links in a circle), STATUS_NO_MEMORY.
 * *output is cleared then. */
MUST_CHECK enum status output_find(struct output *output, const char *path, struct error *error);

/* output_is_standard - whether it is written in order to standard output, by whatever name. */
bool output_is_standard(const struct output *output);

/* output_open - after output_find(): opens what is written in order; a named pipe is waited for until it has a reader.
 * A file that is there is locked (flock) until output_close(), whatever takes its name meanwhile. Where the file system
 * has no locks it does without.
 * Errors: STATUS_IO: another process has the lock (its number is told, where the system says it), no permission, a
 * directory, no directory. *output is closed then. */
MUST_CHECK enum status output_open(struct output *output, enum output_use use, struct error *error);

/* output_new_file - makes an empty file beside a target that is a file; its mode, and where permitted its owner, are
 * those of the target, if that is there. Returns it open for writing at its end and reading, its name newly
 * allocated in *name; -1 and errno when that fails. */
int output_new_file(const struct output *output, char **name);

/* output_back_up - keeps the target, if it is there, as FILE~ beside it, too; an older FILE~ is replaced. The target
 * stays where it is at every moment: the backup is a hard link, or a copy where there are none.
 * Errors: STATUS_IO, STATUS_NO_MEMORY; they read "cannot keep 'path' as FILE~: reason". */
MUST_CHECK enum status output_back_up(const struct output *output, struct error *error);

/* output_is_backup - whether FILE~ and the target are one file, as a kill between backup and rename leaves them. */
bool output_is_backup(const struct output *output);

/* output_replace - gives the file `name`, made by output_new_file() and open as `fd`, the name of the target. What
 * another process has made there meanwhile is not replaced while that writes to it. On success output->fd is `fd`,
 * which becomes the lock; fd = -1: the lock ends there. Returns 0 or errno; EWOULDBLOCK: another process writes
 * there. */
int output_replace(struct output *output, const char *name, int fd);

/* output_is_there - whether the target still is the file that is locked. */
bool output_is_there(const struct output *output);

/* output_failed - sets "cannot write 'path': reason" and returns STATUS_IO, or STATUS_NO_MEMORY for ENOMEM. */
enum status output_failed(const struct output *output, int errnum, struct error *error);

/* output_close - gives up the lock; harmless on a cleared struct. */
void output_close(struct output *output);

/* output_backup_name - target~, newly allocated; NULL when out of memory. */
char *output_backup_name(const struct output *output);

#endif
