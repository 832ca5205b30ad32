/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/l1.h"
#include <math.h>
#include <string.h>

/* The curvature's window at first. */
#define WINDOW 0.1
/* Newton steps without success before something else is tried. */
enum { FAILURES = 2 };
/* Evaluations near the best point, to certify it, before one that cuts the feasible polygon; twice as far out each time. */
enum { NEARS = 4 };

static bool is_curved(const double h[3])
{
	return h[0] + h[2] > 0 && isfinite(h[0] + h[2]);
}

/* Clips the polygon to normal . (x - at) <= level. Returns the number of corners left. */
static int clip(double corner[][2], int n, const double normal[2], const double at[2], double level)
{
	double kept[L1_CORNERS][2];
	int count = 0;

	for (int a = 0; a < n && count + 2 < L1_CORNERS; a++) {
		const double *p = corner[a], *q = corner[(a + 1) % n];
		const double dp = normal[0] * (p[0] - at[0]) + normal[1] * (p[1] - at[1]) - level;
		const double dq = normal[0] * (q[0] - at[0]) + normal[1] * (q[1] - at[1]) - level;

		if (dp <= 0)
			memcpy(kept[count++], p, sizeof *kept);
		if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) {
			const double t = dp / (dp - dq);

			kept[count][0] = p[0] + t * (q[0] - p[0]);
			kept[count++][1] = p[1] + t * (q[1] - p[1]);
		}
	}
	memcpy(corner, kept, (size_t)count * sizeof *kept);
	return count;
}

static int rectangle(const double lo[2], const double hi[2], double corner[][2])
{
	const double x[4] = {lo[0], hi[0], hi[0], lo[0]};
	const double y[4] = {lo[1], lo[1], hi[1], hi[1]};

	for (int a = 0; a < 4; a++) {
		corner[a][0] = x[a];
		corner[a][1] = y[a];
	}
	return 4;
}

/* The caller adds floats, in short runs: a relative error of an error or a slope, at most. */
#define ROUNDING 2e-7

/* By how much rounding may have lifted a cut where the best point is. A cut from afar, where the error is many times the
 * scale, would else rule the minimum out. */
static double lifted(const struct l1 *l1, const struct l1_cut *cut)
{
	double sum = fabs(cut->error - l1->error);

	for (int a = 0; a < 2; a++)
		sum += fabs(cut->slope[a] * (cut->x[a] - l1->best[a]));
	return ROUNDING * sum;
}

/* Clips the polygon to where a cut allows a value of at most `level`. */
static int clip_cut(const struct l1 *l1, double corner[][2], int n, const struct l1_cut *cut, double level)
{
	return clip(corner, n, cut->slope, cut->x, level - cut->error + lifted(l1, cut));
}

/* The same for every cut. */
static int clip_level(const struct l1 *l1, double corner[][2], int n, double level)
{
	for (int a = 0; a < l1->n_cuts && n > 0; a++)
		n = clip_cut(l1, corner, n, &l1->cut[a], level);
	return n;
}

static void mean(const double corner[][2], int n, double x[2])
{
	x[0] = x[1] = 0;
	for (int a = 0; a < n; a++)
		for (int c = 0; c < 2; c++)
			x[c] += corner[a][c] / n;
}

/* The least value that the cuts allow in a rectangle, at most that of the best point; x: where. */
static double lowest(const struct l1 *l1, const double lo[2], const double hi[2], double x[2])
{
	double corner[L1_CORNERS][2], low = 0, high = l1->error, precise = 0.05 * l1->tolerance * l1->scale;

	memcpy(x, l1->best, sizeof l1->best);
	/* The largest level that some cut rules out everywhere, by bisection. */
	for (int step = 0; step < 60 && high - low > precise; step++) {
		const double level = 0.5 * (low + high);
		const int n = clip_level(l1, corner, rectangle(lo, hi, corner), level);

		if (n > 0) {
			high = level;
			mean(corner, n, x);
		} else {
			low = level;
		}
	}
	return low;
}

