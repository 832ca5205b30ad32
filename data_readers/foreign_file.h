/* SPDX-License-Identifier: GPL-3.0-or-later */
/* foreign_file - files that hold a measurement in a way that is not read here, by how they begin. */
#ifndef FOREIGN_FILE_H
#define FOREIGN_FILE_H

#include <stddef.h>

enum { FOREIGN_FILE_HEAD = 12 }; /* bytes that tell */

/* foreign_file - what a file is that begins with these n bytes, and what to do with it, as in "is compressed by gzip:
 * expand it with gunzip first"; NULL for any other. */
const char *foreign_file(const void *head, size_t n);

#endif
