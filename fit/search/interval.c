/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/interval.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What E may be above the best in any case: E near 0 is rounding. */
#define LEAST_ALLOWED 1e-6
/* How near to what is allowed E is met, as a share of it: on the sample, and on the full table. */
#define MET_SAMPLE 0.02
#define MET_FULL 0.01

enum {
	WALK_LEVEL = 1,
	MINIMA_MAX = 6, /* local minima that a parameter is moved from */
	WALK_STEPS = 100,
	ROOT_STEPS = 12,
	FULL_STEPS = 4,
};

const char *interval_parameter_name(enum interval_parameter parameter)
{
	static const char *const name[] = {"sigma",  "gamma",  "ior",   "k",    "exponent",
					   "sigma2", "gamma2", "ratio", "angle"};

	return name[parameter];
}

/* What the profiles of all parameters share. */
struct profile_context {
	const struct multiresolution *multiresolution;
	const struct fit_options *options;
	const struct ndf_class *class;
	struct space space, searched; /* of a conductor in n and k, and as it was searched */
	struct shape best;
	double allowed;                       /* increase of E, relative */
	double full;                          /* E of *best on the full table */
	double least;                         /* and the least one of the sample */
	struct shape minimum[MINIMA_MAX + 1]; /* of the sample; the first one is *best */
	int n_minima;
	struct scan_minima *scan;
	_Atomic long evaluations;
};

/* The profile of one parameter: a dimension of the space. */
struct profile {
	struct profile_context *context;
	int d;
	double spacing; /* of the scan's grid */
	struct objective sample, full;
};

/* A point of a profile: the best shape found with the parameter at coordinate x. */
struct profile_point {
	double x;
	struct shape shape;
	struct linear linear;
	double rise; /* of E on the sample, in units of what is allowed */
};

static void count(void *user, const struct shape *shape, const struct linear *linear)
{
	struct profile_context *c = user;

	(void)shape;
	(void)linear;
	c->evaluations++;
}

static double rise_above(const struct profile_context *c, double error, double least)
{
	return (error - least) / fmax(c->allowed * least, LEAST_ALLOWED);
}

static double x_of(const struct profile *p, struct shape shape)
{
	const struct space *s = &p->context->space;

	return space_x(s, p->d, *space_parameter(s, p->d, &shape));
}

/* The space with the parameter fixed. sigma is the NDF's own, not that of STD which may stand for it in the space. */
static struct space fixed_space(const struct profile *p, double value)
{
	const struct profile_context *c = p->context;
	struct space space = c->space;

	if (space.coordinate[p->d] == COORDINATE_SIGMA) {
		struct fit_options options = *c->options;

		options.sigma = value;
		space_init(&space, &options, c->class);
	} else {
		space_fix(&space, p->d, value);
	}
	return space;
}

/* The best shape with the parameter at coordinate x, sought from a shape near by. */
static enum status refit(struct profile *p, double x, const struct shape *near, const struct linear *linear,
			 struct profile_point *to)
{
	static const struct local_settings settings = {NLOPT_LN_SBPLX, 0.05, 1e-5, 80, false, 0};
	struct profile_context *c = p->context;
	const struct space space = fixed_space(p, space_value(&c->space, p->d, x));
	struct space_point point = {.linear = *linear};
	enum status status = STATUS_OK;

	space_from_shape(&space, near, point.x);
	if (space.dims > 0)
		status = local_descend(&space, &p->sample, &settings, count, c, &point, NULL);
	to->x = x;
	to->shape = space_shape(&space, point.x);
	if (space.dims == 0) {
		point.error = objective_eval(&p->sample, &to->shape, 1e-6, false, &point.linear);
		c->evaluations++;
	}
	to->linear = point.linear;
	to->rise = rise_above(c, point.error, c->least);
	return status == STATUS_OK && fit_cancelled(c->options) ? STATUS_INTERRUPTED : status;
}

/* Where the other parameters go on to, from two points of a profile: along the line through both. */
static struct shape led_on(const struct profile *p, const struct profile_point *before,
			   const struct profile_point *last, double x)
{
	const struct space *s = &p->context->space;
	double a[SPACE_DIMS], b[SPACE_DIMS];
	const double share = last->x != before->x ? (x - last->x) / (last->x - before->x) : 0;

	space_from_shape(s, &before->shape, a);
	space_from_shape(s, &last->shape, b);
	for (int d = 0; d < s->dims; d++)
		b[d] = fmin(fmax(b[d] + share * (b[d] - a[d]), s->lo[d]), s->hi[d]);
	return space_shape(s, b);
}

