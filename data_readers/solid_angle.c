/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/solid_angle.h"
#include <math.h>
#include <stdlib.h>

enum {
	ANGLES = 4,
	SAMPLE = 15,     /* entries that tell where the middle is */
	DEPTH_MAX = 400, /* never reached but by rounding */
};

#define SAME 1e-4f /* radians: angles this near are equal */

enum { THETA_I, THETA_O, DIFFERENCE, PHI_I };

struct point {
	float angle[ANGLES];
	uint32_t entry;
};

/* The part of the domain that a set of points has. `open`: the edge is that of the domain. */
struct cell {
	double low[ANGLES], high[ANGLES];
	bool open_low[ANGLES], open_high[ANGLES];
};

struct cutting {
	struct scattered *scattered;
	int n_angles;
	struct cell domain;
};

static float polar(struct vec3 v)
{
	return (float)atan2(hypot(v.x, v.y), v.z);
}

static struct point point_of(const struct scattered *s, size_t entry)
{
	const struct vec3 i = s->wi[entry], o = s->wo[entry];
	const double phi = atan2(i.x * o.y - i.y * o.x, i.x * o.x + i.y * o.y);
	const bool isotropic = s->symmetry == SYMMETRY_ISOTROPIC;
	struct point point = {.entry = (uint32_t)entry};
	point.angle[THETA_I] = polar(i);
	point.angle[THETA_O] = polar(o);
	point.angle[DIFFERENCE] = (float)(isotropic ? fabs(phi) : phi);
	point.angle[PHI_I] = isotropic ? 0 : (float)atan2(i.y, i.x);
	return point;
}

/* Integrals of sin(theta_i) sin(theta_o) over the cell. */
static double size_of(const struct cutting *cutting, const struct cell *cell)
{
	const double i = cos(cell->low[THETA_I]) - cos(cell->high[THETA_I]);
	const double o = cos(cell->low[THETA_O]) - cos(cell->high[THETA_O]);
	const double difference = cell->high[DIFFERENCE] - cell->low[DIFFERENCE];
	/* Isotropic: all azimuths of wi, and differences of either sign. */
	const double turns = cutting->n_angles < ANGLES ? 4 * M_PI : cell->high[PHI_I] - cell->low[PHI_I];
	return i * o * difference * turns;
}

/* The cell of points that are all equal. */
static void share_cell(const struct cutting *cutting, const struct point *point, size_t n, const struct cell *outer)
{
	struct cell cell = *outer;
	for (int a = 0; a < cutting->n_angles; a++) {
		const double at = (double)point->angle[a];
		if (cell.open_low[a] && !cell.open_high[a])
			cell.low[a] = fmax(cell.low[a], at - (cell.high[a] - at));
		if (cell.open_high[a] && !cell.open_low[a])
			cell.high[a] = fmin(cell.high[a], at + (at - cell.low[a]));
	}
	const float share = (float)(fmax(0, size_of(cutting, &cell)) / (double)n);
	for (size_t p = 0; p < n; p++)
		cutting->scattered->solid_angle[point[p].entry] = share;
}

/* About the median in this angle. Of a few points some are taken more than once. */
static float middle_of(const struct point *point, size_t n, int angle)
{
	float sample[SAMPLE] = {0};
	for (size_t i = 0; i < SAMPLE; i++) {
		const float at = point[(2 * i + 1) * n / (2 * SAMPLE)].angle[angle];
		size_t place = i;
		for (; place > 0 && sample[place - 1] > at; place--)
			sample[place] = sample[place - 1];
		sample[place] = at;
	}
	return sample[SAMPLE / 2];
}

/* Where to cut near `middle`: half way between it and the next on the side that has more points. NaN if all are
 * equal. */
static double cut_at(const struct point *point, size_t n, int angle, float middle)
{
	float below = -INFINITY, above = INFINITY;
	size_t n_below = 0, n_above = 0;
	for (size_t p = 0; p < n; p++) {
		const float at = point[p].angle[angle];
		if (at < middle - SAME) {
			n_below++;
			below = at > below ? at : below;
		} else if (at > middle + SAME) {
			n_above++;
			above = at < above ? at : above;
		}
	}
	if (n_below + n_above == 0)
		return NAN;
	const float other = n_below > n_above ? below : above;
	return ((double)other + (double)middle) / 2;
}

