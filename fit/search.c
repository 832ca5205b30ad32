/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search.h"
#include <math.h>
#include <nlopt.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Slots of the thinned tables. Systematic samples this small estimate E to about 0.1, 0.03 and 0.003 %. */
static const int level_slots[SEARCH_LEVELS - 1] = {3000, 12000, 60000};

enum status levels_init(struct levels *levels, struct table *full)
{
	enum status status = STATUS_OK;

	*levels = (struct levels){0};
	levels->table[SEARCH_LEVELS - 1] = *full;
	*full = (struct table){0};
	for (int l = SEARCH_LEVELS - 2; l >= 0 && status == STATUS_OK; l--)
		status = table_thin(&levels->table[l], &levels->table[l + 1], level_slots[l]);
	if (status != STATUS_OK)
		levels_free(levels);
	return status;
}

void levels_free(struct levels *levels)
{
	for (int l = 0; l < SEARCH_LEVELS; l++)
		table_free(&levels->table[l]);
}

/* The coordinates of the search, in which the valleys are nearly straight: ln sigma, ln(gamma - the least gamma of the
 * NDF), sqrt(F0) = (n - 1)/(n + 1) and k/(k + 1). */
enum coordinate { SIGMA, GAMMA, IOR, K };

static double *parameter(struct shape *shape, enum coordinate c)
{
	double *const at[] = {&shape->sigma, &shape->gamma, &shape->ior, &shape->k};

	return at[c];
}

static double to_coordinate(enum coordinate c, double least_gamma, double value)
{
	switch (c) {
	case SIGMA:
		return log(value);
	case GAMMA:
		return log(value - least_gamma);
	case IOR:
		return (value - 1) / (value + 1);
	default:
		return value / (value + 1);
	}
}

static double from_coordinate(enum coordinate c, double least_gamma, double x)
{
	switch (c) {
	case SIGMA:
		return exp(x);
	case GAMMA:
		return least_gamma + exp(x);
	case IOR:
		return (1 + x) / (1 - x);
	default:
		return x / (1 - x);
	}
}

enum { MOST_VALUES = 32 };

/* The values of one parameter that the scan tries. */
struct axis {
	double value[MOST_VALUES];
	int count;
};

struct place {
	double x[SEARCH_DIMS];
	double error;
};

struct search {
	const struct levels *levels;
	const struct fit_options *options;
	const struct ndf_class *class;
	int dims;
	enum coordinate coordinate[SEARCH_DIMS];
	double lo[SEARCH_DIMS], hi[SEARCH_DIMS];
	double least_gamma, lowest[SEARCH_DIMS], highest[SEARCH_DIMS]; /* of the parameters themselves */
	struct axis axis[SEARCH_DIMS];
	struct shape fixed; /* values of the parameters that are not searched */
	_Atomic long evaluations;
	struct place known; /* found before and in need of beating; its error is INFINITY when there is none */
	double begin_s;
	const char *stage;
	double stage_best; /* least error of this stage */
};

