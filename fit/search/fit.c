/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/fit.h"
#include "fit/error/metrics.h"
#include "fit/search/algorithms.h"
#include "fit/search/anisotropic.h"
#include "fit/search/free_form.h"
#include "fit/search/options_check.h"
#include "fit/search/second_lobe.h"
#include "fit/search/undetermined.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct fit_context {
	struct geometry geometry;
};

enum status fit_context_new(struct fit_context **context, int n_phi_d, const struct fit_options *options)
{
	const bool known = n_phi_d == 0 || n_phi_d == 180 || n_phi_d == 360;
	enum status status = known ? fit_criterion_check(options, NULL) : STATUS_DOMAIN;
	struct fit_context *c = status == STATUS_OK ? calloc(1, sizeof *c) : NULL;

	if (status == STATUS_OK)
		status = c ? geometry_init(&c->geometry, n_phi_d, options) : STATUS_NO_MEMORY;
	if (status != STATUS_OK) {
		free(c);
		c = NULL;
	}
	*context = c;
	return status;
}

void fit_context_free(struct fit_context *context)
{
	if (context)
		geometry_free(&context->geometry);
	free(context);
}

static const char isotropic_table[] =
	"a table over theta_h, theta_d and phi_d is isotropic: an anisotropic model needs scattered entries";

/* Whether the options keep the rules, and the context is one for them and this measurement. */
static enum status check_arguments(const struct fit_context *context, const struct measurement *measurement,
				   const struct fit_options *options, struct error *error)
{
	const struct criterion *made_for = &context->geometry.criterion, *asked = &options->criterion;
	const enum status status = fit_options_check(options, error);

	if (status != STATUS_OK)
		return status;
	if (measurement->n_phi_d != context->geometry.n_phi_d)
		return error_set(error, STATUS_DOMAIN, "the context is for measurements of %d phi_d: this one has %d",
				 context->geometry.n_phi_d, measurement->n_phi_d);
	if (options->anisotropic && measurement->scattered && measurement->scattered->symmetry == SYMMETRY_ISOTROPIC)
		return error_set(error, STATUS_UNSUPPORTED,
				 "an anisotropic model needs wi at several azimuths: this measurement is isotropic");
	if (options->anisotropic && !measurement->scattered)
		return error_set(error, STATUS_DOMAIN, "%s", isotropic_table);
	if (!criterion_equal(made_for, asked))
		return error_set(error, STATUS_DOMAIN,
				 "the context is for gaf %s, weight %s, bins %s, max_theta %g, zero_is_missing %d: the "
				 "options say %s, %s, %s, %g, %d",
				 gaf_name(made_for->gaf), weight_name(made_for->weight), bins_name(made_for->bins),
				 made_for->max_theta, made_for->zero_is_missing, gaf_name(asked->gaf),
				 weight_name(asked->weight), bins_name(asked->bins), asked->max_theta,
				 asked->zero_is_missing);
	return STATUS_OK;
}

/* One material under one set of options. */
struct run {
	const struct fit_context *context;
	const struct measurement *measurement;
	const struct fit_options *options;
	struct multiresolution multiresolution;
	struct nested *isotropic;   /* of anisotropic options: the isotropic fits */
	struct scan_minima *minima; /* of the last search of each class, by its index in the table of distributions */
};

static int index_of(const struct ndf_class *class)
{
	int index = 0;

	while (ndf_at(index) != class)
		index++;
	return index;
}

static bool on_bound(double value, double low, double high)
{
	return value <= low * (1 + 1e-4) || value >= high * (1 - 1e-4);
}

static bool index_on_bound(const struct fit_options *o, double n)
{
	return o->fresnel == FRESNEL_CONDUCTOR ? on_bound(n, FIT_CONDUCTOR_IOR_MIN, FIT_IOR_MAX)
					       : on_bound(n - 1, FIT_IOR_MIN - 1, FIT_IOR_MAX - 1);
}

static unsigned index_bounds(const struct cook_torrance *m, const struct fit_options *o)
{
	unsigned bits = 0;

	for (int c = 0; c < MERL_CHANNELS && o->per_channel_ior; c++) {
		if (index_on_bound(o, m->channel_n[c]))
			bits |= (unsigned)BOUND_IOR_R << c;
		if (on_bound(m->channel_k[c], 0, FIT_K_MAX))
			bits |= (unsigned)BOUND_K_R << c;
	}
	if (o->per_channel_ior)
		return bits;
	if (fresnel_has_ior(o->fresnel) && isnan(o->ior) && index_on_bound(o, m->n))
		bits |= BOUND_IOR;
	if (o->fresnel == FRESNEL_CONDUCTOR && on_bound(m->k, 0, FIT_K_MAX))
		bits |= BOUND_K;
	return bits;
}

