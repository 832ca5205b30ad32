/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/free_form.h"
#include "fit/error/weighted_median.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status free_form_pwl(enum bins bins, const double D[FREE_FORM_VALUES], struct pwl *pwl)
{
	const double rim = 1e-6; /* radians: thin enough to weigh nothing in the normalisation */
	double theta[FREE_FORM_NODES], value[FREE_FORM_NODES];
	int n = 0;

	/* At centres the first row stands off the normal. */
	if (bins == BINS_CENTRE) {
		theta[n] = 0;
		value[n++] = D[0];
	}
	for (int i = 0; i < MERL_THETA_H; i++) {
		theta[n] = bins_angles(bins, i, 0, 0).theta_h;
		value[n++] = D[i];
	}
	theta[n] = M_PI / 2 - 2 * rim;
	value[n++] = D[MERL_THETA_H - 1];
	theta[n] = M_PI / 2 - rim;
	value[n++] = D[MERL_THETA_H];
	theta[n] = M_PI / 2;
	value[n++] = D[MERL_THETA_H];
	return pwl_init(pwl, n, theta, value, NULL);
}

/* A model under way. */
struct state {
	double D[FREE_FORM_VALUES];
	struct shape shape; /* ior and k */
	struct linear linear;
};

struct run {
	const struct fit_options *options;
	const struct sample_set *sample; /* where node values are proposed */
	struct objective full, thin;
	struct weighted_value *values;
	long evaluations;
};

/* What the normalisation has made of the values. */
static double scale_of(const double before[], const double after[])
{
	for (int i = 0; i < MERL_THETA_H; i++)
		if (before[i] > 0)
			return after[i] / before[i];
	return 1;
}

/* Has an objective use a state's D, normalised, and the G that follows from it. */
static enum status use(const struct run *r, struct objective *objective, const struct state *s)
{
	struct pwl pwl;
	struct ndf ndf;
	const enum status status = free_form_pwl(r->options->criterion.bins, s->D, &pwl);

	if (status != STATUS_OK)
		return status;
	ndf_from_pwl(&ndf, &pwl);
	objective_use(objective, &ndf);
	pwl_free(&pwl);
	return STATUS_OK;
}

/* E of a state on the full table: D is normalised, G follows from it, kd and ks are solved for. */
static enum status evaluate(struct run *r, struct state *s, double tolerance, bool certify)
{
	const enum status status = use(r, &r->full, s);

	if (status != STATUS_OK)
		return status;
	s->D[MERL_THETA_H] *= scale_of(s->D, r->full.lobe[0].D);
	memcpy(s->D, r->full.lobe[0].D, sizeof r->full.lobe[0].D);
	objective_eval(&r->full, &s->shape, tolerance, certify, &s->linear);
	r->evaluations++;
	return STATUS_OK;
}

/* The row of a sample; where it is scattered, the node next to its theta_h. */
static int row_of(const struct run *r, size_t n)
{
	const struct sample_set *t = r->sample;

	if (!t->scattered)
		return t->row[n] / MERL_THETA_D;
	const struct halfdiff angles = {atan(hypot((double)t->plane[KERNEL_H_X][n], (double)t->plane[KERNEL_H_Y][n])),
					0, 0};
	const double i = bins_indices(r->options->criterion.bins, angles).i + 0.5;

	return i < 0 ? 0 : (int)fmin(i, MERL_THETA_H - 1);
}

/* What a unit of D at the node of a sample's row adds to its lobe. Where the sample lies between nodes, as if D moved there in
 * proportion to the node. */
static float lobe_per_D(const struct run *r, const struct state *s, size_t n, int row)
{
	if (!r->sample->scattered)
		return r->thin.term[1][n];
	return s->D[row] > 0 ? r->thin.term[1][n] / (float)s->D[row] : 0;
}

/* Adds the values of D that sample n asks of its row to `wanted`. Returns how many it added. */
static int sample_values(const struct run *r, const struct state *s, size_t n, int row, struct weighted_value *wanted)
{
	const struct sample_set *t = r->sample;
	const int block = (int)(n / KERNEL_BLOCK), members = block < t->n_pair_blocks ? 2 : 1;
	int count = 0;

	for (int c = 0; c < MERL_CHANNELS; c++) {
		const float *value = sample_set_value(t, block, c) + n % KERNEL_BLOCK;
		const float per_D = (float)(s->linear.coefficient[c][1] * t->unit) * lobe_per_D(r, s, n, row),
			    below = (float)(s->linear.kd[c] / M_PI * t->unit) * t->w[n];

		for (int a = 0; a < members && per_D > 0; a++)
			wanted[count++] = (struct weighted_value){(value[a * KERNEL_BLOCK] - below) / per_D, per_D};
	}
	return count;
}

