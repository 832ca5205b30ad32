/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lighting - the environment that the options ask for. */
#ifndef LIGHTING_H
#define LIGHTING_H

#include "fit/cli/options.h"
#include "fit/render/environment.h"

/* lighting_make - --environment, a built-in one or a file's map, --light and --exposure. Errors: STATUS_DOMAIN for
 * --light, STATUS_IO, STATUS_FORMAT, STATUS_NO_MEMORY; *environment is then cleared. */
MUST_CHECK enum status lighting_make(const struct options *options, struct environment *environment,
				     struct error *error);

#endif