/* The values inside a bracket at which E rises by what is allowed: of *in it rises by less, of *out by more. */
static enum status find_root(struct profile *p, struct profile_point *in, struct profile_point *out)
{
	enum status status = STATUS_OK;
	double f_in = in->rise - 1, f_out = out->rise - 1;

	for (int n = 0; n < ROOT_STEPS && status == STATUS_OK; n++) {
		/* Regula falsi in Illinois' form, not too near to either end. */
		const double share = fmin(fmax(f_in / (f_in - f_out), 0.02), 0.98);
		const double x = in->x + share * (out->x - in->x);
		const struct shape near = led_on(p, in, out, x);
		struct profile_point at;

		status = refit(p, x, &near, &in->linear, &at);
		if (at.rise > 1) {
			*out = at;
			f_out = at.rise - 1;
			f_in *= 0.5;
		} else {
			*in = at;
			f_in = at.rise - 1;
			f_out *= 0.5;
		}
		if (fabs(at.rise - 1) <= MET_SAMPLE)
			break;
	}
	return status;
}

/* How far E of the full table rises at the shape of a point. */
static double full_rise(struct profile *p, const struct profile_point *at)
{
	struct linear linear;

	objective_begin(&p->full, &at->linear);
	p->context->evaluations++;
	return rise_above(p->context, objective_eval(&p->full, &at->shape, 1e-7, false, &linear), p->context->full);
}

/* Moves the end of an interval to where the full table has it. */
static enum status settle(struct profile *p, struct profile_point *end, double slope, double reach)
{
	enum status status = STATUS_OK;
	const struct space *s = &p->context->space;
	double rise = full_rise(p, end);

	for (int n = 0; n < FULL_STEPS && fabs(rise - 1) > MET_FULL && status == STATUS_OK; n++) {
		const double step = fmin(fmax((1 - rise) / slope, -0.25 * reach), 0.25 * reach);
		const double x = fmin(fmax(end->x + step, s->lo[p->d]), s->hi[p->d]);
		const struct profile_point before = *end;
		const double rise_before = rise;

		status = refit(p, x, &before.shape, &before.linear, end);
		rise = full_rise(p, end);
		if ((rise - rise_before) * (x - before.x) * slope > 0)
			slope = (rise - rise_before) / (x - before.x);
	}
	return status;
}

/* Where a walk ends: an angle has been everywhere after a quarter turn both ways. */
static double end_of_domain(const struct profile *p, double start, int direction)
{
	const struct space *s = &p->context->space;

	if (s->coordinate[p->d] == COORDINATE_ANGLE)
		return start + 90 * direction;
	return direction < 0 ? s->lo[p->d] : s->hi[p->d];
}

/* One end of the interval around *start, in direction -1 or 1; *open: the end of the domain is inside. */
static enum status find_end(struct profile *p, const struct profile_point *start, int direction,
			    struct profile_point *end, bool *open)
{
	const double bound = end_of_domain(p, start->x, direction);
	struct profile_point before = *start, in = *start, out;
	double step = 0.1 * p->spacing;
	enum status status = STATUS_OK;

	*open = false;
	*end = *start;
	for (int n = 0; n < WALK_STEPS && status == STATUS_OK; n++) {
		if (in.x == bound) {
			*open = true;
			*end = in;
			return status;
		}
		const double x = direction < 0 ? fmax(in.x - step, bound) : fmin(in.x + step, bound);
		const struct shape near = led_on(p, &before, &in, x);

		status = refit(p, x, &near, &in.linear, &out);
		if (out.rise > 1)
			break;
		before = in;
		in = out;
		step = fmin(2 * step, p->spacing);
	}
	if (status == STATUS_OK && out.rise > 1)
		status = find_root(p, &in, &out);
	if (status != STATUS_OK)
		return status;
	*end = in;
	const double slope = out.x != in.x ? (out.rise - in.rise) / (out.x - in.x) : direction * HUGE_VAL;

	return settle(p, end, slope, fabs(end->x - start->x));
}

/* The value at an end; a gamma whose domain goes on to inf ends there. */
static double end_value(const struct profile *p, double x, bool open, int direction)
{
	const struct space *s = &p->context->space;
	const double value = space_value(s, p->d, x);

	if (s->coordinate[p->d] == COORDINATE_STRETCH)
		return exp(value);
	if ((s->coordinate[p->d] == COORDINATE_GAMMA || s->coordinate[p->d] == COORDINATE_SECOND_GAMMA) && open &&
	    direction > 0 && isinf(ndf_param_at(p->context->class, 1)->max))
		return INFINITY;
	return value;
}

/* The interval around a local minimum. */
static enum status interval_around(struct profile *p, const struct shape *minimum, struct interval *interval)
{
	static const struct linear none = {.error = 0};
	struct profile_point start, end;
	enum status status = refit(p, x_of(p, *minimum), minimum, &none, &start);