static unsigned bounds_of(const struct fit_result *r, const struct fit_options *o)
{
	const struct cook_torrance *m = &r->model;
	unsigned bits = 0;

	if (o->specular) {
		struct space space;

		space_init(&space, o, m->ndf.class);
		const double sigma = sqrt(m->ndf.sigma_x * m->ndf.sigma_y) / space_sigma_scale(&space, m->ndf.gamma);

		if (isnan(o->sigma) && on_bound(sigma, FIT_SIGMA_MIN, FIT_SIGMA_MAX))
			bits |= BOUND_SIGMA;
		const struct ndf_param *gamma = ndf_has_gamma(m->ndf.class) ? ndf_param_at(m->ndf.class, 1) : NULL;

		if (gamma && isnan(o->gamma) &&
		    on_bound(m->ndf.gamma - gamma->min, gamma->search_min - gamma->min, gamma->search_max - gamma->min))
			bits |= BOUND_GAMMA;
		bits |= index_bounds(m, o);
	}
	for (int c = 0; c < MERL_CHANNELS; c++) {
		if (o->diffuse && (m->kd[c] <= 0 || m->kd[c] >= objective_upper_bound(o, false)))
			bits |= (unsigned)BOUND_KD_R << c;
		if (o->specular && o->fresnel != FRESNEL_F82 &&
		    (m->ks[c] <= 0 || m->ks[c] >= objective_upper_bound(o, true)))
			bits |= (unsigned)BOUND_KS_R << c;
	}
	return bits;
}

/* Turns what a search found into a result; r->model.ndf is there already. */
static enum status result_with_ndf(const struct run *run, const struct found *found, struct fit_result *r)
{
	const struct fit_options *o = run->options;
	struct cook_torrance *m = &r->model;
	enum status status;

	r->diffuse = o->diffuse;
	r->specular = o->specular;
	m->gaf = o->criterion.gaf;
	m->fresnel = o->fresnel;
	m->n = found->shape.ior;
	m->k = found->shape.k;
	m->per_channel_ior = o->per_channel_ior && o->specular;
	memcpy(m->channel_n, found->shape.channel_ior, sizeof m->channel_n);
	memcpy(m->channel_k, found->shape.channel_k, sizeof m->channel_k);
	linear_set_model(&found->linear, o, m);
	status = metrics_compute(&run->context->geometry, run->measurement, m, o->threads, &r->metrics);
	if (status != STATUS_OK)
		return status;
	r->error = r->metrics.error[o->criterion.weight];
	r->error_isotropic = r->error_correlated = NAN;
	r->lower_bound = found->linear.lower_bound;
	r->end = found->limited ? FIT_LIMIT : FIT_CONVERGED;
	r->starts = found->starts;
	r->starts_agreeing = found->starts_agreeing;
	r->at_bound = bounds_of(r, o);
	r->evaluations = found->evaluations;
	r->passes = found->passes;
	return STATUS_OK;
}

/* The sharper lobe comes first, and one lobe is the first. */
static void order_lobes(struct cook_torrance *m)
{
	const bool has_first = m->ks[0] > 0 || m->ks[1] > 0 || m->ks[2] > 0;

	if (!cook_torrance_has_second(m) || (has_first && m->ndf.sigma_x <= m->second.sigma_x))
		return;
	const struct ndf ndf = m->ndf;

	m->ndf = m->second;
	m->second = ndf;
	for (int c = 0; c < MERL_CHANNELS; c++) {
		const double ks = m->ks[c];

		m->ks[c] = m->ks_second[c];
		m->ks_second[c] = ks;
	}
}

static enum status result_of(const struct run *run, const struct ndf_class *class, const struct found *found,
			     struct fit_result *r)
{
	enum status status;

	*r = (struct fit_result){.pwl = NULL};
	r->model.grazing = found->shape.grazing;
	status = shape_ndf(&found->shape, class, run->options->lambda, &r->model.ndf);
	if (status == STATUS_OK && run->options->lobes > 1) {
		const struct shape second = shape_second(&found->shape);

		status = shape_ndf(&second, class, run->options->lambda, &r->model.second);
	}
	if (status == STATUS_OK && run->options->anisotropic && !isnan(run->options->sigma_y)) {
		/* As they were given, to the last bit. */
		r->model.ndf.sigma_x = r->model.ndf.param[0] = run->options->sigma;
		r->model.ndf.sigma_y = run->options->sigma_y;
		status = ndf_turn(&r->model.ndf, found->shape.angle);
	}
	if (status == STATUS_OK)
		status = result_with_ndf(run, found, r);
	if (status == STATUS_OK)
		order_lobes(&r->model);
	return status;
}

/* Nested distributions: at these values of gamma a class is a simpler one, of the same sigma. */
enum { NESTED = 2 };
static const char *const nested_name[NESTED] = {"ggx", "beckmann"};
static const double nested_gamma[NESTED] = {2, INFINITY};
struct nesting {
	bool any;
	double gamma[NESTED]; /* NaN: not within the class */
};

static double gamma_of_nested(const struct ndf_class *class, int n)
{
	struct ndf ndf, plain;
	const bool within = (ndf_has_gamma(class) || ndf_has_tilt(class)) &&
			    ndf_init(&ndf, class, 1, 1, nested_gamma[n]) == STATUS_OK && ndf_plain(&ndf, &plain) &&
			    plain.class == ndf_find(nested_name[n]) && plain.sigma_x == 1;

	return within ? nested_gamma[n] : NAN;
}

/* The other algorithms go without. So do the other forms of Lambda: GGX and Beckmann have theirs. */
static struct nesting nesting_of(const struct run *run, const struct ndf_class *class)
{
	const struct fit_options *o = run->options;
	const bool wanted = isnan(o->gamma) && o->specular && !o->algorithm && o->lambda == LAMBDA_EXACT;
	struct nesting nesting = {.any = false};

