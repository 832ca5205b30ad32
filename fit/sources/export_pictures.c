/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/export_pictures.h"
#include "data_readers/resample.h"
#include "fit/render/picture_error.h"

#include <string.h>

enum { SIZE = 64, SAMPLES = 64 };

/* What all spheres have in common. */
struct studio {
	struct environment light;
	struct sphere_options options;
	enum bins bins;
};

/* A sphere of the model or, sampled by it, of the table, if that is not NULL. */
static enum status render(const struct studio *studio, const struct cook_torrance *model,
			  const struct measurement *table, struct sphere *sphere)
{
	struct measured measured = {.value = NULL};
	struct surface surface;
	enum status status = table ? measured_init(&measured, table, studio->bins, studio->options.threads) : STATUS_OK;
	if (status != STATUS_OK)
		return status;
	status = surface_init(&surface, model, table ? &measured : NULL, SAMPLING_VISIBLE);
	if (status == STATUS_OK)
		status = sphere_render(&surface, &studio->light, &studio->options, sphere);
	surface_free(&surface);
	measured_free(&measured);
	return status;
}

/* What the target shows. */
static enum status render_shown(const struct studio *studio, const struct export *export, struct sphere *sphere)
{
	struct surface surface;
	enum status status = surface_init(&surface, &export->model, NULL, SAMPLING_VISIBLE);
	if (status != STATUS_OK)
		return status;
	if (!export_shows_model(export)) {
		surface.other = export_shown_f;
		surface.context = export;
	}
	status = sphere_render(&surface, &studio->light, &studio->options, sphere);
	surface_free(&surface);
	return status;
}

static enum status compare(const struct studio *studio, struct export *export, const struct measurement *measurement)
{
	const struct cook_torrance *model = export->source.model;
	struct sphere wanted = {.coverage = NULL}, given = wanted, shown = wanted;
	struct picture_error before = {0, 0, 1}, after = before;
	enum status status = render(studio, model, measurement, &wanted);
	if (status == STATUS_OK && measurement)
		status = render(studio, model, NULL, &given);
	if (status == STATUS_OK && measurement)
		status = picture_error_compute(&given, &wanted, &before);
	if (status == STATUS_OK)
		status = render_shown(studio, export, &shown);
	if (status == STATUS_OK)
		status = picture_error_compute(&shown, &wanted, &after);
	if (status == STATUS_OK)
		snprintf(export->pictures, sizeof export->pictures,
			 "spheres in studio light: delta E of the model %.2f, of what stands here %.2f; SSIM %.4f, "
			 "%.4f%s",
			 before.delta_e, after.delta_e, before.ssim, after.ssim,
			 measurement ? "" : " (against the model itself)");
	sphere_free(&wanted);
	sphere_free(&given);
	sphere_free(&shown);
	return status;
}

enum status export_pictures(struct export *export, struct measurement *measurement)
{
	const struct fit_options *fit = export->source.fit;
	struct studio studio = {
		.options = {.size = SIZE, .samples = SAMPLES, .threads = fit->threads, .cancel = fit->cancel},
		.bins = fit->criterion.bins};
	if (!*export->cost)
		return STATUS_OK;
	enum status status = environment_named("studio", &studio.light);
	if (status != STATUS_OK)
		return status;
	/* What turns is shown as it is, with tangents. */
	studio.options.tangents =
		(measurement && measurement_turns(measurement)) || ndf_is_anisotropic(&export->source.model->ndf);
	if (measurement && !measurement_turns(measurement))
		status = measurement_fill(measurement, studio.bins, fit->threads);
	if (status == STATUS_OK)
		status = compare(&studio, export, measurement);
	environment_free(&studio.light);
	return status;
}
