/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/undetermined.h"
#include "fit/search/fit.h"
#include <math.h>
#include <string.h>

/* One parameter held at one value. */
struct fixed {
	enum {
		FIXED_DIMENSION, /* dimension `dim` of the space */
		FIXED_DIFFUSE,   /* kd of a channel */
		FIXED_SPECULAR,  /* its ks */
		FIXED_N,         /* its n where k is searched too, or that of all channels, */
		FIXED_K          /* and k where n is */
	} what;
	int dim, channel;
	double value;
};

static bool is_of_index(const struct fixed *fixed)
{
	return fixed->what == FIXED_N || fixed->what == FIXED_K;
}

static bool is_factor(const struct fixed *fixed)
{
	return fixed->what == FIXED_DIFFUSE || fixed->what == FIXED_SPECULAR;
}

struct refit_context {
	const struct multiresolution *multiresolution;
	const struct fit_options *options;
	const struct ndf_class *class;
	const struct scan_minima *minima;
	struct space space;
	struct shape best;
	double error;   /* E of *best on the full table, */
	double coarse;  /* and on the coarsest */
	double lambert; /* there too: E without a specular term */
	/* And what each channel's part of E rises by, at the least of the shapes that come into question, with kd at its
	 * upper end, and without specular term. */
	double increase[2][MERL_CHANNELS], increase_of_best[2][MERL_CHANNELS]; /* and that at *best */
	_Atomic long evaluations;
};

/* What E may be, on each level's table, for its value on the full one to be in reach. On the materials at hand the samples
 * were wrong about so small a difference of errors by 6e-4, 3e-5 and 1e-5 of E; the G1 of the search is good to 8e-6. */
static const struct {
	double relative, absolute;
} slack[SEARCH_LEVELS] = {{3e-3, 2e-5}, {1.5e-3, 2e-5}, {1.1e-3, 2e-5}, {FIT_UNDETERMINED, FIT_UNDETERMINED_FLOOR}};

static double limit_of(int level, double best)
{
	return best * (1 + slack[level].relative) + slack[level].absolute;
}

double undetermined_limit(double error)
{
	return limit_of(SEARCH_LEVELS - 1, error);
}

/* How each level is searched; the coarsest one decides most. */
static const struct local_settings level_settings[SEARCH_LEVELS - 1] = {{NLOPT_LN_SBPLX, 0.7, 1e-3, 100, false, 0},
									{NLOPT_LN_SBPLX, 0.3, 1e-4, 40, false, 0},
									{NLOPT_LN_SBPLX, 0.2, 3e-5, 20, false, 0}};

static enum status open_level(const struct refit_context *q, int level, struct objective *o)
{
	return objective_init(o, &q->multiresolution->table[level], q->options, q->class, 1,
			      level == SEARCH_LEVELS - 1 ? MASKING_FINE : MASKING_COARSE);
}

/* The n and k of the other channels stay: they say nothing of this one. */
static void fix_other_channels(const struct refit_context *q, struct space *space, int channel)
{
	double x[SPACE_DIMS];

	space_from_shape(&q->space, &q->best, x);
	for (int d = q->space.dims - 1; d >= 0; d--) {
		const enum coordinate c = q->space.coordinate[d];

		if ((c == COORDINATE_LENGTH || c == COORDINATE_PHASE) && q->space.channel[d] != channel)
			space_fix(space, d, space_value(&q->space, d, x[d]));
	}
}

/* The space that a fixed parameter leaves; what it holds there, the objective has to be told. */
static struct space fixed_space(const struct refit_context *q, const struct fixed *fixed)
{
	struct space space = q->space;

	if (fixed->what == FIXED_DIMENSION)
		space_fix(&space, fixed->dim, fixed->value);
	if (is_of_index(fixed)) {
		fix_other_channels(q, &space, fixed->channel);
		space_fix_index(&space, fixed->channel, fixed->what == FIXED_K, fixed->value);
	}
	return space;
}

static void fix_objective(struct objective *o, const struct fixed *fixed)
{
	if (is_factor(fixed))
		objective_fix(o, fixed->channel, fixed->what == FIXED_SPECULAR, fixed->value);
}

