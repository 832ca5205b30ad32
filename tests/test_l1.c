/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two-variable L1 solver against the exact minimum, found by trying every vertex. */
#include "check.h"
#include "fit/error/l1.h"
#include <stdlib.h>
#include <string.h>

enum { TERMS = 40, MANY = 4000 };

struct problem {
	int n;
	double m[MANY], a[MANY], s[MANY];
	double lo[2], hi[2];
};

static double value(const struct problem *p, double x, double y, double slope[2])
{
	double sum = 0;

	slope[0] = slope[1] = 0;
	for (int n = 0; n < p->n; n++) {
		const double r = p->m[n] - x * p->a[n] - y * p->s[n];

		sum += fabs(r);
		slope[0] -= copysign(p->a[n], r);
		slope[1] -= copysign(p->s[n], r);
	}
	return sum;
}

static void try_point(const struct problem *p, double x, double y, double *best)
{
	if (x >= p->lo[0] - 1e-12 && x <= p->hi[0] + 1e-12 && y >= p->lo[1] - 1e-12 && y <= p->hi[1] + 1e-12) {
		double slope[2];

		*best = fmin(*best, value(p, x, y, slope));
	}
}

/* The minimum lies where two of these lines cross: residuals that vanish, edges of the box. */
static double minimum(const struct problem *p)
{
	double a[TERMS + 4], b[TERMS + 4], c[TERMS + 4], best = INFINITY;
	int lines = 0;

	for (int n = 0; n < p->n; n++, lines++) {
		a[lines] = p->a[n];
		b[lines] = p->s[n];
		c[lines] = p->m[n];
	}
	for (int side = 0; side < 4; side++, lines++) {
		a[lines] = side < 2;
		b[lines] = side >= 2;
		c[lines] = side % 2 ? p->hi[side / 2] : p->lo[side / 2];
	}
	for (int i = 0; i < lines; i++)
		for (int j = 0; j < i; j++) {
			const double det = a[i] * b[j] - a[j] * b[i];

			if (det != 0)
				try_point(p, (c[i] * b[j] - c[j] * b[i]) / det, (a[i] * c[j] - a[j] * c[i]) / det,
					  &best);
		}
	return best;
}

static double uniform(unsigned *seed)
{
	*seed = *seed * 1664525u + 1013904223u;
	return (*seed >> 8) / (double)(1 << 24);
}

/* The second derivatives as the kernel estimates them; tau 0: none. */
static void estimate(const struct problem *p, const double x[2], double tau, double h[3])
{
	h[0] = h[1] = h[2] = 0;
	for (int n = 0; n < p->n && tau > 0; n++) {
		const double f = x[0] * p->a[n] + x[1] * p->s[n], window = tau * (f + 1e-2);

		if (fabs(p->m[n] - f) < window) {
			h[0] += p->a[n] * p->a[n] / window;
			h[1] += p->a[n] * p->s[n] / window;
			h[2] += p->s[n] * p->s[n] / window;
		}
	}
}

static void run(const struct problem *p, struct l1 *l1, bool curvature)
{
	double slope[2], h[3];

	while (!l1->done) {
		const double error = value(p, l1->x[0], l1->x[1], slope);

		estimate(p, l1->x, curvature ? l1->tau : 0, h);
		l1_update(l1, error, slope, h);
		assert_true(l1->evaluations <= L1_CUTS);
	}
}

/* Solves to a certified end; the curvature is withheld, as on tables too small to estimate it. */
static void solve(const struct problem *p, const double start[2], double tolerance, struct l1 *l1)
{
	double slope[2];

	l1_start(l1, p->lo, p->hi, start, NULL, value(p, 0, 0, slope), tolerance, true);
	run(p, l1, false);
}

static void reaches_the_exact_minimum(void **state)
{
	unsigned seed = 7;

	(void)state;
	for (int trial = 0; trial < 400; trial++) {
		struct problem p = {.n = 3 + trial % (TERMS - 3), .hi = {1, 1}};
		const double truth[2] = {1.4 * uniform(&seed) - 0.2, 1.4 * uniform(&seed) - 0.2};
		const double start[2] = {uniform(&seed), uniform(&seed)};
		struct l1 l1;
		double slope[2];

		for (int n = 0; n < p.n; n++) {
			p.a[n] = 0.3 + 0.1 * uniform(&seed);
			/* The lobe: a few large values among many small ones. */
			p.s[n] = pow(10, 4 * uniform(&seed) - 2);
			p.m[n] = fmax(0, (truth[0] * p.a[n] + truth[1] * p.s[n]) * (0.4 + 1.2 * uniform(&seed)));
		}
		const double best = minimum(&p), scale = value(&p, 0, 0, slope);

		solve(&p, start, 1e-7, &l1);
		/* The solver evaluations at single-precision points only, which costs up to their rounding. */
		check_abs(l1.error, best, 3e-7 * scale + 1e-9, "minimum");
		assert_true(l1_lower_bound(&l1) <= best * (1 + 1e-12) + 1e-12);
		check_abs(value(&p, l1.best[0], l1.best[1], slope), l1.error, 0, "best is where error was seen");

		/* Second derivatives that mislead, known or estimated, cost evaluations only. */
		const double size = scale * pow(10, 8 * uniform(&seed) - 4), tilt = 2 * uniform(&seed) - 1;
		const double wrong[3] = {size, tilt * size, size};
		l1_start(&l1, p.lo, p.hi, start, wrong, scale, 1e-7, true);
		run(&p, &l1, false);
		check_abs(l1.error, best, 3e-7 * scale + 1e-9, "minimum after a wrong hint");
		l1_start(&l1, p.lo, p.hi, start, NULL, scale, 1e-7, true);
		run(&p, &l1, true);
		check_abs(l1.error, best, 3e-7 * scale + 1e-9, "minimum after an estimate");
	}
}

