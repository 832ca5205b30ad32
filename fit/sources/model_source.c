/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/model_source.h"
#include "data_readers/measurement_read.h"
#include "data_readers/text_quote.h"
#include "fit/export/model_json.h"
#include "fit/results/contradiction.h"

#include <stdlib.h>
#include <string.h>

/* Options */

enum source_kind model_source_kind(const struct options *options)
{
	if (options->from)
		return SOURCE_ROWS;
	return options_given(options, "kd") || options_given(options, "ks") ? SOURCE_GIVEN : SOURCE_FIT;
}

/* The first of the names, which end with NULL, that is given; NULL: none. */
static const char *first_given(const struct options *options, const char *const *name)
{
	while (*name && !options_given(options, *name))
		name++;
	return *name;
}

/* Options that control a fit and do not describe a model. */
static const char *const of_a_fit[] = {"unbounded", "no-diffuse", "no-specular",     "gray", "anisotropic",
				       "diffuse",   "lobes",      "per-channel-ior", NULL};
/* Options that a fit has no use for: what they say is what it finds. */
static const char *const of_a_given_model[] = {"k",      "f0",     "f82",    "f90",   "kg", "ks2",
					       "sigma2", "gamma2", "params", "nodes", NULL};
/* Options that a row determines. */
static const char *const of_a_model[] = {"kd",       "ks",   "sigma",   "angle",     "gamma",  "ior",   "k",   "gaf",
					 "lambda",   "bins", "fresnel", "max-theta", "f0",     "f82",   "f90", "kg",
					 "exponent", "ks2",  "sigma2",  "gamma2",    "params", "nodes", NULL};

/* An export fits a model in the place of another: the weight is of that fit. Elsewhere it chooses rows. */
static bool weighs_substitute(const struct options *options)
{
	return options->command == COMMAND_EXPORT;
}

static bool is_json(const char *path)
{
	const size_t length = strlen(path);
	return length > 5 && !strcmp(path + length - 5, ".json");
}

static int check_rows(const struct options *options)
{
	const char *ignored = first_given(options, of_a_model);
	if (!ignored)
		ignored = first_given(options, of_a_fit);
	if (ignored)
		return options_usage(options->command, "--%s and --from exclude each other", ignored);
	const bool by_weight = options_given(options, "weight") && !weighs_substitute(options);
	const bool chosen = options_given(options, "ndf") || by_weight;
	if (options->row && chosen)
		return options_usage(options->command, "--%s and --row exclude each other",
				     options_given(options, "ndf") ? "ndf" : "weight");
	if (is_json(options->from) && (options->row || chosen))
		return options_usage(options->command, "a model's JSON has neither --row nor --ndf nor --weight");
	return -1;
}

static int check_given(const struct options *options)
{
	struct cook_torrance model;
	const char *ignored = options_given(options, "weight") && !weighs_substitute(options)
				      ? "weight"
				      : first_given(options, of_a_fit);
	if (ignored)
		return options_usage(options->command, "--%s means nothing without a fit, --kd and --ks give the model",
				     ignored);
	struct distribution distribution;
	const int wrong = options_model(options, &model, &distribution);
	distribution_free(&distribution);
	return wrong;
}

int model_source_check(const struct options *options, bool may_fit)
{
	if (options->row && !options->from)
		return options_usage(options->command, "--row means nothing without --from");
	const enum source_kind kind = model_source_kind(options);
	if (kind == SOURCE_ROWS)
		return check_rows(options);
	if (kind == SOURCE_GIVEN || !may_fit)
		return check_given(options);
	const char *given = first_given(options, of_a_given_model);
	if (given)
		return options_usage(options->command, "--%s means nothing without --%s", given,
				     strcmp(given, "kg") ? "ks" : "kd");
	return options_check_fit(options);
}

/* Models */

static enum status no_memory(struct error *error)
{
	return error_set(error, STATUS_NO_MEMORY, "out of memory");
}

