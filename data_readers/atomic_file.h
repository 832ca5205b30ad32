/* SPDX-License-Identifier: GPL-3.0-or-later */
/* atomic_file - output that is complete or absent: written beside its target, renamed when complete. */
#ifndef ATOMIC_FILE_H
#define ATOMIC_FILE_H

#include "data_readers/output.h"
#include <stdio.h>

/* struct atomic_file - an open output. The caller writes to `stream` and may leave checking for errors to the
 * commit. A caller that sees a write fail can store errno in `errnum`: the commit then fails with that reason
 * instead of a general one. */
struct atomic_file {
	FILE *stream;
	int errnum;
	bool keeps;           /* the commit keeps what it replaces as FILE~ */
	struct output output; /* what it is to be */
	char *temp;           /* what is written meanwhile, in the same directory; NULL when written in order */
};

/* atomic_file_open - starts writing `path`; what that name means, output.h says.
 * A replaced file keeps its mode and, where permitted, its owner; a new one honours the umask. Opening a named pipe
 * waits until it has a reader. Returns STATUS_IO if this fails (no such directory, no permission, target read-only or a
 * directory, another process writes it), STATUS_NO_MEMORY; `file` is then cleared and nothing is left behind. Errors
 * read "cannot write 'path': reason". */
MUST_CHECK enum status atomic_file_open(struct atomic_file *file, const char *path, struct error *error);

/* atomic_file_take - the same for an output that is open, which is taken over with its lock: *output is cleared,
 * even on failure. */
MUST_CHECK enum status atomic_file_take(struct atomic_file *file, struct output *output, struct error *error);

/* atomic_file_commit - flushes, syncs and closes the output and renames it to its target.
 * Returns STATUS_IO if any of this, or any write before, failed: the target is then as it was and the temporary file is
 * gone. `file` is cleared in either case. */
MUST_CHECK enum status atomic_file_commit(struct atomic_file *file, struct error *error);

/* atomic_file_abort - drops the output; the target is as it was. Harmless on a cleared struct. */
void atomic_file_abort(struct atomic_file *file);

#endif