	for (int n = 0; n < NESTED; n++) {
		nesting.gamma[n] = wanted ? gamma_of_nested(class, n) : NAN;
		nesting.any |= !isnan(nesting.gamma[n]);
	}
	return nesting;
}

/* Fits that others build on, made when first wanted and shared by all that want them: those of the nested models, and
 * those of each class by its index in the table of distributions. */
struct nested {
	bool done[NESTED], class_done[FIT_NDFS_MAX];
	struct fit_result result[NESTED], of_class[FIT_NDFS_MAX];
};

/* What a run remembers of its searches: megabytes, too much for the stack of a thread. */
struct memory {
	struct nested nested, anisotropic;
	struct scan_minima minima[FIT_NDFS_MAX];
};

static enum status fit_alone(const struct run *run, const struct ndf_class *class, struct fit_result *r)
{
	const double begin = search_clock();
	struct found found;
	enum status status =
		run->options->algorithm
			? algorithm_run(&run->multiresolution.table[SEARCH_LEVELS - 1], run->options, class, &found)
			: search_run(&run->multiresolution, run->options, class, &run->minima[index_of(class)], &found);

	if (status == STATUS_OK)
		status = result_of(run, class, &found, r);
	r->seconds = search_clock() - begin;
	return status;
}

static enum status fit_nested(const struct run *run, struct nested *nested, int which)
{
	if (nested->done[which])
		return STATUS_OK;
	nested->done[which] = true;
	return fit_alone(run, ndf_find(nested_name[which]), &nested->result[which]);
}

/* Those within a class, at once where there are threads for it: two fits on a thread each wait less for one another
 * than two threads within one. */
static enum status fit_all_nested(const struct run *run, const struct nesting *nesting, struct nested *nested)
{
	const int outer = run->options->threads < NESTED ? run->options->threads : NESTED;
	struct fit_options options = *run->options;
	struct run own = *run;
	enum status status[NESTED] = {STATUS_OK, STATUS_OK};

	options.threads /= outer;
	own.options = &options;
#pragma omp parallel for num_threads(outer) schedule(static) if (outer > 1)
	for (int n = 0; n < NESTED; n++)
		if (!isnan(nesting->gamma[n]))
			status[n] = fit_nested(&own, nested, n);
	for (int n = 0; n < NESTED; n++)
		if (status[n] != STATUS_OK)
			return status[n];
	return STATUS_OK;
}

/* A result that replaces another keeps the effort of that one. */
static void keep_effort(struct fit_result *selected, const struct fit_result *before)
{
	selected->starts = before->starts;
	selected->starts_agreeing = before->starts_agreeing;
	selected->evaluations = before->evaluations;
	selected->passes = before->passes;
	selected->seconds = before->seconds;
}

/* Takes the nested optimum over when it is better than what the richer model found: a richer model never loses. */
static enum status take_nested(const struct run *run, struct fit_result *r, const struct ndf_class *class,
			       const struct fit_result *from, double gamma)
{
	struct fit_result selected = *from;
	const struct ndf *ndf = &from->model.ndf;
	enum status status;

	if (from->error >= r->error)
		return STATUS_OK;
	keep_effort(&selected, r);
	*r = selected;
	status = ndf_init(&r->model.ndf, class, ndf->sigma_x, ndf->sigma_y, gamma);
	if (status == STATUS_OK)
		status = ndf_turn(&r->model.ndf, ndf->angle);
	r->at_bound = bounds_of(r, run->options);
	return status;
}

/* A search of an NDF that has been searched already: its trace goes on from there. */
struct further {
	const struct fit_options *options; /* whose trace it is */
	long evaluations;
	double seconds;
};

static void note_further(void *data, const struct fit_trace *point)
{
	const struct further *further = data;
	struct fit_trace own = *point;

	own.evaluations += further->evaluations;
	own.seconds += further->seconds;
	further->options->trace(further->options->trace_data, &own);
}

static void trace_further(struct fit_options *options, struct further *further)
{
	if (!options->trace)
		return;
	options->trace = note_further;
	options->trace_data = further;
}

/* Goes down from the nested optima too. */
static enum status start_from_nested(const struct run *run, const struct ndf_class *class,
				     const struct nesting *nesting, const struct nested *nested, struct fit_result *r)
{
	const double begin = search_clock();
	struct further further = {run->options, r->evaluations, r->seconds};
	struct fit_options options = *run->options;
	struct shape given[NESTED];
	struct fit_result other;
	struct found found;
	enum status status;
	int count = 0;

	for (int n = 0; n < NESTED; n++) {
		if (isnan(nesting->gamma[n]))
			continue;
		given[count] = shape_of(&nested->result[n].model);
		given[count++].gamma = nesting->gamma[n];
	}
	const struct shape known = shape_of(&r->model);

	trace_further(&options, &further);
	status = search_from(&run->multiresolution, &options, class, given, count, &known, r->error, &found);
	if (status == STATUS_OK && found.linear.error < r->error) {
		status = result_of(run, class, &found, &other);
		if (status == STATUS_OK && other.error < r->error) {
			keep_effort(&other, r);
			*r = other;
		}
	}
	r->starts += found.starts;
	r->starts_agreeing += found.starts_agreeing;
	r->evaluations += found.evaluations;
	r->passes += found.passes;
	r->seconds += search_clock() - begin;
	return status;
}

