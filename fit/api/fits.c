/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/api/api.h"
#include "fit/search/algorithms.h"
#include "fit/search/options_check.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert((int)STDFIT_PARAMETER_SIGMA == BOUND_SIGMA && (int)STDFIT_PARAMETER_GAMMA == BOUND_GAMMA &&
		       (int)STDFIT_PARAMETER_N == BOUND_IOR && (int)STDFIT_PARAMETER_KD == BOUND_KD_R &&
		       (int)STDFIT_PARAMETER_KS == BOUND_KS_R && (int)STDFIT_PARAMETER_K == BOUND_K &&
		       (int)STDFIT_PARAMETER_EXPONENT == BOUND_GRAZING &&
		       (int)STDFIT_PARAMETER_SIGMA2 == BOUND_SECOND_SIGMA &&
		       (int)STDFIT_PARAMETER_GAMMA2 == BOUND_SECOND_GAMMA,
	       "the public bits are the internal ones");

struct stdfit_context {
	struct fit_context *inner;
};

struct stdfit_options stdfit_options_default(void)
{
	const struct fit_options o = fit_options_default();

	return (struct stdfit_options){.ndfs = "std,ggx,beckmann",
				       .max_theta = o.criterion.max_theta,
				       .sigma = NAN,
				       .gamma = NAN,
				       .n = NAN,
				       .exponent = NAN,
				       .lobes = o.lobes,
				       .time_s = o.time_s,
				       .diffuse = 1,
				       .specular = 1,
				       .threads = o.threads};
}

const char *stdfit_parameter_name(unsigned bit)
{
	static const char *const name[] = {"sigma", "gamma", "n", "kd_r",  "kd_g",     "kd_b",   "ks_r",
					   "ks_g",  "ks_b",  "k", "angle", "exponent", "sigma2", "gamma2"};

	for (unsigned i = 0; i < sizeof name / sizeof *name; i++)
		if (bit == 1u << i)
			return name[i];
	return NULL;
}

/* The NDFs of a list of names. */
static enum stdfit_status read_ndfs(const char *names, struct fit_options *inner, struct stdfit_error *error)
{
	inner->n_ndf = 0;
	for (const char *at = names; at;) {
		const size_t length = strcspn(at, ",");
		char name[32] = "";

		if (length < sizeof name)
			memcpy(name, at, length);
		if (inner->n_ndf == FIT_NDFS_MAX)
			return api_fail(error, STATUS_DOMAIN, "ndfs: expected at most %d", FIT_NDFS_MAX);
		inner->ndf[inner->n_ndf] = ndf_find(name);
		if (!inner->ndf[inner->n_ndf++])
			return api_unknown(error, "ndfs", length < sizeof name ? name : at);
		at = at[length] ? at + length + 1 : NULL;
	}
	return STDFIT_OK;
}

static enum stdfit_status read_names(const struct stdfit_options *options, struct fit_options *inner,
				     struct stdfit_error *error)
{
	enum stdfit_status status = options->ndfs ? read_ndfs(options->ndfs, inner, error) : STDFIT_OK;

	if (status == STDFIT_OK)
		status = api_gaf(options->gaf, &inner->criterion.gaf, error);
	if (status == STDFIT_OK)
		status = api_model_fresnel(options->fresnel, &inner->fresnel, error);
	if (status == STDFIT_OK)
		status = api_bins(options->bins, &inner->criterion.bins, error);
	if (status != STDFIT_OK)
		return status;
	if (options->lambda && lambda_form_find(options->lambda, &inner->lambda) != STATUS_OK)
		return api_unknown(error, "lambda", options->lambda);
	if (options->weight && weight_find(options->weight, &inner->criterion.weight) != STATUS_OK)
		return api_unknown(error, "weight", options->weight);
	if (options->algorithm && algorithm_find(options->algorithm, &inner->algorithm) != STATUS_OK)
		return api_unknown(error, "algorithm", options->algorithm);
	return STDFIT_OK;
}

/* Passes the steps of a search on. */
static void pass_on(void *data, const struct fit_trace *point)
{
	const struct stdfit_options *options = data;
	const struct stdfit_step step = {.ndf = ndf_name(point->ndf),
					 .stage = point->stage,
					 .sigma = point->sigma,
					 .gamma = point->gamma,
					 .n = point->ior,
					 .k = point->k,
					 .error = point->error,
					 .evaluations = point->evaluations,
					 .seconds = point->seconds};

	options->trace(options->trace_data, &step);
}

