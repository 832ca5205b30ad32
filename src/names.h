/* SPDX-License-Identifier: GPL-3.0-or-later */
/* names - the words by which the values 0..count-1 of an enum are known to a user. */
#ifndef NAMES_H
#define NAMES_H

#include <stddef.h>
#include <string.h>

/* names_find - the index of `name` in names[0..count-1]; -1 when it is not there, or NULL. */
static inline int names_find(const char *const names[], int count, const char *name)
{
	for (int i = 0; name && i < count; i++) {
		if (strcmp(names[i], name) == 0)
			return i;
	}
	return -1;
}

/* names_at - names[index], or "unknown" outside 0..count-1. */
static inline const char *names_at(const char *const names[], int count, int index)
{
	return index >= 0 && index < count ? names[index] : "unknown";
}

#endif
