/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/entry_at.h"
#include "fit/error/sample_set.h"

static bool scattered_at(const struct scattered *s, const struct criterion *criterion, size_t at,
			 struct entry_at *entry)
{
	if (!scattered_takes_part(s, criterion, max_theta_cos(criterion->max_theta), at))
		return false;
	*entry = (struct entry_at){.wi = s->wi[at], .wo = s->wo[at]};
	entry->weight = weight_of_entry(criterion->weight, (double)s->solid_angle[at], s->wi[at].z, s->wo[at].z);
	for (int c = 0; c < MERL_CHANNELS; c++)
		entry->value[c] = (double)s->value[c][at];
	return true;
}

bool entry_at(const struct measurement *measurement, const struct entries *entries, const struct criterion *criterion,
	      size_t at, struct entry_at *entry)
{
	if (measurement->scattered)
		return scattered_at(measurement->scattered, criterion, at, entry);
	if (entry_is_missing(measurement, criterion, at))
		return false;
	const size_t n = (size_t)measurement->n_phi_d, row = at / n;
	const int i = (int)(row / MERL_THETA_D), j = (int)(row % MERL_THETA_D);
	entries_dirs(entries, i, j, (int)(at % n), &entry->wi, &entry->wo);
	if (!entry_in_range(entry->wi, entry->wo, max_theta_cos(criterion->max_theta)))
		return false;
	entry->weight = weight_at(criterion->weight, i, j, entry->wi.z, entry->wo.z);
	for (int c = 0; c < MERL_CHANNELS; c++)
		entry->value[c] = (double)measurement->value[c][at];
	return true;
}
