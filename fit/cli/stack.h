/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stack - the room for the stacks of the program's threads, which the user's limits may have made too small. */
#ifndef STACK_H
#define STACK_H

#include <stdbool.h>
#include <stddef.h>

/* stack_prepare - gives the calling thread and those it makes stacks of STACK_BYTES or more, where limits allow it. Called
 * before anything else. Returns -1, or the exit code to end with where less than STACK_LEAST bytes are left to the calling
 * thread or, by OMP_STACKSIZE, to OpenMP's: reported on standard error. */
enum { STACK_BYTES = 1 << 20, STACK_LEAST = 256 << 10 };
int stack_prepare(void);

/* stack_parse_size - the bytes of a text as OMP_STACKSIZE has it: a number, alone in kB, or with B, K, M or G behind it.
 * False for another text, which OpenMP does not heed. */
bool stack_parse_size(const char *text, size_t *bytes);

#endif
