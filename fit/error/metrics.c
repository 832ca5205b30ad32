/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/metrics.h"
#include "fit/error/error_sum.h"
#include "fit/error/masking.h"
#include <math.h>
#include <stdlib.h>

/* Sums over the entries and channels of one theta_h. */
struct sums {
	double difference[WEIGHT_COUNT], measured[WEIGHT_COUNT];
	double square, cube_root, log;
	size_t n;
};

/* The entries of one row (theta_h, theta_d): measured m, the lobe of the model, and c = cos_i cos_o. Of a rich model `lobe` is not
 * used: `f` has its values. */
enum { ROW_MAX = 4 * 91 };
struct row {
	int n;
	bool rich;
	double c[ROW_MAX], lobe[ROW_MAX], m[MERL_CHANNELS][ROW_MAX], f[MERL_CHANNELS][ROW_MAX];
};

/* Cube root to float precision, in a form that vectorises: a first guess from the exponent, two steps of Halley. */
static inline float cube_root(float x)
{
	union {
		float f;
		int32_t i;
	} y = {x};

	y.i = 0x2a5119f2 + y.i / 3;
	for (int step = 0; step < 2; step++) {
		const float cube = y.f * y.f * y.f;

		/* Over 4, so that no x is too large. */
		y.f *= (0.25F * cube + 0.5F * x) / (0.5F * cube + 0.25F * x);
	}
	return x > 1e-36F ? y.f : 0;
}

/* A constant `rich` is folded in. */
__attribute__((always_inline)) static inline void
sum_values(const struct row *row, bool rich, const struct cook_torrance *model, double cell, struct sums *sums)
{
	const double offset = 1e-3; /* of the logarithmic metric */

	for (int c = 0; c < MERL_CHANNELS; c++) {
		const double kd = rich ? 0 : model->kd[c] / M_PI, ks = rich ? 1 : model->ks[c];
		const double *m = row->m[c], *lobe = rich ? row->f[c] : row->lobe;
		double d_none = 0, d_cosine = 0, m_none = 0, m_cosine = 0, square = 0, root = 0;

#pragma omp simd reduction(+ : d_none, d_cosine, m_none, m_cosine, square, root)
		for (int n = 0; n < row->n; n++) {
			const double f = kd + ks * lobe[n], w = row->c[n], r = error_term(1, m[n], f);
			const float step = cube_root((float)(w * m[n])) - cube_root((float)(w * f));

			d_none += r;
			d_cosine += error_term(w, m[n], f);
			m_none += m[n];
			m_cosine += w * m[n];
			square += w * w * r * r;
			root += (double)(step * step);
		}
		/* A sum of |ln| is the ln of a product: six ratios of at most 1e42 each stay far from overflow. */
		for (int n = 0; n < row->n; n += 6) {
			double product = 1;

			for (int a = n; a < n + 6 && a < row->n; a++) {
				const double f = kd + ks * lobe[a];
				const double x = row->c[a] * m[a] + offset, y = row->c[a] * f + offset;

				product *= x > y ? x / y : y / x;
			}
			sums->log += log(product);
		}
		sums->difference[WEIGHT_NONE] += d_none;
		sums->difference[WEIGHT_COSINE] += d_cosine;
		sums->difference[WEIGHT_SOLID_ANGLE] += cell * d_cosine;
		sums->measured[WEIGHT_NONE] += m_none;
		sums->measured[WEIGHT_COSINE] += m_cosine;
		sums->measured[WEIGHT_SOLID_ANGLE] += cell * m_cosine;
		sums->square += square;
		sums->cube_root += root;
	}
	sums->n += (size_t)row->n * MERL_CHANNELS;
}

static void sum_row(const struct row *row, const struct cook_torrance *model, double cell, struct sums *sums)
{
	if (row->rich)
		sum_values(row, true, model, cell, sums);
	else
		sum_values(row, false, model, cell, sums);
}