/* The options as the fit knows them, checked; *options has to outlive *inner. */
static enum stdfit_status read_options(const struct stdfit_options *options, struct fit_options *inner,
				       struct stdfit_error *error)
{
	struct error why = {""};

	if (!options)
		return api_fail(error, STATUS_DOMAIN, "options is NULL");
	*inner = fit_options_default();
	const enum stdfit_status status = read_names(options, inner, error);

	if (status != STDFIT_OK)
		return status;
	inner->criterion.max_theta = options->max_theta;
	inner->criterion.zero_is_missing = options->zero_is_missing;
	inner->sigma = options->sigma;
	inner->gamma = options->gamma;
	inner->ior = options->n;
	inner->time_s = options->time_s;
	inner->blend = options->blend;
	inner->unbounded = options->unbounded;
	inner->diffuse = options->diffuse;
	inner->specular = options->specular;
	inner->gray = options->gray;
	inner->anisotropic = options->anisotropic;
	inner->grazing = options->burley;
	inner->grazing_exponent = options->exponent;
	inner->lobes = options->lobes;
	inner->starts = options->starts;
	inner->threads = options->threads;
	inner->seed = options->seed;
	inner->stop = options->cancel;
	if (options->trace) {
		inner->trace = pass_on;
		inner->trace_data = (void *)options;
	}
	return api_end(error, fit_options_check(inner, &why), &why);
}

enum stdfit_status stdfit_context_new(stdfit_context **context, int n_phi_d, const struct stdfit_options *options,
				      struct stdfit_error *error)
{
	struct fit_options inner;
	enum stdfit_status status;

	if (!context)
		return api_fail(error, STATUS_DOMAIN, "context is NULL");
	*context = NULL;
	status = read_options(options, &inner, error);
	if (status == STDFIT_OK && n_phi_d != 0 && n_phi_d != 180 && n_phi_d != 360)
		status = api_fail(error, STATUS_DOMAIN,
				  "expected n_phi_d 180 or 360, or 0 for scattered entries, found %d", n_phi_d);
	if (status != STDFIT_OK)
		return status;
	stdfit_context *made = calloc(1, sizeof *made);

	status = api_end(error, made ? fit_context_new(&made->inner, n_phi_d, &inner) : STATUS_NO_MEMORY, NULL);
	if (status == STDFIT_OK)
		*context = made;
	else
		free(made);
	return status;
}

void stdfit_context_free(stdfit_context *context)
{
	if (context)
		fit_context_free(context->inner);
	free(context);
}

static struct stdfit_metrics public_metrics(const struct fit_metrics *m)
{
	return (struct stdfit_metrics){.error = {m->error[0], m->error[1], m->error[2]},
				       .rms_cosine = m->rms_cosine,
				       .rms_cube_root = m->rms_cube_root,
				       .log_error = m->log_error,
				       .entries = m->samples};
}

/* What richer models have; 0 where the model has none of it. */
static void public_terms(const struct cook_torrance *from, struct stdfit_model *to)
{
	for (int c = 0; c < 3 && from->fresnel == FRESNEL_F82; c++) {
		to->f0[c] = from->reflectance[c][0];
		to->f82[c] = from->reflectance[c][1];
		to->f90[c] = from->reflectance[c][2];
	}
	if (cook_torrance_has_grazing(from)) {
		memcpy(to->kg, from->kg, sizeof from->kg);
		to->exponent = from->grazing;
	}
	if (cook_torrance_has_second(from)) {
		memcpy(to->ks2, from->ks_second, sizeof from->ks_second);
		to->sigma2 = from->second.sigma_x;
		to->gamma2 = from->second.gamma;
	}
}

/* The public form of a result, whose table moves there. STATUS_NO_MEMORY. */
static enum status hand_over(struct fit_result *from, struct stdfit_result *to)
{
	const struct cook_torrance *m = &from->model;
	const struct ndf_class *class = m->ndf.class;

