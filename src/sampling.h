/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sampling - which normals are drawn. */
#ifndef SAMPLING_H
#define SAMPLING_H

#include "src/status.h"

enum sampling {
	SAMPLING_VISIBLE, /* those seen from a direction, vndf.h */
	SAMPLING_NDF,     /* all, with density D(m) m.z */
	SAMPLING_COUNT
};

/* sampling_name - "visible", "ndf"; "unknown" for any other value. */
const char *sampling_name(enum sampling sampling);
/* sampling_find - the one called `name`. Returns STATUS_DOMAIN, *sampling untouched, when there is none. */
MUST_CHECK enum status sampling_find(const char *name, enum sampling *sampling);

#endif
