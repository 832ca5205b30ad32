/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/algorithms.h"
#include <math.h>
#include <nlopt.h>
#include <stdlib.h>
#include <string.h>

struct algorithm {
	const char *name;
	nlopt_algorithm id;
	bool local, joint;
};

static const struct algorithm algorithms[] = {
	{"esch", NLOPT_GN_ESCH, false, false},         {"esch-joint", NLOPT_GN_ESCH, false, true},
	{"isres", NLOPT_GN_ISRES, false, false},       {"isres-joint", NLOPT_GN_ISRES, false, true},
	{"crs2", NLOPT_GN_CRS2_LM, false, false},      {"crs2-joint", NLOPT_GN_CRS2_LM, false, true},
	{"direct-l", NLOPT_GN_DIRECT_L, false, false}, {"direct-l-joint", NLOPT_GN_DIRECT_L, false, true},
	{"mlsl", NLOPT_G_MLSL_LDS, false, false},      {"mlsl-joint", NLOPT_G_MLSL_LDS, false, true},
	{"sbplx", NLOPT_LN_SBPLX, true, false},        {"sbplx-joint", NLOPT_LN_SBPLX, true, true},
	{"bobyqa", NLOPT_LN_BOBYQA, true, false},      {"bobyqa-joint", NLOPT_LN_BOBYQA, true, true},
	{"cobyla", NLOPT_LN_COBYLA, true, false},      {"cobyla-joint", NLOPT_LN_COBYLA, true, true},
	{"praxis", NLOPT_LN_PRAXIS, true, false},      {"praxis-joint", NLOPT_LN_PRAXIS, true, true},
};

_Static_assert(sizeof algorithms / sizeof *algorithms + 1 == ALGORITHM_COUNT, "the default and these");

const struct algorithm *algorithm_at(int i)
{
	return i > 0 ? &algorithms[i - 1] : NULL;
}

const char *algorithm_name(const struct algorithm *algorithm)
{
	return algorithm ? algorithm->name : "default";
}

enum status algorithm_find(const char *name, const struct algorithm **algorithm)
{
	for (int i = 0; i < ALGORITHM_COUNT; i++)
		if (!strcmp(name, algorithm_name(algorithm_at(i)))) {
			*algorithm = algorithm_at(i);
			return STATUS_OK;
		}
	return STATUS_DOMAIN;
}

/* Coordinates of a joint search: the shape's, then kd, then ks. */
enum { DIMS_MAX = SPACE_DIMS + 2 * MERL_CHANNELS };

struct run {
	const struct algorithm *algorithm;
	const struct fit_options *options;
	const struct ndf_class *class;
	struct objective objective;
	struct space space; /* of the shape, the first coordinates of */
	int dims;
	double lo[DIMS_MAX], hi[DIMS_MAX];
	double begin_s;
	bool stopped; /* out of time, or cancelled */
	nlopt_opt opt;
	struct found *found; /* the best so far */
	double attempt_best; /* the best of this call of nlopt */
	double *ends;        /* of each call before */
};

/* How many coordinates kd (or ks) take. */
static int factors(const struct fit_options *options, bool present)
{
	return !present ? 0 : options->gray ? 1 : MERL_CHANNELS;
}

static void set_up_space(struct run *r)
{
	const struct fit_options *o = r->options;

	space_init(&r->space, o, r->class);
	r->dims = r->space.dims;
	memcpy(r->lo, r->space.lo, sizeof r->space.lo);
	memcpy(r->hi, r->space.hi, sizeof r->space.hi);
	if (!r->algorithm->joint)
		return;
	r->dims += factors(o, o->diffuse) + factors(o, o->specular);
	for (int d = r->space.dims; d < r->dims; d++) {
		r->lo[d] = 0;
		/* Without a bound kd and ks are searched as k/(1 + k). */
		r->hi[d] = o->unbounded ? FIT_FACTOR_MAX / (1 + FIT_FACTOR_MAX) : 1;
	}
}

/* Reads the three values of kd or ks at *x, which moves on. */
static void read_factors(const struct fit_options *o, bool specular, const double **x, double value[])
{
	const int n = factors(o, specular ? o->specular : o->diffuse);

	for (int c = 0; c < MERL_CHANNELS; c++) {
		const double u = n == 0 ? 0 : (*x)[n == 1 ? 0 : c];

		value[c] = o->unbounded ? u / (1 - u) : u * objective_upper_bound(o, specular);
	}
	*x += n;
}

