/* SPDX-License-Identifier: GPL-3.0-or-later */
/* completion - shell scripts that complete command lines of stdfit, made from the tables that parsing and --help use.
 * Written by hand: no library knows these tables, and each option is defined only once. */
#ifndef COMPLETION_H
#define COMPLETION_H

#include <stdbool.h>
#include <stdio.h>

/* completion_write - the completion for a shell, "bash" or "zsh". Returns false, having written nothing, for another. */
bool completion_write(FILE *file, const char *shell);

#endif