static void count(void *user, const struct shape *shape, const struct linear *linear)
{
	struct refit_context *q = user;

	(void)shape;
	(void)linear;
	q->evaluations++;
}

/* E at a point of a space, on the objective's table. */
static double error_at(struct refit_context *q, struct objective *o, const struct space *space, const double x[],
		       double tolerance, struct linear *linear)
{
	const struct shape shape = space_shape(space, x);

	q->evaluations++;
	return objective_eval(o, &shape, tolerance, false, linear);
}

/* Adds the point of a shape, if it is among the `max_count` best so far. */
static void offer(struct refit_context *q, struct objective *o, const struct space *space, struct shape shape,
		  struct space_point *start, int *n, int max_count)
{
	struct space_point point;

	space_from_shape(space, &shape, point.x);
	point.error = error_at(q, o, space, point.x, 2e-3, &point.linear);
	int at = *n < max_count ? (*n)++ : max_count;

	for (; at > 0 && start[at - 1].error > point.error; at--)
		if (at < max_count)
			start[at] = start[at - 1];
	if (at < max_count)
		start[at] = point;
}

/* The value of the axis that is next to a fixed parameter's. */
static int nearest(const struct axis *axis, double value)
{
	int best = 0;

	for (int i = 1; i < axis->count; i++)
		if (fabs(axis->value[i] - value) < fabs(axis->value[best] - value))
			best = i;
	return best;
}

enum { STARTS = 2 };

/* Offers the optimum with n, or k, as it is fixed and the other at `other`. */
static void offer_index(struct refit_context *q, struct objective *o, const struct space *space,
			const struct fixed *fixed, double other, struct space_point start[STARTS], int *n)
{
	struct shape shape = q->best;

	*space_index(space, &shape, fixed->channel, fixed->what == FIXED_N) = other;
	offer(q, o, space, shape, start, n, STARTS);
}

/* Where n and k nearly trade off, it is along equal F0 = ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2). Where they do not, the other one may
 * be anywhere. */
static int first_points_of_index(struct refit_context *q, struct objective *o, const struct space *space,
				 const struct fixed *fixed, struct space_point start[STARTS])
{
	static const double other[] = {0.03, 0.3, 1, 3, 10, 40};
	const double n_best = *space_index(space, &q->best, fixed->channel, 0),
		     k_best = *space_index(space, &q->best, fixed->channel, 1), at = fixed->value;
	const double F0 = fresnel_conductor(1, n_best, k_best), up = 1 + F0, down = 1 - F0;
	int n = 0;

	offer_index(q, o, space, fixed, fixed->what == FIXED_N ? k_best : n_best, start, &n);
	if (fixed->what == FIXED_N) {
		offer_index(q, o, space, fixed, sqrt(fmax(F0 * (at + 1) * (at + 1) - (at - 1) * (at - 1), 0) / down),
			    start, &n);
	} else {
		const double root = sqrt(fmax(up * up - down * down * (1 + at * at), 0));

		offer_index(q, o, space, fixed, (up + root) / down, start, &n);
		offer_index(q, o, space, fixed, (up - root) / down, start, &n);
	}
	for (size_t i = 0; i < sizeof other / sizeof *other; i++)
		offer_index(q, o, space, fixed, other[i], start, &n);
	return n;
}

/* Where a refit under a fixed parameter begins: at the optimum, and at the best that the scan has seen there. Under a fixed kd or
 * ks, at the best of each sigma; and, since ks may be large where F is small, at the least F. */
static int first_points(struct refit_context *q, struct objective *o, const struct space *space,
			const struct fixed *fixed, struct space_point start[STARTS])
{
	const struct scan_minima *e = q->minima;
	int n = 0;

	if (is_of_index(fixed))
		return first_points_of_index(q, o, space, fixed, start);
	offer(q, o, space, q->best, start, &n, STARTS);
	if (fixed->what == FIXED_DIMENSION) {
		const int i = nearest(&q->space.axis[fixed->dim], fixed->value);

		offer(q, o, space, space_shape(&q->space, e->slice[fixed->dim][i].x), start, &n, STARTS);
		return n;
	}
	for (int i = 0; q->space.dims > 0 && i < q->space.axis[0].count; i++)
		offer(q, o, space, space_shape(&q->space, e->slice[0][i].x), start, &n, STARTS);
	if (fixed->what == FIXED_SPECULAR) {
		struct shape faint = q->best;

		for (int c = 0; c < MERL_CHANNELS; c++) {
			*space_index(space, &faint, c, 0) = FIT_IOR_MIN;
			*space_index(space, &faint, c, 1) = 0;
		}
		offer(q, o, space, faint, start, &n, STARTS);
	}
	return n;
}

