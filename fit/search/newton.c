/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/newton.h"
#include "fit/error/gradient.h"
#include "fit/error/least_distance.h"
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

/* Lengths are in spacings of the scan's grid. */
struct newton {
	const struct space *space;
	struct objective *objective;
	const struct local_settings *settings;
	local_report *report;
	void *user;
	struct gradient gradient;
	double slope[SPACE_DIMS], second[SPACE_DIMS][SPACE_DIMS]; /* of E at the best point */
	struct space_point best;
	gsl_eigen_symmv_workspace *work;
	double tolerance; /* to which kd and ks are known there */
	double radius;
	int evaluations;
};

/* Where a gradient was taken. */
struct place {
	struct space_point point;
	double slope[SPACE_DIMS], tolerance;
};

static double spacing_of(const struct newton *w, int d)
{
	return local_spacing(w->space->coordinate[d]);
}

/* So far from a point, in spacings, stands what tells its derivative. Nearer, rounding would show, farther, curvature. */
#define NEAR 3e-4

static enum status evaluate(struct newton *w, double tolerance, struct place *at)
{
	const struct space *space = w->space;
	const struct shape shape = space_shape(space, at->point.x);
	struct shape near[SPACE_DIMS];
	double step[SPACE_DIMS], change[SPACE_DIMS];

	at->tolerance = tolerance;
	at->point.error = objective_eval(w->objective, &shape, tolerance, false, &at->point.linear);
	w->evaluations++;
	if (w->report)
		w->report(w->user, &shape, &at->point.linear);
	for (int d = 0; d < space->dims; d++) {
		double x[SPACE_DIMS];

		memcpy(x, at->point.x, sizeof x);
		step[d] = NEAR * spacing_of(w, d);
		if (x[d] + step[d] > space->hi[d])
			step[d] = -step[d];
		x[d] += step[d];
		near[d] = space_shape(space, x);
	}
	const enum status status = gradient_changes(&w->gradient, &at->point.linear, near, change);

	for (int d = 0; d < space->dims; d++)
		at->slope[d] = status == STATUS_OK ? change[d] / step[d] * spacing_of(w, d) : 0;
	return status == STATUS_NO_MEMORY ? status : STATUS_OK;
}

static void take(struct newton *w, const struct place *at)
{
	w->best = at->point;
	w->tolerance = at->tolerance;
	memcpy(w->slope, at->slope, sizeof w->slope);
}

/* The correction of rank one that makes the second derivatives explain how the slope changes over a step, unless it is so short
 * that all may come from kd and ks, which are not known better than to a tolerance: the slope then is to its square root. */
static void learn(struct newton *w, const double step[], const struct place *at)
{
	const int n = w->space->dims;
	const double *to = at->slope;
	double left[SPACE_DIMS], product = 0, length = 0, size = 0, steepest = 0;

	for (int i = 0; i < n; i++)
		steepest = fmax(steepest, fabs(w->second[i][i]));
	const double shortest = 10 * sqrt(2 * fmax(w->tolerance, at->tolerance) * w->best.error / steepest);

	for (int i = 0; i < n; i++) {
		left[i] = to[i] - w->slope[i];
		for (int j = 0; j < n; j++)
			left[i] -= w->second[i][j] * step[j];
		product += left[i] * step[i];
		length += step[i] * step[i];
		size += left[i] * left[i];
	}
	if (!(length > shortest * shortest && fabs(product) > 1e-3 * sqrt(length * size)))
		return;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			w->second[i][j] += left[i] * left[j] / product;
}

/* The second derivatives by differences of gradients. A better point on the way is not lost. */
static enum status differences(struct newton *w, double tolerance)
{
	const int n = w->space->dims;
	const struct place start = {.point = w->best, .tolerance = w->tolerance};
	double from[SPACE_DIMS], raw[SPACE_DIMS][SPACE_DIMS] = {{0}};
	struct place better = start;
	enum status status = STATUS_OK;