/* E at a point, and the parameters that it stands for. */
static double error_at(struct run *r, const double x[], struct shape *shape, struct linear *linear)
{
	const struct fit_options *o = r->options;
	double inside[DIMS_MAX];
	const double *factor = inside + r->space.dims;

	/* PRAXIS steps over the bounds, others by an ulp. */
	for (int d = 0; d < r->dims; d++)
		inside[d] = fmin(fmax(x[d], r->lo[d]), r->hi[d]);
	*shape = space_shape(&r->space, inside);
	if (!r->algorithm->joint)
		return objective_eval(&r->objective, shape, 1e-6, false, linear);
	double ks[MERL_CHANNELS];

	read_factors(o, false, &factor, linear->kd);
	read_factors(o, true, &factor, ks);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		linear->coefficient[c][0] = linear->kd[c] / M_PI;
		linear->coefficient[c][1] = ks[c];
	}
	linear->error = objective_error(&r->objective, shape, linear);
	return linear->error;
}

static void report(const struct run *r, const struct shape *shape, double error)
{
	const struct fit_trace point = {r->class,
					"full",
					shape->sigma,
					shape->gamma,
					shape->ior,
					shape->k,
					error,
					r->found->evaluations,
					search_clock() - r->begin_s};

	if (r->options->trace)
		r->options->trace(r->options->trace_data, &point);
}

static bool cancelled(const struct run *r)
{
	return fit_cancelled(r->options);
}

static double time_left(const struct run *r)
{
	return r->options->time_s - (search_clock() - r->begin_s);
}

static double evaluate(unsigned dims, const double *x, double *gradient, void *data)
{
	struct run *r = data;
	struct shape shape;
	struct linear linear = {.error = 0};

	(void)dims;
	(void)gradient;
	r->stopped |= cancelled(r) || (r->found->evaluations > 0 && time_left(r) <= 0);
	if (r->stopped) {
		/* Whoever does not stop at once learns nothing more and finds no time to. */
		nlopt_force_stop(r->opt);
		return OBJECTIVE_NO_FIT;
	}
	const double error = error_at(r, x, &shape, &linear);

	r->found->evaluations++;
	r->attempt_best = fmin(r->attempt_best, error);
	if (error < r->found->linear.error) {
		r->found->shape = shape;
		r->found->linear = linear;
		report(r, &shape, error);
	}
	return error;
}

/* Point n of an additive recurrence: it fills the unit cube evenly however many are taken. The steps are powers of
 * 1/p, p the positive root of p^(dims+1) = p + 1. The first point is the centre. */
static void start_point(const struct run *r, int n, double x[])
{
	const double first = (double)(r->options->seed % 1000000) * 1000;
	double p = 2, step = 1;

	for (int i = 0; i < 40; i++)
		p = pow(1 + p, 1.0 / (r->dims + 1));
	for (int d = 0; d < r->dims; d++) {
		step /= p;
		const double u = 0.5 + (first + n) * step;

		x[d] = r->lo[d] + (u - floor(u)) * (r->hi[d] - r->lo[d]);
	}
}

/* The local search inside MLSL; nlopt copies it. */
static bool set_local(nlopt_opt opt, unsigned dims)
{
	nlopt_opt local = nlopt_create(NLOPT_LN_SBPLX, dims);

	if (!local)
		return false;
	nlopt_set_ftol_rel(local, 1e-4);
	nlopt_set_xtol_rel(local, 1e-4);
	const bool done = nlopt_set_local_optimizer(opt, local) >= 0;

	nlopt_destroy(local);
	return done;
}

static bool set_up_nlopt(struct run *r, nlopt_opt opt, const double x[])
{
	double step[DIMS_MAX];

	for (int d = 0; d < r->dims; d++) {
		step[d] = 0.1 * (r->hi[d] - r->lo[d]);
		if (x[d] + step[d] > r->hi[d])
			step[d] = -step[d];
	}
	nlopt_set_min_objective(opt, evaluate, r);
	nlopt_set_lower_bounds(opt, r->lo);
	nlopt_set_upper_bounds(opt, r->hi);
	if (nlopt_set_initial_step(opt, step) < 0)
		return false;
	nlopt_set_maxtime(opt, fmax(time_left(r), 1e-3));
	if (r->algorithm->local) {
		nlopt_set_ftol_rel(opt, 1e-5);
		nlopt_set_xtol_rel(opt, 1e-5);
	}
	return r->algorithm->id != NLOPT_G_MLSL_LDS || set_local(opt, (unsigned)r->dims);
}

