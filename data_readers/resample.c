/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/resample.h"
#include "data_readers/rgl.h"
#include <stdlib.h>
#include <string.h>

enum {
	AXES = 3,
	SIDES = 4,      /* of a point, in the first two coordinates */
	PER_SIDE = 2,   /* entries that are averaged */
	AT_POINT = 2,   /* entries at the very point that are: both orders of wi and wo */
	TURNS = 8,      /* about the normal, over which a sample that is not isotropic is averaged */
	NEIGHBOURS = 4, /* the last of these tells how dense entries lie */
};

#define FAR 40.0  /* no entry reaches farther than this */
#define NEAR 1e-4 /* entries within this of a point are at it */
#define CELL 0.5  /* half a cell of the table: always near */
#define REACH 1.5 /* times the distance to the fourth neighbour */
#define LOOK 2.0  /* times the reach: how far entries to average may be */
#define DEGREES (180 / M_PI)

/* Entries by their coordinates, as a tree: the middle one divides the others along an axis. */
struct place {
	float x[AXES];
	uint32_t entry;
	float reach; /* how far around it counts as measured */
	int axis;
};

struct tree {
	struct place *place;
	size_t n;
};

static void coordinates(struct vec3 wi, struct vec3 wo, int n_phi_d, float x[AXES])
{
	const struct halfdiff a = halfdiff_from_dirs(wi, wo);
	const double h = DEGREES * a.theta_h, d = DEGREES * a.theta_d;
	double phi = DEGREES * a.phi_d;
	phi = phi > 180 ? 360 - phi : phi;
	if (n_phi_d == 180)
		phi = phi > 90 ? 180 - phi : phi;
	x[0] = (float)(90 * sqrt(h / 90));
	x[1] = (float)(d / 4);
	x[2] = (float)(phi / 5 * fmin(1, d / 30) * fmin(1, h / 10));
}

static int widest(const struct place *place, size_t n)
{
	float low[AXES], high[AXES];
	int best = 0;
	memcpy(low, place->x, sizeof low);
	memcpy(high, place->x, sizeof high);
	for (size_t p = 1; p < n; p++)
		for (int a = 0; a < AXES; a++) {
			low[a] = fminf(low[a], place[p].x[a]);
			high[a] = fmaxf(high[a], place[p].x[a]);
		}
	for (int a = 1; a < AXES; a++)
		if (high[a] - low[a] > high[best] - low[best])
			best = a;
	return best;
}

static void swap(struct place *a, struct place *b)
{
	const struct place other = *a;
	*a = *b;
	*b = other;
}

/* Puts the k-th along the axis at its place, smaller ones before it, larger ones behind [Hoare's selection]. */
static void select_middle(struct place *place, size_t n, size_t k, int axis)
{
	size_t low = 0, high = n - 1;
	while (low < high) {
		const float pivot = place[low + (high - low) / 2].x[axis];
		size_t i = low, j = high;
		for (;;) {
			while (place[i].x[axis] < pivot)
				i++;
			while (place[j].x[axis] > pivot)
				j--;
			if (i >= j)
				break;
			swap(&place[i++], &place[j--]);
		}
		/* All up to j are at most the pivot, all from j + 1 at least. */
		if (k <= j)
			high = j;
		else
			low = j + 1;
	}
}

static void build(struct place *place, size_t n)
{
	while (n > 1) {
		const size_t middle = n / 2;
		const int axis = widest(place, n);
		select_middle(place, n, middle, axis);
		place[middle].axis = axis;
		build(place, middle);
		place += middle + 1;
		n -= middle + 1;
	}
}

/* A search for the nearest places, all or those on one side. */
struct query {
	const float *x;
	int side; /* bit a: those with x[a] at or above the point's, else below it; -1: all */
	size_t n, max;
	double bound; /* square of the largest distance of interest */
	double distance[NEIGHBOURS + 1];
	const struct place *found[NEIGHBOURS + 1];
};

static bool is_on_side(const struct query *q, const struct place *p)
{
	for (int a = 0; q->side >= 0 && a < 2; a++)
		if ((p->x[a] >= q->x[a]) != (q->side >> a & 1))
			return false;
	return true;
}

