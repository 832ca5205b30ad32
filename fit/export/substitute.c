/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/export/substitute.h"
#include "data_readers/text_quote.h"
#include "fit/error/model_samples.h"
#include "fit/error/model_table.h"
#include "fit/export/export_format.h"
#include "fit/export/shown_error.h"

#include <stdarg.h>
#include <string.h>

static bool is_gray(const double x[3])
{
	return x[0] == x[1] && x[1] == x[2];
}

static void add_text(char text[EXPORT_TEXT], const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add_text(char text[EXPORT_TEXT], const char *format, ...)
{
	const size_t used = strlen(text);
	va_list list;
	va_start(list, format);
	vsnprintf(text + used, EXPORT_TEXT - used, format, list);
	va_end(list);
}

/* Of a plain distribution. */
static bool is_beckmann(const struct ndf *plain)
{
	return isinf(plain->gamma);
}

/* What of the lobe has no counterpart. */
static void describe_ndf(const struct ndf *ndf, char why[EXPORT_TEXT])
{
	add_text(why, " no NDF %s", ndf_name(ndf->class));
	if (ndf_has_gamma(ndf->class))
		add_text(why, " of gamma %.5g", ndf->gamma);
	if (ndf->lambda_form == LAMBDA_RATIONAL)
		add_text(why, " with the rational form of Lambda");
	add_text(why, ",");
}

bool substitute_needed(const struct target *target, const struct cook_torrance *model, char why[EXPORT_TEXT])
{
	char text[EXPORT_TEXT] = "";
	struct ndf plain;
	const bool grazing = cook_torrance_has_grazing(model);
	if (!(export_max(model->ks) > 0) && !grazing)
		return false;
	if (cook_torrance_has_second(model))
		add_text(text, " no second lobe,");
	if (grazing)
		add_text(text, " no diffuse term of grazing directions,");
	if (!ndf_plain(&model->ndf, &plain) || (is_beckmann(&plain) && !target->beckmann))
		describe_ndf(&model->ndf, text);
	if (model->gaf != target->gaf)
		add_text(text, " no %s G,", gaf_name(model->gaf));
	if (!(target->fresnel & 1u << model->fresnel))
		add_text(text, " no Fresnel term %s,", fresnel_name(model->fresnel));
	if (model->per_channel_ior && !target->channel_ior)
		add_text(text, " no index of its own for each channel,");
	const double sigma = fmax(model->ndf.sigma_x, model->ndf.sigma_y);
	if (target->sigma_max > 0 && sigma / model->ndf.stretch > target->sigma_max)
		add_text(text, " no roughness of %.5g,", sigma);
	const size_t length = strlen(text);
	if (why && length)
		snprintf(why, EXPORT_TEXT, "%.*s", (int)length - 1, text);
	return length > 0;
}

const struct measurement *substitute_measurement(const struct export_source *source, struct measurement *own)
{
	*own = (struct measurement){0};
	const int threads = source->fit->threads;
	if (source->measurement)
		return source->measurement;
	const enum status status = export_has_axes(source->model)
					   ? model_samples(source->model, threads, own)
					   : model_table(source->model, source->fit->criterion.bins, 180,
							 source->fit->criterion.max_theta, threads, own);
	return status != STATUS_OK ? NULL : own;
}

/* The model's own distribution if the target has it, else all that it has. */
static void choose_ndfs(const struct target *target, const struct cook_torrance *model, struct fit_options *fit)
{
	struct ndf plain;
	const bool known = ndf_plain(&model->ndf, &plain), beckmann = known && is_beckmann(&plain);
	fit->n_ndf = 0;
	if (!(target->beckmann && beckmann))
		fit->ndf[fit->n_ndf++] = ndf_find("ggx");
	if (target->beckmann && (beckmann || !known))
		fit->ndf[fit->n_ndf++] = ndf_find("beckmann");
}

/* The options of the fit: the source's data, the target's lobe, the weight that is asked for. */
static struct fit_options options_for(const struct target *target, const struct export_source *source)
{
	const struct cook_torrance *model = source->model;
	struct fit_options fit = *source->fit;
	choose_ndfs(target, model, &fit);
	fit.criterion.gaf = target->gaf;
	fit.criterion.weight = source->weight;
	fit.fresnel = (target->fresnel & 1u << model->fresnel) ? model->fresnel : target->instead;
	fit.lambda = LAMBDA_EXACT;
	fit.sigma = fit.sigma_y = fit.angle = fit.gamma = fit.ior = NAN;
	fit.anisotropic = export_has_axes(model);
	fit.diffuse = export_max(model->kd) > 0 || cook_torrance_has_grazing(model);
	fit.gray = is_gray(model->kd) && is_gray(model->ks) && !cook_torrance_has_channel_F(model);
	fit.per_channel_ior = model->per_channel_ior && target->channel_ior;
	fit.grazing = false;
	fit.lobes = 1;
	fit.specular = true;
	fit.unbounded = false;
	fit.starts = 0;
	fit.algorithm = NULL;
	fit.trace = NULL;
	return fit;
}

/* The best of the options' distributions, into *model; *value receives its error. */
static enum status fit_once(const struct fit_context *context, const struct measurement *measurement,
			    const struct fit_options *fit, struct cook_torrance *model, double *value,
			    struct error *error)
{
	struct fit_result result[FIT_NDFS_MAX];
	const enum status status = fit_run(context, measurement, fit, result, error);
	*value = INFINITY;
	for (int i = 0; i < fit->n_ndf && status == STATUS_OK; i++) {
		if (result[i].error < *value) {
			*model = result[i].model;
			*value = result[i].error;
		}
		fit_result_free(&result[i]);
	}
	return status;
}

static bool fits_blend(const struct cook_torrance *model)
{
	return export_max(model->kd) + export_max(model->ks) <= 1;
}

enum { BLEND_SCAN = 16, BLEND_STEPS = 6 };

/* About the best weight of the lobe and the best of the options' distributions, as the only one of *fit: from samples of
 * the table. */
static enum status scan_blend(const struct fit_context *context, const struct measurement *measurement,
			      struct fit_options *fit)
{
	struct fit_options tried = *fit;
	double best = INFINITY;
	enum status status = STATUS_OK;
	tried.n_ndf = 1;
	tried.blend = 0.5;
	struct fit_options chosen = tried;
	for (int n = 0; n < fit->n_ndf; n++)
		for (int i = 1; i < BLEND_SCAN && status == STATUS_OK; i++) {
			double value;
			tried.ndf[0] = fit->ndf[n];
			tried.blend = (double)i / BLEND_SCAN;
			status = fit_estimate(context, measurement, &tried, &value, NULL);
			if (status == STATUS_OK && value < best) {
				best = value;
				chosen = tried;
			}
		}
	*fit = chosen;
	return status;
}

/* With a weight w, kd up to 1 - w and ks up to w; and w by golden section, around the best of the scan. */
static enum status fit_blend(const struct fit_context *context, const struct measurement *measurement,
			     struct fit_options *fit, struct cook_torrance *model, struct error *error)
{
	static const double golden = 0.6180339887498949;
	double best = INFINITY, value[2] = {NAN, NAN};
	enum status status = scan_blend(context, measurement, fit);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	double low = fit->blend - 1.0 / BLEND_SCAN, high = fit->blend + 1.0 / BLEND_SCAN;
	for (int i = 0; i < BLEND_STEPS && status == STATUS_OK; i++) {
		const double at[2] = {high - golden * (high - low), low + golden * (high - low)};
		for (int side = 0; side < 2 && status == STATUS_OK; side++) {
			struct cook_torrance tried;
			if (!isnan(value[side]))
				continue;
			fit->blend = at[side];
			status = fit_once(context, measurement, fit, &tried, &value[side], error);
			if (status == STATUS_OK && value[side] < best) {
				best = value[side];
				*model = tried;
			}
		}
		if (value[0] < value[1]) {
			high = at[1];
			value[1] = value[0];
			value[0] = NAN;
		} else {
			low = at[0];
			value[0] = value[1];
			value[1] = NAN;
		}
	}
	return status;
}

/* Fits the substitute into export->model. *blended: as a blend, which the best fit is not. */
static enum status fit_substitute(struct export *export, const struct target *target,
				  const struct measurement *measurement, bool *blended, struct error *error)
{
	struct fit_options fit = options_for(target, &export->source);
	struct fit_context *context = NULL;
	double value;
	enum status status = fit_context_new(&context, measurement->n_phi_d, &fit);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	status = fit_once(context, measurement, &fit, &export->model, &value, error);
	const struct ndf *ndf = &export->model.ndf;
	if (status == STATUS_OK && target->sigma_max > 0 && fmax(ndf->sigma_x, ndf->sigma_y) > target->sigma_max) {
		fit.sigma = fmin(ndf->sigma_x, target->sigma_max);
		fit.sigma_y = fit.anisotropic ? fmin(ndf->sigma_y, target->sigma_max) : NAN;
		status = fit_once(context, measurement, &fit, &export->model, &value, error);
	}
	*blended = status == STATUS_OK && target->blend && !fits_blend(&export->model);
	if (*blended)
		status = fit_blend(context, measurement, &fit, &export->model, error);
	fit_context_free(context);
	return status;
}

/* What the errors are against, for people. */
static void name_data(const struct export_source *source, char name[TEXT_QUOTE_SIZE])
{
	if (source->measurement && source->path)
		text_quote(source->path, name, TEXT_QUOTE_SIZE);
	else
		snprintf(name, TEXT_QUOTE_SIZE, "%s",
			 source->measurement ? "the measurement" : "a table of the model itself");
}

static void tell_cost(struct export *export, const double before[WEIGHT_COUNT], const double after[WEIGHT_COUNT])
{
	const enum weight fitted = export->source.weight;
	const bool measured = export->source.measurement != NULL;
	char name[TEXT_QUOTE_SIZE];
	name_data(&export->source, name);
	snprintf(export->cost, sizeof export->cost,
		 "error of the model %.5g, of what stands here %.5g (weight %s, under which it was fitted, against %s)",
		 measured ? before[fitted] : 0.0, after[fitted], weight_name(fitted), name);
	for (enum weight weight = 0; weight < WEIGHT_COUNT; weight++) {
		const size_t used = strlen(export->cost);

		if (weight != fitted)
			snprintf(export->cost + used, sizeof export->cost - used, "; weight %s: %.5g, %.5g",
				 weight_name(weight), measured ? before[weight] : 0.0, after[weight]);
	}
}

enum status substitute_report(struct export *export, const struct measurement *measurement, struct error *error)
{
	const struct fit_options *fit = export->source.fit;
	struct fit_metrics before, after = {.error = {0}};
	enum status status = fit_eval(measurement, export->source.model, fit, &before, error);
	if (status == STATUS_OK && export_shows_model(export))
		status = fit_eval(measurement, &export->model, fit, &after, error);
	for (enum weight weight = 0; weight < WEIGHT_COUNT && !export_shows_model(export); weight++) {
		struct criterion criterion = fit->criterion;
		criterion.weight = weight;
		after.error[weight] = shown_error(measurement, &criterion, fit->threads, export_shown_f, export);
	}
	if (status == STATUS_OK)
		tell_cost(export, before.error, after.error);
	return status;
}

void substitute_add_why(struct export *export, const char *text)
{
	add_text(export->why, "; %s", text);
}

/* Uses the model as it is, its distribution under the name that the target has for it. */
static void use_as_it_is(struct export *export)
{
	struct ndf plain;
	export->model = *export->source.model;
	if (ndf_plain(&export->model.ndf, &plain))
		export->model.ndf = plain;
}

static enum status check_sigma(const struct export *export, const struct target *target, struct error *error)
{
	const double sigma = fmin(export->model.ndf.sigma_x, export->model.ndf.sigma_y);
	if (!(export_max(export->model.ks) > 0) || sigma >= target->sigma_min)
		return STATUS_OK;
	return error_set(error, STATUS_UNSUPPORTED, "%s takes a roughness of %.5g for a mirror", target->name, sigma);
}

enum status substitute_prepare(struct export *export, const struct target *target, struct error *error)
{
	char lacks[EXPORT_TEXT] = "";
	const struct cook_torrance *given = export->source.model;
	struct measurement own;
	use_as_it_is(export);
	export->substitute = substitute_needed(target, given, lacks);
	if (!export->substitute && target->blend && !fits_blend(given) && export_max(given->ks) > 0) {
		export->substitute = true;
		snprintf(lacks, sizeof lacks, " no kd + ks of %.5g, more than 1",
			 export_max(given->kd) + export_max(given->ks));
	}
	if (!export->substitute)
		return check_sigma(export, target, error);
	const struct measurement *measurement = substitute_measurement(&export->source, &own);
	bool blended = false;
	enum status status = measurement ? fit_substitute(export, target, measurement, &blended, error)
					 : error_set(error, STATUS_NO_MEMORY, "out of memory");
	if (status == STATUS_OK)
		status = substitute_report(export, measurement, error);
	measurement_free(&own);
	if (status == STATUS_OK)
		status = check_sigma(export, target, error);
	snprintf(export->why, sizeof export->why, "approximate: %s has%.200s; %s%s was fitted in its place%s",
		 target->name, lacks, ndf_name(export->model.ndf.class),
		 is_beckmann(&export->model.ndf) ? "" : " (gamma 2)", blended ? ", with kd + ks up to 1" : "");
	if (target->itself)
		add_text(export->why, " (format %s has the model itself)", target->itself);
	return status;
}
