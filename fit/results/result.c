/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/result.h"
#include "data_readers/measurement_read.h"
#include "data_readers/text_quote.h"
#include "fit/results/energy_conservation.h"
#include "fit/search/free_form.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

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
	[RESULT_ALBEDO_R] = {"albedo_r", true},
	[RESULT_ALBEDO_G] = {"albedo_g", true},
	[RESULT_ALBEDO_B] = {"albedo_b", true},
	[RESULT_ENERGY] = {"energy", false},
	[RESULT_SIGMA_X] = {"sigma_x", true},
	[RESULT_SIGMA_Y] = {"sigma_y", true},
	[RESULT_ANGLE] = {"angle", true},
	[RESULT_ERROR_ISOTROPIC] = {"error_isotropic", true},
	[RESULT_KG_R] = {"kg_r", true},
	[RESULT_KG_G] = {"kg_g", true},
	[RESULT_KG_B] = {"kg_b", true},
	[RESULT_EXPONENT] = {"exponent", true},
	[RESULT_F0_R] = {"f0_r", true},
	[RESULT_F0_G] = {"f0_g", true},
	[RESULT_F0_B] = {"f0_b", true},
	[RESULT_F82_R] = {"f82_r", true},
	[RESULT_F82_G] = {"f82_g", true},
	[RESULT_F82_B] = {"f82_b", true},
	[RESULT_F90_R] = {"f90_r", true},
	[RESULT_F90_G] = {"f90_g", true},
	[RESULT_F90_B] = {"f90_b", true},
	[RESULT_KS2_R] = {"ks2_r", true},
	[RESULT_KS2_G] = {"ks2_g", true},
	[RESULT_KS2_B] = {"ks2_b", true},
	[RESULT_SIGMA2] = {"sigma2", true},
	[RESULT_GAMMA2] = {"gamma2", true},
	[RESULT_IOR_R] = {"ior_r", true},
	[RESULT_IOR_G] = {"ior_g", true},
	[RESULT_IOR_B] = {"ior_b", true},
	[RESULT_K_R] = {"k_r", true},
	[RESULT_K_G] = {"k_g", true},
	[RESULT_K_B] = {"k_b", true},
	[RESULT_SUSPECTS] = {"suspects", false},
	[RESULT_SIGMA_LO] = {"sigma_lo", true},
	[RESULT_SIGMA_HI] = {"sigma_hi", true},
	[RESULT_GAMMA_LO] = {"gamma_lo", true},
	[RESULT_GAMMA_HI] = {"gamma_hi", true},
	[RESULT_IOR_LO] = {"ior_lo", true},
	[RESULT_IOR_HI] = {"ior_hi", true},
	[RESULT_K_LO] = {"k_lo", true},
	[RESULT_K_HI] = {"k_hi", true},
	[RESULT_EXPONENT_LO] = {"exponent_lo", true},
	[RESULT_EXPONENT_HI] = {"exponent_hi", true},
	[RESULT_SIGMA2_LO] = {"sigma2_lo", true},
	[RESULT_SIGMA2_HI] = {"sigma2_hi", true},
	[RESULT_GAMMA2_LO] = {"gamma2_lo", true},
	[RESULT_GAMMA2_HI] = {"gamma2_hi", true},
	[RESULT_RATIO_LO] = {"ratio_lo", true},
	[RESULT_RATIO_HI] = {"ratio_hi", true},
	[RESULT_ANGLE_LO] = {"angle_lo", true},
	[RESULT_ANGLE_HI] = {"angle_hi", true},
	[RESULT_OPEN_ENDS] = {"open_ends", false},
	[RESULT_OTHER_INTERVALS] = {"other_intervals", false},
	[RESULT_OTHER_BINS] = {"other_bins", false},
};

enum result_column result_interval_column(enum interval_parameter parameter)
{
	return RESULT_SIGMA_LO + 2 * (enum result_column)parameter;
}

void result_input(char text[RESULT_INPUT_SIZE], const struct measurement *measurement)
{
	snprintf(text, RESULT_INPUT_SIZE, "%" PRIu64 ":%016" PRIx64, measurement->file_size, measurement->file_hash);
}

bool result_is_input(const char *input, const struct measurement *measurement)
{
	char text[RESULT_INPUT_SIZE];
	result_input(text, measurement);
	return !*input || !strcmp(input, text);
}

