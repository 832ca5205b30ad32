/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/sample_set.h"
#include "fit/error/masking.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

double weight_at(enum weight weight, int i, int j, double cos_i, double cos_o)
{
	switch (weight) {
	case WEIGHT_COSINE:
		return cos_i * cos_o;
	case WEIGHT_SOLID_ANGLE:
		return cos_i * cos_o * cell_measure(i, j);
	default:
		return 1;
	}
}

double weight_of_entry(enum weight weight, double solid_angle, double cos_i, double cos_o)
{
	if (weight == WEIGHT_NONE)
		return 1;
	return cos_i * cos_o * (weight == WEIGHT_SOLID_ANGLE ? solid_angle : 1);
}

int geometry_members(const struct geometry *geometry, int n, int k[4])
{
	const int first = geometry->k[n], second = bins_mirror(geometry->criterion.bins, first);
	int count = 0;

	k[count++] = first;
	/* phi_d = 0 and 90 deg are their own mirrors; 180 is a node of the 360 table only. */
	if (second != first && second < geometry->n_phi_d)
		k[count++] = second;
	if (geometry->n_phi_d == 360 && (geometry->criterion.bins == BINS_CENTRE || first != 0)) {
		k[count++] = first + 180;
		if (second != first)
			k[count++] = second + 180;
	}
	return count;
}

bool entry_in_range(struct vec3 wi, struct vec3 wo, double min_cos)
{
	return wi.z > 1e-9 && wo.z > 1e-9 && wi.z >= min_cos && wo.z >= min_cos;
}

double max_theta_cos(double max_theta)
{
	double sine, cosine;

	sincos_deg(max_theta, &sine, &cosine);
	/* A direction that stands on the limit, rounding aside, is within it. */
	return max_theta >= 90 ? 0 : cosine - 1e-12;
}

static void set_sample(struct geometry *g, int n, int i, int j, int k, struct vec3 wi, struct vec3 wo)
{
	const double w = weight_at(g->criterion.weight, i, j, wi.z, wo.z);
	const double G = g->criterion.gaf == GAF_V_GROOVE ? gaf_G(GAF_V_GROOVE, NULL, wi, wo) : 1;

	g->q_i[n] = masking_q(wi);
	g->q_o[n] = masking_q(wo);
	g->geometric_factor[n] = (float)cook_torrance_from_G(w, G, wi.z * wo.z);
	g->w[n] = (float)w;
	g->row[n] = (uint16_t)(j + MERL_THETA_D * i);
	g->k[n] = (uint16_t)k;
}

/* Fills in the samples of one theta_h from index n on, or only counts them when n < 0. */
static int row_samples(struct geometry *g, int i, double min_cos, int n)
{
	const int last_k = bins_mirror(g->criterion.bins, 0) / 2; /* the last one before its own mirror, or on it */
	struct vec3 wi, wo;
	int count = 0;

	for (int j = 0; j < MERL_THETA_D; j++)
		for (int k = 0; k <= last_k; k++) {
			entries_dirs(&g->entries, i, j, k, &wi, &wo);
			if (!entry_in_range(wi, wo, min_cos))
				continue;
			if (n >= 0)
				set_sample(g, n + count, i, j, k, wi, wo);
			count++;
		}
	return count;
}

static enum status geometry_alloc(struct geometry *g)
{
	const size_t n = (size_t)g->n_samples + 1; /* never nothing */

	g->q_i = malloc(n * sizeof *g->q_i);
	g->q_o = malloc(n * sizeof *g->q_o);
	g->geometric_factor = malloc(n * sizeof *g->geometric_factor);
	g->w = malloc(n * sizeof *g->w);
	g->row = malloc(n * sizeof *g->row);
	g->k = malloc(n * sizeof *g->k);
	return g->q_i && g->q_o && g->geometric_factor && g->w && g->row && g->k ? STATUS_OK : STATUS_NO_MEMORY;
}

enum status geometry_init(struct geometry *g, int n_phi_d, const struct fit_options *options)
{
	const double min_cos = max_theta_cos(options->criterion.max_theta);

