/* SPDX-License-Identifier: GPL-3.0-or-later */
/* valley - the way along the floor of a narrow valley of the error.
 *
 * Where a table is all but free of noise, E rises in proportion to the distance from the best shape: its valleys have
 * sharp floors, and where they are curved as well, as gamma and n make them, a search that looks about from one point
 * gets stuck on the floor far from its end. */
#ifndef VALLEY_H
#define VALLEY_H

#include "fit/search/local.h"

/* valley_follow - improves *point on the objective's table: gamma, then n, is moved in steps, the other parameters of the
 * shape refitted at each, as long as that lowers E.
 * Given:   report, user: called at every evaluation
 * Returns: point->error, E there on the objective's table
 * Errors:  as local_descend() */
MUST_CHECK enum status valley_follow(const struct space *space, struct objective *objective, local_report *report,
				     void *user, struct space_point *point);

#endif
