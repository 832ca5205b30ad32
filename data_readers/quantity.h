/* SPDX-License-Identifier: GPL-3.0-or-later */
/* quantity - what the numbers of a file are, and what else a reader is told. */
#ifndef QUANTITY_H
#define QUANTITY_H

#include "src/status.h"

enum quantity {
	QUANTITY_FROM_FILE,          /* what the file says; if it says nothing, the BRDF */
	QUANTITY_BRDF,               /* 1/sr */
	QUANTITY_BRDF_COS,           /* BRDF times the cosine of theta_o, 1/sr */
	QUANTITY_REFLECTANCE_FACTOR, /* BRDF times pi: 1 for a white that scatters evenly */
	QUANTITY_COUNT
};

/* quantity_name - "file", "brdf", "brdf_cos", "reflectance_factor". */
const char *quantity_name(enum quantity quantity);
/* quantity_find - the reverse; STATUS_DOMAIN, *quantity untouched, for another name. */
MUST_CHECK enum status quantity_find(const char *name, enum quantity *quantity);

/* quantity_factor - by what a number of the file is multiplied to give the BRDF. */
double quantity_factor(enum quantity quantity, double cos_o);

/* What becomes of an entry whose colour, computed from a spectrum, has a negative part in linear sRGB. */
enum gamut {
	GAMUT_CLIP, /* that part becomes 0 */
	GAMUT_MASK, /* the entry is left out */
	GAMUT_COUNT
};

/* gamut_name - "clip", "mask"; gamut_find - the reverse, as above. */
const char *gamut_name(enum gamut gamut);
MUST_CHECK enum status gamut_find(const char *name, enum gamut *gamut);

/* struct read_options - how to read. */
struct read_options {
	int threads;            /* less than 1 counts as 1; changes no result */
	enum quantity quantity; /* of formats that can have more than one; wins over what the file says */
	enum gamut gamut;       /* of spectra */
};

#endif
