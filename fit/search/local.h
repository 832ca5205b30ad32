/* SPDX-License-Identifier: GPL-3.0-or-later */
/* local - one local search of a space by nlopt, from a point downhill. */
#ifndef LOCAL_H
#define LOCAL_H

#include "fit/search/space.h"
#include <nlopt.h>

/* struct local_settings - how far it goes. */
struct local_settings {
	nlopt_algorithm algorithm;
	double step;      /* first step, in about the spacings of the scan's grid */
	double tolerance; /* of the error, relative */
	int evaluations;  /* at most */
	bool patient; /* ends after some evaluations that lower the error by less than the tolerance together, not one */
	double enough; /* an error at which it may stop; 0: none */
};

/* local_spacing - about the spacing of the scan's grid along a coordinate. */
double local_spacing(enum coordinate coordinate);

/* Called at every evaluation, by the thread that searches; NULL: nobody. */
typedef void local_report(void *user, const struct shape *shape, const struct linear *linear);

/* local_spacing - about how far the indices of the scan stand apart. */
double local_spacing(enum coordinate coordinate);

/* local_descend - improves *point on the objective's table; point->error need not be set before.
 * Returns: the best point seen; *limited (if not NULL): stopped by settings->evaluations while the error still fell
 * Errors:  STATUS_NO_MEMORY. When the options' cancel is set it ends at once. */
MUST_CHECK enum status local_descend(const struct space *space, struct objective *objective,
				     const struct local_settings *settings, local_report *report, void *user,
				     struct space_point *point, bool *limited);

#endif
