/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/search.h"
#include "fit/search/newton.h"
#include "fit/search/valley.h"
#include "src/splitmix.h"
#include <math.h>
#include <nlopt.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Slots of the thinned tables. Systematic samples this small estimate E to about 0.1, 0.03 and 0.003 %. */
static const int level_samples[SEARCH_LEVELS - 1] = {3000, 12000, 60000};

enum status multiresolution_init(struct multiresolution *multiresolution, struct sample_set *full)
{
	enum status status = STATUS_OK;

	*multiresolution = (struct multiresolution){0};
	multiresolution->table[SEARCH_LEVELS - 1] = *full;
	*full = (struct sample_set){0};
	for (int l = SEARCH_LEVELS - 2; l >= 0 && status == STATUS_OK; l--)
		status = sample_set_thin(&multiresolution->table[l], &multiresolution->table[l + 1], level_samples[l]);
	if (status != STATUS_OK)
		multiresolution_free(multiresolution);
	return status;
}

void multiresolution_free(struct multiresolution *multiresolution)
{
	for (int l = 0; l < SEARCH_LEVELS; l++)
		sample_set_free(&multiresolution->table[l]);
}

struct search {
	const struct multiresolution *multiresolution;
	const struct fit_options *options;
	const struct ndf_class *class;
	struct space space;
	_Atomic long evaluations;
	struct space_point known; /* found before and in need of beating; its error is INFINITY when there is none */
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
static void report(void *user, const struct shape *shape, const struct linear *linear)
{
	struct search *s = user;
	const double error = linear->error;

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
	return fit_cancelled(s->options);
}

static long grid_size(const struct search *s, int from)
{
	long size = 1;

	for (int d = from; d < s->space.dims; d++)
		size *= s->space.axis[d].count;
	return size;
}

static void grid_point(const struct search *s, long index, struct space_point *point)
{
	for (int d = s->space.dims - 1; d >= 0; d--) {
		const struct axis *a = &s->space.axis[d];

		point->x[d] = space_x(&s->space, d, a->value[index % a->count]);
		index /= a->count;
	}
}

/* Evaluates the grid on the coarsest table. Neighbours along the last axes share G1 and begin the inner solve where
 * the one before ended; a stretch of the grid begins afresh, so the result does not depend on the threads. */
static enum status scan(struct search *s, struct space_point *grid)
{
	const long total = grid_size(s, 0);
	const int first_ior = s->space.dims > 0 && s->space.coordinate[0] == COORDINATE_SIGMA
				      ? 1 + (s->space.dims > 1 && s->space.coordinate[1] == COORDINATE_GAMMA)
				      : 0;
	const long stretch = grid_size(s, first_ior);
	enum status status = STATUS_OK;

#pragma omp parallel num_threads(s->options->threads) if (s->options->threads > 1)
	{
		struct objective o;
		enum status mine =
			objective_init(&o, &s->multiresolution->table[0], s->options, s->class, 1, MASKING_COARSE);

#pragma omp for schedule(dynamic)
		for (long n = 0; n < total; n += stretch) {
			if (mine != STATUS_OK || cancelled(s))
				continue;
			objective_forget(&o);
			for (long i = n; i < n + stretch; i++) {
				grid_point(s, i, &grid[i]);
				const struct shape shape = space_shape(&s->space, grid[i].x);

				grid[i].error = objective_eval(&o, &shape, 2e-3, false, &grid[i].linear);
				report(s, &shape, &grid[i].linear);
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

/* Whether no neighbour in the grid is better; of a plateau only the first point counts. */
static bool is_local_minimum(const struct search *s, const struct space_point *grid, long index)
{
	long step = 1;

	for (int d = s->space.dims - 1; d >= 0; d--) {
		const int count = s->space.axis[d].count, at = (int)(index / step % count);

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
	const struct space_point *p = a, *q = b;

	if (p->error != q->error)
		return p->error < q->error ? -1 : 1;
	return memcmp(p->x, q->x, sizeof p->x);
}

enum { STARTS_MAX = 24, FIRST_POINTS_MAX = STARTS_MAX + SPACE_VALUES };

/* The local minima of the grid, best first. Returns how many, at most STARTS_MAX. */
static int pick_starts(const struct search *s, struct space_point *grid, struct space_point starts[])
{
	const long total = grid_size(s, 0);
	long n_minima = 0;
	struct space_point *minimum = malloc((size_t)total * sizeof *minimum);

	if (!minimum)
		return -1;
	for (long n = 0; n < total; n++)
		if (is_local_minimum(s, grid, n))
			minimum[n_minima++] = grid[n];
	qsort(minimum, (size_t)n_minima, sizeof *minimum, by_error);
	const int count = n_minima < STARTS_MAX ? (int)n_minima : STARTS_MAX;

	memcpy(starts, minimum, (size_t)count * sizeof *starts);
	free(minimum);
	return count;
}

/* How a level is searched. */
struct stage {
	const char *name;
	int max_points;                    /* points that go on from the level before, at most */
	double margin;                     /* those whose error is within this of the best, relative */
	struct local_settings by_gradient; /* newton.h's; no evaluations: without */
	struct local_settings settings;
};
/* On the smallest table, whose error is rugged, the simplex method is the one that gets through. The others are smooth to their
 * tolerances, and what one level has learnt of the second derivatives holds for the next: on the full table two or three
 * evaluations are left. Where the gradient is of no use, a quadratic model of values needs the fewest there. Where the valley is
 * long and flat, it takes its time: the error has to be the least to 1e-6, whatever rounding does. */
static const struct stage stages[SEARCH_LEVELS] = {
	{"thin-1", 0, 0, {.evaluations = 0}, {NLOPT_LN_SBPLX, 0.7, 2e-4, 150, false, 0}},
	{"thin-2",
	 8,
	 0.02,
	 {.step = 0.3, .tolerance = 3e-5, .evaluations = 25},
	 {NLOPT_LN_SBPLX, 0.3, 3e-5, 150, false, 0}},
	{"thin-3",
	 4,
	 3e-3,
	 {.step = 0.2, .tolerance = 1e-6, .evaluations = 25},
	 {NLOPT_LN_SBPLX, 0.2, 1e-6, 250, false, 0}},
	{"full",
	 2,
	 1e-4,
	 {.step = 0.05, .tolerance = 1e-7, .evaluations = 25},
	 {NLOPT_LN_BOBYQA, 0.01, 3e-7, 400, true, 0}},
};

/* E below which a table is all but free of noise, and above which a search of such a table is not at its end. */
#define NOISE_FREE 0.01
#define NEXT_TO_NOTHING 1e-6

static bool near(const struct search *s, const struct space_point *a, const struct space_point *b)
{
	for (int d = 0; d < s->space.dims; d++)
		if (fabs(a->x[d] - b->x[d]) >= 0.01 * (s->space.hi[d] - s->space.lo[d]))
			return false;
	return true;
}

/* Places too near a better one to lead anywhere else go; so do those too far behind the best. What has been found before
 * counts as one of them. Returns how many stay. */
static int thin_out(const struct search *s, struct space_point *point, int count, const struct stage *stage)
{
	int kept = 0;

	qsort(point, (size_t)count, sizeof *point, by_error);
	const double best = count > 0 ? fmin(point[0].error, s->known.error) : 0;

	for (int n = 0; n < count && kept < stage->max_points; n++) {
		bool repeats = isfinite(s->known.error) && near(s, &point[n], &s->known);

		for (int m = 0; m < kept && !repeats; m++)
			repeats = near(s, &point[n], &point[m]);
		if (!repeats && point[n].error <= (1 + stage->margin) * best)
			point[kept++] = point[n];
	}
	return kept;
}

/* Where E is smooth about its least, its gradient leads there: not where E is next to nothing, nor on a sample so small that
 * the kink each entry makes shows. Where that does not end on the full table, a search without gradients follows. */
static bool is_smooth(const struct objective *o, const struct space_point *point)
{
	const bool few = o->table->scattered && o->table->n_samples <= OBJECTIVE_EXACT_SAMPLES;

	return point->error > NOISE_FREE && !few;
}

static enum status refine(struct search *s, int level, struct objective *o, struct space_point *point, bool *limited)
{
	const struct stage *stage = &stages[level];

	if (stage->by_gradient.evaluations > 0 && is_smooth(o, point)) {
		bool converged = false;
		const enum status status =
			newton_descend(&s->space, o, &stage->by_gradient, report, s, point, &converged);

		if (level < SEARCH_LEVELS - 1 || converged || status != STATUS_OK)
			return status;
	}
	return local_descend(&s->space, o, &stage->settings, report, s, point, limited);
}

/* Up to so many scattered entries, the end of a search is without tables: it costs no more than the rest. */
enum { EXACT_SAMPLES = 4096 };

static bool has_few_entries(const struct search *s)
{
	const struct sample_set *full = &s->multiresolution->table[SEARCH_LEVELS - 1];

	return full->scattered && full->n_samples <= EXACT_SAMPLES;
}

/* Refines the points on one level's table one after the other; the calling thread leads, the others of its team help
 * with the passes. */
static enum status refine_in_turn(struct search *s, int level, struct space_point *point, int count,
				  struct found *found)
{
	const struct sample_set *table = &s->multiresolution->table[level];
	const bool exact = level == SEARCH_LEVELS - 1 && has_few_entries(s);
	struct objective o;
	enum status status = objective_init(&o, table, s->options, s->class, s->options->threads,
					    exact ? MASKING_FINE : MASKING_COARSE);

	if (status != STATUS_OK)
		return status;
	for (int n = 0; n < count && status == STATUS_OK; n++)
		status = refine(s, level, &o, &point[n], &found->limited);
	if (level == SEARCH_LEVELS - 1)
		found->passes += o.passes;
	objective_free(&o);
	return status;
}

/* The same, one point a thread. */
static enum status refine_at_once(struct search *s, int level, struct space_point *point, int count)
{
	enum status status = STATUS_OK;

#pragma omp parallel num_threads(s->options->threads) if (s->options->threads > 1)
	{
		struct objective o;
		enum status mine =
			objective_init(&o, &s->multiresolution->table[level], s->options, s->class, 1, MASKING_COARSE);
		const bool ready = mine == STATUS_OK;

#pragma omp for schedule(dynamic)
		for (int n = 0; n < count; n++) {
			if (mine == STATUS_OK && !cancelled(s))
				mine = refine(s, level, &o, &point[n], NULL);
		}
		if (ready)
			objective_free(&o);
		if (mine != STATUS_OK)
#pragma omp critical
			status = mine;
	}
	return status;
}

/* Refines the points on a thinned table, whichever way keeps the threads busy. */
static enum status refine_all(struct search *s, int level, struct space_point *point, int count, struct found *found)
{
	enum status status = STATUS_OK;

	if (count >= s->options->threads || level == 0)
		return refine_at_once(s, level, point, count);
#pragma omp parallel num_threads(s->options->threads)
#pragma omp single
	status = refine_in_turn(s, level, point, count, found);
	return status;
}

/* Where the search of such a table is stuck on the floor of a valley, leads it on: on the smallest sample, then on the
 * full table. Of few entries, noise makes the floor rugged. */
static enum status follow_valley(struct search *s, struct space_point *best, struct found *found)
{
	const bool limited = found->limited, smooth = best->error <= NOISE_FREE;
	const double stage_best = s->stage_best;
	struct space_point point = *best;
	struct objective o;
	enum status status;

	if (s->space.dims < 2 || !(smooth || has_few_entries(s)) || best->error < NEXT_TO_NOTHING)
		return STATUS_OK;
	status = objective_init(&o, &s->multiresolution->table[0], s->options, s->class, 1, MASKING_COARSE);
	if (status != STATUS_OK)
		return status;
	begin_stage(s, stages[0].name);
	status = valley_follow(&s->space, &o, report, s, &point);
	objective_free(&o);
	begin_stage(s, stages[SEARCH_LEVELS - 1].name);
	s->stage_best = stage_best;
	if (status == STATUS_OK)
		status = refine_in_turn(s, SEARCH_LEVELS - 1, &point, 1, found);
	if (status == STATUS_OK && point.error < best->error)
		*best = point;
	else
		found->limited = limited;
	return status;
}

/* Ends on the full table: refines the points, then solves for kd and ks of the best one to a certified optimum. */
static enum status finish_in_turn(struct search *s, struct space_point *point, int count, struct found *found)
{
	const int full = SEARCH_LEVELS - 1;
	struct objective o;
	enum status status = STATUS_OK;

	begin_stage(s, stages[full].name);
	found->limited = false;
	if (s->space.dims > 0)
		status = refine_in_turn(s, full, point, count, found);
	qsort(point, (size_t)count, sizeof *point, by_error);
	if (status == STATUS_OK)
		status = follow_valley(s, &point[0], found);
	if (status == STATUS_OK)
		status = objective_init(&o, &s->multiresolution->table[full], s->options, s->class, s->options->threads,
					MASKING_FINE);
	if (status != STATUS_OK)
		return status;
	found->shape = space_shape(&s->space, point[0].x);
	objective_begin(&o, &point[0].linear);
	objective_eval(&o, &found->shape, 1e-7, true, &found->linear);
	report(s, &found->shape, &found->linear);
	found->passes += o.passes;
	objective_free(&o);
	return STATUS_OK;
}

static enum status finish(struct search *s, struct space_point *point, int count, struct found *found)
{
	enum status status = STATUS_OK;

#pragma omp parallel num_threads(s->options->threads) if (s->options->threads > 1)
#pragma omp single
	status = finish_in_turn(s, point, count, found);
	return status;
}

/* Random points, uniform in the coordinates. They start on the second table, which the scan has not seen: a valley that
 * the coarsest one hides can still be found. */
static void random_points(const struct search *s, struct space_point point[], int count)
{
	uint64_t state = s->options->seed;

	for (int n = 0; n < count; n++) {
		point[n] = (struct space_point){.error = 0};
		for (int d = 0; d < s->space.dims; d++)
			point[n].x[d] = s->space.lo[d] + (s->space.hi[d] - s->space.lo[d]) * splitmix_uniform(&state);
	}
}

/* How many of point[from .. count - 1] are within 0.1 % of the best of all, the known one included. */
static int agreeing(const struct search *s, const struct space_point point[], int from, int count)
{
	double best = s->known.error;
	int agree = 0;

	for (int n = 0; n < count; n++)
		best = fmin(best, point[n].error);
	for (int n = from; n < count; n++)
		agree += point[n].error <= 1.001 * best;
	return agree;
}

/* The best point of each slice of the grid. */
static void note_slices(const struct search *s, const struct space_point *grid, struct scan_minima *minima)
{
	const long total = grid_size(s, 0);

	for (int d = 0; d < s->space.dims; d++) {
		const int count = s->space.axis[d].count;
		const long step = grid_size(s, d + 1);

		for (int i = 0; i < count; i++)
			minima->slice[d][i].error = INFINITY;
		for (long n = 0; n < total; n++) {
			struct space_point *best = &minima->slice[d][n / step % count];

			if (grid[n].error < best->error)
				*best = grid[n];
		}
	}
}

/* How far above the best of a scan the best of an index still counts. */
#define BETWEEN 1.1

/* Adds points between the indices of the scan: from one of them to the next F changes its form, and a minimum between two
 * may look like a slope. There the other parameters are those of the better of both. Returns how many points there are. */
static int add_between(const struct search *s, const struct scan_minima *minima, struct space_point point[], int count)
{
	const double enough = BETWEEN * (count > 0 ? point[0].error : 0);

	for (int d = 0; d < s->space.dims; d++)
		for (int i = 0; space_is_of_ior(&s->space, d) && i + 1 < s->space.axis[d].count; i++) {
			const struct space_point *low = &minima->slice[d][i], *high = low + 1;
			const struct space_point *better = low->error < high->error ? low : high;

			if (better->error > enough)
				continue;
			point[count] = *better;
			point[count++].x[d] = 0.5 * (low->x[d] + high->x[d]);
		}
	return count;
}

/* How many dimensions come before those of n and k. */
static int dims_before_index(const struct space *space)
{
	int d = 0;

	while (d < space->dims && space->coordinate[d] != COORDINATE_LENGTH)
		d++;
	return d;
}

/* Of points that differ in n and k alone, those that all channels share, the best for each channel: with the rest of the shape
 * given, E is a sum of what each channel has. Where channels share ks, the best for all. */
static void join_channels(const struct search *s, const struct space_point point[], long count, int first,
			  struct space_point *joint)
{
	*joint = point[0];
	joint->error = 0;
	for (int c = 0; c < MERL_CHANNELS; c++) {
		const int problem = s->options->gray_specular ? 0 : c;
		const struct space_point *best = point;

		for (long n = 1; n < count; n++)
			if (point[n].linear.channel[problem] < best->linear.channel[problem])
				best = &point[n];
		memcpy(&joint->x[first + 2 * c], &best->x[first], 2 * sizeof best->x[0]);
		joint->linear.kd[c] = best->linear.kd[c];
		joint->linear.channel[c] = best->linear.channel[c];
		memcpy(joint->linear.coefficient[c], best->linear.coefficient[c], sizeof best->linear.coefficient[c]);
		memcpy(joint->linear.h[c], best->linear.h[c], sizeof best->linear.h[c]);
		joint->error += problem == c ? best->linear.channel[c] : 0;
	}
	joint->linear.error = joint->error;
	joint->linear.shape = space_shape(&s->space, joint->x);
}

/* The same where each channel has an n and k: the scan is of those that all share, and each channel takes its own from it. */
static int first_points_per_channel(struct search *s, struct space_point point[], struct scan_minima *minima,
				    enum status *status)
{
	struct fit_options options = *s->options;
	struct search shared = *s, outer = *s;

	options.per_channel_ior = false;
	shared.options = &options;
	space_init(&shared.space, &options, s->class);
	outer.space.dims = dims_before_index(&s->space);
	const long total = grid_size(&shared, 0), each = grid_size(&shared, outer.space.dims);
	struct space_point *grid = calloc((size_t)total, sizeof *grid);

	begin_stage(&shared, "scan");
	*status = grid ? scan(&shared, grid) : STATUS_NO_MEMORY;
	int count = 0;

	if (*status == STATUS_OK) {
		for (long n = 0; n < total; n += each) {
			struct space_point joint;

			join_channels(s, &grid[n], each, outer.space.dims, &joint);
			grid[n / each] = joint;
		}
		note_slices(&outer, grid, minima);
		count = pick_starts(&outer, grid, point);
		if (count < 0)
			*status = STATUS_NO_MEMORY;
	}
	s->evaluations = shared.evaluations;
	free(grid);
	return *status == STATUS_OK ? count : 0;
}

/* The points to start from: the local minima of a scan, and some between its points. Returns how many, at most
 * FIRST_POINTS_MAX; 0 on failure. */
static int first_points(struct search *s, struct space_point point[], struct scan_minima *minima, enum status *status)
{
	if (s->space.per_channel)
		return first_points_per_channel(s, point, minima, status);
	struct space_point *grid = calloc((size_t)grid_size(s, 0), sizeof *grid);
	int count = 0;

	begin_stage(s, "scan");
	*status = grid ? scan(s, grid) : STATUS_NO_MEMORY;
	if (*status == STATUS_OK) {
		note_slices(s, grid, minima);
		count = pick_starts(s, grid, point);
		if (count < 0)
			*status = STATUS_NO_MEMORY;
		else
			count = add_between(s, minima, point, count);
	}
	free(grid);
	return *status == STATUS_OK ? count : 0;
}

/* Runs the stages on the thinned tables, from one of them on. Returns how many points are left for the full one, best
 * first. */
static int descend(struct search *s, int first_level, struct space_point point[], int count, struct found *found,
		   enum status *status)
{
	for (int level = first_level; level < SEARCH_LEVELS - 1 && *status == STATUS_OK; level++) {
		if (level > first_level)
			count = thin_out(s, point, count, &stages[level]);
		begin_stage(s, stages[level].name);
		if (count > 0)
			*status = refine_all(s, level, point, count, found);
		if (level == first_level)
			found->starts_agreeing += agreeing(s, point, 0, count);
	}
	return *status == STATUS_OK ? thin_out(s, point, count, &stages[SEARCH_LEVELS - 1]) : 0;
}

static struct search new_search(const struct multiresolution *multiresolution, const struct fit_options *options,
				const struct ndf_class *class)
{
	struct search s = {.multiresolution = multiresolution,
			   .options = options,
			   .class = class,
			   .known = {.error = INFINITY},
			   .begin_s = search_clock()};

	space_init(&s.space, options, class);
	return s;
}

/* The random starts come after the search, which they can only improve. */
static enum status search_random(struct search *s, struct space_point point[], struct found *found)
{
	const int n_random = s->options->starts;
	struct found other = {.linear.error = INFINITY};
	enum status status = STATUS_OK;

	space_from_shape(&s->space, &found->shape, s->known.x);
	s->known.error = found->linear.error;
	random_points(s, point, n_random);
	const int count = descend(s, 1, point, n_random, &other, &status);

	if (count > 0 && status == STATUS_OK)
		status = finish(s, point, count, &other);
	found->starts += n_random;
	found->starts_agreeing += other.starts_agreeing;
	found->passes += other.passes;
	if (status == STATUS_OK && other.linear.error < found->linear.error) {
		found->shape = other.shape;
		found->linear = other.linear;
		found->limited = other.limited;
	}
	return status;
}

enum status search_run(const struct multiresolution *multiresolution, const struct fit_options *options,
		       const struct ndf_class *class, struct scan_minima *minima, struct found *found)
{
	struct search s = new_search(multiresolution, options, class);
	struct space_point *point = calloc(FIRST_POINTS_MAX + (size_t)options->starts, sizeof *point);
	enum status status = point ? STATUS_OK : STATUS_NO_MEMORY;
	int count = 1;

	*found = (struct found){.starts = 1, .starts_agreeing = s.space.dims == 0};
	if (s.space.dims > 0 && status == STATUS_OK) {
		count = first_points(&s, point, minima, &status);
		found->starts = count;
		count = descend(&s, 0, point, count, found, &status);
	}
	if (status == STATUS_OK)
		status = finish(&s, point, count, found);
	if (status == STATUS_OK && s.space.dims > 0 && options->starts > 0)
		status = search_random(&s, point, found);
	free(point);
	found->evaluations = s.evaluations;
	return cancelled(&s) ? STATUS_INTERRUPTED : status;
}

/* The error of the only shape of a space, on the sample that estimates end with. */
static enum status estimate_only_shape(const struct search *s, struct space_point *point)
{
	const struct shape shape = space_shape(&s->space, point->x);
	struct objective o;
	const enum status status =
		objective_init(&o, &s->multiresolution->table[1], s->options, s->class, 1, MASKING_COARSE);

	if (status != STATUS_OK)
		return status;
	point->error = objective_eval(&o, &shape, 1e-5, false, &point->linear);
	objective_free(&o);
	return STATUS_OK;
}

enum status search_estimate(const struct multiresolution *multiresolution, const struct fit_options *options,
			    const struct ndf_class *class, const struct shape given[], int n_given, struct shape *shape,
			    double *error)
{
	struct search s = new_search(multiresolution, options, class);
	struct space_point *point = calloc(FIRST_POINTS_MAX, sizeof *point);
	struct scan_minima *minima = calloc(1, sizeof *minima);
	struct found found = {.starts = 0};
	enum status status = point && minima ? STATUS_OK : STATUS_NO_MEMORY;
	int count = n_given > 0 ? n_given : 1, best = 0;

	for (int n = 0; n < n_given && status == STATUS_OK; n++)
		space_from_shape(&s.space, &given[n], point[n].x);
	if (status == STATUS_OK && s.space.dims == 0)
		status = estimate_only_shape(&s, point);
	else if (status == STATUS_OK && n_given == 0)
		count = first_points(&s, point, minima, &status);
	for (int level = 0; level < 2 && status == STATUS_OK && s.space.dims > 0; level++) {
		if (level > 0)
			count = thin_out(&s, point, count, &stages[level]);
		status = refine_all(&s, level, point, count, &found);
	}
	*error = INFINITY;
	for (int n = 1; n < count && status == STATUS_OK; n++)
		if (point[n].error < point[best].error)
			best = n;
	if (status == STATUS_OK && count > 0) {
		*error = point[best].error;
		*shape = space_shape(&s.space, point[best].x);
	}
	free(minima);
	free(point);
	if (status != STATUS_OK)
		return status;
	return cancelled(&s) ? STATUS_INTERRUPTED : status;
}

enum status search_minima(const struct multiresolution *multiresolution, const struct fit_options *options,
			  const struct ndf_class *class, int level, double margin, struct space_point minimum[],
			  int n_max, int *n, struct scan_minima *scan_minima, _Atomic long *evaluations)
{
	struct search s = new_search(multiresolution, options, class);
	struct space_point *point = calloc(FIRST_POINTS_MAX, sizeof *point);
	const struct stage last = {.max_points = n_max, .margin = margin};
	struct found found = {.starts = 0};
	enum status status = point ? STATUS_OK : STATUS_NO_MEMORY;
	int count = point ? first_points(&s, point, scan_minima, &status) : 0;

	for (int l = 0; l <= level && status == STATUS_OK; l++) {
		/* What the sample before is wrong about a difference of errors comes on top. */
		const struct stage stage = {.max_points = stages[l].max_points, .margin = margin + stages[l].margin};

		if (l > 0)
			count = thin_out(&s, point, count, &stage);
		status = refine_all(&s, l, point, count, &found);
	}
	*n = status == STATUS_OK ? thin_out(&s, point, count, &last) : 0;
	if (*n > 0)
		memcpy(minimum, point, (size_t)*n * sizeof *minimum);
	free(point);
	*evaluations += s.evaluations;
	return cancelled(&s) ? STATUS_INTERRUPTED : status;
}

enum status search_near(const struct multiresolution *multiresolution, const struct fit_options *options,
			const struct ndf_class *class, const struct shape *shape, double enough, double *error)
{
	const struct local_settings settings = {NLOPT_LN_SBPLX, 0.7, 1e-2, 40, false, enough};
	struct search s = new_search(multiresolution, options, class);
	struct space_point point = {.error = 0};
	struct objective o;
	enum status status = objective_init(&o, &multiresolution->table[0], options, class, 1, MASKING_COARSE);

	*error = INFINITY;
	if (status != STATUS_OK)
		return status;
	space_from_shape(&s.space, shape, point.x);
	if (s.space.dims > 0)
		status = local_descend(&s.space, &o, &settings, NULL, NULL, &point, NULL);
	if (status == STATUS_OK && s.space.dims > 0)
		*error = point.error;
	objective_free(&o);
	return status;
}

enum status search_from(const struct multiresolution *multiresolution, const struct fit_options *options,
			const struct ndf_class *class, const struct shape given[], int n_given,
			const struct shape *known, double error, struct found *found)
{
	struct fit_options own = *options;
	struct search s;
	enum status status = STATUS_OK;

	/* Of two lobes there is no search_run(), which would have them. */
	own.starts = options->lobes > 1 ? options->starts : 0;
	s = new_search(multiresolution, &own, class);
	struct space_point *point = calloc(SEARCH_GIVEN + (size_t)own.starts, sizeof *point);

	space_from_shape(&s.space, known, s.known.x);
	s.known.error = error;
	*found = (struct found){.starts = n_given, .linear.error = INFINITY};
	if (!point)
		return STATUS_NO_MEMORY;
	for (int n = 0; n < n_given; n++)
		space_from_shape(&s.space, &given[n], point[n].x);
	const int count = descend(&s, 0, point, n_given, found, &status);

	if (count > 0 && status == STATUS_OK)
		status = finish(&s, point, count, found);
	if (count > 0 && status == STATUS_OK && own.starts > 0)
		status = search_random(&s, point, found);
	free(point);
	found->evaluations = s.evaluations;
	return cancelled(&s) ? STATUS_INTERRUPTED : status;
}
