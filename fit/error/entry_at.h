/* SPDX-License-Identifier: GPL-3.0-or-later */
/* entry_at - the entries of a measurement one by one, whether it is a table or scattered. */
#ifndef ENTRY_AT_H
#define ENTRY_AT_H

#include "fit/error/entries.h"
#include "fit/error/options.h"

struct entry_at {
	struct vec3 wi, wo;
	double weight;               /* under the criterion */
	double value[MERL_CHANNELS]; /* 1/sr */
};

/* entry_at - entry `at` of measurement_count(). entries: entries_make() of the criterion's bins; not used for scattered ones.
 * Returns: false, *entry unset, where it takes no part in the error. */
bool entry_at(const struct measurement *measurement, const struct entries *entries, const struct criterion *criterion,
	      size_t at, struct entry_at *entry);

#endif
