/* SPDX-License-Identifier: GPL-3.0-or-later */
/* suspects - what looks wrong with a measurement before anything is fitted to it: holes stored as zeros, values in
 * other units, weighted values, mixed-up channels. Nothing is changed or left out. */
#ifndef SUSPECTS_H
#define SUSPECTS_H

#include "data_readers/measurement.h"
#include "fit/error/options.h"

/* The kinds, as bits. The limits are such that a sound measurement, noise of 50 % included, stays below them. */
enum suspect {
	SUSPECT_ZEROS = 1 << 0,       /* blocks of exact zeros next to bright entries */
	SUSPECT_WEDGE = 1 << 1,       /* nothing but zeros beyond some theta_i or theta_o */
	SUSPECT_BRIGHT = 1 << 2,      /* a directional albedo above 1 */
	SUSPECT_DARK = 1 << 3,        /* every directional albedo below 0.002 */
	SUSPECT_COSINE = 1 << 4,      /* values multiplied by the cosine of theta_i, of theta_o or of both */
	SUSPECT_INTERLEAVED = 1 << 5, /* red, green and blue alternate instead of standing in three planes */
	SUSPECT_ASYMMETRIC = 1 << 6,  /* exchanging the directions changes the values */
	SUSPECT_SPIKES = 1 << 7,      /* single entries far above all their neighbours */
	SUSPECT_CLIPPED = 1 << 8,     /* the largest value stands in many places */
	SUSPECT_CORRELATED = 1 << 9,  /* correlated G fits much better; only a fit can tell, and sets it */
};

enum { SUSPECTS_ALBEDOS = 3 };

/* struct suspects - what was found, and what it was found by. */
struct suspects {
	unsigned found;     /* enum suspect */
	double zero_share;  /* of the valid entries in range: those that are 0 in all channels */
	double ends_at;     /* degrees: the theta_i or theta_o beyond which nothing is measured or all is 0; NaN */
	double asymmetry;   /* mean relative difference of the halves of a row that the exchange maps on one another */
	int cosine;         /* SUSPECT_COSINE: 1 of theta_i, 2 of theta_o, 3 of both */
	double correlated;  /* SUSPECT_CORRELATED: E is below this with correlated G */
	size_t n_spikes;    /* entries above 5 times each of their six neighbours, in one channel a row */
	int n_clipped_rows; /* rows (theta_h, theta_d) that have a channel's largest value; of the channel with most */
	/* The directional-hemispherical albedo at theta_i = 0, 30 and 60 degrees, integrated over what is measured; and
	 * which share of the hemisphere that is, by the cosine of theta_o. */
	double albedo[SUSPECTS_ALBEDOS][MERL_CHANNELS], measured[SUSPECTS_ALBEDOS];
};

/* suspects_find - looks at the entries that the criterion takes: its bins, max_theta and zero_is_missing. Some 3 ms;
 * takes no memory. The albedos are of all entries, whatever max_theta is. Of scattered entries the albedos,
 * interpolated [interpolant.h], and what they tell: bright and dark; they take some 30 ms, and of a sample that turns
 * they are means over its azimuths. ends_at is the largest theta_i or theta_o that was measured, NaN from 89 degrees
 * on. STATUS_NO_MEMORY. */
MUST_CHECK enum status suspects_find(const struct measurement *measurement, const struct criterion *criterion,
				     struct suspects *suspects);

enum { SUSPECTS_WORDS = 128, SUSPECTS_TEXT = 640 };
/* suspects_words - the kinds as short words joined by +, as in "zeros+wedge"; "" if none. Returns text. */
const char *suspects_words(const struct suspects *suspects, char text[SUSPECTS_WORDS]);
/* suspects_explain - the same in words and numbers, with the option that helps, joined by "; ". Returns text. */
const char *suspects_explain(const struct suspects *suspects, char text[SUSPECTS_TEXT]);

#endif