/* Moves the points below the cut to the front; returns how many there are. */
static size_t part(struct point *point, size_t n, int angle, double cut)
{
	size_t low = 0;
	for (size_t p = 0; p < n; p++) {
		if ((double)point[p].angle[angle] >= cut)
			continue;
		const struct point moved = point[low];
		point[low++] = point[p];
		point[p] = moved;
	}
	return low;
}

/* The angle with the largest extent, and that. */
static int widest(const struct point *point, size_t n, int n_angles, float *extent)
{
	float low[ANGLES], high[ANGLES];
	int best = 0;
	for (int a = 0; a < ANGLES; a++)
		low[a] = high[a] = point->angle[a];
	/* All four at once are faster than three. */
	for (size_t p = 1; p < n; p++)
		for (int a = 0; a < ANGLES; a++) {
			const float at = point[p].angle[a];
			low[a] = at < low[a] ? at : low[a];
			high[a] = at > high[a] ? at : high[a];
		}
	for (int a = 1; a < n_angles; a++)
		if (high[a] - low[a] > high[best] - low[best])
			best = a;
	*extent = high[best] - low[best];
	return best;
}

/* Each half is one level deeper; the larger one goes on in the loop, so that the stack stays flat. */
static void cut(const struct cutting *cutting, struct point *point, size_t n, struct cell cell, int depth)
{
	for (; n > 1 && depth < DEPTH_MAX; depth++) {
		float extent;
		const int angle = widest(point, n, cutting->n_angles, &extent);
		const double at = extent > SAME ? cut_at(point, n, angle, middle_of(point, n, angle)) : (double)NAN;
		const size_t n_low = isnan(at) ? 0 : part(point, n, angle, at);
		if (n_low == 0 || n_low == n)
			break;
		struct cell low = cell, high = cell;
		low.high[angle] = high.low[angle] = at;
		low.open_high[angle] = high.open_low[angle] = false;
		if (2 * n_low > n) {
			cut(cutting, point + n_low, n - n_low, high, depth + 1);
			n = n_low;
			cell = low;
		} else {
			cut(cutting, point, n_low, low, depth + 1);
			point += n_low;
			n -= n_low;
			cell = high;
		}
	}
	share_cell(cutting, point, n, &cell);
}

enum status solid_angle_estimate(struct scattered *scattered)
{
	const bool isotropic = scattered->symmetry == SYMMETRY_ISOTROPIC;
	struct cutting cutting = {
		.scattered = scattered,
		.n_angles = isotropic ? ANGLES - 1 : ANGLES,
		.domain = {.low = {0, 0, isotropic ? 0 : -M_PI, -M_PI}, .high = {M_PI_2, M_PI_2, M_PI, M_PI}}};
	for (int a = 0; a < ANGLES; a++)
		cutting.domain.open_low[a] = cutting.domain.open_high[a] = true;
	if (scattered->n > UINT32_MAX)
		return STATUS_NO_MEMORY;
	struct point *point = malloc(scattered->n * sizeof *point);
	if (!point)
		return STATUS_NO_MEMORY;
	for (size_t e = 0; e < scattered->n; e++)
		point[e] = point_of(scattered, e);
	cut(&cutting, point, scattered->n, cutting.domain, 0);
	free(point);
	return STATUS_OK;
}

void solid_angle_edges(const double *value, size_t n, double low, double high, double *edge)
{
	edge[0] = low;
	edge[n] = high;
	for (size_t i = 1; i < n; i++)
		edge[i] = (value[i - 1] + value[i]) / 2;
	if (n > 1) {
		edge[0] = fmax(low, 2 * value[0] - edge[1]);
		edge[n] = fmin(high, 2 * value[n - 1] - edge[n - 1]);
	}
}
