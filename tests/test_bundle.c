/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The solver of small L1 problems against the exact minimum, found by trying every vertex; and the quadratic program under it. */
#include "check.h"
#include "fit/error/bundle.h"
#include "fit/error/least_distance.h"
#include <stdlib.h>
#include <string.h>

enum { TERMS = 40, MANY = 4000, VARIABLES = BUNDLE_VARIABLES };

/* sum |m - x . a| over a domain. */
struct problem {
	int n;
	double m[MANY], a[MANY][VARIABLES];
	struct bundle_domain domain;
};

static double value(const struct problem *p, const double x[], double slope[])
{
	double sum = 0;

	for (int v = 0; v < p->domain.n; v++)
		slope[v] = 0;
	for (int n = 0; n < p->n; n++) {
		double r = p->m[n];

		for (int v = 0; v < p->domain.n; v++)
			r -= x[v] * p->a[n][v];
		sum += fabs(r);
		for (int v = 0; v < p->domain.n; v++)
			slope[v] -= copysign(p->a[n][v], r);
	}
	return sum;
}

static double scale_of(const struct problem *p)
{
	const double zero[VARIABLES] = {0};
	double slope[VARIABLES];

	return value(p, zero, slope);
}

static bool is_inside(const struct bundle_domain *domain, const double x[], double tolerance)
{
	for (int v = 0; v < domain->n; v++)
		if (x[v] < domain->lo[v] - tolerance || x[v] > domain->hi[v] + tolerance)
			return false;
	for (int k = 0; k < domain->n_linear; k++) {
		double sum = 0;

		for (int v = 0; v < domain->n; v++)
			sum += domain->normal[k][v] * x[v];
		if (sum > domain->level[k] + tolerance)
			return false;
	}
	return true;
}

/* Planes normal . x = level: those of the residuals that vanish and of the domain's faces. */
struct planes {
	int n;
	double normal[TERMS + 2 * VARIABLES + BUNDLE_LINEAR][VARIABLES], level[TERMS + 2 * VARIABLES + BUNDLE_LINEAR];
};

static struct planes planes_of(const struct problem *p)
{
	const struct bundle_domain *domain = &p->domain;
	struct planes planes = {.n = 0};

	for (int n = 0; n < p->n; n++) {
		memcpy(planes.normal[planes.n], p->a[n], sizeof p->a[n]);
		planes.level[planes.n++] = p->m[n];
	}
	for (int side = 0; side < 2 * domain->n; side++) {
		planes.normal[planes.n][side / 2] = 1;
		planes.level[planes.n++] = side % 2 ? domain->hi[side / 2] : domain->lo[side / 2];
	}
	for (int k = 0; k < domain->n_linear; k++) {
		memcpy(planes.normal[planes.n], domain->normal[k], sizeof domain->normal[k]);
		planes.level[planes.n++] = domain->level[k];
	}
	return planes;
}

/* Where some planes cross, by Gauss's elimination; false where they do not. */
static bool cross(const struct planes *planes, const int plane[], int n, double x[])
{
	double m[VARIABLES][VARIABLES + 1];

	for (int i = 0; i < n; i++) {
		memcpy(m[i], planes->normal[plane[i]], (size_t)n * sizeof(double));
		m[i][n] = planes->level[plane[i]];
	}
	for (int i = 0; i < n; i++) {
		int pivot = i;

		for (int j = i + 1; j < n; j++)
			if (fabs(m[j][i]) > fabs(m[pivot][i]))
				pivot = j;
		if (fabs(m[pivot][i]) < 1e-12)
			return false;
		for (int k = 0; k <= n; k++) {
			const double swap = m[i][k];

			m[i][k] = m[pivot][k];
			m[pivot][k] = swap;
		}
		for (int j = 0; j < n; j++)
			for (int k = n; k >= i && j != i; k--)
				m[j][k] -= m[j][i] / m[i][i] * m[i][k];
	}
	for (int i = 0; i < n; i++)
		x[i] = m[i][n] / m[i][i];
	return true;
}

/* The minimum lies at a vertex: as many planes as variables cross there. */
static void try_vertices(const struct problem *p, const struct planes *planes, int plane[], int depth, double *best)
{
	const int n = p->domain.n;

	if (depth == n) {
		double x[VARIABLES];

		if (cross(planes, plane, n, x) && is_inside(&p->domain, x, 1e-12)) {
			double slope[VARIABLES];

			*best = fmin(*best, value(p, x, slope));
		}
		return;
	}
	for (plane[depth] = depth > 0 ? plane[depth - 1] + 1 : 0; plane[depth] < planes->n; plane[depth]++)
		try_vertices(p, planes, plane, depth + 1, best);
}

