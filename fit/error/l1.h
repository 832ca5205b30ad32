/* SPDX-License-Identifier: GPL-3.0-or-later */
/* l1 - minimises a convex function of two variables in a box, where an evaluation costs a pass over a table.
 *
 * Here the function is sum_j |m_j - kd a_j - ks s_j|: convex, piecewise linear, nearly smooth when there are many
 * terms. The caller evaluates, the solver proposes:
 *
 *     l1_start(&l1, ...);
 *     while (!l1_done(&l1)) {
 *             evaluate at l1.x, with window l1.tau;
 *             l1_update(&l1, error, slope, curvature);
 *     }
 *
 * Every evaluation leaves a cutting plane. The planes bound the minimum from below (l1_lower_bound) and enclose it in a polygon,
 * the feasible one. Within it a Newton step is tried, on second derivatives that the table gives at first and the slopes seen
 * correct from then on; else the polygon's centroid, which cuts its area by a constant factor: it ends for any convex
 * function. */
#ifndef L1_H
#define L1_H

#include <stdbool.h>

enum { L1_CUTS = 64, L1_CORNERS = L1_CUTS + 8 };

/* A minimum nearer to 0 than this share of the box is found to full accuracy only if the solver begins without `start`. */
#define L1_FAR 1e-10

struct l1_cut {
	double x[2], error, slope[2];
};

struct l1 {
	double lo[2], hi[2]; /* the box */
	double scale;        /* tolerances are relative to this, the error at kd = ks = 0 */
	double tolerance;    /* stop when the gap is below tolerance * scale */
	bool certify;        /* the gap is the certified one; else Newton's estimate of it */
	double x[2], tau;    /* where to evaluate next, and the relative width of the curvature's window, 0 for none */
	double best[2], error;    /* the best so far */
	double slope[2], h[3];    /* a subgradient there, and the second derivatives xx, xy, yy; all 0: unknown */
	double gap;               /* estimated or certified distance of `error` from the minimum */
	int evaluations, failed;  /* failed: the last evaluations that brought nothing better */
	int nears;                /* evaluations near the best point, to certify it */
	bool cold, snapped, done; /* done: best, error, h and gap are final */
	int n_cuts;
	struct l1_cut cut[L1_CUTS];
	int n_corners; /* the feasible polygon: a convex polygon that holds every minimiser */
	double corner[L1_CORNERS][2];
};

/* l1_start - begins at `start`, moved into the box lo <= x <= hi (finite); NULL: nothing is known, and the function is the
 * one above with a, s, m >= 0 and lo = 0. h: the second derivatives of a problem much like this one, as its l1 had them in
 * the end, or NULL. */
void l1_start(struct l1 *l1, const double lo[2], const double hi[2], const double start[2], const double h[3],
	      double scale, double tolerance, bool certify);
/* l1_update - takes the value, a subgradient and, if l1->tau is not 0, the estimated second derivatives (xx, xy, yy; all 0
 * when unknown) at l1->x, then sets the next l1->x and l1->tau, or done. */
void l1_update(struct l1 *l1, double error, const double slope[2], const double curvature[3]);
/* l1_lower_bound - the least value that a convex function with these cuts can have in the box. */
double l1_lower_bound(const struct l1 *l1);

#endif