/* Appends a model that so far has nothing but its options and material; NULL: out of memory. */
static struct source_model *add(struct model_source *source, const struct options *options, const char *material)
{
	struct source_model *models = realloc(source->model, (source->n + 1) * sizeof *models);
	if (!models)
		return NULL;
	source->model = models;
	struct source_model *model = &models[source->n];
	*model = (struct source_model){
		.fit = options->fit, .error = NAN, .reading = options_reading(options, options->fit.threads)};
	model->material = material ? strdup(material) : NULL;
	if (material && !model->material)
		return NULL;
	source->n++;
	return model;
}

static bool set_path(struct source_model *model, const char *path)
{
	model->path = strdup(path);
	return model->path;
}

static enum status read_given(const struct options *options, const char *material, struct model_source *source,
			      struct error *error)
{
	struct source_model *model = add(source, options, material);
	if (!model)
		return no_memory(error);
	model->fit.criterion.weight = WEIGHT_NONE; /* nothing was fitted */
	struct distribution distribution;
	if (options_model(options, &model->model, &distribution) >= 0)
		return error_set(error, STATUS_DOMAIN, "the options describe no model");
	model->pwl = distribution.pwl;
	return STATUS_OK;
}

static bool wanted(const struct options *options, char *const *row, size_t i, const char *material)
{
	if (options->row)
		return i + 1 == (size_t)options->row;
	if ((material && strcmp(row[RESULT_MATERIAL], material) != 0) || result_failed(row))
		return false;
	if (options_given(options, "weight") && !weighs_substitute(options) &&
	    strcmp(row[RESULT_WEIGHT], weight_name(options->fit.criterion.weight)) != 0)
		return false;
	if (!options_given(options, "ndf"))
		return true;
	for (int n = 0; n < options->fit.n_ndf; n++)
		if (!strcmp(row[RESULT_NDF], ndf_name(options->fit.ndf[n])))
			return true;
	return false;
}

static enum status add_row(const struct options *options, char *const *row, size_t number, struct model_source *source,
			   struct error *error)
{
	struct source_model *model = add(source, options, row[RESULT_MATERIAL]);
	struct error why;
	if (!model)
		return no_memory(error);
	model->row = number;
	const enum status status = result_model(row, &model->model, &model->fit, &model->pwl, &why);
	if (status != STATUS_OK) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(options->from, name, sizeof name);
		return error_set(error, status, "'%s' row %zu: %.200s", name, number, why.text);
	}
	model->error = result_number(row, RESULT_ERROR);
	model->reading = result_reading(row, model->fit.threads);
	snprintf(model->input, sizeof model->input, "%s", row[RESULT_INPUT]);
	return !*row[RESULT_PATH] || set_path(model, row[RESULT_PATH]) ? STATUS_OK : no_memory(error);
}

static enum status no_row(const struct options *options, const char *material, struct error *error)
{
	char name[TEXT_QUOTE_SIZE], wanted_name[TEXT_QUOTE_SIZE];
	text_quote(options->from, name, sizeof name);
	text_quote(material ? material : "", wanted_name, sizeof wanted_name);
	if (!material || options->row)
		return error_set(error, STATUS_NO_DATA, "'%s' has no such row", name);
	return error_set(error, STATUS_NO_DATA, "'%s' has no such row: expected one of material '%s'", name,
			 wanted_name);
}

/* The rows of --from. Which of two that contradict each other is meant, only --row can say. */
static enum status read_from(const struct options *options, struct csv_table *rows, struct error *error)
{
	*rows = csv_table_make(result_columns, RESULT_COLUMNS);
	const enum status status = csv_table_read(rows, options->from, RESULT_SAMPLES, NULL, error);
	return status != STATUS_OK || options->row ? status : contradiction_check(rows, options->from, error);
}

enum status model_source_check_rows(const struct options *options, struct error *error)
{
	struct csv_table rows;
	if (model_source_kind(options) != SOURCE_ROWS || is_json(options->from))
		return STATUS_OK;
	const enum status status = read_from(options, &rows, error);
	csv_table_free(&rows);
	return status;
}