	*interval = (struct interval){NAN, NAN, false, false};
	if (status != STATUS_OK || (start.rise > 1 && minimum != p->context->minimum))
		return status;
	status = find_end(p, &start, -1, &end, &interval->lo_open);
	if (status != STATUS_OK)
		return status;
	interval->lo = end_value(p, end.x, interval->lo_open, -1);
	status = find_end(p, &start, 1, &end, &interval->hi_open);
	interval->hi = end_value(p, end.x, interval->hi_open, 1);
	return status;
}

static bool overlap(const struct interval *a, const struct interval *b)
{
	return a->lo <= b->hi && b->lo <= a->hi;
}

static void unite(struct interval *into, const struct interval *other)
{
	if (other->lo < into->lo) {
		into->lo = other->lo;
		into->lo_open = other->lo_open;
	}
	if (other->hi > into->hi) {
		into->hi = other->hi;
		into->hi_open = other->hi_open;
	}
}

/* Makes one of the first two that overlap, in the place of the former. Returns whether there were any. */
static bool unite_one(struct interval_list *list)
{
	for (int j = 1; j < list->n; j++)
		for (int i = 0; i < j; i++)
			if (overlap(&list->at[i], &list->at[j])) {
				unite(&list->at[i], &list->at[j]);
				list->n--;
				memmove(&list->at[j], &list->at[j + 1], (size_t)(list->n - j) * sizeof list->at[0]);
				return true;
			}
	return false;
}

static int by_place(const void *a, const void *b)
{
	const struct interval *p = a, *q = b;

	return (p->lo > q->lo) - (p->lo < q->lo);
}

static void add_interval(struct interval_list *list, const struct interval *interval)
{
	if (list->n == INTERVALS_MAX)
		return;
	list->at[list->n++] = *interval;
	bool united;

	do
		united = unite_one(list);
	while (united);
	if (list->n > 1)
		qsort(&list->at[1], (size_t)list->n - 1, sizeof list->at[0], by_place);
}

static bool covers(const struct interval_list *list, double value)
{
	for (int i = 0; i < list->n; i++)
		if (value >= list->at[i].lo && value <= list->at[i].hi)
			return true;
	return false;
}

/* What the scan has seen at values of the parameter that lie in no interval yet, and is so good that E may come down to what
 * is allowed: the grid is coarse. */
static enum status add_from_scan(struct profile *p, struct interval_list *list)
{
	/* A fifth is what the scan may be above the bottom of its valley. */
	static const double coarse = 1.2;
	struct profile_context *c = p->context;
	const struct axis *axis = &c->space.axis[p->d];
	const double enough = coarse * (c->least + fmax(c->allowed * c->least, LEAST_ALLOWED));
	enum status status = STATUS_OK;

	for (int i = 0; i < axis->count && status == STATUS_OK; i++) {
		const struct space_point *slice = &c->scan->slice[p->d][i];
		const struct shape shape = space_shape(&c->searched, slice->x);
		struct interval interval;

		if (slice->error > enough || covers(list, axis->value[i]))
			continue;
		status = interval_around(p, &shape, &interval);
		if (status == STATUS_OK && !isnan(interval.lo))
			add_interval(list, &interval);
	}
	return status;
}

static enum status open_profile(struct profile *p)
{
	const struct profile_context *c = p->context;
	enum status status = objective_init(&p->sample, &c->multiresolution->table[WALK_LEVEL], c->options, c->class, 1,
					    MASKING_COARSE);

	if (status != STATUS_OK)
		return status;
	status = objective_init(&p->full, &c->multiresolution->table[SEARCH_LEVELS - 1], c->options, c->class, 1,
				MASKING_FINE);
	if (status != STATUS_OK)
		objective_free(&p->sample);
	return status;
}

/* Of lobes and axes another valley is the same fit with them changed over. */
static bool has_other_valleys(const struct profile *p)
{
	const enum coordinate coordinate = p->context->space.coordinate[p->d];

	return p->context->options->lobes < 2 && coordinate != COORDINATE_STRETCH && coordinate != COORDINATE_ANGLE;
}

/* The axes by their ratio and angle. Both keep the place of the coordinate that they take: the scan has nothing to say of either. */
static void use_ratio_and_angle(struct space *s)
{
	for (int d = 0; d < s->dims; d++)
		if (s->coordinate[d] == COORDINATE_STRETCH_COS) {
			s->coordinate[d] = COORDINATE_STRETCH;
		} else if (s->coordinate[d] == COORDINATE_STRETCH_SIN) {
			s->coordinate[d] = COORDINATE_ANGLE;
			s->lowest[d] = s->lo[d] = -360; /* no end is where it may be */
			s->highest[d] = s->hi[d] = 360;
		}
}