static double minimum(const struct problem *p)
{
	const struct planes planes = planes_of(p);
	int plane[VARIABLES];
	double best = INFINITY;

	try_vertices(p, &planes, plane, 0, &best);
	return best;
}

static double uniform(unsigned *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return (*seed >> 8) / (double)(1 << 24);
}

/* The second derivatives as the kernel estimates them; tau 0: none. */
static void estimate(const struct problem *p, const double x[], double tau, double second[])
{
	memset(second, 0, BUNDLE_SECOND * sizeof *second);
	for (int n = 0; n < p->n && tau > 0; n++) {
		double f = 0;

		for (int v = 0; v < p->domain.n; v++)
			f += x[v] * p->a[n][v];
		const double window = tau * (f + 1e-2);

		if (fabs(p->m[n] - f) < window) {
			int at = 0;

			for (int v = 0; v < p->domain.n; v++)
				for (int w = v; w < p->domain.n; w++)
					second[at++] += p->a[n][v] * p->a[n][w] / window;
		}
	}
}

static void run(const struct problem *p, struct bundle *bundle, bool curvature)
{
	double slope[VARIABLES], second[BUNDLE_SECOND];

	while (!bundle->done) {
		const double error = value(p, bundle->x, slope);

		estimate(p, bundle->x, curvature ? bundle->tau : 0, second);
		bundle_update(bundle, error, slope, second);
		assert_true(bundle->evaluations <= 150);
	}
}

/* Solves to a certified end; the curvature is withheld, as on tables too small to estimate it. */
static void solve(const struct problem *p, const double start[], double tolerance, struct bundle *bundle)
{
	bundle_start(bundle, &p->domain, start, NULL, scale_of(p), tolerance, true);
	run(p, bundle, false);
}

/* A diffuse term, and lobes: a few large values among many small ones. */
static struct problem random_problem(int variables, int n, unsigned *seed)
{
	struct problem p = {.n = n, .domain = {.n = variables}};
	double truth[VARIABLES];

	for (int v = 0; v < variables; v++) {
		p.domain.hi[v] = 1;
		truth[v] = 1.4 * uniform(seed) - 0.2;
	}
	for (int i = 0; i < n; i++) {
		double f = 0;

		for (int v = 0; v < variables; v++) {
			p.a[i][v] = v == 0 ? 0.3 + 0.1 * uniform(seed) : pow(10, 4 * uniform(seed) - 2);
			f += truth[v] * p.a[i][v];
		}
		p.m[i] = fmax(0, f * (0.4 + 1.2 * uniform(seed)));
	}
	return p;
}

static void check_solved(const struct problem *p, const struct bundle *bundle, double best, const char *label)
{
	const double scale = scale_of(p);
	double slope[VARIABLES];

	/* The solver evaluates at single-precision points only, which costs up to their rounding. */
	check_abs(bundle->error, best, 3e-7 * scale + 1e-9, label);
	assert_true(bundle->lower_bound <= best * (1 + 1e-12) + 1e-12);
	check_abs(value(p, bundle->best, slope), bundle->error, 0, "best is where error was seen");
	assert_true(is_inside(&p->domain, bundle->best, 1e-6));
}

static void reaches_the_exact_minimum(void **state)
{
	static const struct {
		int variables, trials, terms;
	} cases[] = {{1, 50, TERMS}, {2, 300, TERMS}, {3, 60, 20}, {4, 20, 12}, {5, 8, 9}};
	unsigned seed = 7;

	(void)state;
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++)
		for (int trial = 0; trial < cases[c].trials; trial++) {
			const int variables = cases[c].variables,
				  n = variables + 1 + trial % (cases[c].terms - variables);
			const struct problem p = random_problem(variables, n, &seed);
			const double best = minimum(&p), scale = scale_of(&p);
			double start[VARIABLES], wrong[BUNDLE_SECOND] = {0};
			struct bundle bundle;

			for (int v = 0; v < variables; v++)
				start[v] = uniform(&seed);
			solve(&p, start, 1e-7, &bundle);
			check_solved(&p, &bundle, best, "minimum");

			/* Second derivatives that mislead, known or estimated, cost evaluations only. */
			const double size = scale * pow(10, 8 * uniform(&seed) - 4), tilt = 2 * uniform(&seed) - 1;

			for (int v = 0, at = 0; v < variables; v++)
				for (int w = v; w < variables; w++)
					wrong[at++] = w == v ? size : w == v + 1 ? 0.5 * tilt * size : 0;
			bundle_start(&bundle, &p.domain, start, wrong, scale, 1e-7, true);
			run(&p, &bundle, false);
			check_solved(&p, &bundle, best, "minimum after a wrong hint");
			bundle_start(&bundle, &p.domain, NULL, NULL, scale, 1e-7, true);
			run(&p, &bundle, true);
			check_solved(&p, &bundle, best, "minimum after an estimate");
		}
}