double l1_lower_bound(const struct l1 *l1)
{
	double x[2];

	return lowest(l1, l1->lo, l1->hi, x);
}

static double clamp(double x, double lo, double hi)
{
	return x < lo ? lo : x > hi ? hi : x;
}

void l1_start(struct l1 *l1, const double lo[2], const double hi[2], const double start[2], const double h[3],
	      double scale, double tolerance, bool certify)
{
	static const double unknown[3] = {0, 0, 0};

	l1->scale = scale;
	l1->tolerance = tolerance;
	l1->certify = certify;
	l1->error = l1->gap = INFINITY;
	l1->evaluations = l1->failed = l1->nears = l1->n_cuts = 0;
	l1->done = l1->snapped = false;
	l1->cold = !start;
	memcpy(l1->h, h ? h : unknown, sizeof l1->h);
	l1->tau = is_curved(l1->h) ? 0 : WINDOW;
	for (int a = 0; a < 2; a++) {
		l1->lo[a] = lo[a];
		l1->hi[a] = hi[a];
		/* The table is evaluated in float: ask only at floats. */
		l1->x[a] = l1->best[a] = start ? (double)(float)clamp(start[a], lo[a], hi[a]) : lo[a];
	}
	l1->n_corners = rectangle(lo, hi, l1->corner);
}

/* The least of slope . d + d H d / 2 over the box, d from the best point: inside, or on one of its four edges. */
static double newton_step(const struct l1 *l1, double step[2])
{
	const double *slope = l1->slope, *h = l1->h, *from = l1->best;
	const double det = h[0] * h[2] - h[1] * h[1];
	double least = 0;

	step[0] = step[1] = 0;
	if (det > 1e-9 * h[0] * h[2]) {
		const double d[2] = {(h[1] * slope[1] - h[2] * slope[0]) / det,
				     (h[1] * slope[0] - h[0] * slope[1]) / det};

		if (from[0] + d[0] >= l1->lo[0] && from[0] + d[0] <= l1->hi[0] && from[1] + d[1] >= l1->lo[1] &&
		    from[1] + d[1] <= l1->hi[1]) {
			memcpy(step, d, sizeof d);
			return 0.5 * (slope[0] * d[0] + slope[1] * d[1]);
		}
	}
	for (int edge = 0; edge < 4; edge++) {
		const int fixed = edge / 2, free = 1 - fixed;
		double d[2];

		d[fixed] = (edge % 2 ? l1->hi[fixed] : l1->lo[fixed]) - from[fixed];
		const double along = slope[free] + h[1] * d[fixed];
		const double reach = h[2 * free] > 0 ? -along / h[2 * free] : along > 0 ? -INFINITY : INFINITY;

		d[free] = clamp(from[free] + reach, l1->lo[free], l1->hi[free]) - from[free];
		const double value = slope[0] * d[0] + slope[1] * d[1] +
				     0.5 * (h[0] * d[0] * d[0] + 2 * h[1] * d[0] * d[1] + h[2] * d[1] * d[1]);

		if (value < least) {
			least = value;
			memcpy(step, d, sizeof d);
		}
	}
	return least;
}

static void centroid(const struct l1 *l1, double x[2])
{
	double area = 0, sx = 0, sy = 0;
	const double *o = l1->corner[0];

	for (int a = 1; a + 1 < l1->n_corners; a++) {
		const double *p = l1->corner[a], *q = l1->corner[a + 1];
		const double part = (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);

		area += part;
		sx += part * (p[0] - o[0] + q[0] - o[0]) / 3;
		sy += part * (p[1] - o[1] + q[1] - o[1]) / 3;
	}
	if (area > 0) {
		x[0] = o[0] + sx / area;
		x[1] = o[1] + sy / area;
		return;
	}
	/* A segment or a point. */
	mean(l1->corner, l1->n_corners, x);
}

