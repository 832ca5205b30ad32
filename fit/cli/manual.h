/* SPDX-License-Identifier: GPL-3.0-or-later */
/* manual - the manual page stdfit(1), made from the tables that parsing and --help use.
 * Written by hand: the text comes from the same tables, and man(7) needs no more than a few macros. */
#ifndef MANUAL_H
#define MANUAL_H

#include <stdio.h>

/* manual_write - the page in the man(7) macros. The same on every machine. */
void manual_write(FILE *file);

#endif