/* Adds the valid entries of sample n to the row. */
static void add_entries(struct row *row, const struct geometry *g, const struct measurement *measurement, int n,
			double c, double lobe, const double f[])
{
	int k[4];
	const int count = geometry_members(g, n, k);

	for (int a = 0; a < count; a++) {
		const size_t at = measurement_at(g->n_phi_d, 0, g->row[n], k[a]);

		if (entry_is_missing(measurement, &g->criterion, at))
			continue;
		row->c[row->n] = c;
		row->lobe[row->n] = lobe;
		for (int ch = 0; ch < MERL_CHANNELS; ch++) {
			row->m[ch][row->n] = (double)measurement->value[ch][at];
			if (row->rich)
				row->f[ch][row->n] = f[ch];
		}
		row->n++;
	}
}

/* The parts of a model that a table of (theta_h, theta_d, phi_d) asks for again and again. */
struct parts {
	struct lobe_parts {
		struct masking masking;
		double D[MERL_THETA_H];
	} lobe[2];
	double F[MERL_CHANNELS][MERL_THETA_D];
	bool rich;
};

static enum status lobe_init(struct lobe_parts *lobe, const struct geometry *g, const struct ndf *ndf)
{
	for (int i = 0; i < MERL_THETA_H; i++)
		lobe->D[i] = ndf_D(ndf, (struct vec3){g->entries.theta[i].sin_h, 0, g->entries.theta[i].cos_h});
	if (masking_init(&lobe->masking, g->q_min, MASKING_FINE) != STATUS_OK)
		return STATUS_NO_MEMORY;
	if (g->criterion.gaf != GAF_V_GROOVE)
		masking_fill(&lobe->masking, ndf);
	return STATUS_OK;
}

static void parts_free(struct parts *parts)
{
	for (int l = 0; l < 2; l++)
		masking_free(&parts->lobe[l].masking);
}

static enum status parts_init(struct parts *parts, const struct geometry *g, const struct cook_torrance *model)
{
	*parts = (struct parts){.rich = cook_torrance_is_rich(model)};
	for (int c = 0; c < MERL_CHANNELS; c++)
		for (int j = 0; j < MERL_THETA_D; j++)
			parts->F[c][j] = cook_torrance_F(model, c, g->entries.theta[j].cos_d);
	enum status status = lobe_init(&parts->lobe[0], g, &model->ndf);

	if (status == STATUS_OK && cook_torrance_has_second(model))
		status = lobe_init(&parts->lobe[1], g, &model->second);
	if (status != STATUS_OK)
		parts_free(parts);
	return status;
}

static double cos_product(const struct geometry *g, int n)
{
	const struct halfdiff_trig *h = &g->entries.theta[g->row[n] / MERL_THETA_D],
				   *d = &g->entries.theta[g->row[n] % MERL_THETA_D];
	const double a = h->cos_h * d->cos_d, b = h->sin_h * d->sin_d * g->entries.phi[g->k[n]].cos_phi;

	return (a - b) * (a + b);
}

/* D G / (4 cos_i cos_o) of sample n, c: cos_i cos_o, times a factor. */
static double facets_at(const struct lobe_parts *p, const struct geometry *g, int n, double c, double factor)
{
	const double spread = p->D[g->row[n] / MERL_THETA_D] * factor;

	/* geometric_factor and w both carry the weight of the fit; geometric_factor alone has the v-groove's G. */
	if (g->criterion.gaf == GAF_V_GROOVE)
		return spread * (double)g->geometric_factor[n] / (double)g->w[n];
	return cook_torrance_from_G1(g->criterion.gaf, spread, masking_at(&p->masking, g->q_i[n]),
				     masking_at(&p->masking, g->q_o[n]), c);
}