/* The rich model first, and alone on all threads: who asks for it waits least. Then the nested ones, as starts and as
 * candidates. */
static enum status fit_with_nested(const struct run *run, const struct ndf_class *class, const struct nesting *nesting,
				   struct nested *nested, struct fit_result *r)
{
	enum status status = fit_alone(run, class, r);

	if (status == STATUS_OK)
		status = fit_all_nested(run, nesting, nested);
	if (status == STATUS_OK)
		status = start_from_nested(run, class, nesting, nested, r);
	for (int n = 0; n < NESTED && status == STATUS_OK; n++)
		if (!isnan(nesting->gamma[n]))
			status = take_nested(run, r, class, &nested->result[n], nesting->gamma[n]);
	return status;
}

/* A form of Lambda that exists at some gammas only: each of them is fitted, and the best selected. */
static enum status fit_each_gamma(const struct run *run, const struct ndf_class *class, struct fit_result *r)
{
	struct fit_options options = *run->options;
	struct run own = *run;
	enum status status = STATUS_OK;
	struct scan_minima *minima = &run->minima[index_of(class)], *best_minima = malloc(sizeof *best_minima);
	struct fit_result one = {0};
	struct ndf ndf;
	struct further sum = {.options = run->options};
	long passes = 0;
	double worst = 0;

	*r = (struct fit_result){.error = INFINITY};
	if (!best_minima)
		return STATUS_NO_MEMORY;
	own.options = &options;
	trace_further(&options, &sum);
	for (options.gamma = 1.5; options.gamma <= 16 && status == STATUS_OK; options.gamma += 0.5) {
		const struct shape shape = {.sigma = 1, .gamma = options.gamma};

		if (shape_ndf(&shape, class, options.lambda, &ndf) != STATUS_OK)
			continue;
		status = fit_alone(&own, class, &one);
		sum.evaluations += one.evaluations;
		passes += one.passes;
		sum.seconds += one.seconds;
		if (status == STATUS_OK && one.error < r->error) {
			*r = one;
			*best_minima = *minima;
		}
		worst = fmax(worst, one.error);
	}
	if (r->error < INFINITY)
		*minima = *best_minima;
	free(best_minima);
	if (worst <= undetermined_limit(r->error))
		r->undetermined = BOUND_GAMMA;
	r->evaluations = sum.evaluations;
	r->passes = passes;
	r->seconds = sum.seconds;
	return status;
}

static bool has_sparse_lambda(const struct run *run, const struct ndf_class *class)
{
	const struct fit_options *o = run->options;

	return (o->lambda == LAMBDA_INTEGER || o->lambda == LAMBDA_HALF_INTEGER) && o->specular && isnan(o->gamma) &&
	       ndf_has_lambda_forms(class);
}

static enum status fit_class(const struct run *run, const struct ndf_class *class, struct nested *nested,
			     struct fit_result *r);

/* The optima of all the parametric NDFs, of which hyper-cauchy and t-family are STD again. */
static enum status fit_starts(const struct run *run, struct nested *nested, struct cook_torrance starts[],
			      int *n_starts)
{
	static const char *const name[] = {"std", "ggx", "beckmann", "gtr", "low"};
	enum status status = STATUS_OK;
	struct fit_result r;

	for (*n_starts = 0; *n_starts < 5 && status == STATUS_OK; (*n_starts)++) {
		status = fit_class(run, ndf_find(name[*n_starts]), nested, &r);
		starts[*n_starts] = r.model;
	}
	return status;
}

/* The piecewise-linear NDF, from the parametric optima. */
static enum status fit_free_form(const struct run *run, struct nested *nested, struct fit_result *r)
{
	const double begin = search_clock();
	struct memory *fresh = NULL;
	struct fit_options exact = *run->options;
	struct run own = *run;
	struct cook_torrance starts[5];
	struct found found;
	int n_starts;
	enum status status;

	exact.lambda = LAMBDA_EXACT;
	exact.gamma = NAN; /* of the starts: pl itself has none */
	own.options = &exact;
	const bool same = run->options->lambda == LAMBDA_EXACT && isnan(run->options->gamma);

	if (!same) {
		fresh = calloc(1, sizeof *fresh);
		if (!fresh)
			return STATUS_NO_MEMORY;
		own.minima = fresh->minima;
	}
	status = fit_starts(&own, same ? nested : &fresh->nested, starts, &n_starts);
	free(fresh);
	if (status != STATUS_OK)
		return status;
	*r = (struct fit_result){.pwl = calloc(1, sizeof *r->pwl)};
	if (!r->pwl)
		return STATUS_NO_MEMORY;
	status = free_form_run(&run->multiresolution, &exact, starts, n_starts, &found, r->pwl);
	if (status == STATUS_OK) {
		ndf_from_pwl(&r->model.ndf, r->pwl);
		status = result_with_ndf(&own, &found, r);
	}
	if (status != STATUS_OK)
		fit_result_free(r);
	r->seconds = search_clock() - begin;
	return status;
}

void fit_result_free(struct fit_result *result)
{
	if (result->pwl)
		pwl_free(result->pwl);
	free(result->pwl);
	result->pwl = NULL;
}

enum { AXES_STARTS = 8 };