	memcpy(from, w->slope, sizeof from);
	memcpy(better.slope, w->slope, sizeof from);
	for (int d = 0; d < n && status == STATUS_OK; d++) {
		struct place at = start;
		double step = w->settings->step;

		/* Downhill, where there is room. */
		if (from[d] > 0)
			step = -step;
		if (at.point.x[d] + step * spacing_of(w, d) > w->space->hi[d] ||
		    at.point.x[d] + step * spacing_of(w, d) < w->space->lo[d])
			step = -step;
		at.point.x[d] += step * spacing_of(w, d);
		status = evaluate(w, tolerance, &at);
		for (int e = 0; e < n; e++)
			raw[d][e] = (at.slope[e] - from[e]) / step;
		if (at.point.error < better.point.error)
			better = at;
	}
	for (int d = 0; d < n; d++)
		for (int e = 0; e < n; e++)
			w->second[d][e] = 0.5 * (raw[d][e] + raw[e][d]);
	take(w, &better);
	return status;
}

/* The quadratic form in its principal directions; curvatures that are negative, or next to nothing, count as positive: what is
 * uphill of nothing but a saddle is left. Returns whether all were positive, so that the model has a least value. */
static bool principal(const struct newton *w, double value[], double vector[][SPACE_DIMS])
{
	const size_t n = (size_t)w->space->dims;
	double a[SPACE_DIMS * SPACE_DIMS], v[SPACE_DIMS * SPACE_DIMS], largest = 0;
	gsl_matrix_view form = gsl_matrix_view_array(a, n, n), vectors = gsl_matrix_view_array(v, n, n);
	gsl_vector_view values = gsl_vector_view_array(value, n);
	bool convex = true;

	for (size_t i = 0; i < n; i++)
		for (size_t j = 0; j < n; j++)
			gsl_matrix_set(&form.matrix, i, j, w->second[i][j]);
	gsl_eigen_symmv(&form.matrix, &values.vector, &vectors.matrix, w->work);
	for (size_t i = 0; i < n; i++)
		largest = fmax(largest, fabs(value[i]));
	for (size_t i = 0; i < n; i++) {
		convex = convex && value[i] > 0;
		value[i] = fmax(fabs(value[i]), fmax(1e-6 * largest, 1e-12));
		for (size_t j = 0; j < n; j++)
			vector[i][j] = v[j * n + i];
	}
	return convex;
}

static double largest_of(const double step[], int n)
{
	double largest = 0;

	for (int d = 0; d < n; d++)
		largest = fmax(largest, fabs(step[d]));
	return largest;
}

/* The least of the quadratic model in the box: *step, and what it promises. *free: the model is convex there, and the trust region
 * does not hold the step back, so that it promises all there is. */
static double model_step(const struct newton *w, double step[], bool *free)
{
	const int n = w->space->dims;
	double value[SPACE_DIMS], vector[SPACE_DIMS][SPACE_DIMS], gain = 0;
	struct least_distance p = {.dims = n};

	*free = principal(w, value, vector);
	for (int k = 0; k < n; k++) {
		double along = 0;

		for (int d = 0; d < n; d++)
			along += vector[k][d] * w->slope[d];
		p.z[k] = -along / sqrt(value[k]);
	}
	for (int d = 0; d < n; d++) {
		const double down = fmax((w->space->lo[d] - w->best.x[d]) / spacing_of(w, d), -w->radius),
			     up = fmin((w->space->hi[d] - w->best.x[d]) / spacing_of(w, d), w->radius);

		for (int k = 0; k < n; k++) {
			p.normal[p.n_rows][k] = vector[k][d] / sqrt(value[k]);
			p.normal[p.n_rows + 1][k] = -p.normal[p.n_rows][k];
		}
		p.level[p.n_rows++] = down;
		p.level[p.n_rows++] = -up;
	}
	least_distance_solve(&p);
	for (int d = 0; d < n; d++) {
		step[d] = 0;
		for (int k = 0; k < n; k++)
			step[d] += vector[k][d] / sqrt(value[k]) * p.z[k];
		gain -= w->slope[d] * step[d];
	}
	for (int k = 0; k < n; k++)
		gain -= 0.5 * p.z[k] * p.z[k];
	*free = *free && largest_of(step, n) < 0.99 * w->radius;
	return gain;
}