/* One call of nlopt, the n-th. */
static enum status attempt(struct run *r, int n)
{
	const long before = r->found->evaluations;
	double x[DIMS_MAX], error;

	start_point(r, n, x);
	r->attempt_best = INFINITY;
	r->opt = nlopt_create(r->algorithm->id, (unsigned)r->dims);
	if (!r->opt || !set_up_nlopt(r, r->opt, x)) {
		nlopt_destroy(r->opt);
		return STATUS_NO_MEMORY;
	}
	/* The state of its random numbers belongs to the thread. */
	nlopt_srand((unsigned long)r->options->seed + (unsigned long)n);
	const nlopt_result result = nlopt_optimize(r->opt, x, &error);

	nlopt_destroy(r->opt);
	if (result == NLOPT_OUT_OF_MEMORY)
		return STATUS_NO_MEMORY;
	return r->stopped || r->found->evaluations > before ? STATUS_OK : STATUS_UNSUPPORTED;
}

static enum status keep_end(struct run *r, int n)
{
	double *ends = realloc(r->ends, ((size_t)n + 1) * sizeof *ends);

	if (!ends)
		return STATUS_NO_MEMORY;
	r->ends = ends;
	ends[n] = r->attempt_best;
	return STATUS_OK;
}

/* Calls nlopt until the time is up: local searches again and again, the others once. */
static enum status attempts(struct run *r)
{
	struct found *f = r->found;
	enum status status = STATUS_OK;
	int n = 0;

	for (; !r->stopped && status == STATUS_OK && (n == 0 || r->algorithm->local); n++) {
		status = attempt(r, n);
		if (status == STATUS_OK)
			status = keep_end(r, n);
		r->stopped |= cancelled(r) || time_left(r) <= 0;
	}
	f->limited = r->stopped;
	f->starts = n;
	f->starts_agreeing = 0;
	for (int i = 0; i < n && status == STATUS_OK; i++)
		f->starts_agreeing += r->ends[i] <= 1.001 * f->linear.error;
	return status;
}

/* With nothing to search, kd and ks are all there is to solve for. */
static enum status evaluate_once(struct run *r)
{
	double nowhere[DIMS_MAX] = {0};

	r->found->evaluations = 1;
	r->found->starts = r->found->starts_agreeing = 1;
	error_at(r, nowhere, &r->found->shape, &r->found->linear);
	report(r, &r->found->shape, r->found->linear.error);
	return STATUS_OK;
}

/* The best once more, with the exact masking and a certified bound. A joint search keeps the kd and ks it found. */
static enum status certify(struct run *r)
{
	struct objective *o = &r->objective;
	struct found *f = r->found;
	struct linear best;
	enum status status;

	objective_free(o);
	status = objective_init(o, r->objective.table, r->options, r->class, r->options->threads, MASKING_FINE);
	if (status != STATUS_OK)
		return status;
	objective_eval(o, &f->shape, 1e-7, true, &best);
	if (r->algorithm->joint) {
		f->linear.error = objective_error(o, &f->shape, &f->linear);
		f->linear.lower_bound = best.lower_bound;
	} else {
		f->linear = best;
	}
	return STATUS_OK;
}

static enum status run_alone(struct run *r)
{
	enum status status = r->dims > 0 ? attempts(r) : evaluate_once(r);

	if (cancelled(r))
		status = STATUS_INTERRUPTED;
	return status == STATUS_OK ? certify(r) : status;
}

enum status algorithm_run(const struct sample_set *full, const struct fit_options *options,
			  const struct ndf_class *class, struct found *found)
{
	struct run r = {.algorithm = options->algorithm,
			.options = options,
			.class = class,
			.found = found,
			.begin_s = search_clock()};
	enum status status = objective_init(&r.objective, full, options, class, options->threads, MASKING_COARSE);

	if (status != STATUS_OK)
		return status;
	*found = (struct found){.linear.error = INFINITY};
	set_up_space(&r);
	/* One thread leads and the others of the team help with the passes. */
#pragma omp parallel num_threads(options->threads) if (options->threads > 1)
#pragma omp single
	status = run_alone(&r);
	objective_free(&r.objective);
	free(r.ends);
	return status;
}
