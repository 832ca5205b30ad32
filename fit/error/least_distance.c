/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/least_distance.h"
#include <float.h>
#include <math.h>
#include <string.h>

/* The rows that hold with equality, as q r: q orthonormal, r upper triangular, column by column. */
struct active {
	int n, row[LEAST_DISTANCE_DIMS];
	double q[LEAST_DISTANCE_DIMS][LEAST_DISTANCE_DIMS], r[LEAST_DISTANCE_DIMS][LEAST_DISTANCE_DIMS];
	double norm[LEAST_DISTANCE_ROWS]; /* of each normal */
};

static double dot(const double a[], const double b[], int dims)
{
	double sum = 0;

	for (int d = 0; d < dims; d++)
		sum += a[d] * b[d];
	return sum;
}

/* What of a normal lies outside the span of the active ones, and its coefficients by q. Orthogonalised twice: once leaves rounding. */
static void split(const struct active *active, const double normal[], int dims, double outside[], double by_q[])
{
	memcpy(outside, normal, (size_t)dims * sizeof *outside);
	memset(by_q, 0, LEAST_DISTANCE_DIMS * sizeof *by_q);
	for (int twice = 0; twice < 2; twice++)
		for (int a = 0; a < active->n; a++) {
			const double part = dot(active->q[a], outside, dims);

			by_q[a] += part;
			for (int d = 0; d < dims; d++)
				outside[d] -= part * active->q[a][d];
		}
}

static bool append(const struct least_distance *p, struct active *active, int row)
{
	double outside[LEAST_DISTANCE_DIMS];
	double *column = active->r[active->n];

	split(active, p->normal[row], p->dims, outside, column);
	const double length = sqrt(dot(outside, outside, p->dims));

	if (active->n >= p->dims || !(length > 1e-11 * active->norm[row]))
		return false;
	column[active->n] = length;
	for (int d = 0; d < p->dims; d++)
		active->q[active->n][d] = outside[d] / length;
	active->row[active->n++] = row;
	return true;
}

static void drop(const struct least_distance *p, struct active *active, int at)
{
	int row[LEAST_DISTANCE_DIMS];
	const int n = active->n;

	memcpy(row, active->row, sizeof row);
	active->n = at;
	for (int a = at + 1; a < n; a++)
		append(p, active, row[a]);
}

/* How the multipliers of the active rows fall as that of a new one grows. */
static void fall(const struct active *active, const double by_q[], double rate[])
{
	for (int a = active->n - 1; a >= 0; a--) {
		rate[a] = by_q[a];
		for (int b = a + 1; b < active->n; b++)
			rate[a] -= active->r[b][a] * rate[b];
		rate[a] /= active->r[a][a];
	}
}

static bool is_active(const struct active *active, int row)
{
	for (int a = 0; a < active->n; a++)
		if (active->row[a] == row)
			return true;
	return false;
}

/* An active row may be violated by its rounding: it counts as fulfilled. */
static int most_violated(const struct least_distance *p, const struct active *active)
{
	const double size = sqrt(dot(p->z, p->z, p->dims));
	double worst = 0;
	int row = -1;

	for (int n = 0; n < p->n_rows; n++) {
		if (!(active->norm[n] > 0))
			continue;
		const double scale = active->norm[n] * size + fabs(p->level[n]);
		const double lack = p->level[n] - dot(p->normal[n], p->z, p->dims);

		if (lack > 1e-12 * scale && lack / active->norm[n] > worst && !is_active(active, n)) {
			worst = lack / active->norm[n];
			row = n;
		}
	}
	return row;
}

/* Moves until the row holds. */
static bool satisfy(struct least_distance *p, struct active *active, int row)
{
	for (int turn = 0; turn < 4 * LEAST_DISTANCE_DIMS; turn++) {
		double outside[LEAST_DISTANCE_DIMS], by_q[LEAST_DISTANCE_DIMS], rate[LEAST_DISTANCE_DIMS];
		double step = INFINITY;
		int first = -1;

		split(active, p->normal[row], p->dims, outside, by_q);
		fall(active, by_q, rate);
		for (int a = 0; a < active->n; a++)
			if (rate[a] > 0 && p->multiplier[active->row[a]] < step * rate[a]) {
				step = p->multiplier[active->row[a]] / rate[a];
				first = a;
			}
		const double square = dot(outside, outside, p->dims),
			     lack = p->level[row] - dot(p->normal[row], p->z, p->dims);
		const bool moves = sqrt(square) > 1e-11 * active->norm[row];
		const double whole = moves ? lack / square : INFINITY;

		if (isinf(step) && !moves)
			return false;
		const bool ends = whole <= step;

		step = fmin(step, whole);
		for (int a = 0; a < active->n; a++)
			p->multiplier[active->row[a]] = fmax(p->multiplier[active->row[a]] - step * rate[a], 0);
		p->multiplier[row] += step;
		for (int d = 0; d < p->dims && moves; d++)
			p->z[d] += step * outside[d];
		if (ends)
			return append(p, active, row);
		p->multiplier[active->row[first]] = 0;
		drop(p, active, first);
	}
	return false;
}

bool least_distance_solve(struct least_distance *p)
{
	struct active active = {.n = 0};

	memset(p->multiplier, 0, sizeof p->multiplier);
	for (int n = 0; n < p->n_rows; n++)
		active.norm[n] = sqrt(dot(p->normal[n], p->normal[n], p->dims));
	for (int turn = 0; turn < 4 * LEAST_DISTANCE_ROWS; turn++) {
		const int row = most_violated(p, &active);

		if (row < 0)
			return true;
		if (!satisfy(p, &active, row))
			return false;
	}
	return false;
}