/* x_1 <= x_0 and x_0 + x_1 <= 1, beside a box. */
static void keeps_linear_constraints(void **state)
{
	unsigned seed = 3;
	int binding = 0;

	(void)state;
	for (int trial = 0; trial < 100; trial++) {
		struct problem p = random_problem(2 + trial % 2, 4 + trial % 12, &seed);
		struct bundle bundle;

		p.domain.n_linear = 2;
		p.domain.normal[0][0] = -1;
		p.domain.normal[0][1] = p.domain.normal[1][0] = p.domain.normal[1][1] = 1;
		p.domain.level[1] = 1;
		solve(&p, NULL, 1e-7, &bundle);
		check_solved(&p, &bundle, minimum(&p), "minimum under constraints");
		binding += fabs(bundle.best[0] - bundle.best[1]) < 1e-6 || bundle.best[0] + bundle.best[1] > 1 - 1e-6;
	}
	assert_true(binding > 20);
}

/* A problem like those of a metal: a lobe over five decades, with noise, and a dark diffuse term in half of the terms, whose
 * values lie so close together that the estimate, made for the lobe, is far too low for it. */
static void make_metal(struct problem *p, unsigned seed, double exponent)
{
	*p = (struct problem){.n = MANY, .domain = {.n = 2, .hi = {1, 1}}};
	for (int n = 0; n < MANY; n++) {
		const bool dark = n % 2;

		p->a[n][0] = 1;
		p->a[n][1] = dark ? 1e-6 : pow(10, exponent * (n + 0.5) / MANY - 3);
		p->m[n] = 1e-3 * (1 + 0.02 * uniform(&seed)) + 0.4 * p->a[n][1] * (0.6 + 0.8 * uniform(&seed));
	}
}

/* What one solve has learnt spares the next one evaluations, and both end within their tolerance of the minimum. */
static void neighbours_teach(void **state)
{
	static struct problem p, next;
	int alone = 0, taught = 0;

	(void)state;
	for (unsigned seed = 1; seed <= 30; seed++) {
		struct bundle first, again, certain;
		double second[BUNDLE_SECOND];

		make_metal(&p, seed, 5);
		make_metal(&next, seed, 5.002);
		const double scale = scale_of(&next);

		bundle_start(&first, &p.domain, NULL, NULL, scale_of(&p), 1e-7, false);
		run(&p, &first, true);
		bundle_start(&again, &next.domain, first.best, NULL, scale, 1e-7, false);
		run(&next, &again, true);
		alone += again.evaluations;
		bundle_second(&first, second);
		bundle_start(&again, &next.domain, first.best, second, scale, 1e-7, false);
		assert_true(again.tau == 0);
		run(&next, &again, false);
		taught += again.evaluations;
		bundle_second(&again, second);
		bundle_start(&certain, &next.domain, again.best, second, scale, 1e-8, true);
		run(&next, &certain, false);
		assert_true(certain.gap <= 1e-8 * scale);
		check_abs(again.error, certain.error, 1e-6 * scale, "error of the taught solve");
		assert_true(again.error >= certain.lower_bound - 1e-12 * scale);
	}
	print_message("evaluations: %d alone, %d taught\n", alone, taught);
	assert_true(taught < alone);
}

static void stays_in_the_box(void **state)
{
	struct problem p = {
		.n = 3, .m = {5, 6, 7}, .a = {{1, 0.1}, {1, 0.2}, {1, 0.3}}, .domain = {.n = 2, .hi = {1, 1}}};
	const double start[2] = {-3, 9};
	struct bundle bundle;

	(void)state;
	solve(&p, start, 1e-9, &bundle);
	check_abs(bundle.best[0], 1, 0, "kd at its bound");
	check_abs(bundle.best[1], 1, 0, "ks at its bound");
	p.domain.hi[0] = 0; /* a variable that is not there */
	solve(&p, start, 1e-9, &bundle);
	check_abs(bundle.best[0], 0, 0, "fixed kd");
	check_abs(bundle.best[1], 1, 0, "ks beside it");
	p.domain.hi[1] = 0; /* nor the other */
	solve(&p, start, 1e-9, &bundle);
	check_abs(bundle.error, 18, 0, "error of nothing");
	check_abs(bundle.lower_bound, 18, 1e-5, "and its bound");
}