double search_clock(void)
{
	struct timespec t;

	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void begin_stage(struct search *s, const char *stage)
{
	s->stage = stage;
	s->stage_best = INFINITY;
}

/* Counts an evaluation and tells the trace, if there is one, of a better shape. */
static void note(struct search *s, const struct shape *shape, double error)
{
	s->evaluations++;
	if (!s->options->trace)
		return;
#pragma omp critical(search_trace)
	if (error < s->stage_best) {
		const struct fit_trace point = {s->class,     s->stage,       shape->sigma,
						shape->gamma, shape->ior,     shape->k,
						error,        s->evaluations, search_clock() - s->begin_s};

		s->stage_best = error;
		s->options->trace(s->options->trace_data, &point);
	}
}

static bool cancelled(const struct search *s)
{
	return s->options->cancel && atomic_load_explicit(s->options->cancel, memory_order_relaxed);
}

/* The grid of the scan. Places in gamma are those of STD, above its least gamma; other NDFs get as many between the
 * ends of theirs, up to 50. */
static const struct axis scan_sigma = {{1e-4,   2e-4, 4e-4,   7e-4,   1e-3,  1.5e-3, 2.2e-3, 3.2e-3, 4.6e-3,
					6.5e-3, 9e-3, 0.0125, 0.0175, 0.025, 0.035,  0.05,   0.07,   0.1,
					0.14,   0.2,  0.28,   0.4,    0.55,  0.8,    1.2,    2,      4},
				       27};
static const struct axis scan_gamma = {{1e-4, 1e-3, 0.005, 0.015, 0.04, 0.1, 0.25, 0.7, 2, 6.5, 48.5}, 11};
static const struct axis scan_ior = {{1.03, 1.15, 1.35, 1.8, 3, 8, 60}, 7};
static const struct axis scan_k = {{0, 0.5, 2, 6, 30}, 5};

static struct axis gamma_axis(double least, double low)
{
	struct axis axis = scan_gamma;
	const double first = low - least, ratio = pow(50 / first, 1.0 / (axis.count - 1));

	for (int n = 0; n < axis.count; n++)
		axis.value[n] = least + (least == 1.5 ? axis.value[n] : first * pow(ratio, n));
	return axis;
}

static void add_dim(struct search *s, enum coordinate c, double lowest, double highest, const struct axis *axis)
{
	const int d = s->dims++;

	s->coordinate[d] = c;
	s->lowest[d] = lowest;
	s->highest[d] = highest;
	s->lo[d] = to_coordinate(c, s->least_gamma, lowest);
	s->hi[d] = to_coordinate(c, s->least_gamma, highest);
	s->axis[d] = *axis;
}

static void setup(struct search *s)
{
	const struct fit_options *o = s->options;

	s->fixed = (struct shape){o->sigma, o->gamma, o->ior, 0};
	if (!o->specular) {
		/* Any valid shape will do: ks is 0. */
		s->fixed = (struct shape){1, 2, 1.5, 0};
		return;
	}
	if (isnan(o->sigma))
		add_dim(s, SIGMA, FIT_SIGMA_MIN, FIT_SIGMA_MAX, &scan_sigma);
	if (ndf_has_gamma(s->class) && isnan(o->gamma)) {
		const struct ndf_param *gamma = ndf_param_at(s->class, 1);
		const struct axis axis = gamma_axis(gamma->min, gamma->search_min);

		s->least_gamma = gamma->min;
		add_dim(s, GAMMA, gamma->search_min, gamma->search_max, &axis);
	}
	if (o->fresnel != FRESNEL_NONE && isnan(o->ior))
		add_dim(s, IOR, FIT_IOR_MIN, FIT_IOR_MAX, &scan_ior);
	if (o->fresnel == FRESNEL_CONDUCTOR)
		add_dim(s, K, 0, FIT_K_MAX, &scan_k);
}

static struct shape shape_at(const struct search *s, const double x[])
{
	struct shape shape = s->fixed;

	for (int d = 0; d < s->dims; d++) {
		const enum coordinate c = s->coordinate[d];
		const double value = from_coordinate(c, s->least_gamma, x[d]);

		*parameter(&shape, c) = fmin(fmax(value, s->lowest[d]), s->highest[d]);
	}
	return shape;
}

static void place_of(const struct search *s, const struct shape *shape, double x[])
{
	struct shape copy = *shape;

	for (int d = 0; d < s->dims; d++) {
		const enum coordinate c = s->coordinate[d];
		const double value = *parameter(&copy, c);

		x[d] = to_coordinate(c, s->least_gamma, fmin(fmax(value, s->lowest[d]), s->highest[d]));
	}
}

int search_bounds(const struct fit_options *options, const struct ndf_class *class, double lo[], double hi[])
{
	struct search s = {.options = options, .class = class};

	setup(&s);
	memcpy(lo, s.lo, (size_t)s.dims * sizeof *lo);
	memcpy(hi, s.hi, (size_t)s.dims * sizeof *hi);
	return s.dims;
}

struct shape search_shape(const struct fit_options *options, const struct ndf_class *class, const double x[])
{
	struct search s = {.options = options, .class = class};

	setup(&s);
	return shape_at(&s, x);
}

static long grid_size(const struct search *s, int from)
{
	long size = 1;

	for (int d = from; d < s->dims; d++)
		size *= s->axis[d].count;
	return size;
}

static void grid_place(const struct search *s, long index, struct place *place)
{
	for (int d = s->dims - 1; d >= 0; d--) {
		const struct axis *a = &s->axis[d];

		place->x[d] = to_coordinate(s->coordinate[d], s->least_gamma, a->value[index % a->count]);
		index /= a->count;
	}
}

/* Evaluates the grid on the coarsest table. Neighbours along the last axes share G1 and begin the inner solve where
 * the one before ended; a stretch of the grid begins afresh, so the result does not depend on the threads. */
static enum status scan(struct search *s, struct place *grid)
{
	const long total = grid_size(s, 0);
	const int first_ior =
		s->dims > 0 && s->coordinate[0] == SIGMA ? 1 + (s->dims > 1 && s->coordinate[1] == GAMMA) : 0;
	const long stretch = grid_size(s, first_ior);
	enum status status = STATUS_OK;

#pragma omp parallel num_threads(s->options->threads) if (s->options->threads > 1)
	{
		struct objective o;
		enum status mine = objective_init(&o, &s->levels->table[0], s->options, s->class, 1, MASKING_COARSE);

#pragma omp for schedule(dynamic)
		for (long n = 0; n < total; n += stretch) {
			struct linear linear;

			if (mine != STATUS_OK || cancelled(s))
				continue;
			objective_forget(&o);
			for (long i = n; i < n + stretch; i++) {
				grid_place(s, i, &grid[i]);
				const struct shape shape = shape_at(s, grid[i].x);

				grid[i].error = objective_eval(&o, &shape, 2e-3, false, &linear);
				note(s, &shape, grid[i].error);
			}
		}
		if (mine == STATUS_OK) {
			objective_free(&o);
		} else {
#pragma omp critical
			status = mine;
		}
	}
	return status;
}

/* Whether no neighbour in the grid is better; of a plateau only the first place counts. */
static bool is_valley(const struct search *s, const struct place *grid, long index)
{
	long step = 1;

	for (int d = s->dims - 1; d >= 0; d--) {
		const int count = s->axis[d].count, at = (int)(index / step % count);

		if (at > 0 && grid[index - step].error <= grid[index].error)
			return false;
		if (at + 1 < count && grid[index + step].error < grid[index].error)
			return false;
		step *= count;
	}
	return true;
}

static int by_error(const void *a, const void *b)
{
	const struct place *p = a, *q = b;

	if (p->error != q->error)
		return p->error < q->error ? -1 : 1;
	return memcmp(p->x, q->x, sizeof p->x);
}

enum { MOST_STARTS = 24 };

/* The valleys of the grid, best first. Returns how many, at most MOST_STARTS. */
static int pick_starts(const struct search *s, struct place *grid, struct place starts[])
{
	const long total = grid_size(s, 0);
	long n_valleys = 0;
	struct place *valley = malloc((size_t)total * sizeof *valley);

	if (!valley)
		return -1;
	for (long n = 0; n < total; n++)
		if (is_valley(s, grid, n))
			valley[n_valleys++] = grid[n];
	qsort(valley, (size_t)n_valleys, sizeof *valley, by_error);
	const int count = n_valleys < MOST_STARTS ? (int)n_valleys : MOST_STARTS;

	memcpy(starts, valley, (size_t)count * sizeof *starts);
	free(valley);
	return count;
}

/* How a level is searched. */
struct stage {
	const char *name;
	int most;      /* places that go on from the level before, at most */
	double margin; /* those whose error is within this of the best, relative */
	nlopt_algorithm algorithm;
	double step;      /* first step, in grid spacings */
	double tolerance; /* of the error, relative */
	int evaluations;
};
/* On the small tables, whose error is rugged, the simplex method is the one that gets through. What is left to do on the
 * full one is a millionth of the error, on smooth ground: a quadratic model needs the fewest looks there. */
static const struct stage stages[SEARCH_LEVELS] = {
	{"thin-1", 0, 0, NLOPT_LN_SBPLX, 0.7, 2e-4, 150},
	{"thin-2", 8, 0.02, NLOPT_LN_SBPLX, 0.3, 3e-5, 150},
	{"thin-3", 4, 3e-3, NLOPT_LN_SBPLX, 0.2, 1e-6, 250},
	{"full", 2, 1e-4, NLOPT_LN_BOBYQA, 0.01, 1e-6, 16},
};

/* One local search. */
struct local {
	struct search *search;
	struct objective *objective;
	double tolerance;
	struct place best;
	double first; /* error of the place it began at */
	nlopt_opt opt;
};

static double local_eval(unsigned dims, const double *x, double *gradient, void *data)
{
	struct local *l = data;
	struct linear linear;
	const struct shape shape = shape_at(l->search, x);

	(void)gradient;
	if (cancelled(l->search))
		nlopt_force_stop(l->opt);
	const double error = objective_eval(l->objective, &shape, l->tolerance, false, &linear);

	note(l->search, &shape, error);

	if (isinf(l->best.error))
		l->first = error;
	if (error < l->best.error) {
		l->best.error = error;
		memcpy(l->best.x, x, dims * sizeof *x);
	}
	return error;
}

/* Improves *place on the objective's table. */
static enum status refine(struct search *s, struct objective *o, const struct stage *stage, struct place *place,
			  bool *limited)
{
	static const double spacing[] = {[SIGMA] = 0.35, [GAMMA] = 1.0, [IOR] = 0.1, [K] = 0.15};
	const unsigned dims = (unsigned)s->dims;
	struct local local = {.search = s, .objective = o, .tolerance = 0.1 * stage->tolerance};
	double x[SEARCH_DIMS], first[SEARCH_DIMS], error;

	objective_forget(o);
	local.best = *place;
	local.best.error = INFINITY;
	memcpy(x, place->x, sizeof x);
	nlopt_opt opt = nlopt_create(stage->algorithm, dims);

	if (!opt)
		return STATUS_NO_MEMORY;
	for (unsigned d = 0; d < dims; d++) {
		first[d] = stage->step * spacing[s->coordinate[d]];
		if (x[d] + first[d] > s->hi[d])
			first[d] = -first[d];
	}
	local.opt = opt;
	nlopt_set_min_objective(opt, local_eval, &local);
	nlopt_set_lower_bounds(opt, s->lo);
	nlopt_set_upper_bounds(opt, s->hi);
	nlopt_set_ftol_rel(opt, stage->tolerance);
	nlopt_set_xtol_rel(opt, 1e-5);
	nlopt_set_maxeval(opt, stage->evaluations);
	/* nlopt keeps the steps in memory that it asks for now; without them it would take others. */
	nlopt_result result = nlopt_set_initial_step(opt, first);
	if (result >= 0)
		result = nlopt_optimize(opt, x, &error);

	/* Stopped with the error still falling; 1e-5 is no matter for an E near 0. */
	*limited = result == NLOPT_MAXEVAL_REACHED && local.best.error < (1 - 1e-4) * local.first - 1e-5;
	nlopt_destroy(opt);
	*place = local.best;
	return result == NLOPT_OUT_OF_MEMORY ? STATUS_NO_MEMORY : STATUS_OK;
}

static bool near(const struct search *s, const struct place *a, const struct place *b)
{
	for (int d = 0; d < s->dims; d++)
		if (fabs(a->x[d] - b->x[d]) >= 0.02 * (s->hi[d] - s->lo[d]))
			return false;
	return true;
}

/* Places too near a better one to lead anywhere else go; so do those too far behind the best. What has been found before
 * counts as one of them. Returns how many stay. */
static int thin_out(const struct search *s, struct place *place, int count, const struct stage *stage)
{
	int kept = 0;

	qsort(place, (size_t)count, sizeof *place, by_error);
	const double best = count > 0 ? fmin(place[0].error, s->known.error) : 0;

	for (int n = 0; n < count && kept < stage->most; n++) {
		bool repeats = isfinite(s->known.error) && near(s, &place[n], &s->known);

		for (int m = 0; m < kept && !repeats; m++)
			repeats = near(s, &place[n], &place[m]);
		if (!repeats && place[n].error <= (1 + stage->margin) * best)
			place[kept++] = place[n];
	}
	return kept;
}

/* Refines the places on one level's table one after the other; the calling thread leads, the others of its team help
 * with the passes. */
static enum status refine_in_turn(struct search *s, int level, struct place *place, int count, struct found *found)
{
	struct objective o;
	enum status status =
		objective_init(&o, &s->levels->table[level], s->options, s->class, s->options->threads, MASKING_COARSE);

	if (status != STATUS_OK)
		return status;
	for (int n = 0; n < count && status == STATUS_OK; n++)
		status = refine(s, &o, &stages[level], &place[n], &found->limited);
	if (level == SEARCH_LEVELS - 1)
		found->passes += o.passes;
	objective_free(&o);
	return status;
}

/* The same, one place a thread. */
static enum status refine_at_once(struct search *s, int level, struct place *place, int count)
{
	enum status status = STATUS_OK;

#pragma omp parallel num_threads(s->options->threads) if (s->options->threads > 1)
	{
		struct objective o;
		enum status mine =
			objective_init(&o, &s->levels->table[level], s->options, s->class, 1, MASKING_COARSE);
		const bool ready = mine == STATUS_OK;

#pragma omp for schedule(dynamic)
		for (int n = 0; n < count; n++) {
			bool limited;

			if (mine == STATUS_OK && !cancelled(s))
				mine = refine(s, &o, &stages[level], &place[n], &limited);
		}
		if (ready)
			objective_free(&o);
		if (mine != STATUS_OK)
#pragma omp critical
			status = mine;
	}
	return status;
}

/* Refines the places on a thinned table, whichever way keeps the threads busy. */
static enum status refine_all(struct search *s, int level, struct place *place, int count, struct found *found)
{
	enum status status = STATUS_OK;

	if (count >= s->options->threads || level == 0)
		return refine_at_once(s, level, place, count);
#pragma omp parallel num_threads(s->options->threads)
#pragma omp single
	status = refine_in_turn(s, level, place, count, found);
	return status;
}

/* Ends on the full table: refines the places, then solves for kd and ks of the best one to a certified optimum. */
static enum status finish_in_turn(struct search *s, struct place *place, int count, struct found *found)
{
	const int full = SEARCH_LEVELS - 1;
	struct objective o;
	enum status status = STATUS_OK;

	begin_stage(s, stages[full].name);
	found->limited = false;
	if (s->dims > 0)
		status = refine_in_turn(s, full, place, count, found);
	qsort(place, (size_t)count, sizeof *place, by_error);
	if (status == STATUS_OK)
		status = objective_init(&o, &s->levels->table[full], s->options, s->class, s->options->threads,
					MASKING_FINE);
	if (status != STATUS_OK)
		return status;
	found->shape = shape_at(s, place[0].x);
	objective_eval(&o, &found->shape, 1e-7, true, &found->linear);
	note(s, &found->shape, found->linear.error);
	found->passes += o.passes;
	objective_free(&o);
	return STATUS_OK;
}

static enum status finish(struct search *s, struct place *place, int count, struct found *found)
{
	enum status status = STATUS_OK;

#pragma omp parallel num_threads(s->options->threads) if (s->options->threads > 1)
#pragma omp single
	status = finish_in_turn(s, place, count, found);
	return status;
}

/* The next number in [0, 1) of the sequence splitmix64 (Steele et al. 2014). */
static double next_uniform(uint64_t *state)
{
	uint64_t z = *state += 0x9e3779b97f4a7c15u;

	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

/* Random places, uniform in the coordinates. They start on the second table, which the scan has not seen: a valley that
 * the coarsest one hides can still be found. */
static void random_places(const struct search *s, struct place place[], int count)
{
	uint64_t state = s->options->seed;

	for (int n = 0; n < count; n++)
		for (int d = 0; d < s->dims; d++)
			place[n].x[d] = s->lo[d] + (s->hi[d] - s->lo[d]) * next_uniform(&state);
}

/* How many of place[from .. count - 1] are within 0.1 % of the best of all, the known one included. */
static int agreeing(const struct search *s, const struct place place[], int from, int count)
{
	double best = s->known.error;
	int agree = 0;

	for (int n = 0; n < count; n++)
		best = fmin(best, place[n].error);
	for (int n = from; n < count; n++)
		agree += place[n].error <= 1.001 * best;
	return agree;
}

/* The places to start from: the valleys of a scan. Returns how many, 0 on failure. */
static int first_places(struct search *s, struct place place[], enum status *status)
{
	struct place *grid = calloc((size_t)grid_size(s, 0), sizeof *grid);
	int count = 0;

	begin_stage(s, "scan");
	*status = grid ? scan(s, grid) : STATUS_NO_MEMORY;
	if (*status == STATUS_OK) {
		count = pick_starts(s, grid, place);
		if (count < 0)
			*status = STATUS_NO_MEMORY;
	}
	free(grid);
	return *status == STATUS_OK ? count : 0;
}

/* Runs the stages on the thinned tables. Returns how many places are left for the full one, best first. */
static int descend(struct search *s, struct place place[], int count, struct found *found, enum status *status)
{
	const int n_random = s->options->starts;

	for (int level = 0; level < SEARCH_LEVELS - 1 && *status == STATUS_OK; level++) {
		int from = 0;

		if (level > 0)
			from = count = thin_out(s, place, count, &stages[level]);
		if (level == 1) {
			random_places(s, place + count, n_random);
			count += n_random;
		}
		begin_stage(s, stages[level].name);
		if (count > 0)
			*status = refine_all(s, level, place, count, found);
		if (level <= 1)
			found->starts_agreeing += agreeing(s, place, from, count);
	}
	return *status == STATUS_OK ? thin_out(s, place, count, &stages[SEARCH_LEVELS - 1]) : 0;
}

static struct search new_search(const struct levels *levels, const struct fit_options *options,
				const struct ndf_class *class)
{
	struct search s = {.levels = levels,
			   .options = options,
			   .class = class,
			   .known = {.error = INFINITY},
			   .begin_s = search_clock()};

	setup(&s);
	return s;
}

enum status search_run(const struct levels *levels, const struct fit_options *options, const struct ndf_class *class,
		       struct found *found)
{
	struct search s = new_search(levels, options, class);
	struct place *place = calloc(MOST_STARTS + (size_t)options->starts + 1, sizeof *place);
	enum status status = place ? STATUS_OK : STATUS_NO_MEMORY;
	int count = 1;

	*found = (struct found){.starts = 1, .starts_agreeing = s.dims == 0};
	if (s.dims > 0 && status == STATUS_OK) {
		count = first_places(&s, place, &status);
		found->starts = count + options->starts;
		count = descend(&s, place, count, found, &status);
	}
	if (status == STATUS_OK)
		status = finish(&s, place, count, found);
	free(place);
	found->evaluations = s.evaluations;
	return cancelled(&s) ? STATUS_INTERRUPTED : status;
}

enum status search_estimate(const struct levels *levels, const struct fit_options *options,
			    const struct ndf_class *class, double *error)
{
	struct search s = new_search(levels, options, class);
	struct place place[MOST_STARTS + 1] = {{.error = 0}};
	struct found found = {.starts = 0};
	enum status status = STATUS_OK;
	int count = s.dims > 0 ? first_places(&s, place, &status) : 1;

	for (int level = 0; level < 2 && status == STATUS_OK && s.dims > 0; level++) {
		if (level > 0)
			count = thin_out(&s, place, count, &stages[level]);
		status = refine_all(&s, level, place, count, &found);
	}
	*error = INFINITY;
	for (int n = 0; n < count && s.dims > 0; n++)
		*error = fmin(*error, place[n].error);
	return cancelled(&s) ? STATUS_INTERRUPTED : status;
}

enum status search_from(const struct levels *levels, const struct fit_options *options, const struct ndf_class *class,
			const struct shape given[], int n_given, const struct shape *known, double error,
			struct found *found)
{
	struct fit_options own = *options;
	struct search s;
	struct place place[SEARCH_GIVEN];
	enum status status = STATUS_OK;

	own.starts = 0;
	s = new_search(levels, &own, class);
	place_of(&s, known, s.known.x);
	s.known.error = error;
	*found = (struct found){.starts = n_given, .linear.error = INFINITY};
	for (int n = 0; n < n_given; n++)
		place_of(&s, &given[n], place[n].x);
	const int count = descend(&s, place, n_given, found, &status);

	if (count > 0 && status == STATUS_OK)
		status = finish(&s, place, count, found);
	found->evaluations = s.evaluations;
	return cancelled(&s) ? STATUS_INTERRUPTED : status;
}