/* The isotropic fit, then axes: from the isotropic optimum as it is, from those of the nested distributions that are anisotropic,
 * and from a scan. */
static enum status fit_anisotropic(const struct run *run, const struct ndf_class *class, struct nested *nested,
				   struct fit_result *r)
{
	const struct nesting nesting = nesting_of(run, class);
	struct fit_options isotropic_options = *run->options, options = *run->options;
	struct fit_result isotropic, inner[NESTED];
	struct run own = *run;
	struct shape start[AXES_STARTS];
	struct found found;
	long evaluations = 0;
	int count = 1;

	isotropic_options.anisotropic = false;
	isotropic_options.angle = NAN;
	own.options = &isotropic_options;
	enum status status = fit_class(&own, class, run->isotropic, &isotropic);

	for (int n = 0; n < NESTED && status == STATUS_OK; n++) {
		if (isnan(nesting.gamma[n]))
			continue;
		status = fit_class(run, ndf_find(nested_name[n]), nested, &inner[n]);
		start[count] = shape_of(&inner[n].model);
		start[count++].gamma = nesting.gamma[n];
	}
	if (status != STATUS_OK)
		return status;
	const double begin = search_clock();

	start[0] = shape_of(&isotropic.model);
	if (has_sparse_lambda(run, class))
		options.gamma = start[0].gamma; /* the other values have been fitted */
	if (ndf_has_tilt(class))
		count += tilted_starts(&run->multiresolution, &options, class, start, count, start + count,
				       AXES_STARTS - count, &evaluations, &status);
	else
		count += anisotropic_starts(&run->multiresolution, &options, class, &start[0], start + count,
					    AXES_STARTS - count, &evaluations, &status);
	if (status == STATUS_OK)
		status = search_from(&run->multiresolution, &options, class, start, count, &start[0], INFINITY, &found);
	if (status == STATUS_OK)
		status = result_of(run, class, &found, r);
	if (status != STATUS_OK)
		return status;
	r->evaluations += isotropic.evaluations + evaluations;
	r->passes += isotropic.passes;
	r->seconds = isotropic.seconds + search_clock() - begin;
	r->undetermined = isotropic.undetermined;
	status = take_nested(run, r, class, &isotropic, isotropic.model.ndf.gamma);
	for (int n = 0; n < NESTED && status == STATUS_OK; n++)
		if (!isnan(nesting.gamma[n]))
			status = take_nested(run, r, class, &inner[n], nesting.gamma[n]);
	r->error_isotropic = isotropic.error;
	return status;
}

/* The same without what a richer model has last. Returns false where it has nothing that could be left out. */
static bool leave_out(struct fit_options *options)
{
	if (options->lobes > 1)
		options->lobes = 1;
	else if (options->grazing)
		options->grazing = false;
	else if (options->fresnel == FRESNEL_F82 && options->specular)
		options->fresnel = FRESNEL_SCHLICK;
	else if (options->per_channel_ior && options->specular)
		options->per_channel_ior = false;
	else
		return false;
	return true;
}

/* A result of a simpler model, as one of the richer kind. */
static void take_simpler(const struct run *run, struct fit_result *r, const struct fit_result *simpler)
{
	struct fit_result selected = *simpler;
	struct cook_torrance *m = &selected.model;

	if (simpler->error >= r->error)
		return;
	/* Schlick's term in the words of the three reflectances. */
	for (int c = 0; c < MERL_CHANNELS && run->options->fresnel == FRESNEL_F82 && m->fresnel == FRESNEL_SCHLICK;
	     c++) {
		m->reflectance[c][0] = m->ks[c] * fresnel_schlick(1, m->n);
		m->reflectance[c][1] = m->ks[c] * fresnel_schlick(1.0 / 7, m->n);
		m->reflectance[c][2] = m->ks[c];
		m->ks[c] = 1;
	}
	if (run->options->per_channel_ior && !m->per_channel_ior) {
		for (int c = 0; c < MERL_CHANNELS; c++) {
			m->channel_n[c] = m->n;
			m->channel_k[c] = m->k;
		}
		m->per_channel_ior = true;
		selected.at_bound = bounds_of(&selected, run->options);
	}
	m->fresnel = run->options->fresnel;
	keep_effort(&selected, r);
	*r = selected;
}

static enum status fit_class(const struct run *run, const struct ndf_class *class, struct nested *nested,
			     struct fit_result *r);

/* Where the search of a richer model may begin: at what the simpler one ended with, and, where there is a second lobe, at both of
 * the same kind that a nested distribution has, and with one lobe beside it. */
static int richer_starts(const struct run *run, const struct ndf_class *class, const struct fit_result *simpler,
			 struct nested *nested, struct shape start[], long *evaluations, enum status *status)
{
	const struct nesting nesting = nesting_of(run, class);
	int count = 1;