	*g = (struct geometry){
		.n_phi_d = n_phi_d, .criterion = options->criterion, .q_min = MASKING_Q_MAX << MASKING_Q_BITS};
	g->entries = entries_make(g->criterion.bins, n_phi_d);
	if (n_phi_d == 0)
		return STATUS_OK;
#pragma omp parallel for num_threads(options->threads) schedule(dynamic)
	for (int i = 0; i < MERL_THETA_H; i++)
		g->first[i + 1] = row_samples(g, i, min_cos, -1);
	for (int i = 0; i < MERL_THETA_H; i++)
		g->first[i + 1] += g->first[i];
	g->n_samples = g->first[MERL_THETA_H];
	if (geometry_alloc(g) != STATUS_OK) {
		geometry_free(g);
		return STATUS_NO_MEMORY;
	}
#pragma omp parallel for num_threads(options->threads) schedule(dynamic)
	for (int i = 0; i < MERL_THETA_H; i++)
		row_samples(g, i, min_cos, g->first[i]);
	for (int n = 0; n < g->n_samples; n++) {
		g->q_min = g->q_i[n] < g->q_min ? g->q_i[n] : g->q_min;
		g->q_min = g->q_o[n] < g->q_min ? g->q_o[n] : g->q_min;
	}
	return STATUS_OK;
}

void geometry_free(struct geometry *g)
{
	free(g->q_i);
	free(g->q_o);
	free(g->geometric_factor);
	free(g->w);
	free(g->row);
	free(g->k);
	*g = (struct geometry){0};
}

static enum status alloc_scattered(struct sample_set *table, size_t samples)
{
	table->plane[0] = aligned_alloc(64, KERNEL_PLANES * samples * sizeof *table->plane[0]);
	table->entry = aligned_alloc(64, samples * sizeof *table->entry);
	if (!table->plane[0] || !table->entry)
		return STATUS_NO_MEMORY;
	for (size_t p = 1; p < KERNEL_PLANES; p++)
		table->plane[p] = table->plane[0] + p * samples;
	return STATUS_OK;
}

static enum status alloc_of_table(struct sample_set *table, size_t samples)
{
	table->q_i = aligned_alloc(64, samples * sizeof *table->q_i);
	table->q_o = aligned_alloc(64, samples * sizeof *table->q_o);
	table->row = aligned_alloc(64, samples * sizeof *table->row);
	return table->q_i && table->q_o && table->row ? STATUS_OK : STATUS_NO_MEMORY;
}

enum status sample_set_alloc(struct sample_set *table, const struct geometry *geometry,
			     const struct scattered *scattered, int n_pairs, int n_singles)
{
	const int pair_blocks = (n_pairs + KERNEL_BLOCK - 1) / KERNEL_BLOCK;
	const int single_blocks = (n_singles + KERNEL_BLOCK - 1) / KERNEL_BLOCK;
	const size_t samples = (size_t)(pair_blocks + single_blocks) * KERNEL_BLOCK;
	const size_t values = (size_t)(2 * pair_blocks + single_blocks) * MERL_CHANNELS * KERNEL_BLOCK;

	*table = (struct sample_set){.geometry = geometry,
				     .scattered = scattered,
				     .n_blocks = pair_blocks + single_blocks,
				     .n_pair_blocks = pair_blocks,
				     .unit = 1,
				     .n_samples = n_pairs + n_singles};
	const enum status status = scattered ? alloc_scattered(table, samples) : alloc_of_table(table, samples);

	table->geometric_factor = aligned_alloc(64, samples * sizeof *table->geometric_factor);
	table->w = aligned_alloc(64, samples * sizeof *table->w);
	table->value = aligned_alloc(64, values * sizeof *table->value);
	if (status != STATUS_OK || !table->geometric_factor || !table->w || !table->value) {
		sample_set_free(table);
		return STATUS_NO_MEMORY;
	}
	return STATUS_OK;
}

void sample_set_free(struct sample_set *table)
{
	free(table->q_i);
	free(table->q_o);
	free(table->geometric_factor);
	free(table->w);
	free(table->row);
	free(table->plane[0]);
	free(table->entry);
	free(table->value);
	*table = (struct sample_set){0};
}

