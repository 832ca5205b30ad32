/* SPDX-License-Identifier: GPL-3.0-or-later */
/* merl - reads and writes MERL .binary files (Matusik et al. 2003, "A data-driven reflectance model").
 *
 * A file is three little-endian int32, the numbers of theta_h, theta_d and phi_d: 90, 90 and 180 (or 360), then one
 * plane each for red, green and blue of that many float64, phi_d running fastest, to be multiplied by 1/1500, 1.15/1500
 * and 1.66/1500 to give 1/sr: 34,992,012 (69,984,012) bytes. A negative value, usually -1, says that nothing was
 * measured. */
#ifndef MERL_H
#define MERL_H

#include "data_readers/measurement.h"

/* merl_read - reads `path` into a new table with up to `threads` threads (less than 1 counts as 1), which change no
 * result. An entry with a negative or non-finite value in any channel is masked in all three and counted once, as
 * non-finite if it is both; what is beyond the range of float counts as non-finite, what is too small for a normal
 * float becomes 0. Returns STATUS_IO if the file cannot be opened or read or changes meanwhile; STATUS_FORMAT if it is
 * not a regular file, or its dimensions or size are not a MERL table's; STATUS_NO_MEMORY. *measurement is then cleared
 * and `error` (may be NULL) says which file, what was expected, what was found. Never waits on a pipe or a device. */
MUST_CHECK enum status merl_read(const char *path, int threads, struct measurement *measurement, struct error *error);

/* merl_write - writes a table; masked entries as -1. STATUS_UNSUPPORTED for scattered entries. Reading it again gives
 * the same floats. Written beside `path`, synced, renamed when complete, see atomic_file.h. Returns STATUS_IO,
 * STATUS_NO_MEMORY; what was at `path` is then untouched. */
MUST_CHECK enum status merl_write(const char *path, const struct measurement *measurement, struct error *error);

#endif
