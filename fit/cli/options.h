/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options - the command line: one table of options serves parsing, help and the text that results are recorded with. */
#ifndef OPTIONS_H
#define OPTIONS_H

#include "data_readers/quantity.h"
#include "fit/cli/command.h"
#include "fit/cli/distribution.h"
#include "fit/cli/files.h"
#include "fit/cli/report.h"
#include "fit/export/export.h"
#include "fit/search/algorithms.h"
#include "fit/search/options_check.h"
#include "src/sampling.h"

enum { OPTIONS_MAX = 128 }; /* rows of the option table, at most */

struct options {
	struct fit_options fit;
	enum weight
		weight[WEIGHT_COUNT]; /* of `fit`, which fits under each of them; fit.criterion.weight is the first */
	int n_weights;                /* 0: fit.criterion.weight is the only one */
	enum command command;
	bool both_bins;         /* what is fitted with one is fitted with the other, too, and the difference told */
	enum quantity quantity; /* of a file that may have another than it says */
	enum gamut gamut;
	const char *output;      /* NULL: standard output */
	bool to_standard_output; /* which was asked for by a name, as in -o - */
	const char *trace;       /* a CSV of the course of each search; NULL: none */
	struct shard shard;      /* .n = 0: all files */
	bool json, quiet, resume, recursive, readable;
	double within;    /* percent; NaN: every NDF as it is */
	double intervals; /* percent; NaN: none are sought */
	/* A model, for eval and synth; its sigma, gamma and ior are those of `fit`. */
	double kd[3], ks[3], ior[3], k[3]; /* ior: where given, see KIND_INDEX */
	double f82[F82_PARTS][3], kg[3], ks2[3], sigma2, gamma2;
	const char *from; /* the result table that has the model */
	int row;          /* its row, from 1; 0: the one of this material and NDF */
	enum export_format format;
	double accuracy, file_size; /* percent, bytes */
	/* A distribution, for ndf and sample, in words: distribution.h. */
	const char *sigma_words, *gamma_words;
	const char *params, *nodes; /* and for a model */
	const char *theta, *phi;    /* lists of angles: angles.h */
	double theta_i, phi_i;      /* degrees; theta_i NaN: not given */
	enum sampling sampling;     /* and for render */
	int count;
	int n_phi_d;
	double noise;
	/* What bench runs; none: all. */
	const struct algorithm *algorithm[ALGORITHM_COUNT];
	int n_algorithms;
	bool forms; /* bench: the forms of Lambda, not algorithms */
	/* Pictures. */
	const char *picture;     /* file to render into; NULL: none */
	const char *environment; /* a built-in one's name or a file */
	const char *light;       /* point lights, X,Y,Z[,E];...; NULL: none */
	double exposure;         /* stops */
	int size, pixel_samples;
	bool difference;
	bool transmission, multiple; /* render: a sphere of glass, with all orders of scattering */
	bool pictures;               /* compare: columns of pictures */
	bool models, sort_by_gain;   /* compare: the ladder of models, not NDFs; the order of materials */
	atomic_bool *cancel;
	char **path; /* what is no option, in the order given */
	int n_paths;
	bool given[OPTIONS_MAX]; /* per row of the option table */
};

/* options_parse - reads a command's arguments into *options; argv is reordered and stays borrowed.
 * Returns -1 to go on, or the exit code to end with: help was asked for (and printed), or something was wrong (and
 * reported). */
MUST_CHECK int options_parse(struct options *options, enum command command, int argc, char **argv, atomic_bool *cancel);

/* options_given - whether the option of this long name is on the command line. */
bool options_given(const struct options *options, const char *name);
/* options_index_per_channel - whether --ior gives each channel another index. */
bool options_index_per_channel(const struct options *options);
/* options_given_beside - the name of some given option that is not among `expected`, which ends with NULL; NULL: none.
 */
const char *options_given_beside(const struct options *options, const char *const *expected);

/* options_reading - how the command reads a measurement. */
struct read_options options_reading(const struct options *options, int threads);

/* options_text - newly allocated: every option that changes a result of a fit under this weight, in a fixed order, defaults
 * included. NULL when out of memory. */
char *options_text(const struct options *options, enum weight weight);

/* options_model - the model that the options describe, into *model, whose NDF is that of *distribution, to be freed by
 * distribution_free().
 * Returns -1, or the exit code when they describe none (reported on standard error); *distribution holds nothing then. */
MUST_CHECK int options_model(const struct options *options, struct cook_torrance *model,
			     struct distribution *distribution);

/* options_check_fit - whether the options of a fit go together. Returns -1, or EXIT_USAGE with a message on standard error. */
MUST_CHECK int options_check_fit(const struct options *options);

/* options_say_weight - on standard error, unless --quiet or --weight is given: under which weight a command has fitted whose
 * output is to be looked at (render, plot, report, export). */
void options_say_weight(const struct options *options);

/* options_show - what a command prints on standard output: JSON if asked for, readable text if asked for or on a
 * terminal, else CSV. With -o only a terminal or --table gets anything; -o - is CSV unless --table asks for text. */
enum show options_show(const struct options *options);

/* options_end - ends a command that makes one table: prints the table as options_show() says, `readable` printing the
 * readable text, or reports what failed. Frees the table and returns the exit code. */
int options_end(const struct options *options, enum status status, const struct error *error, struct csv_table *table,
		report_readable *readable);

/* options_usage - reports on standard error what is wrong with the command line. Returns EXIT_USAGE. */
int options_usage(enum command command, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* struct command_text - a command's name and its help. */
struct command_text {
	const char *name, *arguments, *summary, *help;
};
/* options_command - of a command below COMMAND_COUNT. */
const struct command_text *options_command(enum command command);

/* options_default - the default options of a command. */
struct options options_default(enum command command);

/* options_unknown_command - reports a first word that is neither a command nor a file, with the nearest command. Returns
 * EXIT_USAGE. */
int options_unknown_command(const char *typed);
/* options_overview - the help of the program as a whole, on standard output. */
void options_overview(void);
/* options_find_command - the command of this name, COMMAND_COUNT when there is none. */
enum command options_find_command(const char *name);

#endif
