/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/bundle.h"
#include "fit/error/least_distance.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* The curvature's window at first. */
#define WINDOW 0.1
/* Newton steps without success before something else is tried. */
enum { FAILURES = 2 };
/* Evaluations after which a solve ends wherever it is. */
enum { EVALUATIONS_MAX = 400 };
/* The caller adds floats, in short runs: a relative error of an error or a slope, at most. */
#define ROUNDING 2e-7

static double dot(const double a[], const double b[], int n)
{
	double sum = 0;

	for (int i = 0; i < n; i++)
		sum += a[i] * b[i];
	return sum;
}

static double clamp(double x, double lo, double hi)
{
	return x < lo ? lo : x > hi ? hi : x;
}

/* Some second derivative is known. */
static bool is_curved(const struct bundle *b)
{
	double trace = 0;

	for (int i = 0; i < b->domain.n; i++)
		trace += b->h[i][i];
	return trace > 0 && isfinite(trace);
}

static void set_second(struct bundle *b, const double second[])
{
	for (int i = 0, at = 0; i < b->domain.n; i++)
		for (int j = i; j < b->domain.n; j++, at++)
			b->h[i][j] = b->h[j][i] = second ? second[at] : 0;
}

void bundle_second(const struct bundle *b, double second[])
{
	for (int i = 0, at = 0; i < b->domain.n; i++)
		for (int j = i; j < b->domain.n; j++, at++)
			second[at] = b->h[i][j];
}

/* Moves x to the nearest point that keeps the linear constraints, if there are any, and to a float. */
static void make_feasible(struct bundle *b)
{
	const struct bundle_domain *domain = &b->domain;
	struct least_distance p = {.dims = domain->n};

	for (int k = 0; k < domain->n_linear; k++) {
		for (int i = 0; i < domain->n; i++)
			p.normal[p.n_rows][i] = -domain->normal[k][i];
		p.level[p.n_rows++] = -domain->level[k];
	}
	for (int i = 0; i < domain->n; i++) {
		p.normal[p.n_rows][i] = 1;
		p.level[p.n_rows++] = domain->lo[i];
		p.normal[p.n_rows][i] = -1;
		p.level[p.n_rows++] = -domain->hi[i];
		p.z[i] = b->x[i];
	}
	if (domain->n_linear > 0)
		least_distance_solve(&p);
	for (int i = 0; i < domain->n; i++)
		b->x[i] = clamp((double)(float)p.z[i], domain->lo[i], domain->hi[i]);
}

void bundle_start(struct bundle *b, const struct bundle_domain *domain, const double start[], const double second[],
		  double scale, double tolerance, bool certify)
{
	b->domain = *domain;
	b->scale = scale;
	b->tolerance = tolerance;
	b->certify = certify;
	b->error = b->gap = INFINITY;
	b->lower_bound = 0;
	b->evaluations = b->failed = b->nears = b->n_cuts = 0;
	b->done = b->snapped = false;
	b->cold = !start;
	set_second(b, second);
	b->tau = is_curved(b) ? 0 : WINDOW;
	for (int i = 0; i < domain->n; i++)
		b->x[i] = start ? start[i] : domain->lo[i];
	/* The table is evaluated in float: ask only at floats. */
	if (start)
		make_feasible(b);
	memcpy(b->best, b->x, sizeof b->best);
}

/* By how much rounding may have lifted a cut where the best point is. A cut from afar, where the error is many times the
 * scale, would else rule the minimum out. */
static double lifted(const struct bundle *b, const struct bundle_cut *cut)
{
	double sum = fabs(cut->error - b->error);

	for (int i = 0; i < b->domain.n; i++)
		sum += fabs(cut->slope[i] * (cut->x[i] - b->best[i]));
	return ROUNDING * sum;
}

/* The value of a cut at a point, less what rounding may have lifted it. */
static double cut_at(const struct bundle *b, const struct bundle_cut *cut, const double x[])
{
	double value = cut->error - lifted(b, cut);

	for (int i = 0; i < b->domain.n; i++)
		value += cut->slope[i] * (x[i] - cut->x[i]);
	return value;
}

/* Coordinates about the best point in which the second derivatives are the identity: u = L^T d with H = L L^T over the variables that
 * are free, errors counted in `unit`. */
struct whitened {
	int n, variable[BUNDLE_VARIABLES];
	double unit, l[BUNDLE_VARIABLES][BUNDLE_VARIABLES];
};

/* A variable of which others explain all but this share is taken as independent of those that follow: what is left of its
 * second derivatives may be rounding. */
#define ALONE 1e-9

static struct whitened whiten(const struct bundle *b, double unit)
{
	struct whitened w = {.unit = unit};
	bool alone[BUNDLE_VARIABLES];