enum status result_check_input(const char *input, const struct measurement *measurement, const char *path,
			       struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	if (result_is_input(input, measurement))
		return STATUS_OK;
	text_quote(path, name, sizeof name);
	return error_set(error, STATUS_FORMAT, "cannot show '%s': it is not the file any more that was fitted", name);
}

enum { RECORDED_SIZE = 32 };

/* The value behind NAME= in the text of the options; false: it is not there, or does not fit. */
static bool recorded(const char *options, const char *name, char value[RECORDED_SIZE])
{
	const size_t length = strlen(name);
	for (const char *at = options; *at; at += strspn(at, " ")) {
		const size_t n = strcspn(at, " ");
		if (n > length && !strncmp(at, name, length) && n - length < RECORDED_SIZE) {
			snprintf(value, RECORDED_SIZE, "%.*s", (int)(n - length), at + length);
			return true;
		}
		at += n;
	}
	return false;
}

struct read_options result_reading(char *const *row, int threads)
{
	struct read_options reading = {.threads = threads};
	char value[RECORDED_SIZE];
	/* What is no name that this version knows leaves the default. */
	if (recorded(row[RESULT_OPTIONS], "quantity=", value) && quantity_find(value, &reading.quantity) != STATUS_OK)
		reading.quantity = QUANTITY_FROM_FILE;
	if (recorded(row[RESULT_OPTIONS], "gamut=", value) && gamut_find(value, &reading.gamut) != STATUS_OK)
		reading.gamut = GAMUT_CLIP;
	return reading;
}