static enum status read_rows(const struct options *options, const char *material, struct model_source *source,
			     struct error *error)
{
	struct csv_table rows;
	enum status status = read_from(options, &rows, error);
	for (size_t i = 0; i < rows.n_rows && status == STATUS_OK; i++)
		if (wanted(options, rows.row[i], i, material))
			status = add_row(options, rows.row[i], i + 1, source, error);
	csv_table_free(&rows);
	return status == STATUS_OK && !source->n ? no_row(options, material, error) : status;
}

/* The one model of a file that `stdfit export --format json` wrote, whatever the material. */
static enum status read_json(const struct options *options, struct model_source *source, struct error *error)
{
	struct source_model *model = add(source, options, NULL);
	struct model_json json;
	if (!model)
		return no_memory(error);
	const enum status status = model_json_read(options->from, &json, &model->fit, error);
	if (status != STATUS_OK)
		return status;
	model->model = json.model;
	model->pwl = json.pwl;
	model->error = json.error;
	model->material = json.material;
	model->path = json.path;
	return STATUS_OK;
}

/* Moves the results into models; what cannot be moved is released. */
static enum status add_results(const struct options *options, const char *path, const char *material,
			       struct fit_result *result, struct model_source *source, struct error *error)
{
	enum status status = STATUS_OK;
	for (int i = 0; i < options->fit.n_ndf; i++) {
		struct source_model *model = status != STATUS_OK ? NULL : add(source, options, material);
		if (!model || !set_path(model, path)) {
			status = no_memory(error);
			fit_result_free(&result[i]);
			continue;
		}
		model->model = result[i].model;
		model->error = result[i].error;
		model->pwl = result[i].pwl;
	}
	return status;
}

static enum status fit_file(const struct options *options, const char *path, const char *material,
			    struct model_source *source, struct error *error)
{
	struct fit_context *context = NULL;
	struct fit_result result[FIT_NDFS_MAX];
	struct error why = {""};
	const struct read_options reading = options_reading(options, options->fit.threads);
	enum status status = measurement_read(path, &reading, &source->measurement, error);
	if (status != STATUS_OK)
		return status;
	status = fit_context_new(&context, source->measurement.n_phi_d, &options->fit);
	if (status != STATUS_OK && !why.text[0])
		error_set(&why, status, "%s", status_str(status));
	if (status == STATUS_OK)
		status = fit_run(context, &source->measurement, &options->fit, result, &why);
	fit_context_free(context);
	if (status == STATUS_OK)
		return add_results(options, path, material, result, source, error);
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	return error_set(error, status, "cannot fit '%s': %.200s", name, why.text);
}

enum status model_source_read(const struct options *options, const char *path, struct model_source *source,
			      struct error *error)
{
	*source = (struct model_source){0};
	char *material = path ? result_material(path) : NULL;
	const enum source_kind kind = model_source_kind(options);
	enum status status;
	if (path && !material)
		status = no_memory(error);
	else if (kind == SOURCE_ROWS && is_json(options->from))
		status = read_json(options, source, error);
	else if (kind == SOURCE_ROWS)
		status = read_rows(options, material, source, error);
	else if (kind == SOURCE_GIVEN)
		status = read_given(options, material, source, error);
	else if (!path)
		status = error_set(error, STATUS_NO_DATA, "there is no file to fit to");
	else
		status = fit_file(options, path, material, source, error);
	free(material);
	if (status != STATUS_OK)
		model_source_free(source);
	return status;
}

void model_source_free(struct model_source *source)
{
	for (size_t i = 0; i < source->n; i++) {
		struct source_model *model = &source->model[i];
		result_model_free(&model->model, model->pwl);
		free(model->material);
		free(model->path);
	}
	free(source->model);
	measurement_free(&source->measurement);
	*source = (struct model_source){0};
}
