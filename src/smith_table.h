/* SPDX-License-Identifier: GPL-3.0-or-later */
/* smith_table - G1 of one isotropic distribution for very many directions: its nodes, sixteen to an octave of
 * cot(theta), are evaluated when first asked for, and a polynomial runs through the six around a direction. */
#ifndef SMITH_TABLE_H
#define SMITH_TABLE_H

#include "src/ndf.h"

enum { SMITH_TABLE_OCTAVES = 64, SMITH_TABLE_PER_OCTAVE = 16 };

struct smith_table {
	const struct ndf *ndf;                                         /* not owned */
	double low;                                                    /* log2 cot(theta) of node 0 */
	double node[SMITH_TABLE_OCTAVES * SMITH_TABLE_PER_OCTAVE + 1]; /* NaN: not asked for yet */
};

/* smith_table_init - an empty table. slope: the typical slope of the normals, > 0: the table reaches from 2^-30 of it to
 * 2^34 times as much. */
void smith_table_init(struct smith_table *table, const struct ndf *ndf, double slope);

/* smith_table_G1 - ndf_G1(w), w.z > 0: relative error 2e-8; 1e-6 for pl, whose D has kinks. Outside the table, and for
 * the forms of Lambda that have kinks of their own, all but the exact one, the very value. */
double smith_table_G1(struct smith_table *table, struct vec3 w);

#endif
