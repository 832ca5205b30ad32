/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "result.h"
#include "text_quote.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

const struct csv_column result_columns[RESULT_COLUMNS] = {
	[RESULT_MATERIAL] = {"material", false},
	[RESULT_NDF] = {"ndf", false},
	[RESULT_ERROR] = {"error", true},
	[RESULT_KD_R] = {"kd_r", true},
	[RESULT_KD_G] = {"kd_g", true},
	[RESULT_KD_B] = {"kd_b", true},
	[RESULT_KS_R] = {"ks_r", true},
	[RESULT_KS_G] = {"ks_g", true},
	[RESULT_KS_B] = {"ks_b", true},
	[RESULT_SIGMA] = {"sigma", true},
	[RESULT_GAMMA] = {"gamma", true},
	[RESULT_IOR] = {"ior", true},
	[RESULT_PARAMS] = {"params", false},
	[RESULT_GAF] = {"gaf", false},
	[RESULT_FRESNEL] = {"fresnel", false},
	[RESULT_LAMBDA] = {"lambda", false},
	[RESULT_WEIGHT] = {"weight", false},
	[RESULT_BINS] = {"bins", false},
	[RESULT_MAX_THETA] = {"max_theta", true},
	[RESULT_SAMPLES] = {"samples", true},
	[RESULT_STATUS] = {"status", false},
	[RESULT_STARTS] = {"starts", true},
	[RESULT_STARTS_AGREEING] = {"starts_agreeing", true},
	[RESULT_AT_BOUND] = {"at_bound", false},
	[RESULT_ERROR_NONE] = {"error_none", true},
	[RESULT_ERROR_COSINE] = {"error_cosine", true},
	[RESULT_ERROR_SOLID_ANGLE] = {"error_solid_angle", true},
	[RESULT_RMS_COSINE] = {"rms_cosine", true},
	[RESULT_RMS_CUBE_ROOT] = {"rms_cube_root", true},
	[RESULT_LOG_ERROR] = {"log_error", true},
	[RESULT_EVALUATIONS] = {"evaluations", true},
	[RESULT_SECONDS] = {"seconds", true},
	[RESULT_PATH] = {"path", false},
	[RESULT_INPUT] = {"input", false},
	[RESULT_OPTIONS] = {"options", false},
	[RESULT_VERSION] = {"version", false},
};

void result_input(char text[RESULT_INPUT_SIZE], const struct samples *samples)
{
	snprintf(text, RESULT_INPUT_SIZE, "%" PRIu64 ":%016" PRIx64, samples->file_size, samples->file_hash);
}

char *result_material(const char *path)
{
	static const char suffix[] = ".binary";
	const char *slash = strrchr(path, '/');
	char *name = strdup(slash ? slash + 1 : path);
	if (!name)
		return NULL;
	const size_t length = strlen(name), cut = sizeof suffix - 1;
	if (length > cut && !strcmp(name + length - cut, suffix))
		name[length - cut] = '\0';
	return name;
}

/* A row under construction; number[] holds the text of the cells that are numbers. */
struct row {
	const char *cell[RESULT_COLUMNS];
	char number[RESULT_COLUMNS][CSV_NUMBER_SIZE];
};

static void set_number(struct row *row, enum result_column column, double x)
{
	row->cell[column] = csv_number(row->number[column], x);
}

/* What is known about a row before its fit, and of a fit that failed. */
static struct row *row_new(const struct result_source *source, const struct fit_options *options,
			   const struct ndf_class *ndf, const char *status)
{
	struct row *row = calloc(1, sizeof(*row));
	if (!row)
		return NULL;
	row->cell[RESULT_NDF] = ndf_name(ndf);
	row->cell[RESULT_GAF] = gaf_name(options->gaf);
	row->cell[RESULT_FRESNEL] = fresnel_name(options->fresnel);
	row->cell[RESULT_LAMBDA] = "exact";
	row->cell[RESULT_WEIGHT] = weight_name(options->weight);
	row->cell[RESULT_BINS] = bins_name(options->bins);
	set_number(row, RESULT_MAX_THETA, options->max_theta);
	row->cell[RESULT_STATUS] = status;
	row->cell[RESULT_PATH] = source->path;
	row->cell[RESULT_INPUT] = source->input;
	row->cell[RESULT_OPTIONS] = source->options;
	row->cell[RESULT_VERSION] = STDFIT_VERSION;
	return row;
}