/* New node values: for each row, the median of what its entries ask for under the present kd, ks, n and G. */
static enum status propose(struct run *r, const struct state *s, double D[MERL_THETA_H])
{
	const struct sample_set *t = r->sample;
	const size_t samples = (size_t)t->n_blocks * KERNEL_BLOCK;
	size_t begin[MERL_THETA_H + 1] = {0}, end[MERL_THETA_H];
	double unit[MERL_THETA_H];
	enum status status = use(r, &r->thin, s);

	if (status != STATUS_OK)
		return status;
	/* At scattered entries the lobe is that of D as it is; at those of a table, that of D = 1. */
	for (int i = 0; i < MERL_THETA_H; i++)
		unit[i] = 1;
	memcpy(r->thin.lobe[0].D, unit, sizeof unit);
	status = objective_lobe(&r->thin, &s->shape);
	if (status != STATUS_OK)
		return status;
	for (size_t n = 0; n < samples; n++)
		begin[row_of(r, n) + 1] += 2 * MERL_CHANNELS;
	for (int i = 0; i < MERL_THETA_H; i++) {
		begin[i + 1] += begin[i];
		end[i] = begin[i];
	}
	for (size_t n = 0; n < samples; n++) {
		const int i = row_of(r, n);

		end[i] += (size_t)sample_values(r, s, n, i, r->values + end[i]);
	}
#pragma omp parallel for num_threads(r->options->threads) schedule(dynamic) if (r->options->threads > 1)
	for (int i = 0; i < MERL_THETA_H; i++)
		D[i] = weighted_median(r->values + begin[i], end[i] - begin[i], s->D[i]);
	return STATUS_OK;
}

/* Replaces *s by *next if that is better. */
static bool accept(struct state *s, const struct state *next)
{
	const bool better = next->linear.error < s->linear.error;

	if (better)
		*s = *next;
	return better;
}

/* Moves the node values of rows [from, to) towards D, the whole way or, if that leads up, part of it: G and the
 * normalisation change with D, which the medians do not foresee. */
static enum status move_rows(struct run *r, struct state *s, const double D[], int from, int to, bool *moved)
{
	enum status status = STATUS_OK;
	bool better = false;

	for (double part = 1; part > 0.1 && !better && status == STATUS_OK; part /= 2) {
		struct state next = *s;

		for (int i = from; i < to; i++)
			next.D[i] += part * (D[i] - next.D[i]);
		status = evaluate(r, &next, 1e-5, false);
		/* No node values left at all: nothing to gain that way. */
		if (status == STATUS_DOMAIN)
			status = STATUS_OK;
		else if (status == STATUS_OK)
			better = accept(s, &next);
	}
	*moved = *moved || better;
	return status;
}

/* A step of all node values; where all at once is too much, of a third of them after the other. */
static enum status step_nodes(struct run *r, struct state *s)
{
	enum { THIRD = MERL_THETA_H / 3 };
	double D[MERL_THETA_H];
	bool moved = false;
	enum status status = propose(r, s, D);

	if (status == STATUS_OK)
		status = move_rows(r, s, D, 0, MERL_THETA_H, &moved);
	for (int from = 0; from < MERL_THETA_H && !moved && status == STATUS_OK; from += THIRD) {
		bool ignored = false;

		status = move_rows(r, s, D, from, from + THIRD, &ignored);
	}
	return status;
}

/* Moves one parameter of a state by a step in its own coordinate. Returns false where there is no such point. */
static bool move_ior(struct state *s, double step)
{
	const double root = (s->shape.ior - 1) / (s->shape.ior + 1) + step; /* sqrt(F0) */

	if (root <= 0 || root >= 1)
		return false;
	s->shape.ior = fmin(fmax((1 + root) / (1 - root), FIT_IOR_MIN), FIT_IOR_MAX);
	return true;
}

static bool move_rim(struct state *s, double step)
{
	s->D[MERL_THETA_H] *= exp(10 * step);
	return true;
}

/* A step of one parameter, either way; the step grows or shrinks with success. */
static enum status step_along(struct run *r, struct state *s, bool (*move)(struct state *, double), double *step)
{
	enum status status = STATUS_OK;

	for (int side = 0; side < 2 && status == STATUS_OK; side++, *step = -*step) {
		struct state next = *s;

		if (!move(&next, *step))
			continue;
		status = evaluate(r, &next, 1e-5, false);
		if (status == STATUS_OK && accept(s, &next)) {
			*step *= 1.5;
			return STATUS_OK;
		}
	}
	*step /= 3;
	return status;
}