/* Improves a point on a level's table, on which the optimum has the error `best`, unless there is nothing to search. */
static enum status descend(struct refit_context *q, struct objective *o, const struct space *space, int level,
			   double best, struct space_point *point)
{
	struct local_settings settings = level_settings[level];

	settings.enough = best * (1 + FIT_UNDETERMINED / 2) + FIT_UNDETERMINED_FLOOR / 2;
	point->error = error_at(q, o, space, point->x, 0.1 * settings.tolerance, &point->linear);
	if (space->dims == 0 || point->error <= settings.enough)
		return STATUS_OK;
	return local_descend(space, o, &settings, count, q, point, NULL);
}

/* The best start on the coarsest table, improved. */
static enum status descend_coarse(struct refit_context *q, const struct fixed *fixed, const struct space *space,
				  struct space_point *best)
{
	struct space_point start[STARTS];
	struct objective o;
	enum status status = open_level(q, 0, &o);

	if (status != STATUS_OK)
		return status;
	fix_objective(&o, fixed);
	const int n = first_points(q, &o, space, fixed, start);

	best->error = INFINITY;
	for (int i = 0; i < n && best->error > limit_of(0, q->coarse) && status == STATUS_OK; i++) {
		status = descend(q, &o, space, 0, q->coarse, &start[i]);
		if (start[i].error < best->error)
			*best = start[i];
	}
	objective_free(&o);
	return status;
}

/* Goes on under a fixed parameter on the table of a finer level; on the full one only evaluates. */
static enum status descend_finer(struct refit_context *q, const struct fixed *fixed, const struct space *space,
				 int level, struct space_point *point, bool *reached)
{
	const bool full = level == SEARCH_LEVELS - 1;
	struct objective o;
	struct linear linear;
	enum status status = open_level(q, level, &o);

	if (status != STATUS_OK)
		return status;
	const double best = full ? q->error : objective_eval(&o, &q->best, 1e-5, false, &linear);

	fix_objective(&o, fixed);
	if (full)
		point->error = error_at(q, &o, space, point->x, 1e-7, &linear);
	else
		status = descend(q, &o, space, level, best, point);
	*reached = point->error <= limit_of(level, best);
	objective_free(&o);
	return status;
}

/* Whether E is in reach under a fixed parameter, the other parameters refitted. */
static enum status reaches(struct refit_context *q, const struct fixed *fixed, bool *reached)
{
	const struct space space = fixed_space(q, fixed);
	struct space_point point = {.error = INFINITY};
	enum status status = descend_coarse(q, fixed, &space, &point);

	*reached = point.error <= limit_of(0, q->coarse);
	for (int level = 1; level < SEARCH_LEVELS && *reached && status == STATUS_OK; level++)
		status = descend_finer(q, fixed, &space, level, &point, reached);
	return status;
}

/* Whether E is in reach at all the values of a parameter. */
static enum status reaches_all(struct refit_context *q, struct fixed fixed, const double value[], int n, bool *reached)
{
	enum status status = STATUS_OK;

	*reached = true;
	for (int i = 0; i < n && *reached && status == STATUS_OK; i++) {
		fixed.value = value[i];
		status = reaches(q, &fixed, reached);
		if (fit_cancelled(q->options))
			status = STATUS_INTERRUPTED;
	}
	return status;
}

/* The values of dimension d to try: where the scan was worst first, then the ends of the range and the rest of the axis. */
static int values_of(const struct refit_context *q, int d, double value[])
{
	const struct axis *axis = &q->space.axis[d];
	const struct space_point *slice = q->minima->slice[d];
	int worst = 0, n = 0;

	for (int i = 1; i < axis->count; i++)
		if (slice[i].error > slice[worst].error)
			worst = i;
	value[n++] = axis->value[worst];
	value[n++] = q->space.lowest[d];
	value[n++] = q->space.highest[d];
	for (int i = 0; i < axis->count; i++)
		if (i != worst)
			value[n++] = axis->value[i];
	return n;
}