static void consider(struct query *q, const struct place *p)
{
	double distance = 0;
	for (int a = 0; a < AXES; a++) {
		const double d = (double)p->x[a] - (double)q->x[a];
		distance += d * d;
	}
	if (distance >= q->bound || !is_on_side(q, p))
		return;
	size_t at = q->n < q->max ? q->n++ : q->n - 1;
	for (; at > 0 && q->distance[at - 1] > distance; at--) {
		q->distance[at] = q->distance[at - 1];
		q->found[at] = q->found[at - 1];
	}
	q->distance[at] = distance;
	q->found[at] = p;
	if (q->n == q->max)
		q->bound = q->distance[q->n - 1];
}

static void search(struct query *q, const struct place *place, size_t n)
{
	while (n > 0) {
		const struct place *middle = place + n / 2;
		const size_t n_low = n / 2, n_high = n - n / 2 - 1;
		const int axis = middle->axis;
		const double ahead = (double)q->x[axis] - (double)middle->x[axis];
		const bool sided = q->side >= 0 && axis < 2;
		const bool no_low = sided && (q->side >> axis & 1) && ahead > 0;
		const bool no_high = sided && !(q->side >> axis & 1) && ahead < 0;
		consider(q, middle);
		if (no_low || no_high) {
			place = no_low ? middle + 1 : place;
			n = no_low ? n_high : n_low;
			continue;
		}
		const struct place *near = ahead < 0 ? place : middle + 1, *far = ahead < 0 ? middle + 1 : place;
		search(q, near, ahead < 0 ? n_low : n_high);
		if (ahead * ahead >= q->bound)
			return;
		place = far;
		n = ahead < 0 ? n_high : n_low;
	}
}

/* How far the surroundings of each entry reach. Equal ones are one for this. */
static void find_reach(const struct tree *tree, int threads)
{
#pragma omp parallel for num_threads(threads)
	for (size_t p = 0; p < tree->n; p++) {
		struct query q = {.x = tree->place[p].x, .side = -1, .max = NEIGHBOURS + 1, .bound = FAR * FAR};
		search(&q, tree->place, tree->n);
		tree->place[p].reach = (float)(CELL + REACH * sqrt(q.n ? q.distance[q.n - 1] : 0));
	}
}

static enum status tree_make(struct tree *tree, const struct scattered *s, int n_phi_d, int threads)
{
	*tree = (struct tree){.n = s->n, .place = s->n <= UINT32_MAX ? calloc(s->n, sizeof *tree->place) : NULL};
	if (!tree->place)
		return STATUS_NO_MEMORY;
#pragma omp parallel for num_threads(threads)
	for (size_t e = 0; e < s->n; e++) {
		tree->place[e].entry = (uint32_t)e;
		coordinates(s->wi[e], s->wo[e], n_phi_d, tree->place[e].x);
	}
	build(tree->place, tree->n);
	find_reach(tree, threads);
	return STATUS_OK;
}

/* The cosine of a degree beyond that angle, on this side of the horizon. */
static double beyond(double cosine)
{
	return cos(fmin(acos(cosine) + 1 / DEGREES, M_PI_2));
}

/* The smallest cosines that were measured. */
static void find_ends(const struct scattered *s, double *wi, double *wo)
{
	*wi = *wo = 1;
	for (size_t e = 0; e < s->n; e++) {
		*wi = fmin(*wi, s->wi[e].z);
		*wo = fmin(*wo, s->wo[e].z);
	}
}

/* The sum of weighted values about a point. */
struct value {
	double sum[MERL_CHANNELS], weight;
	bool inside; /* of what was measured */
};

static void take(struct value *v, const struct scattered *s, const struct query *q)
{
	for (size_t i = 0; i < q->n; i++) {
		const size_t e = q->found[i]->entry;
		const double weight = 1 / (q->distance[i] + NEAR * NEAR);
		for (int c = 0; c < MERL_CHANNELS; c++)
			v->sum[c] += weight * (double)s->value[c][e];
		v->weight += weight;
	}
}