	start[0] = shape_of(&simpler->model);
	if (run->options->per_channel_ior)
		shape_spread_index(&start[0]);
	if (isnan(start[0].grazing) || start[0].grazing < FIT_GRAZING_MIN)
		start[0].grazing = isnan(run->options->grazing_exponent) ? 5 : run->options->grazing_exponent;
	if (run->options->lobes < 2)
		return count;
	for (int n = 0; n < NESTED && *status == STATUS_OK; n++) {
		struct fit_result inner;

		if (isnan(nesting.gamma[n]))
			continue;
		*status = fit_class(run, ndf_find(nested_name[n]), nested, &inner);
		start[count] = shape_of(&inner.model);
		start[count].gamma = start[count].second_gamma = nesting.gamma[n];
		count++;
	}
	if (*status != STATUS_OK)
		return 0;
	/* The last nested one takes the place of the shape of one lobe where it has two. */
	if (count > 1 && start[count - 1].second_sigma > 0)
		start[0] = start[--count];
	const struct shape one = shape_of(&simpler->model);

	return count + second_lobe_starts(&run->multiresolution, run->options, class, &one, start + count,
					  SEARCH_GIVEN - count, evaluations, status);
}

static enum status fit_kind(const struct run *run, const struct ndf_class *class, struct nested *nested,
			    struct fit_result *r);

/* A fit under other options, with a memory of its own. */
static enum status fit_apart(const struct run *run, const struct ndf_class *class, const struct fit_options *options,
			     struct fit_result *r)
{
	struct memory *fresh = calloc(1, sizeof *fresh);
	struct run own = *run;

	if (!fresh)
		return STATUS_NO_MEMORY;
	own.options = options;
	own.minima = fresh->minima;
	own.isotropic = &fresh->nested;
	const enum status status =
		fit_class(&own, class, options->anisotropic ? &fresh->anisotropic : &fresh->nested, r);

	free(fresh);
	return status;
}

/* Two lobes beside a grazing term hold two lobes without one, too, which the simpler model is not. */
static enum status fit_without_grazing(const struct run *run, const struct ndf_class *class, struct fit_result *r)
{
	struct fit_options options = *run->options;

	options.grazing = false;
	return fit_apart(run, class, &options, r);
}

/* Of two lobes: where one does as well, the second may have any shape; where none of the grazing term does, that any
 * exponent. */
static unsigned open_beside(const struct run *run, const struct ndf_class *class, const struct fit_result *r,
			    double one_lobe, double no_grazing)
{
	const double limit = undetermined_limit(r->error);
	unsigned bits = 0;

	if (run->options->lobes > 1 && cook_torrance_has_second(&r->model) && one_lobe <= limit)
		bits |= BOUND_SECOND_SIGMA | (ndf_has_gamma(class) ? (unsigned)BOUND_SECOND_GAMMA : 0u);
	if (isnan(run->options->grazing_exponent) && no_grazing <= limit)
		bits |= BOUND_GRAZING;
	return bits;
}

/* A richer model: the simpler one first. With one lobe there is a scan of its own as well. A richer model never loses. */
static enum status fit_richer(const struct run *run, const struct ndf_class *class,
			      const struct fit_options *simpler_options, struct nested *nested, struct fit_result *r)
{
	const bool scans = run->options->lobes < 2;
	const bool two_ways = run->options->lobes > 1 && run->options->grazing;
	struct fit_result simpler, other = {.error = 0};
	struct shape start[SEARCH_GIVEN];
	struct found found;
	long evaluations = 0;
	enum status status = fit_apart(run, class, simpler_options, &simpler);
	int count = 0;
	const double begin = search_clock();

	if (status == STATUS_OK && scans)
		status = run->options->per_channel_ior ? fit_kind(run, class, nested, r) : fit_alone(run, class, r);
	if (status == STATUS_OK)
		count = richer_starts(run, class, &simpler, nested, start, &evaluations, &status);
	if (status == STATUS_OK && two_ways)
		status = fit_without_grazing(run, class, &other);
	if (status == STATUS_OK && two_ways && cook_torrance_has_second(&other.model))
		start[count < SEARCH_GIVEN ? count++ : count - 1] = shape_of(&other.model);
	if (status == STATUS_OK) {
		const struct shape known = scans ? shape_of(&r->model) : start[0];

		status = search_from(&run->multiresolution, run->options, class, start, count, &known,
				     scans ? r->error : INFINITY, &found);
	}
	if (status != STATUS_OK)
		return status;
	if (isfinite(found.linear.error)) {
		struct fit_result from_it;

		status = result_of(run, class, &found, &from_it);
		if (status != STATUS_OK)
			return status;
		if (!scans || from_it.error < r->error)
			*r = from_it;
	}
	take_simpler(run, r, &simpler);
	r->evaluations += simpler.evaluations + evaluations;
	r->passes += simpler.passes;
	if (two_ways) {
		take_simpler(run, r, &other);
		r->evaluations += other.evaluations;
		r->passes += other.passes;
	}
	r->undetermined |= open_beside(run, class, r, simpler.error, two_ways ? other.error : INFINITY);
	r->seconds = simpler.seconds + search_clock() - begin;
	return STATUS_OK;
}

/* What tilts is GGX where nothing tells the azimuth. */
static enum status fit_level(const struct run *run, const struct ndf_class *class, struct nested *nested,
			     struct fit_result *r)
{
	const struct ndf_class *ggx = ndf_find("ggx");
	enum status status = fit_class(run, ggx, nested, r);

	if (status != STATUS_OK)
		return status;
	run->minima[index_of(class)] = run->minima[index_of(ggx)];
	const struct ndf ndf = r->model.ndf;

	return ndf_init(&r->model.ndf, class, ndf.sigma_x, ndf.sigma_y, ndf.gamma);
}

