/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gnuplot - pictures by gnuplot: text inside its scripts, and running them. */
#ifndef GNUPLOT_H
#define GNUPLOT_H

#include "src/status.h"
#include <stdatomic.h>
#include <stdio.h>

/* gnuplot_string - the text as a string of gnuplot, in which nothing is expanded: in single quotes, on one line, made
 * printable. A single quote becomes a string of its own, joined by dots. Doubling it, as the manual says, fails in gnuplot 5.4
 * for two in a row and for one at the start. Where gnuplot would still interpret ^, _ or {}, the script says
 * `noenhanced`. */
void gnuplot_string(FILE *file, const char *text);

/* gnuplot_begin - the head of a script that draws NAME.png and NAME.svg of that many pixels: everything up to gnuplot_end()
 * is done once for each. */
void gnuplot_begin(FILE *file, const char *name, int width, int height);
void gnuplot_end(FILE *file);

/* gnuplot_draw - runs NAME.gp in a directory for each name; each makes NAME.png and NAME.svg there, complete or not at
 * all. Errors: STATUS_UNSUPPORTED: gnuplot is not installed; STATUS_IO: it failed, with its message;
 * STATUS_INTERRUPTED when *cancel is set, within a tenth of a second. Scripts and data stay in any case. */
MUST_CHECK enum status gnuplot_draw(const char *directory, const char *const *name, int n, const atomic_bool *cancel,
				    struct error *error);

#endif