/* How well kd and ks are solved for where a step promises `gain`, relative to E: what they miss is to matter less than the step. */
static double inner_tolerance(const struct newton *w, double gain)
{
	return fmax(0.1 * w->settings->tolerance, fmin(0.03 * gain, 1e-4));
}

static enum status iterate(struct newton *w, double *gain, bool *free)
{
	const int n = w->space->dims;
	double step[SPACE_DIMS] = {0};

	*gain = model_step(w, step, free);
	if (!(*gain > w->settings->tolerance * w->best.error))
		return STATUS_OK;
	struct place at = {.point = w->best};
	const double longest = largest_of(step, n);

	for (int d = 0; d < n; d++)
		at.point.x[d] = fmin(fmax(w->best.x[d] + step[d] * spacing_of(w, d), w->space->lo[d]), w->space->hi[d]);
	const enum status status = evaluate(w, inner_tolerance(w, *gain), &at);
	const double success = (w->best.error - at.point.error) / *gain;

	if (status != STATUS_OK)
		return status;
	learn(w, step, &at);
	if (success < 0.25)
		w->radius = 0.3 * longest;
	else if (success > 0.7 && longest > 0.9 * w->radius)
		w->radius *= 2.5;
	if (success > 0)
		take(w, &at);
	return STATUS_OK;
}

static bool is_known(const struct space_point *point)
{
	for (int i = 0; i < SPACE_SECOND; i++)
		if (point->curvature[i] != 0)
			return true;
	return false;
}

static void unpack(struct newton *w, const struct space_point *point)
{
	for (int i = 0, at = 0; i < w->space->dims; i++)
		for (int j = i; j < w->space->dims; j++)
			w->second[i][j] = w->second[j][i] = (double)point->curvature[at++];
}

static void pack(const struct newton *w, struct space_point *point)
{
	for (int i = 0, at = 0; i < w->space->dims; i++)
		for (int j = i; j < w->space->dims; j++)
			point->curvature[at++] = (float)w->second[i][j];
}

/* A step this short, in spacings, is none. */
#define SHORTEST 1e-5

static enum status descend(struct newton *w, const struct space_point *start, bool *converged)
{
	struct place at = {.point = *start};
	const bool known = is_known(start);
	const double first = known ? 0.1 * w->settings->tolerance : fmax(0.1 * w->settings->tolerance, 1e-6);
	enum status status = evaluate(w, first, &at);

	take(w, &at);
	if (status == STATUS_OK && known)
		unpack(w, start);
	else if (status == STATUS_OK)
		status = differences(w, first);
	while (status == STATUS_OK && w->evaluations < w->settings->evaluations && w->radius > SHORTEST &&
	       !fit_cancelled(w->objective->options)) {
		double gain;
		bool free;

		status = iterate(w, &gain, &free);
		if (!(gain > w->settings->tolerance * w->best.error)) {
			*converged = free;
			break;
		}
	}
	return status;
}

enum status newton_descend(const struct space *space, struct objective *o, const struct local_settings *settings,
			   local_report *report, void *user, struct space_point *point, bool *converged)
{
	struct newton w = {.space = space,
			   .objective = o,
			   .settings = settings,
			   .report = report,
			   .user = user,
			   .radius = 3 * settings->step};
	enum status status = gradient_init(&w.gradient, o, space->dims, o->density);

	*converged = false;
	if (status != STATUS_OK)
		return status;
	w.work = gsl_eigen_symmv_alloc((size_t)space->dims);
	if (w.work) {
		objective_begin(o, &point->linear);
		status = descend(&w, point, converged);
		gsl_eigen_symmv_free(w.work);
		*point = w.best;
		pack(&w, point);
	} else {
		status = STATUS_NO_MEMORY;
	}
	gradient_free(&w.gradient);
	return status;
}