/* Whether every cut leaves room at x for a value below the best. */
static bool promising(const struct l1 *l1, const double x[2])
{
	for (int a = 0; a < l1->n_cuts; a++) {
		const struct l1_cut *cut = &l1->cut[a];

		if (cut->error + cut->slope[0] * (x[0] - cut->x[0]) + cut->slope[1] * (x[1] - cut->x[1]) -
			    lifted(l1, cut) >=
		    l1->error)
			return false;
	}
	return true;
}

/* A best that all but touches an edge is evaluated once more on it: bounds reached are reported. */
static bool snap(struct l1 *l1)
{
	bool moved = false;

	if (l1->snapped)
		return false;
	l1->snapped = true;
	for (int a = 0; a < 2; a++) {
		const double near = 1e-6 * fmin(l1->hi[a] - l1->lo[a], 1);

		l1->x[a] = l1->best[a] - l1->lo[a] < near   ? l1->lo[a]
			   : l1->hi[a] - l1->best[a] < near ? l1->hi[a]
							    : l1->best[a];
		moved |= l1->x[a] != l1->best[a];
	}
	return moved;
}

/* Where the cuts are lowest among the points to which the second derivatives allow no more than half the tolerance above
 * the best one, along an axis: cuts from there close the gap around it. Where they do not, the second derivatives are
 * wrong, and the points are sought further out. */
static void lowest_near(const struct l1 *l1, double x[2])
{
	double lo[2], hi[2];

	for (int a = 0; a < 2; a++) {
		const double reach = ldexp(sqrt(l1->tolerance * l1->scale / l1->h[2 * a]), l1->nears / NEARS);

		lo[a] = fmax(l1->best[a] - reach, l1->lo[a]);
		hi[a] = fmin(l1->best[a] + reach, l1->hi[a]);
	}
	lowest(l1, lo, hi, x);
}

/* Rounds a point to floats. Returns whether that brings anything new. */
static bool is_new(const struct l1 *l1, double x[2])
{
	for (int a = 0; a < 2; a++)
		x[a] = clamp((double)(float)x[a], l1->lo[a], l1->hi[a]);
	return (x[0] != l1->x[0] || x[1] != l1->x[1]) && (x[0] != l1->best[0] || x[1] != l1->best[1]);
}

/* Sets the next point: a step from the best point that promises `gain`, or what cuts the feasible polygon. */
static void propose(struct l1 *l1, const double step[2], double gain)
{
	double x[2] = {l1->best[0] + step[0], l1->best[1] + step[1]};
	bool trusted = is_curved(l1->h) && l1->failed <= FAILURES;

	if (l1->certify && is_curved(l1->h) && gain <= l1->tolerance * l1->scale) {
		trusted = ++l1->nears % NEARS > 0;
		lowest_near(l1, x);
	}
	if (!trusted || !is_new(l1, x) || !promising(l1, x)) {
		centroid(l1, x);
		if (!is_new(l1, x)) {
			l1->done = !snap(l1);
			return;
		}
	}
	memcpy(l1->x, x, sizeof x);
}

/* Corrects the second derivatives so that they explain how the slope changes from the best point to this one (the update
 * of Broyden, Fletcher, Goldfarb and Shanno with Powell's damping): a kink in between becomes a steep curve. But nothing
 * becomes steeper over a step that matters no more than some tolerances: near enough to it, a kink is infinitely steep
 * and would hide how far the minimum may still be. */
