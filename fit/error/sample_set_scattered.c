/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/sample_set.h"
#include "src/smith.h"
#include <limits.h>
#include <math.h>
#include <stdlib.h>

/* An entry that takes part, and what puts it in order. */
struct place {
	double order; /* squared tan theta_h */
	uint32_t entry;
};

/* The slopes of h = (wi + wo)/|wi + wo| are those of the sum itself. */
static double squared_slope(struct vec3 v)
{
	return (v.x * v.x + v.y * v.y) / (v.z * v.z);
}

/* By theta_h: samples that stand together then ask for neighbouring values of D, a thinned table has its share of each theta_h,
 * and the order of the file matters only between entries of one theta_h. */
static int by_order(const void *a, const void *b)
{
	const struct place *p = a, *q = b;

	if (p->order != q->order)
		return p->order < q->order ? -1 : 1;
	return (p->entry > q->entry) - (p->entry < q->entry);
}

/* Returns how many entries take part; 0 with *place NULL: out of memory. */
static size_t list_places(const struct scattered *s, const struct criterion *criterion, struct place **place)
{
	const double min_cos = max_theta_cos(criterion->max_theta);
	size_t count = 0;

	*place = malloc(s->n * sizeof **place);
	for (size_t n = 0; *place && n < s->n; n++)
		if (scattered_takes_part(s, criterion, min_cos, n) && count < INT_MAX)
			(*place)[count++] = (struct place){squared_slope(vec3_add(s->wi[n], s->wo[n])), (uint32_t)n};
	if (*place)
		qsort(*place, count, sizeof **place, by_order);
	return count;
}

/* A factor beyond this, of an entry within 1e-6 of the horizon, counts as this: it is still a float. */
#define FACTOR_MAX 1e36

/* w / (4 cos_i cos_o cos_h^4): P22 cos_h^-4 is D. */
static float factor(enum gaf gaf, double w, struct vec3 wi, struct vec3 wo, double cos_h)
{
	const double G = gaf == GAF_V_GROOVE ? gaf_G(GAF_V_GROOVE, NULL, wi, wo) : 1;
	const double square = cos_h * cos_h;

	return (float)fmin(cook_torrance_from_G(w, G, wi.z * wo.z) / square / square, FACTOR_MAX);
}

static void widen(struct sample_range *range, double h, double i, double o, double cos_d)
{
	range->h_min = fmin(range->h_min, h);
	range->h_max = fmax(range->h_max, h);
	range->w_min = fmin(range->w_min, fmin(i, o));
	range->w_max = fmax(range->w_max, fmax(i, o));
	range->cos_d_min = fmin(range->cos_d_min, cos_d);
}

static void put(struct sample_set *table, size_t n, uint32_t entry)
{
	const struct scattered *s = table->scattered;
	const struct criterion *criterion = &table->geometry->criterion;
	const struct vec3 wi = s->wi[entry], wo = s->wo[entry], sum = vec3_add(wi, wo);
	const double length = vec3_length(sum), cos_d = fmin(0.5 * length, 1);
	const double w = weight_of_entry(criterion->weight, (double)s->solid_angle[entry], wi.z, wo.z);
	const struct vec3 slope[] = {sum, wi, wo};

	for (int v = 0; v < 3; v++) {
		table->plane[KERNEL_H_X + 2 * v][n] = (float)(slope[v].x / slope[v].z);
		table->plane[KERNEL_H_Y + 2 * v][n] = (float)(slope[v].y / slope[v].z);
	}
	table->plane[KERNEL_COS_D][n] = (float)cos_d;
	table->geometric_factor[n] = factor(criterion->gaf, w, wi, wo, sum.z / length);
	table->w[n] = (float)w;
	table->entry[n] = entry;
	widen(&table->range, squared_slope(sum), squared_slope(wi), squared_slope(wo), cos_d);
	table->sum_w += (double)table->w[n];
	for (int c = 0; c < MERL_CHANNELS; c++) {
		float *value = sample_set_value(table, (int)(n / KERNEL_BLOCK), c) + n % KERNEL_BLOCK;

		*value = table->w[n] * (s->value[c][entry] * (float)table->unit);
		table->sum[c] += (double)*value / table->unit;
	}
}

static void put_all(struct sample_set *table, const struct place *place, size_t count)
{
	table->range = (struct sample_range){INFINITY, 0, INFINITY, 0, 1};
	table->sum_w = 0;
	for (int c = 0; c < MERL_CHANNELS; c++)
		table->sum[c] = 0;
	for (size_t n = 0; n < count; n++)
		put(table, n, place[n].entry);
}

enum status sample_set_scattered(struct sample_set *table, const struct geometry *g, const struct scattered *s)
{
	struct place *place;
	const size_t count = list_places(s, &g->criterion, &place);
	enum status status = place ? STATUS_OK : STATUS_NO_MEMORY;

	if (status == STATUS_OK && count == 0)
		status = STATUS_NO_DATA;
	if (status == STATUS_OK)
		status = sample_set_alloc(table, g, s, 0, (int)count);
	if (status == STATUS_OK)
		put_all(table, place, count);
	if (status == STATUS_OK && sample_set_is_faint(table)) {
		table->unit = SAMPLE_SET_FAINT_UNIT;
		put_all(table, place, count);
	}
	free(place);
	return status;
}