/* Fills the unused tail of the pairs, or of the singles, with samples that add nothing. */
static void pad(struct sample_set *table, size_t from, int end_block)
{
	for (size_t n = from; n < (size_t)end_block * KERNEL_BLOCK; n++) {
		table->geometric_factor[n] = table->w[n] = 0;
		if (table->scattered) {
			for (int p = 0; p < KERNEL_PLANES; p++)
				table->plane[p][n] = 1;
			table->entry[n] = 0;
		} else {
			table->q_i[n] = table->q_o[n] = MASKING_Q_MAX << MASKING_Q_BITS;
			table->row[n] = 0;
		}
		for (int c = 0; c < MERL_CHANNELS; c++) {
			float *value = sample_set_value(table, (int)(n / KERNEL_BLOCK), c) + n % KERNEL_BLOCK;

			value[0] = 0;
			if (n < (size_t)table->n_pair_blocks * KERNEL_BLOCK)
				value[KERNEL_BLOCK] = 0;
		}
	}
}

static void pad_all(struct sample_set *table, size_t n_pairs, size_t n_singles)
{
	pad(table, n_pairs, table->n_pair_blocks);
	pad(table, (size_t)table->n_pair_blocks * KERNEL_BLOCK + n_singles, table->n_blocks);
}

/* The valid entries of sample n, as offsets into the planes. */
static int valid_members(const struct geometry *g, const struct measurement *measurement, int n, size_t at[4])
{
	int k[4], valid = 0;
	const int count = geometry_members(g, n, k);

	for (int a = 0; a < count; a++) {
		const size_t entry = measurement_at(g->n_phi_d, 0, g->row[n], k[a]);

		if (!entry_is_missing(measurement, &g->criterion, entry))
			at[valid++] = entry;
	}
	return valid;
}

struct fill {
	size_t pair, single; /* next free index of each sort */
	double sum[MERL_CHANNELS], sum_w;
};

static void put(struct sample_set *table, const struct measurement *measurement, int n, size_t to, const size_t *at,
		int members, double sum[])
{
	const struct geometry *g = table->geometry;
	const float w = g->w[n], unit = (float)table->unit;

	table->q_i[to] = g->q_i[n];
	table->q_o[to] = g->q_o[n];
	table->geometric_factor[to] = g->geometric_factor[n];
	table->w[to] = g->w[n];
	table->row[to] = g->row[n];
	for (int c = 0; c < MERL_CHANNELS; c++) {
		float *value = sample_set_value(table, (int)(to / KERNEL_BLOCK), c) + to % KERNEL_BLOCK;

		for (int a = 0; a < members; a++) {
			value[a * KERNEL_BLOCK] = w * (measurement->value[c][at[a]] * unit);
			sum[c] += (double)value[a * KERNEL_BLOCK];
		}
	}
}

static void fill_row(struct sample_set *table, const struct measurement *measurement, int i, struct fill *fill)
{
	const struct geometry *g = table->geometry;
	size_t at[4];

	for (int n = g->first[i]; n < g->first[i + 1]; n++) {
		const int valid = valid_members(g, measurement, n, at);

		fill->sum_w += valid * (double)g->w[n];
		for (int a = 0; a + 1 < valid; a += 2)
			put(table, measurement, n, fill->pair++, at + a, 2, fill->sum);
		if (valid % 2)
			put(table, measurement, n, fill->single++, at + valid - 1, 1, fill->sum);
	}
}

bool sample_set_is_faint(const struct sample_set *table)
{
	const double faint = 1e-15;

	return table->sum[0] + table->sum[1] + table->sum[2] < faint * table->sum_w;
}

/* Fills in all samples; those of theta_h index i go where fill[i] says. */
static void take_values(struct sample_set *table, const struct measurement *measurement, int threads,
			const struct fill fill[])
{
	struct fill row[MERL_THETA_H];

	memcpy(row, fill, sizeof row);
#pragma omp parallel for num_threads(threads) schedule(dynamic)
	for (int i = 0; i < MERL_THETA_H; i++)
		fill_row(table, measurement, i, &row[i]);
	table->sum_w = 0;
	memset(table->sum, 0, sizeof table->sum);
	for (int i = 0; i < MERL_THETA_H; i++) {
		table->sum_w += row[i].sum_w;
		for (int c = 0; c < MERL_CHANNELS; c++)
			table->sum[c] += row[i].sum[c] / table->unit;
	}
}