/* The values of a rich model at sample n. */
static void rich_at(const struct parts *p, const struct geometry *g, const struct cook_torrance *model, int n, double c,
		    double f[MERL_CHANNELS])
{
	const int j = g->row[n] % MERL_THETA_D;
	const double facets = facets_at(&p->lobe[0], g, n, c, 1);
	const double second = cook_torrance_has_second(model) ? facets_at(&p->lobe[1], g, n, c, 1) : 0;
	double grazing = 0;

	if (cook_torrance_has_grazing(model)) {
		struct vec3 wi, wo;

		entries_dirs(&g->entries, g->row[n] / MERL_THETA_D, j, g->k[n], &wi, &wo);
		grazing = cook_torrance_grazing(model->grazing, wi.z, wo.z, g->entries.theta[j].cos_d);
	}
	for (int ch = 0; ch < MERL_CHANNELS; ch++)
		f[ch] = model->kd[ch] / M_PI + model->kg[ch] * grazing +
			p->F[ch][j] * (model->ks[ch] * facets + model->ks_second[ch] * second);
}

static void add_sums(struct sums *all, const struct sums *sums)
{
	for (int w = 0; w < WEIGHT_COUNT; w++) {
		all->difference[w] += sums->difference[w];
		all->measured[w] += sums->measured[w];
	}
	all->square += sums->square;
	all->cube_root += sums->cube_root;
	all->log += sums->log;
	all->n += sums->n;
}

/* A scattered entry that takes part is a row of its own; no table is used. */
static void sum_scattered(const struct scattered *s, const struct cook_torrance *model, size_t n, struct sums *sums)
{
	struct row row = {.n = 1, .rich = cook_torrance_is_rich(model)};
	double f[MERL_CHANNELS] = {0};

	row.c[0] = s->wi[n].z * s->wo[n].z;
	if (row.rich)
		cook_torrance_f(model, s->wi[n], s->wo[n], f);
	else
		row.lobe[0] = cook_torrance_lobe(model, s->wi[n], s->wo[n]);
	for (int c = 0; c < MERL_CHANNELS; c++) {
		row.m[c][0] = (double)s->value[c][n];
		row.f[c][0] = f[c];
	}
	sum_row(&row, model, (double)s->solid_angle[n], sums);
}

/* Sums of so many entries each: whatever the number of threads, they are added in the same order. */
enum { CHUNK = 1024 };

static enum status sum_all_scattered(const struct geometry *g, const struct scattered *s,
				     const struct cook_torrance *model, int threads, struct sums *all)
{
	const double min_cos = max_theta_cos(g->criterion.max_theta);
	const size_t chunks = (s->n + CHUNK - 1) / CHUNK;
	struct sums *sums = calloc(chunks, sizeof *sums);

	if (!sums)
		return STATUS_NO_MEMORY;
#pragma omp parallel for num_threads(threads) schedule(dynamic) if (threads > 1)
	for (size_t chunk = 0; chunk < chunks; chunk++)
		for (size_t n = chunk * CHUNK; n < (chunk + 1) * CHUNK && n < s->n; n++)
			if (scattered_takes_part(s, &g->criterion, min_cos, n))
				sum_scattered(s, model, n, &sums[chunk]);
	for (size_t chunk = 0; chunk < chunks; chunk++)
		add_sums(all, &sums[chunk]);
	free(sums);
	return STATUS_OK;
}

/* One theta_h, all its rows into sums[0] or each into sums[its theta_d]. */
static void sum_theta_h(const struct geometry *g, const struct measurement *measurement,
			const struct cook_torrance *model, const struct parts *parts, int i, bool by_row,
			struct sums *sums)
{
	struct row row = {.n = 0, .rich = parts->rich};
	double f[MERL_CHANNELS] = {0};

	for (int n = g->first[i]; n < g->first[i + 1]; n++) {
		const double c = cos_product(g, n), F = parts->F[0][g->row[n] % MERL_THETA_D];
		const double lobe = parts->rich ? 0 : facets_at(&parts->lobe[0], g, n, c, F);

		if (parts->rich)
			rich_at(parts, g, model, n, c, f);
		add_entries(&row, g, measurement, n, c, lobe, f);
		if (n + 1 == g->first[i + 1] || g->row[n + 1] != g->row[n]) {
			const int j = g->row[n] % MERL_THETA_D;

			sum_row(&row, model, cell_measure(i, j), &sums[by_row ? j : 0]);
			row.n = 0;
		}
	}
}

