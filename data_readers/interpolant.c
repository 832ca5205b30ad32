/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/interpolant.h"
#include "data_readers/rgl.h"
#include <stdlib.h>
#include <string.h>

enum {
	AXES = 3,       /* coordinates of an isotropic sample */
	TURNED = 5,     /* of one that is not */
	SIDES = 4,      /* of a point, in the first two coordinates */
	PER_SIDE = 2,   /* entries that are averaged */
	AT_POINT = 2,   /* entries at the very point that are: both orders of wi and wo */
	AROUND = 8,     /* nearest entries that are averaged where a sample is not isotropic */
	NEIGHBOURS = 4, /* the last of these tells how dense entries lie */
};

#define FAR 40.0   /* no entry reaches farther than this */
#define NEAR 1e-4  /* entries within this of a point are at it */
#define APART 0.05 /* entries nearer than this to another are one with it, as to how dense they lie */
#define CELL 0.5   /* half a cell of the table: always near */
#define REACH 1.5  /* times the distance to the fourth neighbour */
#define LOOK 2.0   /* times the reach: how far entries to average may be */
#define DEGREES (180 / M_PI)

/* Entries by their coordinates, as a tree: the middle one divides the others along an axis. */
struct place {
	float x[TURNED];
	uint32_t entry;
	float reach; /* how far around it counts as measured */
	int axis;
};

/* Of a sample that turns: the half vector in the plane, theta_h by its root as below, and phi_d, which goes round after
 * half a turn, as both orders of wi and wo are one. */
static void turned_coordinates(struct vec3 wi, struct vec3 wo, float x[TURNED])
{
	const struct halfdiff a = halfdiff_from_dirs(wi, wo);
	const struct vec3 h = vec3_add(wi, wo);
	const double d = DEGREES * a.theta_d, radius = 90 * sqrt(DEGREES * a.theta_h / 90), phi = atan2(h.y, h.x);
	const double round = 180 / (2 * M_PI) / 5 * fmin(1, d / 30) * fmin(1, DEGREES * a.theta_h / 10);
	x[0] = (float)(radius * cos(phi));
	x[1] = (float)(radius * sin(phi));
	x[2] = (float)(d / 4);
	x[3] = (float)(round * cos(2 * a.phi_d));
	x[4] = (float)(round * sin(2 * a.phi_d));
}

static void coordinates(const struct interpolant *ip, struct vec3 wi, struct vec3 wo, float x[TURNED])
{
	if (ip->turns) {
		turned_coordinates(wi, wo, x);
		return;
	}
	const struct halfdiff a = halfdiff_from_dirs(wi, wo);
	const double h = DEGREES * a.theta_h, d = DEGREES * a.theta_d;
	double phi = DEGREES * a.phi_d;
	phi = phi > 180 ? 360 - phi : phi;
	if (ip->n_phi_d == 180)
		phi = phi > 90 ? 180 - phi : phi;
	x[0] = (float)(90 * sqrt(h / 90));
	x[1] = (float)(d / 4);
	x[2] = (float)(phi / 5 * fmin(1, d / 30) * fmin(1, h / 10));
}