/* The kernel adds a few hundred floats before it goes on in double: where those could overflow, everything in units of
 * the weight becomes smaller by a power of two, which changes no error. */
static void keep_in_range(struct sample_set *table)
{
	const double total = table->sum[0] + table->sum[1] + table->sum[2];

	if (!(total > 1e30))
		return;
	const double scale = exp2(-ceil(log2(total * 1e-20)));
	const size_t samples = (size_t)table->n_blocks * KERNEL_BLOCK;
	const size_t values = (size_t)(table->n_blocks + table->n_pair_blocks) * (size_t)MERL_CHANNELS * KERNEL_BLOCK;

	for (size_t n = 0; n < samples; n++) {
		table->geometric_factor[n] *= (float)scale;
		table->w[n] *= (float)scale;
	}
	for (size_t n = 0; n < values; n++)
		table->value[n] *= (float)scale;
	for (int c = 0; c < MERL_CHANNELS; c++)
		table->sum[c] *= scale;
	table->sum_w *= scale;
}

static enum status take_table(struct sample_set *table, const struct geometry *g, const struct measurement *measurement,
			      int threads, size_t *pairs, size_t *singles)
{
	struct fill fill[MERL_THETA_H + 1] = {0};
	enum status status;

	/* Count first: each row then knows where its samples go, whatever thread fills it. */
#pragma omp parallel for num_threads(threads) schedule(dynamic)
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int n = g->first[i]; n < g->first[i + 1]; n++) {
			size_t at[4];
			const int valid = valid_members(g, measurement, n, at);

			fill[i + 1].pair += (size_t)(valid / 2);
			fill[i + 1].single += (size_t)(valid % 2);
		}
	for (int i = 0; i < MERL_THETA_H; i++) {
		fill[i + 1].pair += fill[i].pair;
		fill[i + 1].single += fill[i].single;
	}
	const size_t n_pairs = fill[MERL_THETA_H].pair, n_singles = fill[MERL_THETA_H].single;

	if (n_pairs + n_singles == 0)
		return STATUS_NO_DATA;
	status = sample_set_alloc(table, g, NULL, (int)n_pairs, (int)n_singles);
	if (status != STATUS_OK)
		return status;
	for (int i = 0; i < MERL_THETA_H; i++)
		fill[i].single += (size_t)table->n_pair_blocks * KERNEL_BLOCK;
	take_values(table, measurement, threads, fill);
	if (sample_set_is_faint(table)) {
		table->unit = SAMPLE_SET_FAINT_UNIT;
		take_values(table, measurement, threads, fill);
	}
	*pairs = n_pairs;
	*singles = n_singles;
	return STATUS_OK;
}

enum status sample_set_init(struct sample_set *table, const struct geometry *g, const struct measurement *measurement,
			    int threads)
{
	size_t n_pairs = 0, n_singles = 0;
	enum status status;

	if (measurement->scattered) {
		status = sample_set_scattered(table, g, measurement->scattered);
		n_singles = status == STATUS_OK ? (size_t)table->n_samples : 0;
	} else {
		status = take_table(table, g, measurement, threads, &n_pairs, &n_singles);
	}
	if (status != STATUS_OK)
		return status;
	table->n_entries = MERL_CHANNELS * (2 * n_pairs + n_singles);
	pad_all(table, n_pairs, n_singles);
	if (!(table->sum[0] + table->sum[1] + table->sum[2] > 0)) {
		sample_set_free(table);
		return STATUS_NO_DATA;
	}
	keep_in_range(table);
	return STATUS_OK;
}

static bool is_padding(const struct sample_set *table, size_t n)
{
	return table->w[n] == 0;
}

/* What is measured in sample n, as a share of the table's sum: channels count alike. */
static double measured_share(const struct sample_set *table, size_t n)
{
	const int members = n < (size_t)table->n_pair_blocks * KERNEL_BLOCK ? 2 : 1;
	const double total = table->sum[0] + table->sum[1] + table->sum[2];
	double share = 0;

	for (int c = 0; c < MERL_CHANNELS; c++) {
		const float *value = sample_set_value(table, (int)(n / KERNEL_BLOCK), c) + n % KERNEL_BLOCK;

		for (int a = 0; a < members; a++)
			share += (double)value[a * KERNEL_BLOCK];
	}
	return share / (total * table->unit);
}