static void one_variable_is_a_weighted_median(void **state)
{
	/* kd alone: the median of m / a weighted by a; weights 1, 2, 4 at 0.1, 0.5, 0.3 have it at 0.3. */
	const struct problem p = {.n = 3, .m = {0.1, 1, 1.2}, .a = {{1}, {2}, {4}}, .domain = {.n = 2, .hi = {1, 0}}};
	const double start[2] = {0.9, 0};
	struct bundle bundle;

	(void)state;
	solve(&p, start, 1e-9, &bundle);
	check_rel(bundle.best[0], 0.3, 1e-7, "weighted median");
}

static void all_zero_data_end_at_zero(void **state)
{
	const struct problem p = {.n = 4, .a = {{1, 1}, {1, 2}, {1, 3}, {1, 4}}, .domain = {.n = 2, .hi = {1, 1}}};
	const double start[2] = {0.5, 0.5};
	struct bundle bundle;

	(void)state;
	solve(&p, start, 1e-9, &bundle);
	check_abs(bundle.error, 0, 1e-6, "error");
}

/* The whole problem times 2^-60, in the same box: the same minimum, times 2^-60. */
static void finds_what_is_next_to_nothing_beside_the_box(void **state)
{
	unsigned seed = 11;

	(void)state;
	for (int trial = 0; trial < 100; trial++) {
		struct problem p = {.n = 3 + trial % (TERMS - 3), .domain = {.n = 2, .hi = {1, 1}}};
		struct bundle bundle, faint;

		for (int n = 0; n < p.n; n++) {
			p.a[n][0] = 0.3 + 0.1 * uniform(&seed);
			p.a[n][1] = pow(10, 4 * uniform(&seed) - 2);
			p.m[n] = (0.2 * p.a[n][0] + 0.1 * p.a[n][1]) * (0.4 + 1.2 * uniform(&seed));
		}
		const double scale = scale_of(&p);

		solve(&p, NULL, 1e-7, &bundle);
		for (int n = 0; n < p.n; n++)
			p.m[n] *= 0x1p-60;
		solve(&p, NULL, 1e-7, &faint);
		check_abs(faint.error * 0x1p60, bundle.error, 3e-7 * scale, "minimum of the faint problem");
		assert_true(faint.lower_bound * 0x1p60 <= bundle.error + 3e-7 * scale);
	}
}

/* The conditions of Karush, Kuhn and Tucker, and that a polytope without a point is told. */
static void the_nearest_point_is_the_nearest(void **state)
{
	unsigned seed = 5;

	(void)state;
	for (int trial = 0; trial < 300; trial++) {
		struct least_distance p = {.dims = 1 + trial % LEAST_DISTANCE_DIMS, .n_rows = 1 + trial % 40};
		double inside[LEAST_DISTANCE_DIMS] = {0}, given[LEAST_DISTANCE_DIMS] = {0};

		for (int d = 0; d < p.dims; d++) {
			inside[d] = uniform(&seed);
			given[d] = p.z[d] = 20 * uniform(&seed) - 10;
		}
		for (int n = 0; n < p.n_rows; n++) {
			p.level[n] = -uniform(&seed);
			for (int d = 0; d < p.dims; d++) {
				p.normal[n][d] = pow(10, 2 * uniform(&seed)) * (uniform(&seed) - 0.5);
				p.level[n] += p.normal[n][d] * inside[d];
			}
		}
		assert_true(least_distance_solve(&p));
		for (int n = 0; n < p.n_rows; n++) {
			double over = -p.level[n];

			for (int d = 0; d < p.dims; d++)
				over += p.normal[n][d] * p.z[d];
			assert_true(over >= -1e-8 && p.multiplier[n] >= 0);
			check_abs(p.multiplier[n] * over, 0, 1e-7,
				  "a row that does not hold with equality has no part");
		}
		for (int d = 0; d < p.dims; d++) {
			double sum = given[d];

			for (int n = 0; n < p.n_rows; n++)
				sum += p.multiplier[n] * p.normal[n][d];
			check_abs(p.z[d], sum, 1e-9, "z is the given point and its rows' part");
		}
	}
	struct least_distance nowhere = {.dims = 1, .n_rows = 2, .normal = {{1}, {-1}}, .level = {1, 1}};

	assert_false(least_distance_solve(&nowhere));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reaches_the_exact_minimum),
		cmocka_unit_test(keeps_linear_constraints),
		cmocka_unit_test(neighbours_teach),
		cmocka_unit_test(stays_in_the_box),
		cmocka_unit_test(one_variable_is_a_weighted_median),
		cmocka_unit_test(all_zero_data_end_at_zero),
		cmocka_unit_test(finds_what_is_next_to_nothing_beside_the_box),
		cmocka_unit_test(the_nearest_point_is_the_nearest),
	};

	return cmocka_run_group_tests_name("bundle", tests, NULL, NULL);
}