	*to = (struct stdfit_result){.ndf = ndf_name(class),
				     .model = {.gaf = gaf_name(m->gaf), .fresnel = fresnel_name(m->fresnel)},
				     .sigma = ndf_is_tabulated(class) ? NAN : sqrt(m->ndf.sigma_x * m->ndf.sigma_y),
				     .sigma_x = ndf_is_tabulated(class) ? NAN : m->ndf.sigma_x,
				     .sigma_y = ndf_is_tabulated(class) ? NAN : m->ndf.sigma_y,
				     .angle = m->ndf.angle,
				     .error_isotropic = from->error_isotropic,
				     .gamma = ndf_has_gamma(class) ? m->ndf.gamma : NAN,
				     .error = from->error,
				     .lower_bound = from->lower_bound,
				     .metrics = public_metrics(&from->metrics),
				     .converged = from->end == FIT_CONVERGED,
				     .starts = from->starts,
				     .starts_agreeing = from->starts_agreeing,
				     .at_bound = from->at_bound,
				     .undetermined = from->undetermined,
				     .evaluations = from->evaluations,
				     .passes = from->passes,
				     .seconds = from->seconds};
	to->model.n = m->n;
	to->model.k = m->k;
	memcpy(to->model.kd, m->kd, sizeof m->kd);
	memcpy(to->model.ks, m->ks, sizeof m->ks);
	public_terms(m, &to->model);
	to->distribution = calloc(1, sizeof *to->distribution);
	if (!to->distribution)
		return STATUS_NO_MEMORY;
	to->distribution->ndf = m->ndf;
	if (from->pwl) {
		to->distribution->pwl = *from->pwl;
		ndf_from_pwl(&to->distribution->ndf, &to->distribution->pwl);
		free(from->pwl);
		from->pwl = NULL;
	}
	return STATUS_OK;
}

void stdfit_result_clear(struct stdfit_result *result)
{
	if (!result)
		return;
	stdfit_ndf_free(result->distribution);
	result->distribution = NULL;
}

static enum stdfit_status check_fit(const stdfit_context *context, const stdfit_measurement *measurement,
				    const struct stdfit_options *options, struct fit_options *inner,
				    struct stdfit_error *error)
{
	if (!context || !measurement)
		return api_fail(error, STATUS_DOMAIN, "%s is NULL", context ? "measurement" : "context");
	return read_options(options, inner, error);
}

enum stdfit_status stdfit_fit(const stdfit_context *context, const stdfit_measurement *measurement,
			      const struct stdfit_options *options, int n_results, struct stdfit_result *results,
			      struct stdfit_error *error)
{
	struct fit_options inner;
	struct fit_result found[FIT_NDFS_MAX];
	struct error why = {""};
	enum stdfit_status public = check_fit(context, measurement, options, &inner, error);

	if (public != STDFIT_OK)
		return public;
	if (!results || n_results != inner.n_ndf)
		return api_fail(error, STATUS_DOMAIN, "expected room for %d results, found %d", inner.n_ndf,
				results ? n_results : 0);
	enum status status = fit_run(context->inner, &measurement->grid, &inner, found, &why);

	if (status != STATUS_OK)
		return api_end(error, status, &why);
	for (int n = 0; n < n_results; n++) {
		const enum status mine = hand_over(&found[n], &results[n]);

		status = mine != STATUS_OK ? mine : status;
		fit_result_free(&found[n]);
	}
	for (int n = 0; n < n_results && status != STATUS_OK; n++)
		stdfit_result_clear(&results[n]);
	return api_end(error, status, NULL);
}

enum stdfit_status stdfit_estimate(const stdfit_context *context, const stdfit_measurement *measurement,
				   const struct stdfit_options *options, double *estimate, struct stdfit_error *error)
{
	struct fit_options inner;
	struct error why = {""};
	const enum stdfit_status status = check_fit(context, measurement, options, &inner, error);
	double value;

	if (status != STDFIT_OK)
		return status;
	if (!estimate)
		return api_fail(error, STATUS_DOMAIN, "estimate is NULL");
	const enum status end = fit_estimate(context->inner, &measurement->grid, &inner, &value, &why);

	if (end == STATUS_OK)
		*estimate = value;
	return api_end(error, end, &why);
}

enum stdfit_status stdfit_compare(const stdfit_measurement *measurement, const struct stdfit_model *model,
				  const stdfit_ndf *ndf, const struct stdfit_options *options,
				  struct stdfit_metrics *metrics, struct stdfit_error *error)
{
	struct fit_options inner;
	struct cook_torrance inner_model;
	struct fit_metrics m;
	struct error why = {""};
	enum stdfit_status status = api_model(model, ndf, &inner_model, error);

	if (status == STDFIT_OK)
		status = read_options(options, &inner, error);
	if (status == STDFIT_OK && (!measurement || !metrics))
		status = api_fail(error, STATUS_DOMAIN, "measurement or metrics is NULL");
	if (status != STDFIT_OK)
		return status;
	const enum status end = fit_eval(&measurement->grid, &inner_model, &inner, &m, &why);

	if (end == STATUS_OK)
		*metrics = public_metrics(&m);
	return api_end(error, end, &why);
}
