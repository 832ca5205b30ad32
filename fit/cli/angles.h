/* SPDX-License-Identifier: GPL-3.0-or-later */
/* angles - lists of angles in words: START:END:STEP, END included if a step ends on it, or numbers between commas. */
#ifndef ANGLES_H
#define ANGLES_H

#include "src/status.h"
#include <stddef.h>

enum { ANGLES_MAX = 1000000 }; /* in one list */

struct angles {
	double *deg;
	size_t n;
};

/* angles_parse - the angles of `text`, degrees, each in [min, max]. STATUS_DOMAIN, with what was expected, when it is no
 * list of at most ANGLES_MAX; STATUS_NO_MEMORY. *angles holds nothing then. */
MUST_CHECK enum status angles_parse(const char *text, double min, double max, struct angles *angles,
				    struct error *error);
void angles_free(struct angles *angles);

#endif