static enum status sum_table(const struct geometry *g, const struct measurement *measurement,
			     const struct cook_torrance *model, int threads, struct sums *all)
{
	struct sums sums[MERL_THETA_H] = {{.n = 0}};
	struct parts parts;

	if (parts_init(&parts, g, model) != STATUS_OK)
		return STATUS_NO_MEMORY;
#pragma omp parallel for num_threads(threads) schedule(dynamic) if (threads > 1)
	for (int i = 0; i < MERL_THETA_H; i++)
		sum_theta_h(g, measurement, model, &parts, i, false, &sums[i]);
	parts_free(&parts);
	for (int i = 0; i < MERL_THETA_H; i++)
		add_sums(all, &sums[i]);
	return STATUS_OK;
}

enum status metrics_compute(const struct geometry *g, const struct measurement *measurement,
			    const struct cook_torrance *model, int threads, struct fit_metrics *metrics)
{
	struct sums all = {.n = 0};
	const enum status status = measurement->scattered
					   ? sum_all_scattered(g, measurement->scattered, model, threads, &all)
					   : sum_table(g, measurement, model, threads, &all);

	if (status != STATUS_OK)
		return status;
	if (!(all.measured[WEIGHT_COSINE] > 0))
		return STATUS_NO_DATA;
	for (int w = 0; w < WEIGHT_COUNT; w++)
		metrics->error[w] = error_ratio(all.difference[w], all.measured[w]);
	metrics->rms_cosine = sqrt(all.square / (double)all.n);
	metrics->rms_cube_root = sqrt(all.cube_root / (double)all.n);
	metrics->log_error = all.log / (double)all.n;
	metrics->samples = all.n;
	return STATUS_OK;
}

/* Each entry in the row of a table with nodes that is next to it. */
static void sum_scattered_rows(const struct geometry *g, const struct scattered *s, const struct cook_torrance *model,
			       struct sums *sums)
{
	const double min_cos = max_theta_cos(g->criterion.max_theta);

	for (size_t n = 0; n < s->n; n++) {
		const struct bins_indices at = bins_indices(BINS_NODE, halfdiff_from_dirs(s->wi[n], s->wo[n]));
		const int i = (int)fmin(at.i + 0.5, MERL_THETA_H - 1), j = (int)fmin(at.j + 0.5, MERL_THETA_D - 1);

		if (scattered_takes_part(s, &g->criterion, min_cos, n))
			sum_scattered(s, model, n, &sums[j + MERL_THETA_D * i]);
	}
}

enum status metrics_rows(const struct geometry *g, const struct measurement *measurement,
			 const struct cook_torrance *model, int threads, struct metrics_row row[MERL_ROWS])
{
	struct sums *sums = calloc(MERL_ROWS, sizeof *sums);
	struct parts parts;

	if (!sums || (!measurement->scattered && parts_init(&parts, g, model) != STATUS_OK)) {
		free(sums);
		return STATUS_NO_MEMORY;
	}
	if (measurement->scattered) {
		sum_scattered_rows(g, measurement->scattered, model, sums);
	} else {
#pragma omp parallel for num_threads(threads) schedule(dynamic) if (threads > 1)
		for (int i = 0; i < MERL_THETA_H; i++)
			sum_theta_h(g, measurement, model, &parts, i, true, sums + (size_t)i * MERL_THETA_D);
		parts_free(&parts);
	}
	for (int n = 0; n < MERL_ROWS; n++)
		row[n] = (struct metrics_row){sums[n].difference[g->criterion.weight],
					      sums[n].measured[g->criterion.weight], sums[n].n};
	free(sums);
	return STATUS_OK;
}
