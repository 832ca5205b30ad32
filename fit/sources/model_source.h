/* SPDX-License-Identifier: GPL-3.0-or-later */
/* model_source - the models of a command, from one of these sources:
 *     rows of a result table    --from FILE.csv, all of --ndf and --weight that are of this material, or --row N
 *     a model's JSON            --from FILE.json, as `stdfit export` writes it
 *     given parameters          --kd, --ks, --ndf, --sigma, --gamma, ...
 *     a fresh fit               of a MERL file, with each NDF of --ndf, else */
#ifndef MODEL_SOURCE_H
#define MODEL_SOURCE_H

#include "fit/cli/options.h"
#include "fit/results/result.h"

enum source_kind { SOURCE_ROWS, SOURCE_GIVEN, SOURCE_FIT };

/* struct source_model - one model; owned by the source. */
struct source_model {
	struct cook_torrance model;
	struct pwl *pwl; /* the table of model.ndf, if that is pl */
	struct fit_options
		fit;    /* the command's, with the G, F, weight, bins, max_theta that the model was fitted under */
	double error;   /* E under fit.criterion.weight as fitted, as the row has it; NaN for given parameters */
	char *material; /* of the row or the file; NULL: given parameters without a file */
	char *path;     /* the MERL file that it was fitted to, as the row has it; NULL: none, or not known */
	char input[RESULT_INPUT_SIZE]; /* size and hash of that file, as the row has them; "": not known */
	struct read_options reading;   /* how that file was read */
	size_t row;                    /* SOURCE_ROWS: number of its row in the table, from 1; else 0 */
};

struct model_source {
	struct source_model *model;
	size_t n; /* at least one after success */
	/* The table of the file, where it had to be read for a fit; else its planes are NULL. */
	struct measurement measurement;
};

/* model_source_kind - which of the three the options ask for. */
enum source_kind model_source_kind(const struct options *options);

/* model_source_check - whether the options go together and describe models. may_fit: the command fits when they give
 * none. Returns -1, or EXIT_USAGE with a message on standard error. */
MUST_CHECK int model_source_check(const struct options *options, bool may_fit);

/* model_source_check_rows - whether the table of --from can be read and has no rows of one fit that contradict each
 * other; with --row they may. STATUS_OK where there is no table. Errors: STATUS_IO, STATUS_FORMAT, STATUS_NO_MEMORY. */
MUST_CHECK enum status model_source_check_rows(const struct options *options, struct error *error);

/* model_source_read - the models that the options, checked, ask for, in the order of the table or of --ndf.
 * path: the MERL file that they are of; NULL: none, where any material's row is wanted or the parameters are given.
 * Errors: STATUS_IO, STATUS_FORMAT (as model_source_check_rows(), too), STATUS_NO_DATA (no such row; nothing to fit
 * to), STATUS_NO_MEMORY, with the file in the text; STATUS_INTERRUPTED. *source holds nothing then. */
MUST_CHECK enum status model_source_read(const struct options *options, const char *path, struct model_source *source,
					 struct error *error);

/* model_source_free - releases models and measurement; harmless on a zeroed struct. */
void model_source_free(struct model_source *source);

#endif