	for (int i = 0; i < b->domain.n; i++)
		if (b->domain.hi[i] > b->domain.lo[i])
			w.variable[w.n++] = i;
	for (int i = 0; i < w.n; i++) {
		const int vi = w.variable[i];
		const double width = b->domain.hi[vi] - b->domain.lo[vi];
		/* A variable that nothing tells of is as wide as its box. */
		const double diagonal = fmax(b->h[vi][vi] / unit, 0) + 1e-6 / (width * width);

		for (int j = 0; j < i; j++)
			w.l[i][j] =
				alone[j] ? 0 : (b->h[vi][w.variable[j]] / unit - dot(w.l[i], w.l[j], j)) / w.l[j][j];
		const double left = diagonal - dot(w.l[i], w.l[i], i), least = ALONE * diagonal;

		alone[i] = left < least;
		w.l[i][i] = sqrt(fmax(left, least));
	}
	return w;
}

/* L^-1 of a slope. */
static void slope_to_white(const struct whitened *w, const double slope[], double out[])
{
	for (int i = 0; i < w->n; i++)
		out[i] = (slope[w->variable[i]] - dot(w->l[i], out, i)) / w->l[i][i];
}

/* L^-T u: a step, of all variables. */
static void step_from_white(const struct whitened *w, const double u[], double step[])
{
	double d[BUNDLE_VARIABLES];

	memset(step, 0, BUNDLE_VARIABLES * sizeof *step);
	for (int i = w->n - 1; i >= 0; i--) {
		d[i] = u[i];
		for (int j = i + 1; j < w->n; j++)
			d[i] -= w->l[j][i] * d[j];
		d[i] /= w->l[i][i];
		step[w->variable[i]] = d[i];
	}
}

/* Adds normal . d >= level. */
static void add_row(struct least_distance *p, const struct whitened *w, const double normal[], double level)
{
	slope_to_white(w, normal, p->normal[p->n_rows]);
	for (int i = w->n; i < p->dims; i++)
		p->normal[p->n_rows][i] = 0;
	p->level[p->n_rows++] = level;
}

/* The rows of the domain: first lo and hi of each free variable, then the linear ones. */
static void add_domain(struct least_distance *p, const struct whitened *w, const struct bundle *b)
{
	const struct bundle_domain *domain = &b->domain;

	for (int i = 0; i < w->n; i++) {
		const int v = w->variable[i];
		double axis[BUNDLE_VARIABLES] = {0};

		axis[v] = 1;
		add_row(p, w, axis, domain->lo[v] - b->best[v]);
		axis[v] = -1;
		add_row(p, w, axis, b->best[v] - domain->hi[v]);
	}
	for (int k = 0; k < domain->n_linear; k++) {
		double normal[BUNDLE_VARIABLES];

		for (int i = 0; i < domain->n; i++)
			normal[i] = -domain->normal[k][i];
		/* The best point may lie outside by its rounding to floats. */
		add_row(p, w, normal, fmin(dot(domain->normal[k], b->best, domain->n) - domain->level[k], 0));
	}
}

/* The least of slope . d + d H d / 2 over the domain, d from the best point: 0 or less. */
static double newton_step(const struct bundle *b, double step[])
{
	const struct whitened w = whiten(b, b->scale);
	struct least_distance p = {.dims = w.n};
	double slope[BUNDLE_VARIABLES], least = 0;

	slope_to_white(&w, b->slope, slope);
	for (int i = 0; i < w.n; i++)
		p.z[i] = -slope[i] / b->scale;
	add_domain(&p, &w, b);
	least_distance_solve(&p);
	for (int i = 0; i < w.n; i++)
		least += p.z[i] * (slope[i] / b->scale + 0.5 * p.z[i]);
	step_from_white(&w, p.z, step);
	return least * b->scale;
}

/* What the multipliers of a solved problem prove: a convex combination of the cuts, and of the linear constraints what is
 * their due, is a plane below the function; its least value in the box. */
static double proven(const struct bundle *b, const struct whitened *w, const struct least_distance *p)
{
	const struct bundle_domain *domain = &b->domain;
	const double *linear = p->multiplier + 2 * w->n, *cuts = linear + domain->n_linear;
	double plane[BUNDLE_VARIABLES] = {0}, value = 0, sum = 0;

	for (int n = 0; n < b->n_cuts; n++)
		sum += cuts[n];
	if (!(sum > 0))
		return 0;
	for (int n = 0; n < b->n_cuts; n++) {
		const double share = cuts[n] / sum;

		value += share * cut_at(b, &b->cut[n], b->best);
		for (int i = 0; i < domain->n; i++)
			plane[i] += share * b->cut[n].slope[i];
	}
	for (int k = 0; k < domain->n_linear; k++) {
		const double due = linear[k] / sum * w->unit;

		value -= due * (domain->level[k] - dot(domain->normal[k], b->best, domain->n));
		for (int i = 0; i < domain->n; i++)
			plane[i] += due * domain->normal[k][i];
	}
	for (int i = 0; i < domain->n; i++)
		value += fmin(plane[i] * (domain->lo[i] - b->best[i]), plane[i] * (domain->hi[i] - b->best[i]));
	return value;
}