/* Among the models of one kind, as the options have it. */
static enum status fit_kind(const struct run *run, const struct ndf_class *class, struct nested *nested,
			    struct fit_result *r)
{
	const struct nesting nesting = nesting_of(run, class);

	if (ndf_is_tabulated(class))
		return fit_free_form(run, nested, r);
	if (run->options->anisotropic && isnan(run->options->sigma_y))
		return fit_anisotropic(run, class, nested, r);
	if (ndf_has_tilt(class) && !run->options->anisotropic && !run->options->algorithm)
		return fit_level(run, class, nested, r);
	if (nesting.any)
		return fit_with_nested(run, class, &nesting, nested, r);
	if (has_sparse_lambda(run, class))
		return fit_each_gamma(run, class, r);
	for (int n = 0; n < NESTED; n++)
		if (class == ndf_find(nested_name[n])) {
			const enum status status = fit_nested(run, nested, n);

			*r = nested->result[n];
			return status;
		}
	return fit_alone(run, class, r);
}

static enum status fit_anew(const struct run *run, const struct ndf_class *class, struct nested *nested,
			    struct fit_result *r)
{
	struct fit_options simpler = *run->options;

	return leave_out(&simpler) ? fit_richer(run, class, &simpler, nested, r) : fit_kind(run, class, nested, r);
}

static enum status fit_class(const struct run *run, const struct ndf_class *class, struct nested *nested,
			     struct fit_result *r)
{
	enum status status = STATUS_OK;
	const int index = index_of(class);

	if (!nested->class_done[index]) {
		status = fit_anew(run, class, nested, &nested->of_class[index]);
		/* A table belongs to one result only. */
		nested->class_done[index] = status == STATUS_OK && !ndf_is_tabulated(class);
	}
	*r = nested->of_class[index];
	return status;
}

/* BOUND_GAMMA where the fits of the nested models have shown already that gamma is determined. */
static unsigned gamma_settled(const struct run *run, const struct ndf_class *class, const struct nested *nested,
			      const struct fit_result *r)
{
	const struct nesting nesting = nesting_of(run, class);
	const double limit = undetermined_limit(r->error);

	for (int n = 0; n < NESTED; n++)
		if (!isnan(nesting.gamma[n]) && nested->result[n].error > limit)
			return BOUND_GAMMA;
	return 0;
}

/* Adds to a fit which of its parameters the data leave open. */
static enum status find_undetermined(const struct run *run, const struct ndf_class *class, const struct nested *nested,
				     struct fit_result *r)
{
	const double begin = search_clock();
	const struct cook_torrance *m = &r->model;
	const unsigned settled = run->options->anisotropic ? 0 : gamma_settled(run, class, nested, r);
	const struct shape best = shape_of(m);
	struct fit_options options = *run->options;
	enum status status = STATUS_OK;
	unsigned found = 0;

	if (has_sparse_lambda(run, class))
		options.gamma = m->ndf.gamma; /* the other values have been fitted */
	/* Of two lobes no scan has been made, over all the shapes of both: open_beside() tells what is known. */
	if (!options.algorithm && options.lobes < 2)
		status = undetermined_find(&run->multiresolution, &options, class, &run->minima[index_of(class)], &best,
					   r->error, settled, &found, &r->evaluations);
	r->undetermined |= found;
	if (r->error_isotropic <= undetermined_limit(r->error))
		r->undetermined |= BOUND_ANGLE;
	r->seconds += search_clock() - begin;
	return status;
}

/* E from which on a fit is so bad that the data may have another G, and the part of it that tells that they have. */
#define BAD 0.03
#define MUCH_BETTER 0.6

/* What the best of the fits would be with correlated G, if that is much better. Of data with uncorrelated G it is
 * worse. */
static enum status try_correlated(const struct run *run, struct fit_result results[])
{
	struct fit_options other = *run->options;
	struct fit_result *best = &results[0];
	const struct ndf_class *class = other.ndf[0];

	for (int n = 1; n < other.n_ndf; n++)
		if (results[n].error < best->error) {
			best = &results[n];
			class = other.ndf[n];
		}
	if (other.criterion.gaf != GAF_UNCORRELATED || other.algorithm || !other.specular || other.anisotropic ||
	    ndf_is_tabulated(class) || leave_out(&other) || best->error < BAD)
		return STATUS_OK;
	const struct shape shape = shape_of(&best->model);
	const double enough = MUCH_BETTER * best->error;
	double error;

	other.criterion.gaf = GAF_CORRELATED;
	const enum status status = search_near(&run->multiresolution, &other, class, &shape, enough, &error);

	if (status == STATUS_OK && error < enough)
		best->error_correlated = error;
	return status;
}

enum status fit_samples_of(const struct fit_context *context, const struct measurement *measurement,
			   const struct fit_options *options, struct multiresolution *multiresolution,
			   struct error *error)
{
	struct sample_set full;
	enum status status = check_arguments(context, measurement, options, error);

