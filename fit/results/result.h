/* SPDX-License-Identifier: GPL-3.0-or-later */
/* result - the result table: one row per material and NDF, its columns, and the way back from a row to a model. */
#ifndef RESULT_H
#define RESULT_H

#include "data_readers/quantity.h"
#include "fit/results/csv.h"
#include "fit/search/fit.h"

enum result_column {
	RESULT_MATERIAL,
	RESULT_NDF,
	RESULT_ERROR,
	RESULT_KD_R,
	RESULT_KD_G,
	RESULT_KD_B,
	RESULT_KS_R,
	RESULT_KS_G,
	RESULT_KS_B,
	RESULT_SIGMA,
	RESULT_GAMMA,
	RESULT_IOR,
	RESULT_PARAMS,
	RESULT_GAF,
	RESULT_FRESNEL,
	RESULT_LAMBDA,
	RESULT_WEIGHT,
	RESULT_BINS,
	RESULT_MAX_THETA,
	RESULT_SAMPLES,
	RESULT_STATUS,
	RESULT_STARTS,
	RESULT_STARTS_AGREEING,
	RESULT_AT_BOUND,
	RESULT_ERROR_NONE,
	RESULT_ERROR_COSINE,
	RESULT_ERROR_SOLID_ANGLE,
	RESULT_RMS_COSINE,
	RESULT_RMS_CUBE_ROOT,
	RESULT_LOG_ERROR,
	RESULT_EVALUATIONS,
	RESULT_SECONDS,
	RESULT_PATH,
	RESULT_INPUT,
	RESULT_OPTIONS,
	RESULT_VERSION,
	RESULT_ALBEDO_R,
	RESULT_ALBEDO_G,
	RESULT_ALBEDO_B,
	RESULT_ENERGY,
	RESULT_SUSPECTS,
	RESULT_SIGMA_X,
	RESULT_SIGMA_Y,
	RESULT_ANGLE,
	RESULT_ERROR_ISOTROPIC,
	/* Of models with more terms than two, else empty */
	RESULT_KG_R,
	RESULT_KG_G,
	RESULT_KG_B,
	RESULT_EXPONENT,
	RESULT_F0_R,
	RESULT_F0_G,
	RESULT_F0_B,
	RESULT_F82_R,
	RESULT_F82_G,
	RESULT_F82_B,
	RESULT_F90_R,
	RESULT_F90_G,
	RESULT_F90_B,
	RESULT_KS2_R,
	RESULT_KS2_G,
	RESULT_KS2_B,
	RESULT_SIGMA2,
	RESULT_GAMMA2,
	RESULT_SIGMA_LO,
	RESULT_SIGMA_HI,
	RESULT_GAMMA_LO,
	RESULT_GAMMA_HI,
	RESULT_IOR_LO,
	RESULT_IOR_HI,
	RESULT_K_LO,
	RESULT_K_HI,
	RESULT_EXPONENT_LO,
	RESULT_EXPONENT_HI,
	RESULT_SIGMA2_LO,
	RESULT_SIGMA2_HI,
	RESULT_GAMMA2_LO,
	RESULT_GAMMA2_HI,
	RESULT_RATIO_LO,
	RESULT_RATIO_HI,
	RESULT_ANGLE_LO,
	RESULT_ANGLE_HI,
	RESULT_OPEN_ENDS,
	RESULT_OTHER_INTERVALS,
	RESULT_OTHER_BINS,
	/* Of conductors with an index for each channel, else empty */
	RESULT_IOR_R,
	RESULT_IOR_G,
	RESULT_IOR_B,
	RESULT_K_R,
	RESULT_K_G,
	RESULT_K_B,
	RESULT_COLUMNS,
	RESULT_LATER = RESULT_SIGMA_X /* from here on columns that earlier tables lack: what is not there is empty */
};

extern const struct csv_column result_columns[RESULT_COLUMNS];

/* The columns of metrics stand side by side. */
enum { RESULT_METRICS = RESULT_LOG_ERROR - RESULT_ERROR_NONE + 1 };

/* result_metric - the value of a column from RESULT_ERROR_NONE to RESULT_LOG_ERROR; NaN of any other. */
double result_metric(const struct fit_metrics *metrics, enum result_column column);

