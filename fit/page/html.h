/* SPDX-License-Identifier: GPL-3.0-or-later */
/* html - text and files inside a page. Failures to write show in ferror().
 * Written by hand: one fixed page needs a few lines, and no library for templates. */
#ifndef HTML_H
#define HTML_H

#include "src/status.h"
#include <stdio.h>

/* html_text - any bytes as text, fit for an attribute in double quotes too: & < > " ' escaped, what is no printable UTF-8
 * as \xNN. */
void html_text(FILE *page, const char *text);

/* html_typeset - as html_text(), but a letter behind a Greek one and a low line is an index: θ_h. */
void html_typeset(FILE *page, const char *text);

/* html_file - the file as a data URI: "data:TYPE;base64,...". STATUS_IO, STATUS_NO_MEMORY: nothing was written then. */
MUST_CHECK enum status html_file(FILE *page, const char *path, const char *type, struct error *error);

#endif