/* Adds the row to the table and frees it. */
static enum status row_finish(struct row *row, struct csv_table *table, const char *path)
{
	char *material = result_material(path);
	enum status status = STATUS_NO_MEMORY;
	if (material) {
		row->cell[RESULT_MATERIAL] = material;
		status = csv_table_add(table, row->cell);
	}
	free(material);
	free(row);
	return status;
}

static void set_model(struct row *row, const struct fit_result *result, char params[64])
{
	const struct cook_torrance *model = &result->model;
	for (int c = 0; c < 3 && result->diffuse; c++)
		set_number(row, RESULT_KD_R + (enum result_column)c, model->kd[c]);
	if (!result->specular)
		return;
	for (int c = 0; c < 3; c++)
		set_number(row, RESULT_KS_R + (enum result_column)c, model->ks[c]);
	set_number(row, RESULT_SIGMA, model->ndf.sigma_x);
	set_number(row, RESULT_GAMMA, model->ndf.gamma);
	if (model->fresnel != FRESNEL_NONE)
		set_number(row, RESULT_IOR, model->n);
	if (model->fresnel == FRESNEL_CONDUCTOR) {
		char k[CSV_NUMBER_SIZE];
		snprintf(params, 64, "k=%s", csv_number(k, model->k));
		row->cell[RESULT_PARAMS] = params;
	}
}

static void set_metrics(struct row *row, const struct fit_metrics *metrics)
{
	set_number(row, RESULT_SAMPLES, (double)metrics->samples);
	set_number(row, RESULT_ERROR_NONE, metrics->error[WEIGHT_NONE]);
	set_number(row, RESULT_ERROR_COSINE, metrics->error[WEIGHT_COSINE]);
	set_number(row, RESULT_ERROR_SOLID_ANGLE, metrics->error[WEIGHT_SOLID_ANGLE]);
	set_number(row, RESULT_RMS_COSINE, metrics->rms_cosine);
	set_number(row, RESULT_RMS_CUBE_ROOT, metrics->rms_cube_root);
	set_number(row, RESULT_LOG_ERROR, metrics->log_error);
}

enum { BOUNDS_SIZE = 64 };

static const char *bounds_text(char text[BOUNDS_SIZE], unsigned at_bound)
{
	static const char *const name[] = {"sigma", "gamma", "ior",  "kd_r", "kd_g",
					   "kd_b",  "ks_r",  "ks_g", "ks_b", "k"};
	char *at = text;
	*at = '\0';
	for (size_t b = 0; b < sizeof name / sizeof *name; b++) {
		if (!(at_bound & 1u << b))
			continue;
		if (at > text)
			*at++ = ';';
		at = stpcpy(at, name[b]);
	}
	return text;
}

enum status result_add(struct csv_table *table, const struct result_source *source, const struct fit_options *options,
		       const struct fit_result *result)
{
	char params[64], bounds[BOUNDS_SIZE];
	struct row *row =
		row_new(source, options, result->model.ndf.class, result->end == FIT_CONVERGED ? "converged" : "limit");
	if (!row)
		return STATUS_NO_MEMORY;
	set_number(row, RESULT_ERROR, result->error);
	set_model(row, result, params);
	set_metrics(row, &result->metrics);
	set_number(row, RESULT_STARTS, result->starts);
	set_number(row, RESULT_STARTS_AGREEING, result->starts_agreeing);
	row->cell[RESULT_AT_BOUND] = bounds_text(bounds, result->at_bound);
	set_number(row, RESULT_EVALUATIONS, (double)result->evaluations);
	set_number(row, RESULT_SECONDS, result->seconds);
	return row_finish(row, table, source->path);
}

enum status result_add_failure(struct csv_table *table, const struct result_source *source,
			       const struct fit_options *options, const char *reason)
{
	struct error text;
	snprintf(text.text, sizeof text.text, "failed: %s", reason);
	for (int i = 0; i < options->n_ndf; i++) {
		struct row *row = row_new(source, options, options->ndf[i], text.text);
		if (!row || row_finish(row, table, source->path))
			return STATUS_NO_MEMORY;
	}
	return STATUS_OK;
}

