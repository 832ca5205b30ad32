/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/gradient.h"
#include <stdlib.h>
#include <string.h>

enum status gradient_init(struct gradient *g, struct objective *o, int n, enum masking_density density)
{
	enum status status = STATUS_OK;

	*g = (struct gradient){.objective = o};
	g->sums = malloc((size_t)o->table->n_blocks * sizeof *g->sums);
	g->probe = malloc((size_t)n * sizeof *g->probe);
	if (!g->sums || !g->probe)
		status = STATUS_NO_MEMORY;
	for (; g->n < n && status == STATUS_OK; g->n += status == STATUS_OK)
		status = objective_init(&g->probe[g->n], o->table, o->options, o->class, 1, density);
	if (status != STATUS_OK)
		gradient_free(g);
	return status;
}

void gradient_free(struct gradient *g)
{
	for (int i = 0; i < g->n; i++)
		objective_free(&g->probe[i]);
	free(g->probe);
	free(g->sums);
	*g = (struct gradient){.objective = NULL};
}

/* Floats for one block. */
struct buffers {
	_Alignas(64) float weight[OBJECTIVE_ARRAYS][KERNEL_BLOCK], near[KERNEL_BLOCK];
};

static void sum_block(const struct gradient *g, const struct linear *linear, int block)
{
	const struct objective *o = g->objective;
	const struct sample_set *table = o->table;
	const size_t at = (size_t)block * KERNEL_BLOCK;
	const int slices = objective_slices(o),
		  members = (block < table->n_pair_blocks ? 2 : 1) * MERL_CHANNELS / slices;
	const float *term[KERNEL_TERMS] = {table->w + at};
	struct buffers b;
	float *weight[KERNEL_TERMS] = {NULL};

	memset(b.weight, 0, sizeof b.weight);
	for (int c = 0; c < slices; c++) {
		double x[KERNEL_TERMS];

		for (int t = 1; t < o->terms.n; t++) {
			const int array = objective_array(o, t, c);

			term[t] = o->term[array] + at;
			weight[t] = b.weight[array];
		}
		for (int t = 0; t < o->terms.n; t++)
			x[t] = linear->coefficient[c][t] * table->unit;
		o->kernel->signs(o->terms.n, members, sample_set_value(table, block, c), term, x, weight);
	}
	for (int i = 0; i < g->n; i++) {
		g->sums[block][i] = 0;
		for (int a = 1; a < o->n_arrays; a++) {
			objective_term_block(&g->probe[i], a, block, b.near);
			g->sums[block][i] -= o->kernel->change(b.weight[a], o->term[a] + at, b.near);
		}
	}
}

enum status gradient_changes(struct gradient *g, const struct linear *linear, const struct shape near[],
			     double change[])
{
	enum { CHUNK = 8 };
	struct objective *o = g->objective;
	const size_t n_blocks = (size_t)o->table->n_blocks;
	const double sum = (o->table->sum[0] + o->table->sum[1] + o->table->sum[2]) * o->table->unit;

	for (int i = 0; i < g->n; i++) {
		const enum status status = objective_tabulate(&g->probe[i], &near[i]);

		if (status != STATUS_OK)
			return status;
	}
	o->passes++;
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wsign-conversion" /* clang finds some in what it makes of the loop */
#pragma omp taskloop grainsize(CHUNK) default(shared) if (o->threads > 1)
	for (size_t block = 0; block < n_blocks; block++)
		sum_block(g, linear, (int)block);
#pragma GCC diagnostic pop
	for (int i = 0; i < g->n; i++) {
		change[i] = 0;
		for (size_t block = 0; block < n_blocks; block++)
			change[i] += g->sums[block][i] / sum;
	}
	return STATUS_OK;
}
