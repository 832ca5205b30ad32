/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/smith_table.h"

enum { LAST = SMITH_TABLE_OCTAVES * SMITH_TABLE_PER_OCTAVE };

void smith_table_init(struct smith_table *table, const struct ndf *ndf, double slope)
{
	table->ndf = ndf;
	table->low = floor(log2(slope)) - 30.0;
	for (int i = 0; i <= LAST; i++)
		table->node[i] = NAN;
}

static double node_at(struct smith_table *table, int i)
{
	if (isnan(table->node[i])) {
		const double cot = exp2(table->low + (double)i / SMITH_TABLE_PER_OCTAVE);
		const double sine = 1.0 / sqrt(1.0 + cot * cot);
		table->node[i] = ndf_G1(table->ndf, (struct vec3){sine, 0.0, cot * sine});
	}
	return table->node[i];
}

/* Lagrange's polynomial through six nodes, at t in [0, 1) between the third and the fourth. */
static double six_points(const double y[6], double t)
{
	const double a = t + 2.0, b = t + 1.0, d = t - 1.0, e = t - 2.0, f = t - 3.0;
	return (b * t * d * (e * (a * y[5] - f * y[0])) + 5.0 * a * t * (d * e * f * y[1] - b * d * f * y[4]) +
		10.0 * a * b * (t * e * f * y[3] - d * e * f * y[2])) /
	       120.0;
}

double smith_table_G1(struct smith_table *table, struct vec3 w)
{
	const double position = (log2(w.z) - log2(hypot(w.x, w.y)) - table->low) * SMITH_TABLE_PER_OCTAVE;
	if (!(position >= 2.0 && position < LAST - 3.0) || table->ndf->lambda_form != LAMBDA_EXACT)
		return ndf_G1(table->ndf, w);
	const int i = (int)position;
	double y[6];
	for (int k = 0; k < 6; k++)
		y[k] = node_at(table, i - 2 + k);
	return six_points(y, position - i);
}