/* The least of the cuts plus hold d H d / 2 over the domain. Returns a bound of the function, below which it is not. */
static double bundle_step(const struct bundle *b, double hold, double unit, double step[])
{
	/* The cuts' own level is a variable too. Its square is added, small: all that is sought lies within a few units. */
	const double level_weight = 1e-2;
	const struct whitened w = whiten(b, unit / hold);
	struct least_distance p = {.dims = w.n + 1};

	add_domain(&p, &w, b);
	for (int n = 0; n < b->n_cuts; n++) {
		const struct bundle_cut *cut = &b->cut[n];
		double normal[BUNDLE_VARIABLES];

		for (int i = 0; i < b->domain.n; i++)
			normal[i] = -cut->slope[i] / unit;
		add_row(&p, &w, normal, (cut_at(b, cut, b->best) - b->error) / unit);
		p.normal[p.n_rows - 1][w.n] = 1 / level_weight;
	}
	p.z[w.n] = -1 / level_weight;
	least_distance_solve(&p);
	step_from_white(&w, p.z, step);
	return proven(b, &w, &p);
}

/* Next to nothing of the second derivatives: what is left is the least of the cuts. */
#define HARDLY 1e-8

/* How far the least of the cuts may be below the best point: the unit of errors there. */
static double unit_of_cuts(const struct bundle *b)
{
	return fmax(b->error - b->lower_bound, 0.01 * b->tolerance * b->scale);
}

static void prove(struct bundle *b)
{
	const double unit = unit_of_cuts(b);

	if (unit > 0) {
		double step[BUNDLE_VARIABLES];

		b->lower_bound = fmax(bundle_step(b, HARDLY, unit, step), b->lower_bound);
	}
	b->lower_bound = fmin(b->lower_bound, b->error);
	b->gap = b->error - b->lower_bound;
}

/* Whether every cut leaves room at x for a value below the best. */
static bool promising(const struct bundle *b, const double x[])
{
	for (int n = 0; n < b->n_cuts; n++)
		if (cut_at(b, &b->cut[n], x) >= b->error)
			return false;
	return true;
}

/* A best that all but touches an end of the box is evaluated once more on it: bounds reached are reported. */
static bool snap(struct bundle *b)
{
	bool moved = false;

	if (b->snapped)
		return false;
	b->snapped = true;
	for (int i = 0; i < b->domain.n; i++) {
		const double lo = b->domain.lo[i], hi = b->domain.hi[i], near = 1e-6 * fmin(hi - lo, 1);

		b->x[i] = b->best[i] - lo < near ? lo : hi - b->best[i] < near ? hi : b->best[i];
		moved |= b->x[i] != b->best[i];
	}
	for (int k = 0; k < b->domain.n_linear; k++)
		moved &= dot(b->domain.normal[k], b->x, b->domain.n) <= b->domain.level[k];
	return moved;
}

/* Rounds a point to floats in the box. Returns whether that brings anything new. */
static bool is_new(const struct bundle *b, const double step[], double x[])
{
	bool moved = false, elsewhere = false;

	for (int i = 0; i < b->domain.n; i++) {
		x[i] = clamp((double)(float)(b->best[i] + step[i]), b->domain.lo[i], b->domain.hi[i]);
		moved |= x[i] != b->best[i];
		elsewhere |= x[i] != b->x[i];
	}
	return moved && elsewhere;
}

/* Sets the next point: Newton's, which promises `gain`, or one that the cuts propose. Returns whether there is one. */
static bool propose(struct bundle *b, const double newton[], double gain)
{
	const double unit = unit_of_cuts(b);
	double x[BUNDLE_VARIABLES], step[BUNDLE_VARIABLES];
	const bool near = b->certify && gain <= b->tolerance * b->scale;

	if (!near && is_curved(b) && b->failed <= FAILURES && is_new(b, newton, x) && promising(b, x)) {
		memcpy(b->x, x, sizeof x);
		return true;
	}
	/* The longer it takes, the more the cuts alone decide. */
	const int fading = near ? b->nears++ : b->failed;

	for (double hold = ldexp(1, -fading); hold > 0.1 * HARDLY; hold *= 1e-2) {
		bundle_step(b, hold, unit, step);
		if (is_new(b, step, x)) {
			memcpy(b->x, x, sizeof x);
			return true;
		}
	}
	return false;
}

