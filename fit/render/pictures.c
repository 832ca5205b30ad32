/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/pictures.h"
#include <stdlib.h>

static enum status render(const struct cook_torrance *model, const struct measured *measured, enum sampling sampling,
			  const struct environment *environment, const struct sphere_options *options,
			  struct sphere *sphere)
{
	struct surface surface;
	enum status status = surface_init(&surface, model, measured, sampling);
	if (status == STATUS_OK)
		status = sphere_render(&surface, environment, options, sphere);
	surface_free(&surface);
	return status;
}

static const struct cook_torrance *best_of(const struct pictures_model *model, int n)
{
	int best = 0;
	for (int i = 1; i < n; i++)
		if (model[i].error < model[best].error)
			best = i;
	return model[best].model;
}

static bool any_has_axes(const struct pictures_model *model, int n)
{
	bool any = false;
	for (int i = 0; i < n; i++)
		any |= ndf_is_anisotropic(&model[i].model->ndf);
	return any;
}

enum status pictures_render(const struct measurement *measurement, enum bins bins, const struct pictures_model *model,
			    int n, enum sampling sampling, const struct environment *environment,
			    const struct sphere_options *options, struct pictures *p)
{
	struct measured measured;
	struct sphere_options sphere = *options;
	sphere.tangents = measurement_turns(measurement) || any_has_axes(model, n);
	*p = (struct pictures){
		.n = n, .sphere = calloc((size_t)n, sizeof *p->sphere), .error = calloc((size_t)n, sizeof *p->error)};
	enum status status = p->sphere && p->error ? STATUS_OK : STATUS_NO_MEMORY;
	if (status == STATUS_OK)
		status = measured_init(&measured, measurement, bins, options->threads);
	if (status == STATUS_OK) {
		status = render(best_of(model, n), &measured, sampling, environment, &sphere, &p->measured);
		measured_free(&measured);
	}
	for (int i = 0; i < n && status == STATUS_OK; i++) {
		status = render(model[i].model, NULL, sampling, environment, &sphere, &p->sphere[i]);
		if (status == STATUS_OK)
			status = picture_error_compute(&p->sphere[i], &p->measured, &p->error[i]);
	}
	if (status != STATUS_OK)
		pictures_free(p);
	return status;
}

void pictures_free(struct pictures *p)
{
	sphere_free(&p->measured);
	for (int i = 0; p->sphere && i < p->n; i++)
		sphere_free(&p->sphere[i]);
	free(p->sphere);
	free(p->error);
	*p = (struct pictures){0};
}

enum status pictures_render_model(const struct cook_torrance *model, enum sampling sampling,
				  const struct environment *environment, const struct sphere_options *options,
				  struct sphere *sphere)
{
	struct sphere_options with_axes = *options;
	with_axes.tangents = ndf_is_anisotropic(&model->ndf);
	return render(model, NULL, sampling, environment, &with_axes, sphere);
}