bool result_failed(char *const *row)
{
	return !strncmp(row[RESULT_STATUS], "failed", strlen("failed"));
}

double result_number(char *const *row, enum result_column column)
{
	double x = NAN;
	return csv_parse_number(row[column], &x) ? x : NAN;
}

static double number_or(char *const *row, enum result_column column, double otherwise)
{
	const double x = result_number(row, column);
	return isnan(x) ? otherwise : x;
}

static enum status bad_cell(char *const *row, enum result_column column, struct error *error)
{
	char found[TEXT_QUOTE_SIZE];
	text_quote(row[column], found, sizeof found);
	return error_set(error, STATUS_FORMAT, "the row's column %s does not describe a model: '%s'",
			 result_columns[column].name, found);
}

static bool is_factor(char *const *row, enum result_column column)
{
	const double x = number_or(row, column, 0);
	return x >= 0 && !isinf(x);
}

enum status result_model(char *const *row, struct cook_torrance *model, struct fit_options *options,
			 struct error *error)
{
	*model = (struct cook_torrance){.n = number_or(row, RESULT_IOR, 1.5)};
	const struct ndf_class *ndf = ndf_find(row[RESULT_NDF]);
	if (result_failed(row))
		return bad_cell(row, RESULT_STATUS, error);
	if (!ndf)
		return bad_cell(row, RESULT_NDF, error);
	if (gaf_find(row[RESULT_GAF], &options->gaf))
		return bad_cell(row, RESULT_GAF, error);
	if (fresnel_find(row[RESULT_FRESNEL], &options->fresnel))
		return bad_cell(row, RESULT_FRESNEL, error);
	if (weight_find(row[RESULT_WEIGHT], &options->weight))
		return bad_cell(row, RESULT_WEIGHT, error);
	if (bins_find(row[RESULT_BINS], &options->bins))
		return bad_cell(row, RESULT_BINS, error);
	options->max_theta = number_or(row, RESULT_MAX_THETA, 90);
	if (!(options->max_theta > 0 && options->max_theta <= 90))
		return bad_cell(row, RESULT_MAX_THETA, error);
	for (enum result_column c = 0; c < 3; c++) {
		if (!is_factor(row, RESULT_KD_R + c))
			return bad_cell(row, RESULT_KD_R + c, error);
		if (!is_factor(row, RESULT_KS_R + c))
			return bad_cell(row, RESULT_KS_R + c, error);
		model->kd[c] = number_or(row, RESULT_KD_R + c, 0);
		model->ks[c] = number_or(row, RESULT_KS_R + c, 0);
	}
	if (!(model->n > 0 && !isinf(model->n)))
		return bad_cell(row, RESULT_IOR, error);
	if (options->fresnel == FRESNEL_CONDUCTOR && *row[RESULT_SIGMA] &&
	    (strncmp(row[RESULT_PARAMS], "k=", 2) || !csv_parse_number(row[RESULT_PARAMS] + 2, &model->k) ||
	     !(model->k >= 0)))
		return bad_cell(row, RESULT_PARAMS, error);
	const double sigma = number_or(row, RESULT_SIGMA, 1);
	model->gaf = options->gaf;
	model->fresnel = options->fresnel;
	if (ndf_init(&model->ndf, ndf, sigma, sigma, number_or(row, RESULT_GAMMA, 2)))
		return bad_cell(row, sigma > 0 ? RESULT_GAMMA : RESULT_SIGMA, error);
	return STATUS_OK;
}

int result_order(const void *a, const void *b)
{
	static const enum result_column key[] = {RESULT_MATERIAL, RESULT_NDF, RESULT_PATH};
	char *const *const row_a = *(char **const *)a, *const *const row_b = *(char **const *)b;
	for (size_t k = 0; k < sizeof key / sizeof *key; k++) {
		const int order = strcmp(row_a[key[k]], row_b[key[k]]);
		if (order)
			return order;
	}
	return 0;
}