static enum status shape_parameter(struct refit_context *q, int d, bool *undetermined)
{
	double value[SPACE_VALUES + 2];
	const int n = values_of(q, d, value);

	return reaches_all(q, (struct fixed){.what = FIXED_DIMENSION, .dim = d}, value, n, undetermined);
}

/* Whether E is in reach at any of two values in the domain of a parameter. */
static enum status reaches_any(struct refit_context *q, struct fixed fixed, const double value[2], double lowest,
			       double highest, bool *reached)
{
	enum status status = STATUS_OK;

	*reached = false;
	for (int i = 0; i < 2 && !*reached && status == STATUS_OK; i++) {
		fixed.value = value[i];
		if (value[i] >= lowest && value[i] <= highest)
			status = reaches(q, &fixed, reached);
		if (fit_cancelled(q->options))
			status = STATUS_INTERRUPTED;
	}
	return status;
}

/* Of a conductor: n and k nearly trade off over a part of their domain. Neither is determined where not even its size is. d: of
 * k where n is fixed, of the length or the phase where both are free, and there of n, or of k. */
static enum status index_parameter(struct refit_context *q, int d, bool *undetermined)
{
	const int channel = q->space.channel[d];
	const double n = *space_index(&q->space, &q->best, channel, 0),
		     k = *space_index(&q->space, &q->best, channel, 1), half = 0.5 * fmax(n, k);
	const double of_n[2] = {n / 2, 2 * n}, of_k[2] = {k - half, k + half};
	struct fixed fixed = {.what = FIXED_DIMENSION, .dim = d, .channel = channel};

	if (q->space.coordinate[d] == COORDINATE_LENGTH) {
		fixed.what = FIXED_N;
		return reaches_any(q, fixed, of_n, FIT_CONDUCTOR_IOR_MIN, FIT_IOR_MAX, undetermined);
	}
	if (q->space.coordinate[d] == COORDINATE_PHASE)
		fixed.what = FIXED_K;
	return reaches_any(q, fixed, of_k, 0, FIT_K_MAX, undetermined);
}

/* Whether E is in reach at both ends of a factor with the shape as it is. It is convex in kd and ks: then it is in reach
 * all the way. */
static enum status reaches_both_ends(struct refit_context *q, int channel, bool specular, bool *reached)
{
	struct objective o;
	struct linear linear;
	const enum status status = open_level(q, SEARCH_LEVELS - 1, &o);

	*reached = status == STATUS_OK;
	for (int end = 0; end < 2 && *reached; end++) {
		objective_fix(&o, channel, specular,
			      (int)specular == end ? objective_upper_bound(q->options, specular) : 0);
		*reached = objective_eval(&o, &q->best, 1e-7, false, &linear) <= limit_of(SEARCH_LEVELS - 1, q->error);
		q->evaluations++;
	}
	if (status == STATUS_OK)
		objective_free(&o);
	return status;
}

static enum status factor(struct refit_context *q, int channel, bool specular, bool *undetermined)
{
	/* Of the upper end; first the one of which `increase` tells. */
	enum { SHARES = 8 };
	static const double share[2][SHARES] = {{1, 0, 0.6, 0.3, 0.1, 1e-2, 1e-3, 1e-4},
						{0, 1, 0.6, 0.3, 0.1, 1e-2, 1e-3, 1e-4}};
	const double maximum = objective_upper_bound(q->options, specular);
	double value[SHARES];

	*undetermined = false;
	if (q->coarse + q->increase[specular][channel] > limit_of(0, q->coarse))
		return STATUS_OK;
	enum status status = STATUS_OK;

	/* Where that is likely it saves the refits. */
	if (q->coarse + q->increase_of_best[specular][channel] <= limit_of(1, q->coarse))
		status = reaches_both_ends(q, channel, specular, undetermined);
	if (status != STATUS_OK || *undetermined)
		return status;
	for (int n = 0; n < SHARES; n++)
		value[n] = maximum * share[specular][n];
	return reaches_all(q, (struct fixed){.what = specular ? FIXED_SPECULAR : FIXED_DIFFUSE, .channel = channel},
			   value, SHARES, undetermined);
}

