/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/export/lambda_table.h"
#include <stdlib.h>

enum { FIRST_DENSITY = 8, LAST_DENSITY = 32 };
enum { LOG2_MIN = -60, LOG2_MAX = 24 };

#define ENOUGH 2e-7
/* Lambda below this is nothing to G1. */
#define NOTHING 1e-8

static double L_at(const struct ndf *ndf, double mu)
{
	const double length = hypot(1.0, mu);
	return mu * ndf_lambda(ndf, (struct vec3){1.0 / length, 0, mu / length});
}

/* The octave above which Lambda vanishes, or has at least become L/mu with a constant L. */
static int last_octave(const struct ndf *ndf)
{
	int last = LOG2_MAX;
	while (last > LOG2_MIN + 2 && L_at(ndf, exp2(last - 1)) < NOTHING * exp2(last - 1))
		last--;
	return last;
}

/* The octave below which L is linear. */
static int first_octave(const struct ndf *ndf, int last)
{
	for (int first = last - 2; first > LOG2_MIN; first--) {
		const double mu = exp2(first), L = L_at(ndf, mu);
		if (fabs(L_at(ndf, 0.5 * mu) - L - 0.25 * mu) < NOTHING * L)
			return first;
	}
	return LOG2_MIN;
}

double lambda_table_at(const struct lambda_table *table, double mu)
{
	const double x = (log2(mu) - table->log2_first) * table->per_octave;
	if (x <= 0)
		return table->L0 - 0.5 * mu;
	if (x >= table->n - 1)
		return table->L[table->n - 1];
	const int i = (int)fmin(fmax(floor(x), 2), table->n - 4);
	const double t = x - i, *at = table->L + i;
	const double a = (t + 2) * (t + 1) * t * (t - 1) * (t - 2) * (t - 3);
	static const double weight[6] = {-1.0 / 120, 1.0 / 24, -1.0 / 12, 1.0 / 12, -1.0 / 24, 1.0 / 120};
	double sum = 0;
	for (int k = 0; k < 6; k++) {
		const double d = t - (k - 2);
		if (d == 0)
			return at[k - 2];
		sum += weight[k] * at[k - 2] / d;
	}
	return sum * a;
}

/* The largest relative error of G1 at two points between each pair of nodes, and at as many below them. */
static double measure(const struct lambda_table *table, const struct ndf *ndf)
{
	double worst = 0;
	for (int i = -2 * table->per_octave; i < table->n; i++)
		for (double part = 0.5; part > 0.1; part -= 0.3) {
			const double mu = exp2(table->log2_first + (i + part) / table->per_octave);
			const double exact = mu / (mu + L_at(ndf, mu));
			worst = fmax(worst, fabs(mu / (mu + lambda_table_at(table, mu)) / exact - 1));
		}
	return worst;
}

static enum status fill(struct lambda_table *table, const struct ndf *ndf, int octaves)
{
	table->n = octaves * table->per_octave + 1;
	free(table->L);
	table->L = malloc((size_t)table->n * sizeof *table->L);
	if (!table->L)
		return STATUS_NO_MEMORY;
#pragma omp parallel for schedule(dynamic, 8)
	for (int i = 0; i < table->n; i++)
		table->L[i] = L_at(ndf, exp2(table->log2_first + (double)i / table->per_octave));
	table->L0 = table->L[0] + 0.5 * exp2(table->log2_first);
	table->G1_error = measure(table, ndf);
	return STATUS_OK;
}

enum status lambda_table_init(struct lambda_table *table, const struct ndf *ndf)
{
	const int last = last_octave(ndf), first = first_octave(ndf, last);
	*table = (struct lambda_table){.log2_first = first};
	for (int density = FIRST_DENSITY; density <= LAST_DENSITY; density *= 2) {
		table->per_octave = density;
		if (fill(table, ndf, last - first) != STATUS_OK)
			return STATUS_NO_MEMORY;
		if (table->G1_error < ENOUGH)
			break;
	}
	return STATUS_OK;
}

void lambda_table_free(struct lambda_table *table)
{
	free(table->L);
	*table = (struct lambda_table){0};
}
