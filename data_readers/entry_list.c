/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/entry_list.h"
#include "data_readers/solid_angle.h"
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK = 4096 };

struct stored {
	struct vec3 wi, wo;
	float value[MERL_CHANNELS], solid_angle;
};

struct entry_block {
	struct entry_block *next;
	size_t n;
	struct stored entry[BLOCK];
};

static float stored_value(double x)
{
	return x < (double)FLT_MIN ? 0 : (float)x;
}

/* Azimuths within a thousandth of a degree are one, and so are two half a turn apart, as signed angles in a plane have
 * them: every model here is the same after half a turn. */
static void note_azimuth(struct entry_list *list, struct vec3 wi)
{
	const double same = 2e-5;
	if (list->several_azimuths || hypot(wi.x, wi.y) < same)
		return;
	const double azimuth = atan2(wi.y, wi.x);
	if (!list->has_azimuth)
		list->azimuth = azimuth;
	list->has_azimuth = true;
	list->several_azimuths = fabs(remainder(azimuth - list->azimuth, M_PI)) > same;
}

static bool is_finite(struct vec3 v)
{
	return isfinite(v.x) && isfinite(v.y) && isfinite(v.z);
}

enum status entry_list_add(struct entry_list *list, const struct entry *entry, bool derived)
{
	bool finite = true, negative = false;
	for (int c = 0; c < MERL_CHANNELS; c++) {
		finite = finite && fabs(entry->value[c]) <= (double)FLT_MAX;
		negative = negative || entry->value[c] < 0;
	}
	/* An azimuth that is not finite leaves z as it is. */
	if (!is_finite(entry->wi) || !is_finite(entry->wo)) {
		list->n_nonfinite++;
		return STATUS_OK;
	}
	if (entry->wi.z <= ENTRY_HORIZON || entry->wo.z <= ENTRY_HORIZON) {
		list->n_below_horizon++;
		return STATUS_OK;
	}
	list->n_nonfinite += !finite;
	list->n_negative += finite && negative && !derived;
	list->n_out_of_gamut += finite && negative && derived;
	if (!finite || (negative && (!derived || list->gamut == GAMUT_MASK)))
		return STATUS_OK;
	if (!list->last || list->last->n == BLOCK) {
		struct entry_block *block = malloc(sizeof *block);
		if (!block)
			return STATUS_NO_MEMORY;
		block->next = NULL;
		block->n = 0;
		if (list->last)
			list->last->next = block;
		else
			list->first = block;
		list->last = block;
	}
	struct stored *stored = &list->last->entry[list->last->n++];
	*stored = (struct stored){.wi = entry->wi, .wo = entry->wo, .solid_angle = (float)entry->solid_angle};
	for (int c = 0; c < MERL_CHANNELS; c++)
		stored->value[c] = stored_value(entry->value[c]);
	note_azimuth(list, entry->wi);
	list->n++;
	return STATUS_OK;
}

void entry_list_free(struct entry_list *list)
{
	while (list->first) {
		struct entry_block *block = list->first;
		list->first = block->next;
		free(block);
	}
	*list = (struct entry_list){0};
}

/* Frees each block when it has been copied: memory for all entries twice is never needed. */
static void move_entries(struct entry_list *list, struct scattered *s)
{
	size_t at = 0;
	while (list->first) {
		struct entry_block *block = list->first;
		for (size_t e = 0; e < block->n; e++, at++) {
			const struct stored *stored = &block->entry[e];
			s->wi[at] = stored->wi;
			s->wo[at] = stored->wo;
			for (int c = 0; c < MERL_CHANNELS; c++)
				s->value[c][at] = stored->value[c];
			s->solid_angle[at] = stored->solid_angle;
		}
		list->first = block->next;
		free(block);
	}
	list->last = NULL;
}

/* What became of the entries when none is left. */
static void no_entry(const struct entry_list *list, struct error *why)
{
	const struct {
		size_t n;
		const char *what;
	} counts[] = {{list->n_below_horizon, "at or below the horizon"},
		      {list->n_negative, "negative"},
		      {list->n_nonfinite, "not finite"},
		      {list->n_missing, "not measured"},
		      {list->n_out_of_gamut, "out of gamut"}};
	char text[256] = "";
	for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
		const size_t used = strlen(text);
		if (counts[i].n)
			snprintf(text + used, sizeof text - used, "%s%zu %s", used ? ", " : "", counts[i].n,
				 counts[i].what);
	}
	error_set(why, STATUS_NO_DATA, "no sample can be used: %s", text[0] ? text : "there is none");
}

enum status entry_list_finish(struct entry_list *list, struct measurement *measurement, struct error *why)
{
	enum status status = STATUS_NO_DATA;
	*measurement = (struct measurement){0};
	if (!list->n) {
		no_entry(list, why);
	} else {
		status = measurement_scattered(measurement, list->n);
		if (status != STATUS_OK)
			error_set(why, status, "%s", status_str(status));
	}
	if (status != STATUS_OK) {
		entry_list_free(list);
		return status;
	}
	struct scattered *s = measurement->scattered;
	s->gray = list->gray;
	s->symmetry = list->has_symmetry       ? list->symmetry
		      : list->several_azimuths ? SYMMETRY_ANISOTROPIC
					       : SYMMETRY_ISOTROPIC;
	measurement->n_channels = list->n_channels;
	measurement->n_negative = list->n_negative;
	measurement->n_nonfinite = list->n_nonfinite;
	measurement->n_below_horizon = list->n_below_horizon;
	measurement->n_missing = list->n_missing;
	measurement->n_out_of_gamut = list->n_out_of_gamut;
	const bool from_grid = list->from_grid;
	move_entries(list, s);
	entry_list_free(list);
	if (!from_grid)
		status = solid_angle_estimate(s);
	if (status != STATUS_OK) {
		error_set(why, status, "%s", status_str(status));
		measurement_free(measurement);
	}
	return status;
}
