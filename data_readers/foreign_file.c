/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/foreign_file.h"
#include <string.h>

static const struct {
	const char *magic;
	size_t size;
	const char *what;
} kinds[] = {
	{"\x1f\x8b", 2, "is compressed by gzip: expand it with gunzip first"},
	{"\xfd"
	 "7zXZ\0",
	 6, "is compressed by xz: expand it with unxz first"},
	{"\x28\xb5\x2f\xfd", 4, "is compressed by zstd: expand it with unzstd first"},
	{"BZh", 3, "is compressed by bzip2: expand it with bunzip2 first"},
	{"PK\x03\x04", 4, "is a zip archive: unpack it with unzip first"},
	{"\0\0\0\x5a\0\0\0\x5a\0\0\0\xb4", 12, "is a MERL table with big-endian numbers: reverse their bytes first"},
	{"\0\0\0\x5a\0\0\0\x5a\0\0\1\x68", 12, "is a MERL table with big-endian numbers: reverse their bytes first"},
};

const char *foreign_file(const void *head, size_t n)
{
	for (size_t k = 0; k < sizeof kinds / sizeof *kinds; k++)
		if (n >= kinds[k].size && !memcmp(head, kinds[k].magic, kinds[k].size))
			return kinds[k].what;
	return NULL;
}