static unsigned bit_of(const struct space *space, int d)
{
	static const unsigned bit[] = {[COORDINATE_SIGMA] = BOUND_SIGMA,
				       [COORDINATE_GAMMA] = BOUND_GAMMA,
				       [COORDINATE_IOR] = BOUND_IOR,
				       [COORDINATE_K] = BOUND_K,
				       [COORDINATE_LENGTH] = BOUND_IOR, /* in whose place n is asked for, and k */
				       [COORDINATE_PHASE] = BOUND_K,
				       [COORDINATE_ANGLE] = BOUND_ANGLE,
				       [COORDINATE_GRAZING] = BOUND_GRAZING,
				       [COORDINATE_SECOND_SIGMA] = BOUND_SECOND_SIGMA,
				       [COORDINATE_SECOND_GAMMA] = BOUND_SECOND_GAMMA};

	if (space->per_channel && space->coordinate[d] == COORDINATE_LENGTH)
		return (unsigned)BOUND_IOR_R << space->channel[d];
	if (space->per_channel && space->coordinate[d] == COORDINATE_PHASE)
		return (unsigned)BOUND_K_R << space->channel[d];
	return bit[space->coordinate[d]];
}

static unsigned bits_of_factor(const struct fit_options *options, int channel, bool specular)
{
	const unsigned first = specular ? BOUND_KS_R : BOUND_KD_R;

	const bool shared = options->gray || (specular && options->gray_specular);

	return shared ? first | first << 1 | first << 2 : first << channel;
}

/* Notes by how much each channel's error rises at one shape, whose own E may be refitted to `above` that of the optimum:
 * there no refit brings the sum of both below its least over all shapes. */
static void note_increase(struct refit_context *q, struct objective *o, const struct shape *shape, double above,
			  const struct linear *lambert)
{
	struct linear free, white;

	objective_unfix(o);
	objective_eval(o, shape, 1e-4, false, &free);
	for (int c = 0; c < MERL_CHANNELS; c++)
		objective_fix(o, c, false, objective_upper_bound(q->options, false));
	objective_eval(o, shape, 1e-4, false, &white);
	q->evaluations += 2;
	for (int c = 0; c < MERL_CHANNELS; c++) {
		/* Where channels share ks, a channel has no part of E to itself: nothing is known before refits. */
		if (q->options->gray_specular) {
			q->increase[0][c] = q->increase[1][c] = 0;
			continue;
		}
		q->increase[0][c] = fmin(q->increase[0][c], above + white.channel[c] - free.channel[c]);
		q->increase[1][c] = fmin(q->increase[1][c], above + lambert->channel[c] - free.channel[c]);
	}
}

/* What the coarsest table tells before any refit. */
static enum status evaluate_coarse(struct refit_context *q)
{
	const int n = q->space.dims > 0 ? q->space.axis[0].count : 0;
	const struct space_point *slice = q->minima->slice[0];
	struct objective o;
	struct linear linear;
	enum status status = open_level(q, 0, &o);

	if (status != STATUS_OK)
		return status;
	q->coarse = objective_eval(&o, &q->best, 1e-5, false, &linear);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		objective_fix(&o, c, true, 0);
		q->increase[0][c] = q->increase[1][c] = INFINITY;
	}
	q->lambert = objective_eval(&o, &q->best, 1e-5, false, &linear);
	q->evaluations += 2;
	note_increase(q, &o, &q->best, 0, &linear);
	memcpy(q->increase_of_best, q->increase, sizeof q->increase);
	for (int i = 0; i < n; i++) {
		/* A fifth is what the scan may be above the bottom of its valley. */
		const double above = fmax(slice[i].error / 1.2 - q->coarse, 0);
		const struct shape shape = space_shape(&q->space, slice[i].x);

		if (q->coarse + above <= limit_of(0, q->coarse))
			note_increase(q, &o, &shape, above, &linear);
	}
	objective_free(&o);
	return STATUS_OK;
}