/* result_interval_column - RESULT_SIGMA_LO or its like; the column of the upper end is the next one. */
enum result_column result_interval_column(enum interval_parameter parameter);

/* struct result_source - what the rows of one file share. */
struct result_source {
	const char *path;
	const char *input;    /* "<size>:<hash>", see result_input(); "" when it is no MERL file, NULL when not known */
	const char *options;  /* canonical text of every option that changes the result */
	const char *suspects; /* suspects_words(); NULL: none, or not looked for */
};

enum { RESULT_INPUT_SIZE = 40 };
/* result_input - size and hash of a file's bytes: how a row says which bytes it was made from. */
void result_input(char text[RESULT_INPUT_SIZE], const struct measurement *measurement);
/* result_is_input - whether these are the bytes that a row was made from; `input` is its text, "": it does not say, true. */
bool result_is_input(const char *input, const struct measurement *measurement);
/* result_check_input - the same for samples read from `path`; STATUS_FORMAT with a message if they are not. */
MUST_CHECK enum status result_check_input(const char *input, const struct measurement *measurement, const char *path,
					  struct error *error);

/* result_reading - how the file of a row was read, as its options tell. */
struct read_options result_reading(char *const *row, int threads);

/* result_material - newly allocated: the name of a file without its directory and its extension, if that is of a known format;
 * NULL: out of memory. */
char *result_material(const char *path);

/* result_add - appends the row of one fitted model. STATUS_NO_MEMORY. */
MUST_CHECK enum status result_add(struct csv_table *table, const struct result_source *source,
				  const struct fit_options *options, const struct fit_result *result);
/* result_add_failure - appends a row per NDF that says why there is none. STATUS_NO_MEMORY. */
MUST_CHECK enum status result_add_failure(struct csv_table *table, const struct result_source *source,
					  const struct fit_options *options, const char *reason);
bool result_failed(char *const *row);

/* result_difference - the first column but seconds in which two rows differ; RESULT_COLUMNS when there is none. */
enum result_column result_difference(char *const *a, char *const *b);
/* What stands before the terms that --within has left out of a model, at the end of the row's options. */
#define RESULT_CHOSEN " chosen="
/* result_same_options - whether the options of two rows ask for the same; what --within chose may differ. */
bool result_same_options(const char *a, const char *b);
/* result_same_but_weight - the same of two rows, but one may have been fitted under another weight; then their columns of the
 * weight differ as their options do. */
bool result_same_but_weight(char *const *a, char *const *b);
/* RESULT_LOOKS_WRONG - of a fit under another weight: from this error under the weight solid-angle on, a fit under that weight
 * would most likely look much better. Of STD on twenty MERL tables it names 14, delta E of 11 of which is at least halved. */
#define RESULT_LOOKS_WRONG 0.15
/* result_looks_wrong - whether the row is of such a fit. */
bool result_looks_wrong(char *const *row);
/* result_one_row_a_file - whether a row was made with --within: then its file has one row a weight, of whatever NDF was chosen, or,
 * where the fit failed, a row for each NDF. */
bool result_one_row_a_file(char *const *row);

/* result_number - the value of a number column; NaN when empty. */
double result_number(char *const *row, enum result_column column);

/* result_model - the model that a row describes, and the options (G, Fresnel, bins, max_theta, zero_is_missing,
 * weight) under which it
 * was fitted. What a row leaves empty the model has not: kd = 0 or ks = 0. STATUS_FORMAT when the row is of a failed
 * fit or describes no model; `error` then says what is wrong in it. */
MUST_CHECK enum status result_model(char *const *row, struct cook_torrance *model, struct fit_options *options,
				    struct pwl **pwl, struct error *error);
/* result_model_free - frees the table, if any, that result_model() made for the model's NDF: *pwl, NULL unless it is pl. */
void result_model_free(struct cook_torrance *model, struct pwl *pwl);

/* result_param - the value of a parameter in the text of the column params, name=value;... Returns false, *value
 * untouched, when it is not there or no number. */
bool result_param(const char *params, const char *name, double *value);

/* result_order - qsort order of rows (char ***): material, ndf, path, weight. */
int result_order(const void *a, const void *b);

#endif
