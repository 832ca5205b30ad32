/* SPDX-License-Identifier: GPL-3.0-or-later */
/* bundle - minimises a convex function of a few variables in a polytope, where an evaluation costs a pass over a table.
 *
 * Here the function is sum_j |m_j - x . a_j|: convex, piecewise linear, nearly smooth when there are many terms. The caller evaluates,
 * the solver proposes:
 *
 *     bundle_start(&bundle, ...);
 *     while (!bundle.done) {
 *             evaluate at bundle.x, with window bundle.tau;
 *             bundle_update(&bundle, error, slope, curvature);
 *     }
 *
 * Every evaluation leaves a cutting plane; together they bound the minimum from below. A Newton step is tried on second
 * derivatives that the table gives at first and the slopes correct from then on. Where it does not help, the least of
 * the planes is sought, held near the best point by a quadratic term that fades: a proximal bundle method (Kiwiel 1990),
 * which ends for any convex function. */
#ifndef BUNDLE_H
#define BUNDLE_H

#include <stdbool.h>

enum {
	BUNDLE_VARIABLES = 5,
	BUNDLE_SECOND = BUNDLE_VARIABLES * (BUNDLE_VARIABLES + 1) /
			2, /* second derivatives: row by row, from the diagonal on */
	BUNDLE_LINEAR = 24,
	BUNDLE_CUTS = 64
};

/* A minimum nearer to 0 than this share of the box is found to full accuracy only if the solver begins without `start`. */
#define BUNDLE_FAR 1e-10

/* struct bundle_domain - lo <= x <= hi, finite, and normal . x <= level for each of the linear constraints. */
struct bundle_domain {
	int n, n_linear;
	double lo[BUNDLE_VARIABLES], hi[BUNDLE_VARIABLES];
	double normal[BUNDLE_LINEAR][BUNDLE_VARIABLES], level[BUNDLE_LINEAR];
};

struct bundle_cut {
	double x[BUNDLE_VARIABLES], error, slope[BUNDLE_VARIABLES];
};

struct bundle {
	struct bundle_domain domain;
	double scale;                    /* tolerances are relative to this, the error at x = 0 */
	double tolerance;                /* stop when the gap is below tolerance * scale */
	bool certify;                    /* the gap is the certified one; else Newton's estimate of it */
	double x[BUNDLE_VARIABLES], tau; /* where to evaluate next, and the relative width of the curvature's window */
	double best[BUNDLE_VARIABLES], error;         /* the best so far */
	double slope[BUNDLE_VARIABLES];               /* a subgradient there */
	double h[BUNDLE_VARIABLES][BUNDLE_VARIABLES]; /* and the second derivatives; all 0: unknown */
	double gap;                                   /* estimated or certified distance of `error` from the minimum */
	double lower_bound; /* the function's least value is not below it; of a certified solve only */
	int evaluations, failed, nears;
	bool cold, snapped, done; /* done: best, error, h, gap and lower_bound are final */
	int n_cuts;
	struct bundle_cut cut[BUNDLE_CUTS];
};

/* bundle_start - begins at `start`, moved into the domain; NULL: nothing is known, and x = lo is feasible.
 * second: the second derivatives of a problem much like this one, or NULL; bundle_second - those that this one ended with. */
void bundle_start(struct bundle *bundle, const struct bundle_domain *domain, const double start[],
		  const double second[], double scale, double tolerance, bool certify);
void bundle_second(const struct bundle *bundle, double second[]);
/* bundle_update - takes the value, a subgradient and, if bundle->tau is not 0, the estimated second derivatives (all 0 when
 * unknown) at bundle->x, then sets the next bundle->x and bundle->tau, or done. */
void bundle_update(struct bundle *bundle, double error, const double slope[], const double second[]);

#endif
