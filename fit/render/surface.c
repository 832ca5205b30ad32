/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/surface.h"
#include "src/vndf.h"
#include <math.h>

static double mean_of(const double rgb[3])
{
	return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

static enum status lobe_init(struct surface_lobe *lobe, const struct ndf *ndf, enum sampling sampling)
{
	lobe->ndf = ndf;
	const enum sampling used = sampler_init_near(&lobe->sampler, ndf, sampling);
	/* The density of those visible has no G1 where that is bounded. */
	lobe->own = (used == SAMPLING_VISIBLE && !ndf_is_tilted(ndf)) || used == SAMPLING_NDF;
	lobe->turns = ndf_is_anisotropic(ndf);
	if (lobe->turns)
		return STATUS_OK;
	const struct vec3 lowest = {sqrt(1 - SURFACE_HORIZON * SURFACE_HORIZON), 0, SURFACE_HORIZON};
	const enum status status = masking_init(&lobe->masking, masking_q(lowest) - 1, MASKING_FINE);
	if (status == STATUS_OK)
		masking_fill(&lobe->masking, ndf);
	return status;
}

static double G1_at(const struct surface_lobe *lobe, struct vec3 w)
{
	return lobe->turns ? ndf_G1(lobe->ndf, w) : masking_at(&lobe->masking, masking_q(w));
}

enum status surface_init(struct surface *s, const struct cook_torrance *model, const struct measured *measured,
			 enum sampling sampling)
{
	enum status status = STATUS_OK;
	*s = (struct surface){.model = model, .measured = measured};
	if (mean_of(model->ks) > 0)
		status = lobe_init(&s->lobe[0], &model->ndf, sampling);
	if (status == STATUS_OK && cook_torrance_has_second(model))
		status = lobe_init(&s->lobe[1], &model->second, sampling);
	if (status != STATUS_OK)
		surface_free(s);
	return status;
}

void surface_free(struct surface *s)
{
	for (int l = 0; l < SURFACE_LOBES; l++)
		masking_free(&s->lobe[l].masking);
}

/* About what a lobe sends back, all channels together. */
static double reflected(const struct cook_torrance *model, const double ks[3], double cos_o)
{
	if (!cook_torrance_has_channel_F(model))
		return mean_of(ks) * cook_torrance_F(model, 0, cos_o);
	double sum = 0;
	for (int c = 0; c < 3; c++)
		sum += ks[c] * cook_torrance_F(model, c, cos_o);
	return sum / 3;
}

/* Neither part is ever left out: the lobe reflects more than this at grazing angles, and a measured material scatters light
 * where its model does not. */
static double lobe_share(double lobe, double rest)
{
	return fmin(fmax(lobe / (lobe + rest), 0.1), 0.9);
}

struct view surface_view(const struct surface *s, struct vec3 wo)
{
	const struct cook_torrance *model = s->model;
	const double kd = mean_of(model->kd) + mean_of(model->kg);
	struct view view = {.wo = wo};
	double lobe[SURFACE_LOBES] = {0};
	for (int l = 0; l < SURFACE_LOBES; l++) {
		const struct ndf *ndf = s->lobe[l].ndf;
		if (!ndf)
			continue;
		view.lobe[l].G1 = G1_at(&s->lobe[l], wo);
		view.lobe[l].G1_exact =
			ndf->lambda_form == LAMBDA_EXACT ? view.lobe[l].G1 : ndf_G1(&s->lobe[l].sampler.proposal, wo);
		lobe[l] = reflected(model, l ? model->ks_second : model->ks, wo.z);
	}
	if (s->lobe[0].ndf && s->lobe[1].ndf) {
		const double both = lobe_share(lobe[0] + lobe[1], kd), first = lobe_share(lobe[0], lobe[1]);
		view.lobe[0].share = both * first;
		view.lobe[1].share = both * (1 - first);
	} else {
		const int l = s->lobe[1].ndf ? 1 : 0;
		view.lobe[l].share = s->lobe[l].ndf ? lobe_share(lobe[l], kd) : 0;
	}
	return view;
}

/* D G/(4 cos_i cos_o) of a lobe, times a factor of D. */
static double facets_f(const struct surface *s, const struct view *view, int l, struct vec3 wi, double D)
{
	const enum gaf gaf = s->model->gaf;
	const struct surface_lobe *lobe = &s->lobe[l];
	const double cosines = wi.z * view->wo.z;
	if (gaf == GAF_V_GROOVE)
		return cook_torrance_from_G(D, gaf_G(gaf, lobe->ndf, wi, view->wo), cosines);
	return cook_torrance_from_G1(gaf, D, G1_at(lobe, wi), view->lobe[l].G1, cosines);
}

/* The half vector, and what lobes need of it. */
struct half {
	struct vec3 m;
	double cos_d;
};

static struct half half_of(struct vec3 wi, struct vec3 wo)
{
	const struct vec3 sum = vec3_add(wi, wo);
	const double length = sqrt(vec3_dot(sum, sum));
	return (struct half){vec3_scale(sum, 1 / length), fmin(0.5 * length, 1)};
}

/* Adds a lobe to f. Returns the density of its normals per direction wi: d m = d wi / (4 cos_d). */
static double add_lobe(const struct surface *s, const struct view *view, int l, struct vec3 wi, struct half half,
		       double f[3])
{
	const struct cook_torrance *model = s->model;
	const struct surface_lobe *lobe = &s->lobe[l];
	const double *ks = l ? model->ks_second : model->ks;
	const double D = ndf_D(lobe->ndf, half.m);
	const bool given = s->measured || s->other;
	if (!given && !cook_torrance_has_channel_F(model)) {
		const double value = facets_f(s, view, l, wi, cook_torrance_F(model, 0, half.cos_d) * D);
		for (int c = 0; c < 3; c++)
			f[c] += ks[c] * value;
	} else if (!given) {
		const double value = facets_f(s, view, l, wi, D);
		for (int c = 0; c < 3; c++)
			f[c] += ks[c] * cook_torrance_F(model, c, half.cos_d) * value;
	}
	if (!lobe->own)
		return sampler_pdf(&lobe->sampler, view->wo, half.m) / (4 * half.cos_d);
	return lobe->sampler.procedure == SAMPLING_VISIBLE ? D * view->lobe[l].G1_exact / (4 * view->wo.z)
							   : D * half.m.z / (4 * half.cos_d);
}

static void diffuse_f(const struct surface *s, const struct view *view, struct vec3 wi, struct half half, double f[3])
{
	const struct cook_torrance *model = s->model;
	const double grazing = cook_torrance_has_grazing(model)
				       ? cook_torrance_grazing(model->grazing, wi.z, view->wo.z, half.cos_d)
				       : 0;
	for (int c = 0; c < 3; c++)
		f[c] = model->kd[c] * M_1_PI + model->kg[c] * grazing;
}

double surface_f(const struct surface *s, const struct view *view, struct vec3 wi, double f[3])
{
	double rest = 1, lobes = 0;
	f[0] = f[1] = f[2] = 0;
	if (wi.z < SURFACE_HORIZON)
		return 0;
	const struct half half = half_of(wi, view->wo);
	if (s->other)
		s->other(s->context, wi, view->wo, f);
	else if (s->measured)
		measured_f(s->measured, wi, view->wo, f);
	else
		diffuse_f(s, view, wi, half, f);
	for (int l = 0; l < SURFACE_LOBES; l++) {
		const double share = view->lobe[l].share;
		if (!(share > 0))
			continue;
		lobes += share * add_lobe(s, view, l, wi, half, f);
		rest -= share;
	}
	return lobes + rest * wi.z * M_1_PI;
}

bool surface_sample(const struct surface *s, const struct view *view, const double u[2], struct vec3 *wi)
{
	/* The second number chooses between the lobes and the rest, and what is left of it serves there. */
	double chosen = u[1], rest = 1;
	for (int l = 0; l < SURFACE_LOBES; l++) {
		const struct surface_lobe *lobe = &s->lobe[l];
		const double share = view->lobe[l].share;
		if (chosen < share) {
			const double left = chosen / share;
			const struct vec3 m = sampler_sample(&lobe->sampler, view->wo, u[0], left);
			*wi = vec3_sub(vec3_scale(m, 2 * vec3_dot(view->wo, m)), view->wo);
			return wi->z >= SURFACE_HORIZON;
		}
		chosen -= share;
		rest -= share;
	}
	const double left = fmin(chosen / rest, 1);
	const double r = sqrt(left), turn = 2 * M_PI * u[0];
	*wi = (struct vec3){r * cos(turn), r * sin(turn), sqrt(1 - left)};
	return wi->z >= SURFACE_HORIZON;
}
