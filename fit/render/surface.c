/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/surface.h"
#include "src/vndf.h"
#include <math.h>

static double mean_of(const double rgb[3])
{
	return (rgb[0] + rgb[1] + rgb[2]) / 3;
}

enum status surface_init(struct surface *s, const struct cook_torrance *model, const struct measured *measured,
			 enum sampling sampling)
{
	*s = (struct surface){.model = model, .measured = measured};
	if (!(mean_of(model->ks) > 0))
		return STATUS_OK;
	enum sampling used = sampling;
	if (sampler_init(&s->sampler, &model->ndf, used) != STATUS_OK)
		used = vndf_supports(&model->ndf) ? SAMPLING_VISIBLE : SAMPLING_NDF;
	s->own = used == SAMPLING_VISIBLE || used == SAMPLING_NDF;
	if (used != sampling && sampler_init(&s->sampler, &model->ndf, used) != STATUS_OK)
		return STATUS_UNSUPPORTED;
	const struct vec3 lowest = {sqrt(1 - SURFACE_HORIZON * SURFACE_HORIZON), 0, SURFACE_HORIZON};
	const enum status status = masking_init(&s->masking, masking_q(lowest) - 1, MASKING_FINE);
	if (status == STATUS_OK)
		masking_fill(&s->masking, &model->ndf);
	return status;
}

void surface_free(struct surface *s)
{
	masking_free(&s->masking);
}

struct view surface_view(const struct surface *s, struct vec3 wo)
{
	const struct cook_torrance *model = s->model;
	const double ks = mean_of(model->ks), kd = mean_of(model->kd);
	struct view view = {.wo = wo};
	if (!(ks > 0))
		return view;
	view.G1 = masking_at(&s->masking, masking_q(wo));
	view.G1_exact = model->ndf.lambda_form == LAMBDA_EXACT ? view.G1 : ndf_G1(&s->sampler.proposal, wo);
	const double lobe = ks * fresnel_F(model->fresnel, wo.z, model->n, model->k);
	/* Neither part is ever left out: the lobe reflects more than this at grazing angles, and a measured material
	 * scatters light where its model does not. */
	view.specular = fmin(fmax(lobe / (lobe + kd), 0.1), 0.9);
	return view;
}

/* The specular term for ks = 1. */
static double specular_f(const struct surface *s, const struct view *view, struct vec3 wi, double DF)
{
	const enum gaf gaf = s->model->gaf;
	const double cosines = wi.z * view->wo.z;
	if (gaf == GAF_V_GROOVE)
		return cook_torrance_from_G(DF, gaf_G(gaf, &s->model->ndf, wi, view->wo), cosines);
	return cook_torrance_from_G1(gaf, DF, masking_at(&s->masking, masking_q(wi)), view->G1, cosines);
}

/* What the lobe is worth in one direction. */
struct lobe {
	double f;   /* for ks = 1 */
	double pdf; /* of its normals, per direction wi: d m = d wi / (4 cos_d) */
};

static struct lobe lobe_at(const struct surface *s, const struct view *view, struct vec3 wi)
{
	const struct cook_torrance *model = s->model;
	const struct vec3 sum = vec3_add(wi, view->wo);
	const double length = sqrt(vec3_dot(sum, sum)), cos_d = fmin(0.5 * length, 1);
	const struct vec3 m = vec3_scale(sum, 1 / length);
	const double D = ndf_D(&model->ndf, m);
	struct lobe lobe = {0, 0};
	if (!s->own)
		lobe.pdf = sampler_pdf(&s->sampler, view->wo, m) / (4 * cos_d);
	else if (s->sampler.procedure == SAMPLING_VISIBLE)
		lobe.pdf = D * view->G1_exact / (4 * view->wo.z);
	else
		lobe.pdf = D * m.z / (4 * cos_d);
	if (!s->measured)
		lobe.f = specular_f(s, view, wi, fresnel_F(model->fresnel, cos_d, model->n, model->k) * D);
	return lobe;
}

double surface_f(const struct surface *s, const struct view *view, struct vec3 wi, double f[3])
{
	const struct cook_torrance *model = s->model;
	struct lobe lobe = {0, 0};
	f[0] = f[1] = f[2] = 0;
	if (wi.z < SURFACE_HORIZON)
		return 0;
	if (view->specular > 0)
		lobe = lobe_at(s, view, wi);
	if (s->measured)
		measured_f(s->measured, wi, view->wo, f);
	for (int c = 0; c < 3 && !s->measured; c++)
		f[c] = model->kd[c] * M_1_PI + model->ks[c] * lobe.f;
	return view->specular * lobe.pdf + (1 - view->specular) * wi.z * M_1_PI;
}

bool surface_sample(const struct surface *s, const struct view *view, const double u[2], struct vec3 *wi)
{
	/* The second number chooses between the lobe and the rest, and what is left of it serves there. */
	if (u[1] < view->specular) {
		const double rest = u[1] / view->specular;
		const struct vec3 m = sampler_sample(&s->sampler, view->wo, u[0], rest);
		*wi = vec3_sub(vec3_scale(m, 2 * vec3_dot(view->wo, m)), view->wo);
	} else {
		const double rest = (u[1] - view->specular) / (1 - view->specular);
		const double r = sqrt(rest), turn = 2 * M_PI * u[0];
		*wi = (struct vec3){r * cos(turn), r * sin(turn), sqrt(1 - rest)};
	}
	return wi->z >= SURFACE_HORIZON;
}