static int widest(const struct place *place, size_t n, int n_axes)
{
	float low[TURNED], high[TURNED];
	int best = 0;
	memcpy(low, place->x, sizeof low);
	memcpy(high, place->x, sizeof high);
	for (size_t p = 1; p < n; p++)
		for (int a = 0; a < n_axes; a++) {
			low[a] = fminf(low[a], place[p].x[a]);
			high[a] = fmaxf(high[a], place[p].x[a]);
		}
	for (int a = 1; a < n_axes; a++)
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

static void build(struct place *place, size_t n, int n_axes)
{
	while (n > 1) {
		const size_t middle = n / 2;
		const int axis = widest(place, n, n_axes);
		select_middle(place, n, middle, axis);
		place[middle].axis = axis;
		build(place, middle, n_axes);
		place += middle + 1;
		n -= middle + 1;
	}
}

/* A search for the nearest places, all or those on one side. */
struct query {
	const float *x;
	int n_axes;
	int side; /* bit a: those with x[a] at or above the point's, else below it; -1: all */
	size_t n, max;
	double least; /* square of the smallest one: what is at the point is left out; 0: none */
	double bound; /* square of the largest distance of interest */
	double distance[AROUND];
	const struct place *found[AROUND];
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
	for (int a = 0; a < q->n_axes; a++) {
		const double d = (double)p->x[a] - (double)q->x[a];
		distance += d * d;
	}
	if (distance >= q->bound || distance < q->least || !is_on_side(q, p))
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

static int axes_of(const struct interpolant *ip)
{
	return ip->turns ? TURNED : AXES;
}

/* How far the surroundings of each entry reach. Those at the same place are no neighbours. */
static void find_reach(const struct interpolant *ip, int threads)
{
#pragma omp parallel for num_threads(threads)
	for (size_t p = 0; p < ip->n; p++) {
		struct query q = {.x = ip->place[p].x,
				  .n_axes = axes_of(ip),
				  .side = -1,
				  .max = NEIGHBOURS,
				  .least = APART * APART,
				  .bound = FAR * FAR};
		search(&q, ip->place, ip->n);
		ip->place[p].reach = (float)(CELL + REACH * sqrt(q.n ? q.distance[q.n - 1] : 0));
	}
}

enum status interpolant_init(struct interpolant *ip, const struct measurement *measurement, int n_phi_d, bool turns,
			     int threads)
{
	const struct scattered *s = measurement->scattered;
	*ip = (struct interpolant){.scattered = s, .rgl = measurement->rgl, .n_phi_d = n_phi_d, .turns = turns};
	if (ip->rgl)
		return STATUS_OK;
	ip->n = s->n;
	ip->place = s->n <= UINT32_MAX ? calloc(s->n, sizeof *ip->place) : NULL;
	if (!ip->place)
		return STATUS_NO_MEMORY;
#pragma omp parallel for num_threads(threads)
	for (size_t e = 0; e < s->n; e++) {
		ip->place[e].entry = (uint32_t)e;
		coordinates(ip, s->wi[e], s->wo[e], ip->place[e].x);
	}
	build(ip->place, ip->n, axes_of(ip));
	find_reach(ip, threads);
	return STATUS_OK;
}

void interpolant_free(struct interpolant *ip)
{
	free(ip->place);
	*ip = (struct interpolant){0};
}

static void take(struct interpolated *v, const struct scattered *s, const struct query *q)
{
	for (size_t i = 0; i < q->n; i++) {
		const size_t e = q->found[i]->entry;
		const double weight = 1 / (q->distance[i] + NEAR * NEAR);
		for (int c = 0; c < MERL_CHANNELS; c++)
			v->sum[c] += weight * (double)s->value[c][e];
		v->weight += weight;
	}
}

/* The nearest entries on all four sides of a point in the first two coordinates, or as many anywhere. */
static void take_around(struct interpolated *v, const struct interpolant *ip, const float x[TURNED], double bound)
{
	for (int side = 0; side < SIDES && !ip->turns; side++) {
		struct query q = {.x = x, .n_axes = AXES, .side = side, .max = PER_SIDE, .bound = bound};
		search(&q, ip->place, ip->n);
		take(v, ip->scattered, &q);
	}
	if (ip->turns) {
		struct query q = {.x = x, .n_axes = TURNED, .side = -1, .max = AROUND, .bound = bound};
		search(&q, ip->place, ip->n);
		take(v, ip->scattered, &q);
	}
}

/* The nearest tells whether the point is inside, and how far to look for others. */
struct interpolated interpolant_at(const struct interpolant *ip, struct vec3 wi, struct vec3 wo)
{
	float x[TURNED];
	struct interpolated v = {.weight = 0};
	struct query nearest = {.x = x, .n_axes = axes_of(ip), .side = -1, .max = AT_POINT, .bound = INFINITY};
	coordinates(ip, wi, wo, x);
	search(&nearest, ip->place, ip->n);
	if (nearest.n == 0) /* there is at least one */
		return v;
	const double reach = (double)nearest.found[0]->reach, at_point = NEAR * NEAR;
	const double bound = LOOK * LOOK * fmax(reach * reach, nearest.distance[0]);
	v.inside = nearest.distance[0] <= reach * reach;
	v.distance = sqrt(nearest.distance[0]);
	if (nearest.distance[0] <= at_point) {
		while (nearest.n > 1 && nearest.distance[nearest.n - 1] > at_point)
			nearest.n--;
		take(&v, ip->scattered, &nearest);
		return v;
	}
	take_around(&v, ip, x, bound);
	return v;
}

/* f cos_o is bounded; nearer to the horizon than this it is divided by this. */
#define HORIZON 0.03

void interpolant_f(const struct interpolant *ip, struct vec3 wi, struct vec3 wo, double f[MERL_CHANNELS])
{
	f[0] = f[1] = f[2] = 0;
	if (!(wi.z > 0 && wo.z > 0))
		return;
	if (ip->rgl) {
		(void)rgl_f(ip->rgl, wi, wo, f);
		for (int c = 0; c < MERL_CHANNELS; c++)
			f[c] = fmax(f[c], 0) * wo.z / fmax(wo.z, HORIZON);
		return;
	}
	const struct interpolated v = interpolant_at(ip, wi, wo);
	for (int c = 0; c < MERL_CHANNELS && v.weight > 0; c++)
		f[c] = v.sum[c] / v.weight;
}
