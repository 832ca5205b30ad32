/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/export/gltf_fit.h"
#include "fit/error/entry_at.h"
#include "fit/export/shown_error.h"
#include "src/cook_torrance.h"

#include <stdlib.h>
#include <string.h>

static double max_of(const double x[3])
{
	return fmax(x[0], fmax(x[1], x[2]));
}

/* D G / (4 cos_i cos_o) */
static double lobe_of(const struct ndf *ndf, struct vec3 wi, struct vec3 wo)
{
	const struct cook_torrance lobe = {.ndf = *ndf, .gaf = GAF_CORRELATED, .fresnel = FRESNEL_NONE};
	return cook_torrance_lobe(&lobe, wi, wo);
}

/* (1 - cos_d)^5 */
static double grazing(struct vec3 wi, struct vec3 wo)
{
	const double x = 1 - fmin(0.5 * vec3_length(vec3_add(wi, wo)), 1);
	return (x * x) * (x * x) * x;
}

void gltf_material_f(const struct gltf_material *material, struct vec3 wi, struct vec3 wo, double f[3])
{
	const double x = grazing(wi, wo), lobe = material->specular ? lobe_of(&material->ndf, wi, wo) : 0;
	double F[3];
	for (int c = 0; c < 3; c++)
		F[c] = material->specular ? material->F0[c] + (1 - material->F0[c]) * x : 0;
	for (int c = 0; c < 3; c++)
		f[c] = (1 - max_of(F)) * material->base[c] * M_1_PI + F[c] * lobe;
}

static void shown(const void *context, struct vec3 wi, struct vec3 wo, double f[3])
{
	gltf_material_f(context, wi, wo, f);
}

/* ---- The fit ---- */

enum { ENTRIES = 16000 };

/* An entry that the fit looks at, with the lobe of the roughness that is tried. */
struct point {
	struct vec3 wi, wo;
	double weight, value[3], grazing, lobe;
};

struct search {
	struct point *point;
	size_t n;
	double small; /* a residual that counts as none */
	bool gray;
	struct gltf_material start, best;
	double best_value;
};

/* Every stride-th entry, a stride that meets every phi_d. */
static size_t choose_entries(const struct measurement *measurement, const struct criterion *criterion,
			     struct point *point)
{
	const struct entries entries = entries_make(criterion->bins, measurement->n_phi_d);
	const size_t all = measurement_count(measurement);
	size_t stride = all / ENTRIES + 1, n = 0;
	while (stride > 1 && (stride % 2 == 0 || stride % 3 == 0 || stride % 5 == 0))
		stride++;
	for (size_t at = 0; at < all; at += stride) {
		struct entry_at entry;
		if (!entry_at(measurement, &entries, criterion, at, &entry))
			continue;
		point[n] = (struct point){
			.wi = entry.wi, .wo = entry.wo, .weight = entry.weight, .grazing = grazing(entry.wi, entry.wo)};
		memcpy(point[n++].value, entry.value, sizeof entry.value);
	}
	return n;
}

/* The normal equations of base and F0 for channels that share them, and what they solve. */
struct normal {
	double aa, ab, bb, ar, br;
};

static double within_0_1(double x)
{
	return fmin(fmax(x, 0), 1);
}

/* The least squares within [0, 1]: at an edge the other one alone. */
static void solve(const struct normal *e, double *base, double *F0)
{
	const double det = e->aa * e->bb - e->ab * e->ab;
	if (det > 1e-12 * e->aa * e->bb) {
		*base = (e->ar * e->bb - e->br * e->ab) / det;
		*F0 = (e->br * e->aa - e->ar * e->ab) / det;
		if (*base >= 0 && *base <= 1 && *F0 >= 0 && *F0 <= 1)
			return;
	}
	if (*F0 < 0 || *F0 > 1 || !(e->bb > 0)) {
		*F0 = within_0_1(*F0);
		*base = e->aa > 0 ? within_0_1((e->ar - e->ab * *F0) / e->aa) : 0;
		return;
	}
	*base = within_0_1(*base);
	*F0 = within_0_1((e->br - e->ab * *base) / e->bb);
}