/* Corrects the second derivatives so that they explain how the slope changes from the best point to this one (the update
 * of Broyden, Fletcher, Goldfarb and Shanno with Powell's damping): a kink in between becomes a steep curve. But nothing
 * becomes steeper over a step that matters no more than some tolerances: near enough to it, a kink is infinitely steep
 * and would hide how far the minimum may still be. */
static void learn(struct bundle *b, const double slope[])
{
	const int n = b->domain.n;
	double s[BUNDLE_VARIABLES], hs[BUNDLE_VARIABLES], y[BUNDLE_VARIABLES];

	for (int i = 0; i < n; i++) {
		s[i] = b->x[i] - b->best[i];
		y[i] = slope[i] - b->slope[i];
	}
	for (int i = 0; i < n; i++)
		hs[i] = dot(b->h[i], s, n);
	double ys = dot(y, s, n);
	const double shs = dot(s, hs, n), least = 0.2 * shs;

	if (b->evaluations == 0 || !(shs > 0) || (ys > shs && ys <= 30 * b->tolerance * b->scale))
		return;
	if (ys < least) {
		const double part = (shs - least) / (shs - ys);

		for (int i = 0; i < n; i++)
			y[i] = part * y[i] + (1 - part) * hs[i];
		ys = least;
	}
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			b->h[i][j] += y[i] * y[j] / ys - hs[i] * hs[j] / shs;
}

/* The cut that is furthest below the best point goes first. */
static int place_for_cut(const struct bundle *b)
{
	double least = INFINITY;
	int at = 0;

	if (b->n_cuts < BUNDLE_CUTS)
		return b->n_cuts;
	for (int n = 0; n < b->n_cuts; n++) {
		const double value = cut_at(b, &b->cut[n], b->best);

		if (value < least) {
			least = value;
			at = n;
		}
	}
	return at;
}

/* Returns whether the point is the best so far. */
static bool add_cut(struct bundle *b, double error, const double slope[])
{
	const size_t size = sizeof(double) * (size_t)b->domain.n;
	const int at = place_for_cut(b);
	struct bundle_cut *cut = &b->cut[at];

	memcpy(cut->x, b->x, size);
	memcpy(cut->slope, slope, size);
	cut->error = error;
	if (at == b->n_cuts)
		b->n_cuts++;
	if (!(error < b->error || (b->snapped && error == b->error)))
		return false;
	b->error = error;
	memcpy(b->best, b->x, size);
	memcpy(b->slope, slope, size);
	return true;
}

/* At x = lo, all but nothing, the slopes are the sums of the terms. A term that comes to more than twice what is measured
 * is worse than none: where the box goes far beyond that, the error at its far end would have no digit left for what is
 * sought, and it is cut off. A first guess gives the first term and the others shares of what is measured. */
static void guess(struct bundle *b, double error, const double slope[])
{
	b->cold = false;
	for (int i = 0; i < b->domain.n; i++) {
		const double whole = slope[i] < 0 ? -error / slope[i] : INFINITY;
		const double share = i == 0 ? 0.3 : 0.5 / (b->domain.n - 1);

		if (2 * whole < BUNDLE_FAR * b->domain.hi[i])
			b->domain.hi[i] = fmax(2 * whole, b->domain.lo[i]);
		b->x[i] = isfinite(whole) ? share * whole : b->domain.lo[i];
	}
	make_feasible(b);
}

void bundle_update(struct bundle *b, double error, const double slope[], const double second[])
{
	double step[BUNDLE_VARIABLES];

	if (b->tau > 0)
		set_second(b, second);
	else
		learn(b, slope);
	const bool improved = add_cut(b, error, slope);

	b->evaluations++;
	if (b->cold) {
		guess(b, error, slope);
		return;
	}
	b->tau = is_curved(b) ? 0 : WINDOW;
	b->failed = improved ? 0 : b->failed + 1;
	const double gain = -newton_step(b, step), enough = b->tolerance * b->scale;

	/* Newton's estimate is of use where the best point is evaluated; elsewhere only the cuts can tell. */
	if (!b->certify && is_curved(b) && improved)
		b->gap = gain;
	else if (gain <= enough || !improved)
		prove(b);
	if (b->gap <= enough || b->evaluations >= EVALUATIONS_MAX || b->snapped || !propose(b, step, gain)) {
		b->done = !snap(b);
		if (b->done && b->certify)
			prove(b);
	}
}