char *result_material(const char *path)
{
	const char *slash = strrchr(path, '/');
	char *name = strdup(slash ? slash + 1 : path);
	if (!name)
		return NULL;
	name[strlen(name) - measurement_extension(name)] = '\0';
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
	row->cell[RESULT_GAF] = gaf_name(options->criterion.gaf);
	row->cell[RESULT_FRESNEL] = fresnel_name(options->fresnel);
	row->cell[RESULT_LAMBDA] = lambda_form_name(options->lambda);
	row->cell[RESULT_WEIGHT] = weight_name(options->criterion.weight);
	row->cell[RESULT_BINS] = bins_name(options->criterion.bins);
	set_number(row, RESULT_MAX_THETA, options->criterion.max_theta);
	row->cell[RESULT_STATUS] = status;
	row->cell[RESULT_PATH] = source->path;
	row->cell[RESULT_INPUT] = source->input;
	row->cell[RESULT_OPTIONS] = source->options;
	row->cell[RESULT_SUSPECTS] = source->suspects;
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

enum { PARAMS_SIZE = 8192 }; /* pl has 90 node values */

/* Adds name=value to the text of the column params. */
static void add_param(char params[PARAMS_SIZE], const char *name, double value)
{
	char number[CSV_NUMBER_SIZE];
	const size_t used = strlen(params);
	snprintf(params + used, PARAMS_SIZE - used, "%s%s=%s", used ? ";" : "", name, csv_number(number, value));
}

/* The values of pl: D0 to D89 at the rows of the table, which their bins place, and D90 at the horizon. */
static void set_nodes(const struct fit_options *options, const struct ndf *ndf, char params[PARAMS_SIZE])
{
	for (int i = 0; i < FREE_FORM_VALUES; i++) {
		const struct halfdiff_trig h = bins_trig(options->criterion.bins, i < MERL_THETA_H ? i : 0, 0, 0);
		const struct vec3 horizon = {1, 0, 1e-300};
		char name[16];
		snprintf(name, sizeof name, "D%d", i);
		add_param(params, name, ndf_D(ndf, i < MERL_THETA_H ? (struct vec3){h.sin_h, 0, h.cos_h} : horizon));
	}
}

/* sigma and gamma have columns; what else a distribution has goes to params. */
static void set_ndf(struct row *row, const struct ndf *ndf, char params[PARAMS_SIZE])
{
	for (int i = 0; ndf_param_at(ndf->class, i); i++) {
		const struct ndf_param *param = ndf_param_at(ndf->class, i);
		if (param->role == NDF_ROLE_SIGMA)
			set_number(row, RESULT_SIGMA,
				   ndf->sigma_x == ndf->sigma_y ? ndf->param[i] : sqrt(ndf->sigma_x * ndf->sigma_y));
		else if (param->role == NDF_ROLE_GAMMA)
			set_number(row, RESULT_GAMMA, ndf->param[i]);
		else
			add_param(params, param->name, ndf->param[i]);
	}
	if (!ndf_has_gamma(ndf->class) && !ndf_is_tabulated(ndf->class))
		set_number(row, RESULT_GAMMA, ndf->gamma);
}

/* Of an anisotropic fit; its sigma is the geometric mean. Where both are one roughness, there is no angle. */
static void set_axes(struct row *row, const struct fit_result *result)
{
	const struct ndf *ndf = &result->model.ndf;
	set_number(row, RESULT_SIGMA_X, ndf->sigma_x);
	set_number(row, RESULT_SIGMA_Y, ndf->sigma_y);
	if (ndf->sigma_x != ndf->sigma_y)
		set_number(row, RESULT_ANGLE, ndf->angle);
	if (!isnan(result->error_isotropic))
		set_number(row, RESULT_ERROR_ISOTROPIC, result->error_isotropic);
}

static void set_channels(struct row *row, enum result_column first, const double value[3])
{
	for (int c = 0; c < 3; c++)
		set_number(row, first + (enum result_column)c, value[c]);
}

/* What a model has of more terms than two. */
static void set_terms(struct row *row, const struct fit_options *options, const struct fit_result *result)
{
	const struct cook_torrance *model = &result->model;
	if (options->grazing) {
		set_channels(row, RESULT_KG_R, model->kg);
		set_number(row, RESULT_EXPONENT, model->grazing);
	}
	for (int i = 0; i < F82_PARTS && result->specular && model->fresnel == FRESNEL_F82; i++)
		for (int c = 0; c < 3; c++)
			set_number(row, RESULT_F0_R + (enum result_column)(3 * i + c), model->reflectance[c][i]);
	if (result->specular && options->lobes > 1) {
		set_channels(row, RESULT_KS2_R, model->ks_second);
		if (!cook_torrance_has_second(model))
			return; /* one lobe was best */
		set_number(row, RESULT_SIGMA2, model->second.sigma_x);
		set_number(row, RESULT_GAMMA2, model->second.gamma);
	}
}

static void set_model(struct row *row, const struct fit_options *options, const struct fit_result *result,
		      char params[PARAMS_SIZE])
{
	const struct cook_torrance *model = &result->model;
	if (result->diffuse)
		set_channels(row, RESULT_KD_R, model->kd);
	set_terms(row, options, result);
	if (!result->specular)
		return;
	set_channels(row, RESULT_KS_R, model->ks);
	if (options->anisotropic)
		set_axes(row, result);
	if (ndf_is_tabulated(model->ndf.class))
		set_nodes(options, &model->ndf, params);
	else
		set_ndf(row, &model->ndf, params);
	if (options->anisotropic && ndf_has_tilt(model->ndf.class)) {
		add_param(params, "tilt_x", model->ndf.tilt_x);
		add_param(params, "tilt_y", model->ndf.tilt_y);
	}
	if (model->per_channel_ior) {
		set_channels(row, RESULT_IOR_R, model->channel_n);
		set_channels(row, RESULT_K_R, model->channel_k);
	} else if (fresnel_has_ior(model->fresnel)) {
		set_number(row, RESULT_IOR, model->n);
	}
	if (model->fresnel == FRESNEL_CONDUCTOR && !model->per_channel_ior)
		add_param(params, "k", model->k);
	row->cell[RESULT_PARAMS] = params;
	row->cell[RESULT_LAMBDA] = lambda_form_name(model->ndf.lambda_form);
}

double result_metric(const struct fit_metrics *metrics, enum result_column column)
{
	switch ((int)column) {
	case RESULT_ERROR_NONE:
		return metrics->error[WEIGHT_NONE];
	case RESULT_ERROR_COSINE:
		return metrics->error[WEIGHT_COSINE];
	case RESULT_ERROR_SOLID_ANGLE:
		return metrics->error[WEIGHT_SOLID_ANGLE];
	case RESULT_RMS_COSINE:
		return metrics->rms_cosine;
	case RESULT_RMS_CUBE_ROOT:
		return metrics->rms_cube_root;
	case RESULT_LOG_ERROR:
		return metrics->log_error;
	default:
		return NAN;
	}
}

static void set_metrics(struct row *row, const struct fit_metrics *metrics)
{
	set_number(row, RESULT_SAMPLES, (double)metrics->samples);
	for (enum result_column c = RESULT_ERROR_NONE; c < RESULT_ERROR_NONE + RESULT_METRICS; c++)
		set_number(row, c, result_metric(metrics, c));
}

static void set_energy_conservation(struct row *row, const struct cook_torrance *model)
{
	const struct energy_conservation energy = energy_conservation_of(model);
	for (int c = 0; c < 3; c++)
		set_number(row, RESULT_ALBEDO_R + (enum result_column)c, energy.albedo[c]);
	row->cell[RESULT_ENERGY] = energy_conservation_name(&energy);
}

enum { NAMES_SIZE = 160, STATUS_SIZE = NAMES_SIZE + 16 };

/* The names of enum fit_bound's bits. */
static const char *names_text(char text[NAMES_SIZE], unsigned bits)
{
	static const char *const name[] = {"sigma", "gamma", "ior",   "kd_r",  "kd_g",     "kd_b",   "ks_r",
					   "ks_g",  "ks_b",  "k",     "angle", "exponent", "sigma2", "gamma2",
					   "ior_r", "ior_g", "ior_b", "k_r",   "k_g",      "k_b"};
	char *at = text;
	*at = '\0';
	for (size_t b = 0; b < sizeof name / sizeof *name; b++) {
		if (!(bits & 1u << b))
			continue;
		if (at > text)
			*at++ = ';';
		at = stpcpy(at, name[b]);
	}
	return text;
}

static const char *status_text(char text[STATUS_SIZE], const struct fit_result *result)
{
	char names[NAMES_SIZE];
	if (result->end == FIT_LIMIT)
		return "limit";
	if (!result->undetermined)
		return "converged";
	snprintf(text, STATUS_SIZE, "undetermined: %s", names_text(names, result->undetermined));
	return text;
}

enum { OPEN_SIZE = 192, OTHERS_SIZE = 1536 };

/* Text of the intervals of a fit beside the columns of their ends. */
struct interval_words {
	char open[OPEN_SIZE];     /* "gamma_hi;ior_hi" */
	char others[OTHERS_SIZE]; /* "sigma=0.3:0.4;sigma=0.7:0.9" */
};

static void add_open(struct interval_words *words, enum result_column column)
{
	const size_t used = strlen(words->open);
	snprintf(words->open + used, OPEN_SIZE - used, "%s%s", used ? ";" : "", result_columns[column].name);
}

static void add_other(struct interval_words *words, const char *name, const struct interval *interval)
{
	char lo[CSV_NUMBER_SIZE], hi[CSV_NUMBER_SIZE];
	const size_t used = strlen(words->others);
	snprintf(words->others + used, OTHERS_SIZE - used, "%s%s=%s:%s", used ? ";" : "", name,
		 csv_number(lo, interval->lo), csv_number(hi, interval->hi));
}

static void set_intervals(struct row *row, const struct fit_result *result, struct interval_words *words)
{
	*words = (struct interval_words){"", ""};
	for (enum interval_parameter p = 0; p < INTERVAL_PARAMETERS; p++) {
		const struct interval_list *list = &result->interval[p];
		const enum result_column lo = result_interval_column(p);
		if (!list->n)
			continue;
		set_number(row, lo, list->at[0].lo);
		set_number(row, lo + 1, list->at[0].hi);
		if (list->at[0].lo_open)
			add_open(words, lo);
		if (list->at[0].hi_open)
			add_open(words, lo + 1);
		for (int i = 1; i < list->n; i++)
			add_other(words, interval_parameter_name(p), &list->at[i]);
	}
	row->cell[RESULT_OPEN_ENDS] = words->open;
	row->cell[RESULT_OTHER_INTERVALS] = words->others;
}

/* The numbers of a row that describe a model, name=value;..., into text, and what is in its params but for a table's values. */
static void write_model(char text[PARAMS_SIZE], const struct row *row, bool tabulated)
{
	size_t used = 0;
	for (enum result_column c = 0; c < RESULT_COLUMNS; c++) {
		const bool of_model = c == RESULT_ERROR || (c >= RESULT_KD_R && c <= RESULT_IOR) ||
				      (c >= RESULT_SIGMA_X && c <= RESULT_ANGLE) ||
				      (c >= RESULT_KG_R && c <= RESULT_GAMMA2);
		if (of_model && row->cell[c] && *row->cell[c])
			used += (size_t)snprintf(text + used, PARAMS_SIZE - used, "%s%s=%s", used ? ";" : "",
						 result_columns[c].name, row->cell[c]);
	}
	const char *params = row->cell[RESULT_PARAMS];
	if (params && *params && !tabulated)
		snprintf(text + used, PARAMS_SIZE - used, ";%s", params);
}

/* The fit with the other bins: a row of its own, of which only the model is kept. */
static enum status set_other_bins(struct row *row, const struct result_source *source,
				  const struct fit_options *options, const struct fit_result *other,
				  char text[PARAMS_SIZE])
{
	char params[PARAMS_SIZE] = "";
	struct row *scratch = row_new(source, options, other->model.ndf.class, "");
	if (!scratch)
		return STATUS_NO_MEMORY;
	set_number(scratch, RESULT_ERROR, other->error);
	set_model(scratch, options, other, params);
	write_model(text, scratch, ndf_is_tabulated(other->model.ndf.class));
	row->cell[RESULT_OTHER_BINS] = text;
	free(scratch);
	return STATUS_OK;
}

enum status result_add(struct csv_table *table, const struct result_source *source, const struct fit_options *options,
		       const struct fit_result *result)
{
	char params[PARAMS_SIZE] = "", bounds[NAMES_SIZE], text[STATUS_SIZE];
	char other_bins[PARAMS_SIZE] = "";
	struct interval_words words;
	struct row *row = row_new(source, options, result->model.ndf.class, status_text(text, result));
	if (!row)
		return STATUS_NO_MEMORY;
	set_number(row, RESULT_ERROR, result->error);
	set_model(row, options, result, params);
	set_metrics(row, &result->metrics);
	set_energy_conservation(row, &result->model);
	set_number(row, RESULT_STARTS, result->starts);
	set_number(row, RESULT_STARTS_AGREEING, result->starts_agreeing);
	row->cell[RESULT_AT_BOUND] = names_text(bounds, result->at_bound);
	set_number(row, RESULT_EVALUATIONS, (double)result->evaluations);
	set_number(row, RESULT_SECONDS, result->seconds);
	set_intervals(row, result, &words);
	if (result->other_bins && set_other_bins(row, source, options, result->other_bins, other_bins) != STATUS_OK) {
		free(row);
		return STATUS_NO_MEMORY;
	}
	return row_finish(row, table, source->path);
}

enum status result_add_failure(struct csv_table *table, const struct result_source *source,
			       const struct fit_options *options, const char *reason)
{
	struct error text;
	snprintf(text.text, sizeof text.text, "failed: %s", reason);
	for (int i = 0; i < options->n_ndf; i++) {
		struct row *row = row_new(source, options, options->ndf[i], text.text);
		if (!row || row_finish(row, table, source->path) != STATUS_OK)
			return STATUS_NO_MEMORY;
	}
	return STATUS_OK;
}

bool result_failed(char *const *row)
{
	return !strncmp(row[RESULT_STATUS], "failed", strlen("failed"));
}

enum result_column result_difference(char *const *a, char *const *b)
{
	enum result_column c = 0;
	while (c < RESULT_COLUMNS && (c == RESULT_SECONDS || !strcmp(a[c], b[c])))
		c++;
	return c;
}

/* Where the words of --within's choice begin, or the end. */
static size_t asked_length(const char *options)
{
	const char *chosen = strstr(options, RESULT_CHOSEN);
	return chosen ? (size_t)(chosen - options) : strlen(options);
}

bool result_same_options(const char *a, const char *b)
{
	const size_t length = asked_length(a);
	return length == asked_length(b) && !memcmp(a, b, length);
}

/* The first occurrence of "weight=NAME" in the options of a row, NAME being that of its column; NULL: there is none. */
static const char *weight_word(char *const *row)
{
	static const char name[] = "weight=";
	const char *word = strstr(row[RESULT_OPTIONS], name);
	const size_t length = strlen(row[RESULT_WEIGHT]);
	const char *value = word ? word + strlen(name) : "";
	const bool same = word && strcspn(value, " ") == length && !strncmp(value, row[RESULT_WEIGHT], length);
	return same ? word : NULL;
}

bool result_same_but_weight(char *const *a, char *const *b)
{
	const char *word_a = weight_word(a), *word_b = weight_word(b);
	const char *options_a = a[RESULT_OPTIONS], *options_b = b[RESULT_OPTIONS];
	if (!strcmp(a[RESULT_WEIGHT], b[RESULT_WEIGHT]) || !word_a || !word_b)
		return result_same_options(options_a, options_b);
	const size_t before = (size_t)(word_a - options_a);
	return before == (size_t)(word_b - options_b) && !memcmp(options_a, options_b, before) &&
	       result_same_options(word_a + strcspn(word_a, " "), word_b + strcspn(word_b, " "));
}

bool result_looks_wrong(char *const *row)
{
	return strcmp(row[RESULT_WEIGHT], weight_name(WEIGHT_SOLID_ANGLE)) != 0 && !result_failed(row) &&
	       result_number(row, RESULT_ERROR_SOLID_ANGLE) > RESULT_LOOKS_WRONG;
}

bool result_one_row_a_file(char *const *row)
{
	return strstr(row[RESULT_OPTIONS], "within=");
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

/* kd or ks of a channel; the other channels of a term that is there have theirs. */
static bool is_factor(char *const *row, enum result_column column, enum result_column first)
{
	const double x = number_or(row, column, 0);
	return x >= 0 && x <= FIT_FACTOR_MAX && !*row[column] == !*row[first];
}

/* A cell that a lobe cannot do without. */
static bool is_missing(char *const *row, enum result_column column)
{
	return *row[RESULT_KS_R] && !*row[column];
}

bool result_param(const char *params, const char *name, double *value)
{
	const size_t length = strlen(name);
	for (const char *at = params; at; at = strchr(at, ';')) {
		at += *at == ';';
		if (!strncmp(at, name, length) && at[length] == '=') {
			char text[CSV_NUMBER_SIZE];
			const char *number = at + length + 1;
			const size_t digits = strcspn(number, ";");
			if (digits >= sizeof text)
				return false;
			snprintf(text, sizeof text, "%.*s", (int)digits, number);
			return csv_parse_number(text, value);
		}
	}
	return false;
}

/* pl, from the node values in params. */
static enum status result_nodes(char *const *row, enum bins bins, struct ndf *ndf, struct pwl **pwl)
{
	double D[FREE_FORM_VALUES];
	for (int i = 0; i < FREE_FORM_VALUES; i++) {
		char name[16];
		snprintf(name, sizeof name, "D%d", i);
		if (!result_param(row[RESULT_PARAMS], name, &D[i]))
			return STATUS_DOMAIN;
	}
	struct pwl *made = calloc(1, sizeof *made);
	enum status status = made ? free_form_pwl(bins, D, made) : STATUS_NO_MEMORY;
	if (status != STATUS_OK) {
		free(made);
		return status;
	}
	ndf_from_pwl(ndf, made);
	*pwl = made;
	return STATUS_OK;
}

void result_model_free(struct cook_torrance *model, struct pwl *pwl)
{
	model->ndf.pwl = NULL;
	if (pwl)
		pwl_free(pwl);
	free(pwl);
}

/* Makes the distribution of a row anisotropic. Those that can be have no parameters but sigma and gamma, or an x of 2. */
static enum status result_axes(char *const *row, struct ndf *ndf, enum result_column *wrong)
{
	const double sigma_x = result_number(row, RESULT_SIGMA_X), sigma_y = result_number(row, RESULT_SIGMA_Y);
	*wrong = RESULT_SIGMA_X;
	if (!(sigma_x > 0))
		return STATUS_DOMAIN;
	*wrong = RESULT_SIGMA_Y;
	if (!(sigma_y > 0) || ndf_init(ndf, ndf->class, sigma_x, sigma_y, ndf->gamma) != STATUS_OK)
		return STATUS_DOMAIN;
	*wrong = RESULT_ANGLE;
	return sigma_x == sigma_y ? STATUS_OK : ndf_turn(ndf, result_number(row, RESULT_ANGLE));
}

/* The distribution of a row, from its columns and params; names the column to blame. */
static enum status result_ndf(char *const *row, const struct ndf_class *class, struct ndf *ndf,
			      enum result_column *wrong)
{
	double value[NDF_PARAMS_MAX];
	enum lambda_form form;
	*wrong = RESULT_SIGMA;
	for (int i = 0; ndf_param_at(class, i); i++) {
		const struct ndf_param *param = ndf_param_at(class, i);
		if (param->role == NDF_ROLE_SIGMA) {
			value[i] = number_or(row, RESULT_SIGMA, 1);
			if (is_missing(row, RESULT_SIGMA) || !(value[i] >= NDF_SIGMA_MIN && value[i] <= NDF_SIGMA_MAX))
				return STATUS_DOMAIN;
		} else if (param->role == NDF_ROLE_GAMMA) {
			*wrong = RESULT_GAMMA;
			value[i] = number_or(row, RESULT_GAMMA, 2.5);
			if (is_missing(row, RESULT_GAMMA))
				return STATUS_DOMAIN;
		} else {
			*wrong = RESULT_PARAMS;
			/* Without a specular term there are none. */
			if (!result_param(row[RESULT_PARAMS], param->name, &value[i])) {
				if (*row[RESULT_KS_R])
					return STATUS_DOMAIN;
				value[i] = 1;
			}
		}
	}
	if (ndf_init_params(ndf, class, value) != STATUS_OK)
		return STATUS_DOMAIN;
	if (*row[RESULT_SIGMA_X] && result_axes(row, ndf, wrong) != STATUS_OK)
		return STATUS_DOMAIN;
	double tilt_x, tilt_y;
	*wrong = RESULT_PARAMS;
	if (ndf_has_tilt(class) && result_param(row[RESULT_PARAMS], "tilt_x", &tilt_x) &&
	    !(result_param(row[RESULT_PARAMS], "tilt_y", &tilt_y) && ndf_tilt(ndf, tilt_x, tilt_y) == STATUS_OK))
		return STATUS_DOMAIN;
	*wrong = RESULT_LAMBDA;
	if (lambda_form_find(row[RESULT_LAMBDA], &form) != STATUS_OK)
		return STATUS_DOMAIN;
	return form == LAMBDA_EXACT ? STATUS_OK : ndf_set_lambda_form(ndf, form);
}

/* The terms beyond two of a row, RESULT_COLUMNS where they are whole, else the column to blame. */
static enum result_column result_terms(char *const *row, struct cook_torrance *model, struct fit_options *options)
{
	const bool f82 = model->fresnel == FRESNEL_F82 && *row[RESULT_KS_R];
	options->grazing = *row[RESULT_EXPONENT];
	options->lobes = *row[RESULT_KS2_R] ? 2 : 1;
	model->grazing = number_or(row, RESULT_EXPONENT, 0);
	if (options->grazing && !(model->grazing >= FIT_GRAZING_MIN && model->grazing <= FIT_GRAZING_MAX))
		return RESULT_EXPONENT;
	for (enum result_column c = 0; c < 3; c++) {
		if (!is_factor(row, RESULT_KG_R + c, RESULT_EXPONENT))
			return RESULT_KG_R + c;
		if (!is_factor(row, RESULT_KS2_R + c, RESULT_KS2_R))
			return RESULT_KS2_R + c;
		model->kg[c] = number_or(row, RESULT_KG_R + c, 0);
		model->ks_second[c] = number_or(row, RESULT_KS2_R + c, 0);
		for (int i = 0; i < F82_PARTS; i++) {
			const enum result_column at = RESULT_F0_R + (enum result_column)(3 * i) + c;
			model->reflectance[c][i] = number_or(row, at, 0);
			if (!*row[at] != !f82 || !(model->reflectance[c][i] >= 0 && model->reflectance[c][i] <= 1))
				return at;
		}
	}
	return RESULT_COLUMNS;
}

/* The second lobe of a row, of the same kind as the first. */
static enum result_column result_second(char *const *row, struct cook_torrance *model)
{
	struct shape shape = {.sigma = result_number(row, RESULT_SIGMA2),
			      .gamma = number_or(row, RESULT_GAMMA2, model->ndf.gamma)};
	if (!cook_torrance_has_second(model))
		return RESULT_COLUMNS;
	if (!(shape.sigma >= NDF_SIGMA_MIN && shape.sigma <= NDF_SIGMA_MAX))
		return RESULT_SIGMA2;
	return shape_ndf(&shape, model->ndf.class, LAMBDA_EXACT, &model->second) == STATUS_OK ? RESULT_COLUMNS
											      : RESULT_GAMMA2;
}

/* The index of a row: one, or one for each channel. Returns RESULT_COLUMNS where it is whole, else the column to blame. */
static enum result_column result_index(char *const *row, struct cook_torrance *model, struct fit_options *options)
{
	const bool conductor = options->fresnel == FRESNEL_CONDUCTOR && *row[RESULT_KS_R];
	model->per_channel_ior = options->per_channel_ior = conductor && *row[RESULT_IOR_R];
	for (enum result_column c = 0; c < 3 && model->per_channel_ior; c++) {
		model->channel_n[c] = number_or(row, RESULT_IOR_R + c, 0);
		model->channel_k[c] = number_or(row, RESULT_K_R + c, -1);
		if (!(model->channel_n[c] > 0 && !isinf(model->channel_n[c])))
			return RESULT_IOR_R + c;
		if (!(model->channel_k[c] >= 0 && !isinf(model->channel_k[c])))
			return RESULT_K_R + c;
	}
	if (model->per_channel_ior)
		return RESULT_COLUMNS;
	if (!(model->n > 0 && !isinf(model->n)) || (fresnel_has_ior(options->fresnel) && is_missing(row, RESULT_IOR)))
		return RESULT_IOR;
	if (conductor && !(result_param(row[RESULT_PARAMS], "k", &model->k) && model->k >= 0))
		return RESULT_PARAMS;
	return RESULT_COLUMNS;
}

enum status result_model(char *const *row, struct cook_torrance *model, struct fit_options *options, struct pwl **pwl,
			 struct error *error)
{
	*pwl = NULL;
	*model = (struct cook_torrance){.n = number_or(row, RESULT_IOR, 1.5)};
	const struct ndf_class *ndf = ndf_find(row[RESULT_NDF]);
	if (result_failed(row))
		return bad_cell(row, RESULT_STATUS, error);
	if (!ndf)
		return bad_cell(row, RESULT_NDF, error);
	if (gaf_find(row[RESULT_GAF], &options->criterion.gaf) != STATUS_OK)
		return bad_cell(row, RESULT_GAF, error);
	if (fresnel_find(row[RESULT_FRESNEL], &options->fresnel) != STATUS_OK)
		return bad_cell(row, RESULT_FRESNEL, error);
	if (weight_find(row[RESULT_WEIGHT], &options->criterion.weight) != STATUS_OK)
		return bad_cell(row, RESULT_WEIGHT, error);
	if (bins_find(row[RESULT_BINS], &options->criterion.bins) != STATUS_OK)
		return bad_cell(row, RESULT_BINS, error);
	options->criterion.max_theta = number_or(row, RESULT_MAX_THETA, 90);
	if (!(options->criterion.max_theta > 0 && options->criterion.max_theta <= 90))
		return bad_cell(row, RESULT_MAX_THETA, error);
	options->criterion.zero_is_missing = strstr(row[RESULT_OPTIONS], "zero-is-missing=yes");
	for (enum result_column c = 0; c < 3; c++) {
		if (!is_factor(row, RESULT_KD_R + c, RESULT_KD_R))
			return bad_cell(row, RESULT_KD_R + c, error);
		if (!is_factor(row, RESULT_KS_R + c, RESULT_KS_R))
			return bad_cell(row, RESULT_KS_R + c, error);
		model->kd[c] = number_or(row, RESULT_KD_R + c, 0);
		model->ks[c] = number_or(row, RESULT_KS_R + c, 0);
	}
	enum result_column wrong = result_index(row, model, options);
	if (wrong != RESULT_COLUMNS)
		return bad_cell(row, wrong, error);
	model->gaf = options->criterion.gaf;
	model->fresnel = options->fresnel;
	wrong = result_terms(row, model, options);
	if (wrong != RESULT_COLUMNS)
		return bad_cell(row, wrong, error);
	if (ndf_is_tabulated(ndf))
		return result_nodes(row, options->criterion.bins, &model->ndf, pwl) != STATUS_OK
			       ? bad_cell(row, RESULT_PARAMS, error)
			       : STATUS_OK;
	if (result_ndf(row, ndf, &model->ndf, &wrong) != STATUS_OK)
		return bad_cell(row, wrong, error);
	wrong = result_second(row, model);
	return wrong == RESULT_COLUMNS ? STATUS_OK : bad_cell(row, wrong, error);
}

int result_order(const void *a, const void *b)
{
	static const enum result_column key[] = {RESULT_MATERIAL, RESULT_NDF, RESULT_PATH, RESULT_WEIGHT};
	char *const *const row_a = *(char **const *)a, *const *const row_b = *(char **const *)b;
	for (size_t k = 0; k < sizeof key / sizeof *key; k++) {
		const int order = strcmp(row_a[key[k]], row_b[key[k]]);
		if (order)
			return order;
	}
	return 0;
}
