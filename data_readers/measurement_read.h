/* SPDX-License-Identifier: GPL-3.0-or-later */
/* measurement_read - reads a measurement of any known format, told by its content. */
#ifndef MEASUREMENT_READ_H
#define MEASUREMENT_READ_H

#include "data_readers/measurement.h"
#include "data_readers/quantity.h"

/* measurement_read - reads `path`; *options may be NULL: one thread, the file's own quantity. The format is the one
 * that knows the first bytes; where none does, the one that the name's extension stands for tells what is wrong.
 * Errors, all with the file's name, and of a text with the line: STATUS_IO, STATUS_FORMAT (of no known format, or
 * wrong), STATUS_UNSUPPORTED (known, but not read), STATUS_NO_DATA (no usable entry), STATUS_NO_MEMORY. *measurement is
 * then cleared. Never waits on a pipe or a device. */
MUST_CHECK enum status measurement_read(const char *path, const struct read_options *options,
					struct measurement *measurement, struct error *error);

/* measurement_is_known - whether a file that lies in a directory is a measurement: by its extension, and unless that is
 * .binary also by its first bytes. */
bool measurement_is_known(const char *path);

/* measurement_extension - the length of a known format's extension at the end of a name, with the point; else 0. */
size_t measurement_extension(const char *name);

#endif