/* Whether no specular term at all is as good: then any shape is. */
static enum status can_do_without_lobe(struct refit_context *q, bool *can)
{
	struct objective o;
	struct linear linear;
	enum status status = open_level(q, SEARCH_LEVELS - 1, &o);

	if (status != STATUS_OK)
		return status;
	for (int c = 0; c < MERL_CHANNELS; c++)
		objective_fix(&o, c, true, 0);
	*can = objective_eval(&o, &q->best, 1e-7, false, &linear) <= limit_of(SEARCH_LEVELS - 1, q->error);
	objective_free(&o);
	return status;
}

/* A free parameter of the model: dimension n of the space, or a factor behind them. */
static enum status ask(struct refit_context *q, int n, unsigned determined, bool any_shape, unsigned *bits)
{
	const struct fit_options *options = q->options;
	bool undetermined = any_shape;
	enum status status = STATUS_OK;

	*bits = 0;
	if (n < q->space.dims && space_is_of_axes(&q->space, n))
		return STATUS_OK; /* the isotropic fit tells: fit.c */
	if (n < q->space.dims) {
		const enum coordinate c = q->space.coordinate[n];
		const bool of_conductor = c == COORDINATE_LENGTH || c == COORDINATE_PHASE || c == COORDINATE_K;

		if (!any_shape && of_conductor)
			status = index_parameter(q, n, &undetermined);
		else if (!any_shape && !(bit_of(&q->space, n) & determined))
			status = shape_parameter(q, n, &undetermined);
		*bits = undetermined ? bit_of(&q->space, n) : 0;
		return status;
	}
	const int channel = (n - q->space.dims) / 2;
	const bool specular = (n - q->space.dims) % 2;

	const bool shared = options->gray || (specular && options->gray_specular);

	if (specular && options->fresnel == FRESNEL_F82)
		return STATUS_OK; /* F0 is one of three: nothing is known of it alone */
	if ((shared && channel > 0) || !(specular ? options->specular : options->diffuse))
		return STATUS_OK;
	status = factor(q, channel, specular, &undetermined);
	*bits = undetermined ? bits_of_factor(options, channel, specular) : 0;
	return status;
}

/* Where D is free there is no shape to be refitted. */
static enum status find_of_table(struct refit_context *q, unsigned *undetermined)
{
	const bool free_ior = fresnel_has_ior(q->options->fresnel) && isnan(q->options->ior);
	bool any = false;

	q->class = ndf_find("ggx");
	q->best = (struct shape){.sigma = 1, .gamma = 2, .ior = 1.5};
	const enum status status = can_do_without_lobe(q, &any);

	*undetermined = any && free_ior ? BOUND_IOR : 0;
	*undetermined |= any && q->options->fresnel == FRESNEL_CONDUCTOR ? BOUND_K : 0;
	return status;
}

enum status undetermined_find(const struct multiresolution *multiresolution, const struct fit_options *options,
			      const struct ndf_class *class, const struct scan_minima *minima, const struct shape *best,
			      double error, unsigned determined, unsigned *undetermined, long *evaluations)
{
	struct refit_context q = {.multiresolution = multiresolution,
				  .options = options,
				  .class = class,
				  .minima = minima,
				  .best = *best};
	bool any_shape = false;
	unsigned all = 0;

	q.error = error;
	if (ndf_is_tabulated(class))
		return find_of_table(&q, undetermined);
	space_init(&q.space, options, class);
	enum status status = evaluate_coarse(&q);

	if (status == STATUS_OK && options->specular && q.lambert <= limit_of(0, q.coarse))
		status = can_do_without_lobe(&q, &any_shape);
	const int n_questions = status == STATUS_OK ? q.space.dims + 2 * MERL_CHANNELS : 0;

#pragma omp parallel for num_threads(options->threads) schedule(dynamic) reduction(| : all) if (options->threads > 1)
	for (int n = 0; n < n_questions; n++) {
		unsigned bits = 0;
		const enum status mine = ask(&q, n, determined, any_shape, &bits);

		all |= bits;
		if (mine != STATUS_OK)
#pragma omp critical
			status = mine;
	}
	*undetermined = all;
	*evaluations += q.evaluations;
	return status;
}
