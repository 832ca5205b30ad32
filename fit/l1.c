/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "l1.h"
#include <math.h>
#include <string.h>

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

static int box_corners(const struct l1 *l1, double corner[][2])
{
	const double x[4] = {l1->lo[0], l1->hi[0], l1->hi[0], l1->lo[0]};
	const double y[4] = {l1->lo[1], l1->lo[1], l1->hi[1], l1->hi[1]};

	for (int a = 0; a < 4; a++) {
		corner[a][0] = x[a];
		corner[a][1] = y[a];
	}
	return 4;
}

/* Clips the polygon to where every cut allows a value of at most `level`. */
static int clip_level(const struct l1 *l1, double corner[][2], int n, double level)
{
	for (int a = 0; a < l1->n_cuts && n > 0; a++)
		n = clip(corner, n, l1->cut[a].slope, l1->cut[a].x, level - l1->cut[a].error);
	return n;
}

double l1_lower_bound(const struct l1 *l1)
{
	double corner[L1_CORNERS][2], low = 0, high = l1->error, precise = 0.05 * l1->tolerance * l1->scale;

	/* The largest level that some cut rules out everywhere in the box, by bisection. */
	for (int step = 0; step < 60 && high - low > precise; step++) {
		const double level = 0.5 * (low + high);

		if (clip_level(l1, corner, box_corners(l1, corner), level) > 0)
			high = level;
		else
			low = level;
	}
	return low;
}

static double clamp(double x, double lo, double hi)
{
	return x < lo ? lo : x > hi ? hi : x;
}

void l1_start(struct l1 *l1, const double lo[2], const double hi[2], const double start[2], double scale,
	      double tolerance, bool certify)
{
	l1->scale = scale;
	l1->tolerance = tolerance;
	l1->certify = certify;
	l1->tau = 0.1;
	l1->error = l1->gap = INFINITY;
	l1->looks = l1->n_cuts = 0;
	l1->done = l1->snapped = l1->newton = false;
	l1->cold = !start;
	for (int a = 0; a < 2; a++) {
		l1->lo[a] = lo[a];
		l1->hi[a] = hi[a];
		/* The table is evaluated in float: ask only where float can look. */
		l1->x[a] = l1->best[a] = start ? (double)(float)clamp(start[a], lo[a], hi[a]) : lo[a];
	}
	l1->n_corners = box_corners(l1, l1->corner);
}