/* The nearest tells whether the point is inside, and how far to look for others. */
static struct value value_at(const struct tree *tree, const struct scattered *s, const float x[AXES])
{
	struct value v = {.weight = 0};
	struct query nearest = {.x = x, .side = -1, .max = AT_POINT, .bound = INFINITY};
	search(&nearest, tree->place, tree->n);
	if (nearest.n == 0) /* there is at least one */
		return v;
	const double reach = (double)nearest.found[0]->reach, at_point = NEAR * NEAR;
	const double bound = LOOK * LOOK * fmax(reach * reach, nearest.distance[0]);
	v.inside = nearest.distance[0] <= reach * reach;
	if (nearest.distance[0] <= at_point) {
		while (nearest.n > 1 && nearest.distance[nearest.n - 1] > at_point)
			nearest.n--;
		take(&v, s, &nearest);
		return v;
	}
	for (int side = 0; side < SIDES; side++) {
		struct query q = {.x = x, .side = side, .max = PER_SIDE, .bound = bound};
		search(&q, tree->place, tree->n);
		take(&v, s, &q);
	}
	return v;
}

/* What filling a table takes. */
struct filling {
	const struct scattered *scattered;
	const struct rgl *rgl;   /* if the measurement has an interpolant of its own, */
	const struct tree *tree; /* else this */
	enum bins bins;
	enum gaps gaps;
	double min_z;  /* of both directions, */
	double min_wi; /* and of wi */
	struct measurement *table;
};

static struct vec3 turned(struct vec3 v, double phi, bool mirrored)
{
	const double c = cos(phi), s = sin(phi), y = mirrored ? -v.y : v.y;
	return (struct vec3){c * v.x - s * y, s * v.x + c * y, v.z};
}

/* The interpolant's mean over both sides of the plane of incidence, over both orders of wi and wo unless the table tells them
 * apart, and over turns of the sample; a channel out of gamut is 0. Only orders whose wi is not below `least` take part. */
static struct value mean_at(const struct filling *f, struct vec3 wi, struct vec3 wo, double least)
{
	const int turns = f->scattered->symmetry == SYMMETRY_ISOTROPIC ? 1 : TURNS;
	const int orders = f->table->n_phi_d == 180 ? 2 : 1;
	struct value v = {.inside = true};
	for (int i = 0; i < turns * orders * 2; i++) {
		const double phi = 2 * M_PI * (i / (2 * orders)) / turns;
		const struct vec3 a = turned(wi, phi, i % 2), b = turned(wo, phi, i % 2);
		const bool swapped = i / 2 % orders;
		double value[MERL_CHANNELS];
		if ((swapped ? b.z : a.z) < least || !rgl_f(f->rgl, swapped ? b : a, swapped ? a : b, value))
			continue;
		for (int c = 0; c < MERL_CHANNELS; c++)
			v.sum[c] += fmax(0, value[c]);
		v.weight += 1;
	}
	return v;
}

/* Where no order was measured, both are taken. */
static struct value interpolant_at(const struct filling *f, struct vec3 wi, struct vec3 wo)
{
	struct value v = mean_at(f, wi, wo, f->min_wi);
	if (v.weight == 0) {
		v = mean_at(f, wi, wo, 0);
		v.inside = false;
	}
	return v;
}

/* Returns 1 if the entry is among what was measured, -1 if it is not, 0 below the horizon. */
static int fill_entry(const struct filling *f, int i, int j, int k)
{
	const size_t at = measurement_at(f->table->n_phi_d, i, j, k);
	struct vec3 wi, wo;
	float x[AXES];
	halfdiff_trig_dirs(bins_trig(f->bins, i, j, k), &wi, &wo);
	if (!(wi.z > 1e-9 && wo.z > 1e-9))
		return 0;
	coordinates(wi, wo, f->table->n_phi_d, x);
	const struct value v = f->rgl ? interpolant_at(f, wi, wo) : value_at(f->tree, f->scattered, x);
	const bool inside = v.inside && fmin(wi.z, wo.z) >= f->min_z;
	for (int c = 0; c < MERL_CHANNELS && v.weight > 0 && (inside || f->gaps == GAPS_FILLED); c++)
		f->table->value[c][at] = (float)(v.sum[c] / v.weight);
	return inside ? 1 : -1;
}

/* The k of the entry that is the mirror image of entry k; may be n_phi_d. */
static int mirror_of(const struct filling *f, int k)
{
	return bins_mirror(f->bins, k) + (f->table->n_phi_d == 180 ? 0 : 180);
}

