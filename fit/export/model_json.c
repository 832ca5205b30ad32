/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/export/model_json.h"
#include "data_readers/text_file.h"
#include "data_readers/text_quote.h"

#include <jansson.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_SIZE_MAX = 64 << 20 };

/* A member that is not as it should be. */
static enum status bad(const char *name, const char *expected, struct error *error)
{
	return error_set(error, STATUS_FORMAT, "the member \"%s\" should be %s", name, expected);
}

static const char *text_of(const json_t *json, const char *name)
{
	const char *text = json_string_value(json_object_get(json, name));
	return text ? text : "";
}

/* A number, or "inf"; NaN for anything else. */
static double number_of(const json_t *value)
{
	if (json_is_number(value))
		return json_number_value(value);
	return json_is_string(value) && !strcmp(json_string_value(value), "inf") ? INFINITY : NAN;
}

/* The numbers of an array, newly allocated; NULL: none, or out of memory. */
static double *numbers_of(const json_t *array, size_t *n)
{
	*n = json_array_size(array);
	double *x = *n ? malloc(*n * sizeof *x) : NULL;
	for (size_t i = 0; x && i < *n; i++)
		x[i] = number_of(json_array_get(array, i));
	return x;
}

static enum status read_rgb(const json_t *json, const char *name, double rgb[3], struct error *error)
{
	const json_t *array = json_object_get(json, name);
	if (json_array_size(array) != 3)
		return bad(name, "three numbers", error);
	for (int c = 0; c < 3; c++) {
		rgb[c] = number_of(json_array_get(array, (size_t)c));
		if (!(rgb[c] >= 0 && rgb[c] <= FIT_FACTOR_MAX))
			return bad(name, "three numbers from 0 to 1e6", error);
	}
	return STATUS_OK;
}

static enum status read_nodes(const json_t *json, struct model_json *read, struct error *error)
{
	const json_t *nodes = json_object_get(json, "nodes");
	const json_t *array_y = json_object_get(nodes, "Dy");
	size_t n = 0, n_D = 0, n_Dy = 0;
	double *theta = numbers_of(json_object_get(nodes, "theta"), &n),
	       *D = numbers_of(json_object_get(nodes, "D"), &n_D), *Dy = numbers_of(array_y, &n_Dy);
	enum status status = STATUS_DOMAIN;
	read->pwl = calloc(1, sizeof *read->pwl);
	if (!read->pwl)
		status = STATUS_NO_MEMORY;
	else if (theta && D && n == n_D && n <= PWL_NODES_MAX && (!array_y || (Dy && n == n_Dy)))
		status = pwl_init(read->pwl, (int)n, theta, D, Dy);
	free(theta);
	free(D);
	free(Dy);
	if (status == STATUS_NO_MEMORY)
		return error_set(error, status, "out of memory");
	if (status != STATUS_OK)
		return bad("nodes", "two arrays, theta from 0 to pi/2 and D", error);
	ndf_from_pwl(&read->model.ndf, read->pwl);
	if (array_y && ndf_turn(&read->model.ndf, number_of(json_object_get(nodes, "angle"))) != STATUS_OK)
		return bad("nodes", "with Dy an object with the angle in degrees, too", error);
	return STATUS_OK;
}

/* Those that can be have no parameters but sigma and gamma, or an x of 2. */
static enum status read_axes(const json_t *parameters, struct ndf *ndf)
{
	const double sigma_y = number_of(json_object_get(parameters, "sigma_y"));
	const enum status status = ndf_init(ndf, ndf->class, ndf->sigma_x, sigma_y, ndf->gamma);
	if (status != STATUS_OK || ndf_turn(ndf, number_of(json_object_get(parameters, "angle"))) != STATUS_OK)
		return STATUS_DOMAIN;
	return json_object_get(parameters, "tilt_x") ? ndf_tilt(ndf, number_of(json_object_get(parameters, "tilt_x")),
								number_of(json_object_get(parameters, "tilt_y")))
						     : STATUS_OK;
}

static enum status read_parameters(const json_t *json, const struct ndf_class *class, struct ndf *ndf)
{
	const json_t *parameters = json_object_get(json, "parameters");
	double value[NDF_PARAMS_MAX];
	for (int i = 0; ndf_param_at(class, i); i++)
		value[i] = number_of(json_object_get(parameters, ndf_param_at(class, i)->name));
	return ndf_init_params(ndf, class, value);
}

