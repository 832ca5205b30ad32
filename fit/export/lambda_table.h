/* SPDX-License-Identifier: GPL-3.0-or-later */
/* lambda_table - Smith's Lambda of an isotropic distribution as a table, for a language that cannot integrate.
 *
 * With mu = cot(theta), L(mu) = mu Lambda(mu) is smooth in ln mu, finite at grazing incidence, where it is linear in mu:
 *     L = L0 - mu/2 + O(mu^2)            since d(mu Lambda)/d mu = -(share of the slopes beyond mu)
 * and falls to nothing at normal incidence; G1 = mu/(mu + L). Between nodes, even in log2 mu, a polynomial through six of
 * them. */
#ifndef LAMBDA_TABLE_H
#define LAMBDA_TABLE_H

#include "src/ndf.h"

struct lambda_table {
	double log2_first; /* log2 mu of node 0 */
	int per_octave;    /* nodes an octave of mu */
	int n;             /* nodes, at least 6 */
	double *L;
	double L0;       /* below node 0, L = L0 - mu/2; above the last node L stays */
	double G1_error; /* the largest relative error of G1, measured between the nodes */
};

/* lambda_table_init - tabulates ndf until the error is below 2e-7, or the nodes are as dense as allowed (32 an octave).
 * STATUS_NO_MEMORY. */
MUST_CHECK enum status lambda_table_init(struct lambda_table *table, const struct ndf *ndf);
void lambda_table_free(struct lambda_table *table);

/* lambda_table_at - L(mu) from the table, for mu > 0. */
double lambda_table_at(const struct lambda_table *table, double mu);

#endif