/* One step for the channels [from, to): squares weighted by one over the last residual. Returns the L1 sum before it. */
static double least_squares(const struct search *search, struct gltf_material *m, double F0_max, int from, int to)
{
	struct normal e = {0, 0, 0, 0, 0};
	double sum = 0;
	for (size_t i = 0; i < search->n; i++) {
		const struct point *p = &search->point[i];
		const double a = M_1_PI * (1 - F0_max) * (1 - p->grazing);
		const double b = (1 - p->grazing) * p->lobe;
		for (int c = from; c < to; c++) {
			const double r = p->value[c] - p->grazing * p->lobe;
			const double residual = fabs(r - a * m->base[from] - b * m->F0[from]);
			const double w = p->weight / fmax(residual, search->small);
			sum += p->weight * residual;
			e.aa += w * a * a;
			e.ab += w * a * b;
			e.bb += w * b * b;
			e.ar += w * a * r;
			e.br += w * b * r;
		}
	}
	solve(&e, &m->base[from], &m->F0[from]);
	for (int c = from + 1; c < to; c++) {
		m->base[c] = m->base[from];
		m->F0[c] = m->F0[from];
	}
	return sum;
}

enum { STEPS = 16 };

/* The L1 sum with the best base and F0 for a roughness; the best material of all is kept. */
static double try(struct search *search, double log_sigma)
{
	struct gltf_material m = search->best;
	const struct ndf *start = &search->start.ndf;
	const double scale = exp(log_sigma);
	if (fmax(start->sigma_x, start->sigma_y) * scale > 1 ||
	    ndf_init(&m.ndf, start->class, start->sigma_x * scale, start->sigma_y * scale, start->gamma) != STATUS_OK ||
	    ndf_turn(&m.ndf, start->angle) != STATUS_OK)
		return INFINITY;
	for (size_t i = 0; i < search->n; i++)
		search->point[i].lobe = lobe_of(&m.ndf, search->point[i].wi, search->point[i].wo);
	double value = INFINITY;
	for (int step = 0; step < STEPS; step++) {
		const struct gltf_material tried = m;
		const double F0_max = max_of(m.F0);
		double sum = 0;
		for (int c = 0; c < 3; c += search->gray ? 3 : 1)
			sum += least_squares(search, &m, F0_max, c, search->gray ? 3 : c + 1);
		value = fmin(value, sum);
		if (sum < search->best_value) {
			search->best_value = sum;
			search->best = tried;
		}
	}
	return value;
}

enum { SCAN = 8, SECTIONS = 10 };

/* The logarithm of the roughness: a scan from a fifth of the start's to five times it, and golden sections around the best. */
static void scan_roughness(struct search *search)
{
	static const double golden = 0.6180339887498949, reach = 1.6;
	double best = INFINITY, at = 0;
	for (int i = -SCAN; i <= SCAN; i++) {
		const double value = try(search, reach * i / SCAN);
		if (value < best) {
			best = value;
			at = reach * i / SCAN;
		}
	}
	double low = at - reach / SCAN, high = at + reach / SCAN, value[2];
	value[0] = try(search, high - golden * (high - low));
	value[1] = try(search, low + golden * (high - low));
	for (int i = 0; i < SECTIONS; i++)
		if (value[0] < value[1]) {
			high = low + golden * (high - low);
			value[1] = value[0];
			value[0] = try(search, high - golden * (high - low));
		} else {
			low = high - golden * (high - low);
			value[0] = value[1];
			value[1] = try(search, low + golden * (high - low));
		}
}

enum status gltf_fit(const struct measurement *measurement, const struct criterion *criterion, int threads, bool gray,
		     struct gltf_material *material)
{
	struct search search = {.gray = gray, .start = *material, .best = *material, .best_value = INFINITY};
	double sum = 0, weight = 0;
	search.point = calloc(ENTRIES + 1, sizeof *search.point);
	if (!search.point)
		return STATUS_NO_MEMORY;
	search.n = choose_entries(measurement, criterion, search.point);
	for (size_t i = 0; i < search.n; i++) {
		sum += search.point[i].weight * max_of(search.point[i].value);
		weight += search.point[i].weight;
	}
	search.small = weight > 0 ? 1e-4 * sum / weight : 1;
	scan_roughness(&search);
	free(search.point);
	if (shown_error(measurement, criterion, threads, shown, &search.best) <
	    shown_error(measurement, criterion, threads, shown, material))
		*material = search.best;
	return STATUS_OK;
}