static enum status read_ndf(const json_t *json, struct model_json *read, struct error *error)
{
	const struct ndf_class *class = ndf_find(text_of(json, "ndf"));
	const json_t *parameters = json_object_get(json, "parameters");
	enum lambda_form form;
	if (!class)
		return bad("ndf", "the name of a distribution", error);
	if (lambda_form_find(text_of(json, "lambda"), &form) != STATUS_OK)
		return bad("lambda", "the name of a form of Lambda", error);
	if (ndf_is_tabulated(class))
		return read_nodes(json, read, error);
	if (read_parameters(json, class, &read->model.ndf) != STATUS_OK)
		return bad("parameters", "those of the distribution", error);
	if (json_object_get(parameters, "sigma_y") && read_axes(parameters, &read->model.ndf) != STATUS_OK)
		return bad("parameters", "sigma, sigma_y and angle of a distribution that can be anisotropic", error);
	if (form != LAMBDA_EXACT && ndf_set_lambda_form(&read->model.ndf, form) != STATUS_OK)
		return bad("lambda", "a form that the distribution has", error);
	return STATUS_OK;
}

static bool is_index(double n)
{
	return n > 0 && n <= 1e75;
}

static bool is_absorption(double k)
{
	return k >= 0 && k <= 1e75;
}

/* One index, or one for each channel. */
static enum status read_index(const json_t *json, struct cook_torrance *model, struct error *error)
{
	const json_t *n = json_object_get(json, "ior"), *k = json_object_get(json, "k");
	model->per_channel_ior = json_is_array(n) || json_is_array(k);
	model->n = model->per_channel_ior ? 1.5 : number_of(n);
	model->k = model->per_channel_ior ? 0 : number_of(k);
	if (model->per_channel_ior && model->fresnel != FRESNEL_CONDUCTOR)
		return bad("ior", "one number, but for a conductor", error);
	if (model->per_channel_ior && (json_array_size(n) != 3 || json_array_size(k) != 3))
		return bad("ior", "one number as \"k\" is, or three as \"k\" are", error);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		model->channel_n[c] = number_of(json_array_get(n, (size_t)c));
		model->channel_k[c] = number_of(json_array_get(k, (size_t)c));
		if (!is_index(model->per_channel_ior ? model->channel_n[c] : model->n))
			return bad("ior", "a positive number, or three of them", error);
		if (!is_absorption(model->per_channel_ior ? model->channel_k[c] : model->k))
			return bad("k", "a number, not negative, or three of them", error);
	}
	return STATUS_OK;
}

static enum status read_terms(const json_t *json, struct model_json *read, struct fit_options *fit, struct error *error)
{
	struct cook_torrance *model = &read->model;
	if (gaf_find(text_of(json, "gaf"), &model->gaf) != STATUS_OK)
		return bad("gaf", "the name of a masking-shadowing term", error);
	if (fresnel_find(text_of(json, "fresnel"), &model->fresnel) != STATUS_OK)
		return bad("fresnel", "the name of a Fresnel term", error);
	fit->criterion.gaf = model->gaf;
	fit->fresnel = model->fresnel;
	fit->lambda = model->ndf.lambda_form;
	const enum status status = read_index(json, model, error);
	fit->per_channel_ior = model->per_channel_ior;
	return status;
}

static bool is_reflectance(const double rgb[3])
{
	return rgb[0] <= 1 && rgb[1] <= 1 && rgb[2] <= 1;
}

/* What richer models have besides. */
static enum status read_rich(const json_t *json, struct cook_torrance *model, struct fit_options *fit,
			     struct error *error)
{
	static const char *const name[F82_PARTS] = {"f0", "f82", "f90"};
	enum status status = STATUS_OK;
	for (int i = 0; i < F82_PARTS && status == STATUS_OK && model->fresnel == FRESNEL_F82; i++) {
		double rgb[3];
		status = read_rgb(json, name[i], rgb, error);
		if (status == STATUS_OK && !is_reflectance(rgb))
			status = bad(name[i], "three numbers from 0 to 1", error);
		for (int c = 0; c < 3 && status == STATUS_OK; c++)
			model->reflectance[c][i] = rgb[c];
	}
	fit->grazing = json_object_get(json, "kg");
	fit->lobes = json_object_get(json, "ks2") ? 2 : 1;
	if (status == STATUS_OK && fit->grazing)
		status = read_rgb(json, "kg", model->kg, error);
	if (status == STATUS_OK && fit->lobes > 1)
		status = read_rgb(json, "ks2", model->ks_second, error);
	if (status != STATUS_OK)
		return status;
	model->grazing = fit->grazing ? number_of(json_object_get(json, "exponent")) : 0;
	if (fit->grazing && !(model->grazing >= FIT_GRAZING_MIN && model->grazing <= FIT_GRAZING_MAX))
		return bad("exponent", "a number from 1 to 20", error);
	if (fit->lobes < 2)
		return STATUS_OK;
	if (ndf_is_tabulated(model->ndf.class) ||
	    read_parameters(json_object_get(json, "second"), model->ndf.class, &model->second) != STATUS_OK)
		return bad("second", "an object with the parameters of a distribution of the same kind", error);
	return STATUS_OK;
}