/* Scales p so that their sum is n_samples, or every p is 1; none is above 1, for a sample is selected once. */
static void scale_to(float *p, size_t count, double n_samples)
{
	for (int round = 0; round < 20; round++) {
		double free_sum = 0, sure = 0;

		for (size_t n = 0; n < count; n++)
			if (p[n] >= 1)
				sure++;
			else
				free_sum += (double)p[n];
		const double scale = free_sum > 0 ? (n_samples - sure) / free_sum : 1;

		if (scale <= 1.0001 && scale >= 0.9999)
			break;
		for (size_t n = 0; n < count; n++)
			p[n] = p[n] >= 1 ? 1 : fminf(1, p[n] * (float)scale);
	}
	for (size_t n = 0; n < count; n++)
		p[n] = fminf(1, p[n]);
}

static void copy_sample(struct sample_set *to, size_t b, const struct sample_set *from, size_t a, int members,
			float scale)
{
	if (to->scattered) {
		for (int p = 0; p < KERNEL_PLANES; p++)
			to->plane[p][b] = from->plane[p][a];
		to->entry[b] = from->entry[a];
	} else {
		to->q_i[b] = from->q_i[a];
		to->q_o[b] = from->q_o[a];
		to->row[b] = from->row[a];
	}
	to->geometric_factor[b] = from->geometric_factor[a] * scale;
	to->w[b] = from->w[a] * scale;
	for (int c = 0; c < MERL_CHANNELS; c++) {
		const float *x = sample_set_value(from, (int)(a / KERNEL_BLOCK), c) + a % KERNEL_BLOCK;
		float *y = sample_set_value(to, (int)(b / KERNEL_BLOCK), c) + b % KERNEL_BLOCK;

		for (int m = 0; m < members; m++)
			y[m * KERNEL_BLOCK] = x[m * KERNEL_BLOCK] * scale;
	}
}

/* Systematic sampling: sample n is selected when the running sum of p passes a whole number within it. */
static bool is_selected(const float *p, size_t n, double *running)
{
	const double before = floor(*running);

	*running += (double)p[n];
	return p[n] > 0 && floor(*running) > before;
}

enum status sample_set_thin(struct sample_set *table, const struct sample_set *full, int n_samples)
{
	const size_t count = (size_t)full->n_blocks * KERNEL_BLOCK,
		     pairs_end = (size_t)full->n_pair_blocks * KERNEL_BLOCK;
	const double even = 1.0 / full->n_samples;
	size_t n_selected[2] = {0, 0}, to[2];
	double running = 0.5;
	enum status status;
	float *p = malloc(count * sizeof *p);

	if (!p)
		return STATUS_NO_MEMORY;
	for (size_t n = 0; n < count; n++)
		p[n] = is_padding(full, n) ? 0 : (float)(n_samples * (0.75 * measured_share(full, n) + 0.25 * even));
	scale_to(p, count, fmin(n_samples, full->n_samples));
	for (size_t n = 0; n < count; n++)
		n_selected[n >= pairs_end] += is_selected(p, n, &running);
	status = sample_set_alloc(table, full->geometry, full->scattered, (int)n_selected[0], (int)n_selected[1]);
	if (status != STATUS_OK)
		goto out;
	to[0] = 0;
	to[1] = (size_t)table->n_pair_blocks * KERNEL_BLOCK;
	running = 0.5;
	for (size_t n = 0; n < count; n++)
		if (is_selected(p, n, &running))
			copy_sample(table, to[n >= pairs_end]++, full, n, n < pairs_end ? 2 : 1, 1 / p[n]);
	pad_all(table, n_selected[0], n_selected[1]);
	memcpy(table->sum, full->sum, sizeof table->sum);
	table->sum_w = full->sum_w;
	table->unit = full->unit;
	table->n_entries = full->n_entries;
	table->range = full->range;
out:
	free(p);
	return status;
}
