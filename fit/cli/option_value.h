/* SPDX-License-Identifier: GPL-3.0-or-later */
/* option_value - the table of all options of all commands, and their values from text and as text. */
#ifndef OPTION_VALUE_H
#define OPTION_VALUE_H

#include "fit/cli/options.h"
#include <stdio.h>

/* What an option's value is, and how it is written. */
enum option_kind {
	KIND_ON,
	KIND_OFF,     /* bool, set to true or false */
	KIND_TEXT,    /* const char * */
	KIND_WORD,    /* the same, of no file */
	KIND_INT,     /* int in [min, max] */
	KIND_SEED,    /* uint64_t */
	KIND_NUMBER,  /* double in [min, max] */
	KIND_GAMMA,   /* the same, or inf */
	KIND_SIGMA,   /* the same, or two of them with a comma between: fit.sigma and fit.sigma_y */
	KIND_PERCENT, /* the same, perhaps with a % behind it */
	KIND_RGB,     /* double[3], each in [min, max]; one number stands for all three */
	KIND_INDEX,   /* fit.ior, or one for each channel: ior, and fit.ior is NaN where they differ */
	KIND_SHARD,   /* struct shard, I/N with N up to max */
	KIND_PHI,     /* int, 180 or 360 */
	KIND_NDFS,
	KIND_GAF,
	KIND_LAMBDA,
	KIND_LAMBDA_OF_ANY, /* that of pl, too */
	KIND_FRESNEL,
	KIND_DIFFUSE, /* bool: whether burley, not lambert */
	KIND_SORT,    /* bool: whether gain, not name */
	KIND_WEIGHT,
	KIND_WEIGHTS, /* several of them, separated by commas: weight and n_weights; the first is fit.criterion.weight */
	KIND_BINS,
	KIND_BINS_OR_BOTH, /* the same, or "both": node, and both_bins is set */
	KIND_QUANTITY,
	KIND_GAMUT,
	KIND_FORMAT,
	KIND_SAMPLING,
	KIND_ALGORITHM,
	KIND_ALGORITHMS,
};

/* Whether a value belongs to the text that results are recorded with. */
enum recorded {
	NOT_RECORDED,
	RECORDED,
	RECORDED_WITHIN,      /* only with --within */
	RECORDED_GIVEN,       /* only where given */
	RECORDED_ANISOTROPIC, /* only with --anisotropic */
	RECORDED_ALGORITHM,   /* only with another algorithm than the default */
};

struct option_spec {
	const char *name;
	int letter; /* 0: none */
	enum option_kind kind;
	unsigned commands; /* bits 1 << enum command */
	enum recorded recorded;
	const char *argument, *help;
	size_t offset;
	double min, max;
};

extern const struct option_spec option_specs[]; /* ends with a row whose name is NULL; at most OPTIONS_MAX with it */

/* option_choice - the i-th of the names that a value of this kind can have; NULL beyond the last. */
const char *option_choice(enum option_kind kind, int i);
/* option_parse - sets the option's member of *options from text.
 * STATUS_DOMAIN, with what was expected, when the text is no value of it. */
MUST_CHECK enum status option_parse(struct options *options, const struct option_spec *spec, const char *text,
				    struct error *error);
/* option_applies - whether a command has this option. */
bool option_applies(const struct option_spec *spec, enum command command);
/* option_describe - the option's help: what it does, the names it takes, its default, if any. */
void option_describe(FILE *file, const struct options *defaults, const struct option_spec *spec);
/* option_write - the value as it would be written on the command line; "yes" and "no" for one without an argument; "free" for a number
 * that is not fixed. */
void option_write(FILE *file, const struct options *options, const struct option_spec *spec);

/* option_comma_hint - for a refused text that may be one number with a decimal comma: what was read; else "". */
const char *option_comma_hint(const char *text);

#endif
