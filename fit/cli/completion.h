/* SPDX-License-Identifier: GPL-3.0-or-later */
/* completion - what shells need to complete command lines of stdfit, made from the tables that parsing and --help use.
 * By hand: generators of completions want the options in a form of their own. */
#ifndef COMPLETION_H
#define COMPLETION_H

#include <stdbool.h>
#include <stdio.h>

/* completion_write - the completion for a shell, "bash" or "zsh". Returns false, having written nothing, for another. */
bool completion_write(FILE *file, const char *shell);

#endif
