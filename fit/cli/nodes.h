/* SPDX-License-Identifier: GPL-3.0-or-later */
/* nodes - the piecewise-linear NDF from a CSV of its nodes. */
#ifndef NODES_H
#define NODES_H

#include "src/pwl.h"

/* nodes_read - from the columns theta, degrees, ascending from 0 to 90, and D, in any unit; or Dx and Dy, along the azimuths 0
 * and 90 degrees [pwl.h]. Other columns do not matter.
 * Errors: STATUS_IO, STATUS_NO_MEMORY; STATUS_FORMAT, with the file in the text: no such table. *pwl holds nothing then. */
MUST_CHECK enum status nodes_read(const char *path, struct pwl *pwl, struct error *error);

#endif