/* A problem like those of a metal: a lobe over five decades, with noise, and a dark diffuse term in half of the terms, whose
 * values lie so close together that the estimate, made for the lobe, is far too low for it. */
static void make_metal(struct problem *p, unsigned seed, double exponent)
{
	*p = (struct problem){.n = MANY, .hi = {1, 1}};
	for (int n = 0; n < MANY; n++) {
		const bool dark = n % 2;

		p->a[n] = 1;
		p->s[n] = dark ? 1e-6 : pow(10, exponent * (n + 0.5) / MANY - 3);
		p->m[n] = 1e-3 * (1 + 0.02 * uniform(&seed)) + 0.4 * p->s[n] * (0.6 + 0.8 * uniform(&seed));
	}
}

/* What one solve has learnt spares the next one evaluations, and both end within their tolerance of the minimum. */
static void neighbours_teach(void **state)
{
	static struct problem p, next;
	int alone = 0, taught = 0;

	(void)state;
	for (unsigned seed = 1; seed <= 30; seed++) {
		struct l1 first, again, certain;
		double slope[2];

		make_metal(&p, seed, 5);
		make_metal(&next, seed, 5.002);
		const double scale = value(&next, 0, 0, slope);

		l1_start(&first, p.lo, p.hi, NULL, NULL, value(&p, 0, 0, slope), 1e-7, false);
		run(&p, &first, true);
		l1_start(&again, next.lo, next.hi, first.best, NULL, scale, 1e-7, false);
		run(&next, &again, true);
		alone += again.evaluations;
		l1_start(&again, next.lo, next.hi, first.best, first.h, scale, 1e-7, false);
		assert_true(again.tau == 0);
		run(&next, &again, false);
		taught += again.evaluations;
		l1_start(&certain, next.lo, next.hi, again.best, again.h, scale, 1e-8, true);
		run(&next, &certain, false);
		assert_true(certain.gap <= 1e-8 * scale);
		check_abs(again.error, certain.error, 1e-6 * scale, "error of the taught solve");
		assert_true(again.error >= l1_lower_bound(&certain) - 1e-12 * scale);
	}
	print_message("evaluations: %d alone, %d taught\n", alone, taught);
	assert_true(taught < alone);
}

static void stays_in_the_box(void **state)
{
	struct problem p = {.n = 3, .m = {5, 6, 7}, .a = {1, 1, 1}, .s = {0.1, 0.2, 0.3}, .hi = {1, 1}};
	const double start[2] = {-3, 9};
	struct l1 l1;

	(void)state;
	solve(&p, start, 1e-9, &l1);
	check_abs(l1.best[0], 1, 0, "kd at its bound");
	check_abs(l1.best[1], 1, 0, "ks at its bound");
	p.hi[0] = 0; /* a variable that is not there */
	solve(&p, start, 1e-9, &l1);
	check_abs(l1.best[0], 0, 0, "fixed kd");
	check_abs(l1.best[1], 1, 0, "ks beside it");
}

static void one_variable_is_a_weighted_median(void **state)
{
	/* kd alone: the median of m / a weighted by a; weights 1, 2, 4 at 0.1, 0.5, 0.3 have it at 0.3. */
	struct problem p = {.n = 3, .m = {0.1, 1, 1.2}, .a = {1, 2, 4}, .hi = {1, 0}};
	const double start[2] = {0.9, 0};
	struct l1 l1;

	(void)state;
	solve(&p, start, 1e-9, &l1);
	check_rel(l1.best[0], 0.3, 1e-7, "weighted median");
}

static void all_zero_data_end_at_zero(void **state)
{
	struct problem p = {.n = 4, .a = {1, 1, 1, 1}, .s = {1, 2, 3, 4}, .hi = {1, 1}};
	const double start[2] = {0.5, 0.5};
	struct l1 l1;

	(void)state;
	solve(&p, start, 1e-9, &l1);
	check_abs(l1.error, 0, 1e-6, "error");
}

/* The whole problem times 2^-60, in the same box: the same minimum, times 2^-60. */
static void finds_what_is_next_to_nothing_beside_the_box(void **state)
{
	unsigned seed = 11;

	(void)state;
	for (int trial = 0; trial < 100; trial++) {
		struct problem p = {.n = 3 + trial % (TERMS - 3), .hi = {1, 1}};
		struct l1 l1, faint;
		double slope[2];

		for (int n = 0; n < p.n; n++) {
			p.a[n] = 0.3 + 0.1 * uniform(&seed);
			p.s[n] = pow(10, 4 * uniform(&seed) - 2);
			p.m[n] = (0.2 * p.a[n] + 0.1 * p.s[n]) * (0.4 + 1.2 * uniform(&seed));
		}
		const double scale = value(&p, 0, 0, slope);

		solve(&p, NULL, 1e-7, &l1);
		for (int n = 0; n < p.n; n++)
			p.m[n] *= 0x1p-60;
		solve(&p, NULL, 1e-7, &faint);
		check_abs(faint.error * 0x1p60, l1.error, 3e-7 * scale, "minimum of the faint problem");
		assert_true(l1_lower_bound(&faint) * 0x1p60 <= l1.error + 3e-7 * scale);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(reaches_the_exact_minimum),
		cmocka_unit_test(neighbours_teach),
		cmocka_unit_test(stays_in_the_box),
		cmocka_unit_test(one_variable_is_a_weighted_median),
		cmocka_unit_test(all_zero_data_end_at_zero),
		cmocka_unit_test(finds_what_is_next_to_nothing_beside_the_box),
	};

	return cmocka_run_group_tests_name("l1", tests, NULL, NULL);
}
