/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/page/report_spheres.h"
#include "fit/render/pictures.h"
#include "fit/render/sheet.h"

#include <stdio.h>

static void draw(struct sheet *sheet, const struct material_data *data, const struct pictures *pictures)
{
	sheet_title(sheet, 0, "measured");
	sheet_sphere(sheet, 0, 0, &pictures->measured, data->name);
	sheet_legend(sheet, 0);
	for (int f = 0; f < data->n; f++) {
		char label[32];
		snprintf(label, sizeof label, "dE %.2f", pictures->error[f].delta_e);
		sheet_title(sheet, f + 1, data->fit[f].ndf);
		sheet_sphere(sheet, f + 1, 0, &pictures->sphere[f], label);
		sheet_difference(sheet, f + 1, 0, &pictures->sphere[f], &pictures->measured);
	}
}

enum status report_spheres(const char *path, const struct material_data *data, const struct environment *environment,
			   const struct options *options, struct picture_error picture[FIT_NDFS_MAX],
			   struct error *error)
{
	const struct sphere_options sphere = {.size = options->size,
					      .samples = options->pixel_samples,
					      .threads = options->fit.threads,
					      .cancel = options->cancel};
	struct pictures_model model[FIT_NDFS_MAX];
	struct pictures pictures;
	struct sheet sheet;
	for (int f = 0; f < data->n; f++)
		model[f] = (struct pictures_model){&data->fit[f].model, data->fit[f].error};
	const struct measurement *measurement = data->turned.scattered ? &data->turned : &data->measurement;
	enum status status = pictures_render(measurement, data->fit[0].options.criterion.bins, model, data->n,
					     SAMPLING_VISIBLE, environment, &sphere, &pictures);
	if (status != STATUS_OK)
		return error_set(error, status, "cannot render: %s", status_str(status));
	status = sheet_init(&sheet, options->size, data->n + 1, 1, true);
	if (status != STATUS_OK) {
		error_set(error, status, "cannot render: %s", status_str(status));
	} else {
		draw(&sheet, data, &pictures);
		status = image_write_png(path, &sheet.image, error);
		sheet_free(&sheet);
	}
	for (int f = 0; f < data->n && status == STATUS_OK; f++)
		picture[f] = pictures.error[f];
	pictures_free(&pictures);
	return status;
}
