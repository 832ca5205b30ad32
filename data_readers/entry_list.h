/* SPDX-License-Identifier: GPL-3.0-or-later */
/* entry_list - collects the entries of a file whose number is not known beforehand. */
#ifndef ENTRY_LIST_H
#define ENTRY_LIST_H

#include "data_readers/measurement.h"
#include "data_readers/quantity.h"

/* struct entry - one as it was read. */
struct entry {
	struct vec3 wi, wo;          /* unit vectors */
	double value[MERL_CHANNELS]; /* 1/sr; of one channel the same three times */
	double solid_angle;          /* sr^2, if the file has it */
};

/* struct entry_list - zero it, add, finish or free. */
struct entry_list {
	struct entry_block *first, *last;
	size_t n;
	bool from_grid;    /* the solid angles are the file's own */
	enum gamut gamut;  /* what becomes of a colour out of gamut */
	bool gray;         /* one channel */
	int n_channels;    /* values of an entry in the file */
	bool has_symmetry; /* the file tells the symmetry; if not, several azimuths of wi mean anisotropic */
	enum symmetry symmetry;
	bool several_azimuths;
	double azimuth; /* of the first wi off the normal */
	bool has_azimuth;
	size_t n_negative, n_nonfinite, n_below_horizon, n_missing, n_out_of_gamut;
};

#define ENTRY_HORIZON 1e-6 /* a direction whose cosine is not above this counts as below the horizon */

/* entry_list_add - adds an entry, or leaves it out and counts it: for a direction that is not finite; for one at or
 * below the horizon; else for a value that is not finite or beyond float; else for one that is negative. If `derived`,
 * the values were computed from a spectrum, and the list's `gamut` says what becomes of a negative one; the entry is
 * counted in n_out_of_gamut in any case. What is too small for a normal float becomes 0. STATUS_NO_MEMORY. */
MUST_CHECK enum status entry_list_add(struct entry_list *list, const struct entry *entry, bool derived);

/* entry_list_finish - moves the entries and counts into a measurement; estimates the solid angles unless the file has
 * them. The list is empty afterwards in any case. STATUS_NO_DATA: no entry is left; `why` says how many were left out
 * and why. STATUS_NO_MEMORY. *measurement is cleared then. */
MUST_CHECK enum status entry_list_finish(struct entry_list *list, struct measurement *measurement, struct error *why);

void entry_list_free(struct entry_list *list);

#endif