/* The intervals of dimension d of the space. */
static enum status find_intervals(struct profile_context *c, int d, struct interval_list *list)
{
	struct profile p = {.context = c, .d = d, .spacing = local_spacing(c->space.coordinate[d])};
	enum status status = open_profile(&p);

	if (status != STATUS_OK)
		return status;
	const bool others = has_other_valleys(&p);

	for (int n = 0; n < (others ? c->n_minima : 1) && status == STATUS_OK; n++) {
		struct interval interval;

		status = interval_around(&p, &c->minimum[n], &interval);
		if (status == STATUS_OK && !isnan(interval.lo))
			add_interval(list, &interval);
	}
	/* The scan has seen no values of a conductor's n or k. */
	if (status == STATUS_OK && others && c->space.coordinate[d] == c->searched.coordinate[d])
		status = add_from_scan(&p, list);
	objective_free(&p.full);
	objective_free(&p.sample);
	return status;
}

/* Which parameter a dimension of the space is; INTERVAL_PARAMETERS: none that is told of. */
static enum interval_parameter parameter_of(enum coordinate coordinate)
{
	switch (coordinate) {
	case COORDINATE_SIGMA:
		return INTERVAL_SIGMA;
	case COORDINATE_GAMMA:
		return INTERVAL_GAMMA;
	case COORDINATE_IOR:
		return INTERVAL_IOR;
	case COORDINATE_K:
		return INTERVAL_K;
	case COORDINATE_GRAZING:
		return INTERVAL_EXPONENT;
	case COORDINATE_SECOND_SIGMA:
		return INTERVAL_SIGMA2;
	case COORDINATE_SECOND_GAMMA:
		return INTERVAL_GAMMA2;
	case COORDINATE_STRETCH:
		return INTERVAL_RATIO;
	case COORDINATE_ANGLE:
		return INTERVAL_ANGLE;
	default:
		return INTERVAL_PARAMETERS;
	}
}

/* The local minima of the sample, and E there. */
static enum status find_minima(struct profile_context *c)
{
	struct space_point point[MINIMA_MAX];
	struct objective o;
	struct linear linear;
	int n = 0;
	enum status status = STATUS_OK;

	if (c->options->lobes < 2)
		status = search_minima(c->multiresolution, c->options, c->class, WALK_LEVEL, c->allowed, point,
				       MINIMA_MAX, &n, c->scan, &c->evaluations);
	if (status == STATUS_OK)
		status = objective_init(&o, &c->multiresolution->table[WALK_LEVEL], c->options, c->class, 1,
					MASKING_COARSE);
	if (status != STATUS_OK)
		return status;
	c->least = objective_eval(&o, &c->best, 1e-6, false, &linear);
	objective_free(&o);
	c->minimum[c->n_minima++] = c->best;
	for (int i = 0; i < n; i++) {
		c->least = fmin(c->least, point[i].error);
		c->minimum[c->n_minima++] = space_shape(&c->searched, point[i].x);
	}
	return STATUS_OK;
}

enum status interval_find(const struct multiresolution *multiresolution, const struct fit_options *options,
			  const struct ndf_class *class, const struct shape *best, double error, double percent,
			  struct interval_list list[INTERVAL_PARAMETERS], long *evaluations)
{
	struct profile_context c = {.multiresolution = multiresolution,
				    .options = options,
				    .class = class,
				    .best = *best,
				    .allowed = 0.01 * percent,
				    .full = error};

	memset(list, 0, INTERVAL_PARAMETERS * sizeof *list);
	if (ndf_is_tabulated(class))
		return STATUS_OK;
	space_init(&c.searched, options, class);
	c.space = c.searched;
	space_plain_index(&c.space);
	if (c.space.dims == 0)
		return STATUS_OK;
	c.scan = calloc(1, sizeof *c.scan);
	enum status status = c.scan ? find_minima(&c) : STATUS_NO_MEMORY;
	const int dims = status == STATUS_OK ? c.space.dims : 0;

	use_ratio_and_angle(&c.space);
#pragma omp parallel for num_threads(options->threads) schedule(dynamic) if (options->threads > 1)
	for (int d = 0; d < dims; d++) {
		const enum interval_parameter parameter = parameter_of(c.space.coordinate[d]);
		const enum status mine =
			parameter < INTERVAL_PARAMETERS ? find_intervals(&c, d, &list[parameter]) : STATUS_OK;

		if (mine != STATUS_OK)
#pragma omp critical(interval_status)
			status = mine;
	}
	free(c.scan);
	*evaluations += c.evaluations;
	return status;
}