static void learn(struct l1 *l1, const double slope[2])
{
	double *h = l1->h;
	const double s[2] = {l1->x[0] - l1->best[0], l1->x[1] - l1->best[1]};
	const double hs[2] = {h[0] * s[0] + h[1] * s[1], h[1] * s[0] + h[2] * s[1]};
	double y[2] = {slope[0] - l1->slope[0], slope[1] - l1->slope[1]};
	double ys = y[0] * s[0] + y[1] * s[1];
	const double shs = s[0] * hs[0] + s[1] * hs[1], least = 0.2 * shs;

	if (l1->evaluations == 0 || !(shs > 0) || (ys > shs && ys <= 30 * l1->tolerance * l1->scale))
		return;
	if (ys < least) {
		const double part = (shs - least) / (shs - ys);

		for (int a = 0; a < 2; a++)
			y[a] = part * y[a] + (1 - part) * hs[a];
		ys = least;
	}
	h[0] += y[0] * y[0] / ys - hs[0] * hs[0] / shs;
	h[1] += y[0] * y[1] / ys - hs[0] * hs[1] / shs;
	h[2] += y[1] * y[1] / ys - hs[1] * hs[1] / shs;
}

/* Returns whether the point is the best so far. */
static bool add_cut(struct l1 *l1, double error, const double slope[2])
{
	struct l1_cut *cut = &l1->cut[l1->n_cuts++];

	memcpy(cut->x, l1->x, sizeof cut->x);
	memcpy(cut->slope, slope, sizeof cut->slope);
	cut->error = error;
	if (error < l1->error || (l1->snapped && error == l1->error)) {
		l1->error = error;
		memcpy(l1->best, l1->x, sizeof l1->best);
		memcpy(l1->slope, slope, sizeof l1->slope);
		l1->n_corners = clip_level(l1, l1->corner, l1->n_corners, error);
		return true;
	}
	l1->n_corners = clip_cut(l1, l1->corner, l1->n_corners, cut, l1->error);
	return false;
}

/* At kd = ks = 0 the error is all that is measured, and the slopes are the sums of the terms. A term that comes to more
 * than twice as much is worse than none. Where the box goes far beyond that, the error at its far end would have no digit
 * left for what is sought: there it is cut off. */
static void narrow(struct l1 *l1, double error, const double slope[2])
{
	bool narrowed = false;

	for (int a = 0; a < 2; a++) {
		const double maximum = slope[a] < 0 ? -2 * error / slope[a] : INFINITY;

		if (maximum < L1_FAR * l1->hi[a]) {
			l1->hi[a] = maximum;
			narrowed = true;
		}
	}
	if (narrowed)
		l1->n_corners = clip_level(l1, l1->corner, rectangle(l1->lo, l1->hi, l1->corner), l1->error);
}

/* There, too, a first guess gives the diffuse term and the lobe shares of what is measured. */
static void guess(struct l1 *l1, double error, const double slope[2])
{
	static const double share[2] = {0.3, 0.5};

	l1->cold = false;
	narrow(l1, error, slope);
	for (int a = 0; a < 2; a++)
		l1->x[a] = slope[a] < 0 ? (double)(float)clamp(-share[a] * error / slope[a], l1->lo[a], l1->hi[a])
					: l1->lo[a];
}

void l1_update(struct l1 *l1, double error, const double slope[2], const double curvature[3])
{
	double step[2];

	if (l1->tau > 0)
		memcpy(l1->h, curvature, sizeof l1->h);
	else
		learn(l1, slope);
	const bool improved = add_cut(l1, error, slope);

	l1->evaluations++;
	if (l1->cold) {
		guess(l1, error, slope);
		return;
	}
	l1->tau = is_curved(l1->h) ? 0 : WINDOW;
	l1->failed = improved ? 0 : l1->failed + 1;
	const double gain = -newton_step(l1, step);

	/* Newton's estimate is of use where the best point is evaluated; elsewhere only the cuts can tell. */
	if (!l1->certify && is_curved(l1->h) && improved)
		l1->gap = gain;
	else
		l1->gap = l1->error - l1_lower_bound(l1);
	if (l1->gap <= l1->tolerance * l1->scale || l1->n_corners == 0 || l1->n_cuts >= L1_CUTS - 1 ||
	    (slope[0] == 0 && slope[1] == 0) || l1->snapped) {
		l1->done = !snap(l1);
		return;
	}
	propose(l1, step, gain);
}
