/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lint - what `make lint` tells clang-tidy about a function that it cannot see from another file. */
#ifndef LINT_H
#define LINT_H

#include "src/status.h"

/* error_set() returns the status that it is given. */
#define error_set(error, status, ...) ((void)error_set(error, status, __VA_ARGS__), (status))

#endif