	if (status != STATUS_OK)
		return status;
	status = sample_set_init(&full, &context->geometry, measurement, options->threads);
	if (status == STATUS_NO_DATA)
		return error_set(error, status, "no entry to fit: expected some valid ones that are not all zero");
	*multiresolution = (struct multiresolution){.table = {{.n_blocks = 0}}};
	if (status == STATUS_OK && options->algorithm)
		multiresolution->table[SEARCH_LEVELS - 1] = full; /* other algorithms need no thinned tables */
	else if (status == STATUS_OK)
		status = multiresolution_init(multiresolution, &full);
	return status == STATUS_OK ? status : error_set(error, status, "%s", status_str(status));
}

enum status fit_run(const struct fit_context *context, const struct measurement *measurement,
		    const struct fit_options *options, struct fit_result *results, struct error *error)
{
	struct run run = {.context = context, .measurement = measurement, .options = options};
	struct memory *memory = NULL;
	enum status status = fit_samples_of(context, measurement, options, &run.multiresolution, error);

	if (status != STATUS_OK)
		return status;
	for (int n = 0; n < options->n_ndf; n++)
		results[n].pwl = NULL;
	memory = calloc(1, sizeof *memory);
	if (!memory)
		status = STATUS_NO_MEMORY;
	else
		run.minima = memory->minima;
	struct nested *nested = !memory ? NULL : options->anisotropic ? &memory->anisotropic : &memory->nested;

	run.isotropic = memory ? &memory->nested : NULL;
	for (int n = 0; n < options->n_ndf && status == STATUS_OK; n++) {
		status = fit_class(&run, options->ndf[n], nested, &results[n]);
		if (status == STATUS_OK)
			status = find_undetermined(&run, options->ndf[n], nested, &results[n]);
	}
	if (status == STATUS_OK)
		status = try_correlated(&run, results);
	for (int n = 0; n < options->n_ndf && status != STATUS_OK; n++)
		fit_result_free(&results[n]);
	free(memory);
	multiresolution_free(&run.multiresolution);
	return status == STATUS_OK ? status : error_set(error, status, "%s", status_str(status));
}

/* The intervals of one result. */
static enum status find_intervals(const struct multiresolution *multiresolution, const struct fit_options *asked,
				  const struct ndf_class *class, double percent, struct fit_result *r)
{
	const double begin = search_clock();
	const struct shape best = shape_of(&r->model);
	struct fit_options options = *asked;

	if (options.lambda == LAMBDA_INTEGER || options.lambda == LAMBDA_HALF_INTEGER)
		options.gamma = r->model.ndf.gamma; /* the values between have no such form */
	const enum status status =
		interval_find(multiresolution, &options, class, &best, r->error, percent, r->interval, &r->evaluations);

	/* A simpler model may have been as good. */
	if (!cook_torrance_has_second(&r->model))
		r->interval[INTERVAL_SIGMA2].n = r->interval[INTERVAL_GAMMA2].n = 0;
	if (best.stretch == 0)
		r->interval[INTERVAL_ANGLE].n = 0;
	r->seconds += search_clock() - begin;
	return status;
}

enum status fit_intervals(const struct fit_context *context, const struct measurement *measurement,
			  const struct fit_options *options, double percent, struct fit_result *results,
			  struct error *error)
{
	struct multiresolution multiresolution;
	enum status status = fit_samples_of(context, measurement, options, &multiresolution, error);

	if (status != STATUS_OK)
		return status;
	for (int n = 0; n < options->n_ndf && status == STATUS_OK; n++)
		status = find_intervals(&multiresolution, options, options->ndf[n], percent, &results[n]);
	multiresolution_free(&multiresolution);
	return status == STATUS_OK ? status : error_set(error, status, "%s", status_str(status));
}

enum status fit_estimate(const struct fit_context *context, const struct measurement *measurement,
			 const struct fit_options *options, double *estimate, struct error *error)
{
	struct multiresolution multiresolution;
	enum status status = fit_samples_of(context, measurement, options, &multiresolution, error);
	bool known = true;

	*estimate = INFINITY;
	if (status != STATUS_OK)
		return status;
	for (int n = 0; n < options->n_ndf && status == STATUS_OK; n++) {
		struct space space;
		struct shape shape;
		double one;

		space_init(&space, options, options->ndf[n]);
		known = known && space.dims > 0;
		if (space.dims == 0)
			continue;
		status = search_estimate(&multiresolution, options, options->ndf[n], NULL, 0, &shape, &one);
		*estimate = fmin(*estimate, one);
	}
	if (!known)
		*estimate = INFINITY;
	multiresolution_free(&multiresolution);
	return status;
}

enum status fit_eval(const struct measurement *measurement, const struct cook_torrance *model,
		     const struct fit_options *options, struct fit_metrics *metrics, struct error *error)
{
	struct fit_options own = *options;
	struct fit_context *context;
	enum status status;

	own.criterion.gaf = model->gaf;
	if (ndf_is_anisotropic(&model->ndf) && !measurement->scattered)
		return error_set(error, STATUS_DOMAIN, "%s", isotropic_table);
	status = fit_criterion_check(&own, error);
	if (status != STATUS_OK)
		return status;
	status = fit_context_new(&context, measurement->n_phi_d, &own);
	if (status == STATUS_OK)
		status = metrics_compute(&context->geometry, measurement, model, options->threads, metrics);
	fit_context_free(context);
	if (status == STATUS_NO_DATA)
		return error_set(error, status, "no entry to compare: expected some valid ones that are not all zero");
	return status == STATUS_OK ? status : error_set(error, status, "%s", status_str(status));
}