/* Takes up to `rounds` rounds of steps. */
static enum status follow(struct run *r, struct state *s, int rounds)
{
	const bool free_ior = fresnel_has_ior(r->options->fresnel) && isnan(r->options->ior);
	enum status status = STATUS_OK;
	double ior_step = 0.03, rim_step = 0.03;

	for (int round = 0; round < rounds && status == STATUS_OK; round++) {
		const double before = s->linear.error;

		if (fit_cancelled(r->options))
			return STATUS_INTERRUPTED;
		status = step_nodes(r, s);
		if (status == STATUS_OK && free_ior)
			status = step_along(r, s, move_ior, &ior_step);
		if (status == STATUS_OK)
			status = step_along(r, s, move_rim, &rim_step);
		if (s->linear.error > before * (1 - 2e-5) && fabs(ior_step) < 5e-3 && fabs(rim_step) < 5e-3)
			break;
	}
	return status;
}

/* Lambda at 45 degrees of a state whose rim has this value. */
static double lambda_with_rim(const struct run *r, struct state *s, double rim)
{
	struct pwl pwl;
	double lambda;

	s->D[MERL_THETA_H] = rim;
	if (free_form_pwl(r->options->criterion.bins, s->D, &pwl) != STATUS_OK)
		return NAN;
	lambda = pwl_lambda(&pwl, (struct vec3){M_SQRT1_2, 0, M_SQRT1_2});
	pwl_free(&pwl);
	return lambda;
}

/* The rim gets what is missing from Lambda, which is linear in it. */
static struct state state_of(const struct run *r, const struct cook_torrance *model)
{
	const struct geometry *g = r->sample->geometry;
	struct state s = {.shape = {.ior = model->n, .k = model->k}};

	for (int i = 0; i < MERL_THETA_H; i++)
		s.D[i] = ndf_D(&model->ndf, (struct vec3){g->entries.theta[i].sin_h, 0, g->entries.theta[i].cos_h});
	const double some = 1e5, without = lambda_with_rim(r, &s, 0), with = lambda_with_rim(r, &s, some);
	const double want = ndf_lambda(&model->ndf, (struct vec3){M_SQRT1_2, 0, M_SQRT1_2});
	const double rim = some * (want - without) / (with - without);

	s.D[MERL_THETA_H] = rim > 1 ? rim : 1;
	return s;
}

static enum status run_all(struct run *r, const struct cook_torrance starts[], int n_starts, struct state *best)
{
	enum { SHORT = 6, LONG = 40 };
	enum status status = STATUS_OK;

	best->linear.error = INFINITY;
	for (int n = 0; n < n_starts && status == STATUS_OK; n++) {
		struct state s = state_of(r, &starts[n]);

		status = evaluate(r, &s, 1e-5, false);
		/* A start that leaves the table of nodes empty is none. */
		if (status == STATUS_DOMAIN) {
			status = STATUS_OK;
			continue;
		}
		if (status == STATUS_OK)
			status = follow(r, &s, SHORT);
		if (status == STATUS_OK)
			accept(best, &s);
	}
	if (status == STATUS_OK && !isfinite(best->linear.error))
		status = STATUS_DOMAIN; /* no start was one */
	if (status == STATUS_OK)
		status = follow(r, best, LONG);
	return status;
}

enum status free_form_run(const struct multiresolution *multiresolution, const struct fit_options *options,
			  const struct cook_torrance starts[], int n_starts, struct found *found, struct pwl *pwl)
{
	struct run r = {.options = options, .sample = &multiresolution->table[SEARCH_LEVELS - 2]};
	const struct sample_set *full = &multiresolution->table[SEARCH_LEVELS - 1];
	const size_t values = (size_t)r.sample->n_blocks * KERNEL_BLOCK * 2 * MERL_CHANNELS;
	const struct ndf_class *class = ndf_find("pl");
	enum status status = objective_init(&r.full, full, options, class, 1, MASKING_FINE);
	struct state best = {0};

	*found = (struct found){.starts = n_starts, .starts_agreeing = 1};
	if (status == STATUS_OK)
		status = objective_init(&r.thin, r.sample, options, class, 1, MASKING_FINE);
	r.values = malloc(values * sizeof *r.values);
	if (status == STATUS_OK && !r.values)
		status = STATUS_NO_MEMORY;
	if (status == STATUS_OK)
		status = run_all(&r, starts, n_starts, &best);
	if (status == STATUS_OK)
		status = evaluate(&r, &best, 1e-7, true);
	if (status == STATUS_OK)
		status = free_form_pwl(options->criterion.bins, best.D, pwl);
	if (status == STATUS_OK) {
		found->shape = best.shape;
		found->linear = best.linear;
	}
	found->evaluations = r.evaluations;
	found->passes = r.full.passes;
	free(r.values);
	objective_free(&r.thin);
	objective_free(&r.full);
	return status;
}