/* The least of slope . d + d H d / 2 over the box around x: inside, or on one of its four edges. */
static double newton_step(const struct l1 *l1, const double slope[2], const double h[3], double step[2])
{
	const double det = h[0] * h[2] - h[1] * h[1];
	double least = 0;

	step[0] = step[1] = 0;
	if (det > 1e-9 * h[0] * h[2]) {
		const double d[2] = {(h[1] * slope[1] - h[2] * slope[0]) / det,
				     (h[1] * slope[0] - h[0] * slope[1]) / det};

		if (l1->x[0] + d[0] >= l1->lo[0] && l1->x[0] + d[0] <= l1->hi[0] && l1->x[1] + d[1] >= l1->lo[1] &&
		    l1->x[1] + d[1] <= l1->hi[1]) {
			memcpy(step, d, sizeof d);
			return 0.5 * (slope[0] * d[0] + slope[1] * d[1]);
		}
	}
	for (int edge = 0; edge < 4; edge++) {
		const int fixed = edge / 2, free = 1 - fixed;
		double d[2];

		d[fixed] = (edge % 2 ? l1->hi[fixed] : l1->lo[fixed]) - l1->x[fixed];
		const double along = slope[free] + h[1] * d[fixed];
		const double reach = h[2 * free] > 0 ? -along / h[2 * free] : along > 0 ? -INFINITY : INFINITY;

		d[free] = clamp(l1->x[free] + reach, l1->lo[free], l1->hi[free]) - l1->x[free];
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
	/* A segment or a point: the mean of the corners. */
	x[0] = x[1] = 0;
	for (int a = 0; a < l1->n_corners; a++)
		for (int n = 0; n < 2; n++)
			x[n] += l1->corner[a][n] / l1->n_corners;
}

/* Whether every cut leaves room at x for a value below the best. */
static bool promising(const struct l1 *l1, const double x[2])
{
	for (int a = 0; a < l1->n_cuts; a++) {
		const struct l1_cut *cut = &l1->cut[a];

		if (cut->error + cut->slope[0] * (x[0] - cut->x[0]) + cut->slope[1] * (x[1] - cut->x[1]) >= l1->error)
			return false;
	}
	return true;
}

/* A best that all but touches an edge is looked at once more on it: bounds reached are reported. */
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

static void propose(struct l1 *l1, const double step[2], bool newton)
{
	double x[2] = {l1->x[0] + step[0], l1->x[1] + step[1]};

	for (int a = 0; a < 2; a++)
		x[a] = (double)(float)clamp(x[a], l1->lo[a], l1->hi[a]);
	if (!newton || !promising(l1, x)) {
		centroid(l1, x);
		for (int a = 0; a < 2; a++)
			x[a] = clamp((double)(float)x[a], l1->lo[a], l1->hi[a]);
	}
	/* The window follows the change of the model that is left to make. */
	double change = 0;
	for (int a = 0; a < 2; a++) {
		const double size = fmax(fabs(x[a]), fabs(l1->x[a]));

		if (size > 0)
			change = fmax(change, fabs(x[a] - l1->x[a]) / size);
	}
	l1->tau = clamp(change, 2e-3, 0.2);
	if (x[0] == l1->x[0] && x[1] == l1->x[1])
		l1->done = !snap(l1);
	else
		memcpy(l1->x, x, sizeof x);
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
		l1->n_corners = clip_level(l1, l1->corner, l1->n_corners, error);
		return true;
	}
	l1->n_corners = clip(l1->corner, l1->n_corners, slope, l1->x, l1->error - error);
	return false;
}

/* At kd = ks = 0 the error is all that is measured, and the slopes are the sums of the terms. A term that comes to more
 * than twice as much is worse than none. Where the box goes far beyond that, the error at its far end would have no digit
 * left for what is sought: there it is cut off. */
static void narrow(struct l1 *l1, double error, const double slope[2])
{
	bool narrowed = false;

	for (int a = 0; a < 2; a++) {
		const double most = slope[a] < 0 ? -2 * error / slope[a] : INFINITY;

		if (most < L1_FAR * l1->hi[a]) {
			l1->hi[a] = most;
			narrowed = true;
		}
	}
	if (narrowed)
		l1->n_corners = clip_level(l1, l1->corner, box_corners(l1, l1->corner), l1->error);
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
	const bool curved = curvature[0] + curvature[2] > 0 && isfinite(curvature[0] + curvature[2]);
	const bool improved = add_cut(l1, error, slope);
	double step[2];

	l1->looks++;
	if (l1->cold) {
		guess(l1, error, slope);
		return;
	}
	const double gain = -newton_step(l1, slope, curvature, step);

	/* Newton's estimate is of use where the best point is looked at; elsewhere only the cuts can tell. */
	if (!l1->certify && curved && improved)
		l1->gap = gain;
	else
		l1->gap = l1->error - l1_lower_bound(l1);
	if (l1->gap <= l1->tolerance * l1->scale || l1->n_corners == 0 || l1->n_cuts >= L1_CUTS - 1 ||
	    (slope[0] == 0 && slope[1] == 0) || l1->snapped) {
		l1->done = !snap(l1);
		return;
	}
	/* A Newton step that brought nothing is followed by one that surely cuts the fence. */
	l1->newton = curved && (improved || !l1->newton);
	propose(l1, step, l1->newton);
}