static bool copy(const char *text, char **copied)
{
	*copied = *text ? strdup(text) : NULL;
	return !*text || *copied;
}

static enum status read_fitted(const json_t *json, struct model_json *read, struct fit_options *fit,
			       struct error *error)
{
	const json_t *fitted = json_object_get(json, "fitted");
	fit->criterion.max_theta = number_of(json_object_get(fitted, "max_theta"));
	fit->criterion.zero_is_missing = json_is_true(json_object_get(fitted, "zero_is_missing"));
	read->error = number_of(json_object_get(fitted, "error"));
	if (weight_find(text_of(fitted, "weight"), &fit->criterion.weight) != STATUS_OK ||
	    bins_find(text_of(fitted, "bins"), &fit->criterion.bins) != STATUS_OK ||
	    !(fit->criterion.max_theta > 0 && fit->criterion.max_theta <= 90))
		return bad("fitted", "an object with weight, bins and max_theta", error);
	if (!copy(text_of(json, "material"), &read->material) || !copy(text_of(fitted, "path"), &read->path))
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	return STATUS_OK;
}

static enum status read_model(const json_t *json, struct model_json *read, struct fit_options *fit, struct error *error)
{
	if (strcmp(text_of(json, "format"), "stdfit-model-1") != 0)
		return bad("format", "\"stdfit-model-1\"", error);
	enum status status = read_rgb(json, "kd", read->model.kd, error);
	if (status == STATUS_OK)
		status = read_rgb(json, "ks", read->model.ks, error);
	if (status == STATUS_OK)
		status = read_ndf(json, read, error);
	if (status == STATUS_OK)
		status = read_terms(json, read, fit, error);
	if (status == STATUS_OK)
		status = read_rich(json, &read->model, fit, error);
	return status != STATUS_OK ? status : read_fitted(json, read, fit, error);
}

/* The tree of a text; NULL, and the reason. */
static json_t *parse(const char *text, size_t size, enum status *status, struct error *why)
{
	json_error_t error;
	char quoted[TEXT_QUOTE_SIZE];
	json_t *tree = json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &error);
	if (tree)
		return tree;
	/* Of what has run out while an array or an object grew, no text is given. */
	if (json_error_code(&error) == json_error_out_of_memory || !*error.text) {
		*status = error_set(why, STATUS_NO_MEMORY, "out of memory");
		return NULL;
	}
	text_quote(error.text, quoted, sizeof quoted);
	*status = error_set(why, STATUS_FORMAT, "line %d, column %d: %s", error.line, error.column, quoted);
	return NULL;
}

static enum status read_tree(const char *path, json_t **tree, struct error *error)
{
	char *text, name[TEXT_QUOTE_SIZE];
	struct error why;
	size_t size;
	enum status status = text_file_read(path, "a model", FILE_SIZE_MAX, &text, &size, &why);
	*tree = status == STATUS_OK ? parse(text, size, &status, &why) : NULL;
	free(text);
	if (status == STATUS_OK)
		return STATUS_OK;
	text_quote(path, name, sizeof name);
	return error_set(error, status, "cannot read '%s': %.200s", name, why.text);
}

enum status model_json_read(const char *path, struct model_json *json, struct fit_options *fit, struct error *error)
{
	json_t *tree;
	struct error why;
	char name[TEXT_QUOTE_SIZE];
	*json = (struct model_json){0};
	enum status status = read_tree(path, &tree, error);
	if (status != STATUS_OK)
		return status;
	status = read_model(tree, json, fit, &why);
	json_decref(tree);
	if (status == STATUS_OK)
		return STATUS_OK;
	model_json_free(json);
	text_quote(path, name, sizeof name);
	return error_set(error, status, "'%s' describes no model: %.200s", name, why.text);
}

void model_json_free(struct model_json *json)
{
	if (json->pwl)
		pwl_free(json->pwl);
	free(json->pwl);
	free(json->material);
	free(json->path);
	*json = (struct model_json){0};
}