/* Entries that are each other's mirror image have one value: the first is computed, the other copied. */
static void fill_row(const struct filling *f, int i, int j, size_t *measured, size_t *outside)
{
	const int n = f->table->n_phi_d;
	for (int k = 0; k < n && k <= mirror_of(f, k); k++) {
		const int mirror = mirror_of(f, k), found = fill_entry(f, i, j, k);
		const bool twice = mirror < n && mirror != k;
		const size_t from = measurement_at(n, i, j, k);
		for (int c = 0; c < MERL_CHANNELS && twice; c++)
			f->table->value[c][measurement_at(n, i, j, mirror)] = f->table->value[c][from];
		*measured += found > 0 ? 1u + twice : 0;
		*outside += found < 0 ? 1u + twice : 0;
	}
}

static void fill_rows(const struct filling *f, int threads, struct resampled *result)
{
	size_t measured = 0, outside = 0;
#pragma omp parallel for num_threads(threads) schedule(dynamic) reduction(+ : measured, outside)
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			fill_row(f, i, j, &measured, &outside);
	result->n_measured = measured;
	result->n_outside = outside;
}

static enum status from_scattered(const struct scattered *s, const struct filling *filling, int threads,
				  struct resampled *result)
{
	struct filling f = *filling;
	struct tree tree = {0};
	const enum status status = f.rgl ? STATUS_OK : tree_make(&tree, s, f.table->n_phi_d, threads);
	if (status != STATUS_OK)
		return status;
	f.tree = &tree;
	double lowest_i, lowest_o;
	find_ends(s, &lowest_i, &lowest_o);
	f.min_wi = beyond(lowest_i);
	/* An interpolant grows without bound towards the horizon. */
	f.min_z = f.rgl ? fmin(lowest_i, lowest_o) : beyond(fmin(lowest_i, lowest_o));
	fill_rows(&f, threads, result);
	result->symmetrised = true;
	free(tree.place);
	return STATUS_OK;
}

/* The mean of the values that are there; NaN if there is none. */
static float mean(float a, float b)
{
	if (isnan(a) || isnan(b))
		return isnan(a) ? b : a;
	return a / 2 + b / 2;
}

static void from_table(const struct measurement *from, struct measurement *to, struct resampled *result)
{
	const bool folds = from->n_phi_d == 360 && to->n_phi_d == 180;
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < to->n_phi_d; k++) {
				const size_t at = measurement_at(to->n_phi_d, i, j, k);
				const size_t first = measurement_at(from->n_phi_d, i, j, k % from->n_phi_d);
				for (int c = 0; c < MERL_CHANNELS; c++)
					to->value[c][at] =
						folds ? mean(from->value[c][first], from->value[c][first + 180])
						      : from->value[c][first];
				result->n_measured += isnan(to->value[0][at]) ? 0 : 1;
			}
	result->symmetrised = folds;
}

enum status measurement_resample(const struct measurement *measurement, enum bins bins, int n_phi_d, enum gaps gaps,
				 int threads, struct measurement *table, struct resampled *result)
{
	struct resampled mine = {0};
	const int team = threads < 1 ? 1 : threads;
	enum status status = measurement_alloc(table, n_phi_d);
	if (status != STATUS_OK)
		return status;
	const struct filling filling = {.scattered = measurement->scattered,
					.rgl = measurement->rgl,
					.bins = bins,
					.gaps = gaps,
					.table = table};
	if (measurement->scattered)
		status = from_scattered(measurement->scattered, &filling, team, &mine);
	else
		from_table(measurement, table, &mine);
	if (status != STATUS_OK) {
		measurement_free(table);
		return status;
	}
	table->n_negative = measurement->n_negative;
	table->n_nonfinite = measurement->n_nonfinite;
	table->n_below_horizon = measurement->n_below_horizon;
	table->n_missing = measurement->n_missing;
	table->n_out_of_gamut = measurement->n_out_of_gamut;
	table->n_channels = measurement->n_channels;
	table->format = measurement->format;
	table->file_size = measurement->file_size;
	table->file_hash = measurement->file_hash;
	if (result)
		*result = mine;
	return STATUS_OK;
}

enum status measurement_fill(struct measurement *measurement, enum bins bins, int threads)
{
	struct measurement table;
	if (!measurement->scattered)
		return STATUS_OK;
	const enum status status = measurement_resample(measurement, bins, 180, GAPS_FILLED, threads, &table, NULL);
	if (status != STATUS_OK)
		return status;
	measurement_free(measurement);
	*measurement = table;
	return STATUS_OK;
}
