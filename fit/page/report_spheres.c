/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/page/report_spheres.h"
#include "fit/page/page.h"
#include "fit/render/pictures.h"
#include "fit/render/sheet.h"

#include <stdio.h>
#include <stdlib.h>

/* One sphere, below it the legend or the difference. */
static void draw(struct sheet *sheet, const struct material_data *data, const struct pictures *pictures, int part)
{
	const int f = part - 1;
	char label[64];
	if (part == 0) {
		sheet_title(sheet, 0, "measured");
		sheet_sphere(sheet, 0, 0, &pictures->measured, data->name);
		sheet_legend(sheet, 0);
		return;
	}
	sheet_error_label(sheet, &pictures->error[f], label, sizeof label);
	sheet_title(sheet, 0, data->fit[f].ndf);
	sheet_sphere(sheet, 0, 0, &pictures->sphere[f], label);
	sheet_difference(sheet, 0, 0, &pictures->sphere[f], &pictures->measured);
}

static enum status write_part(const char *path, const struct material_data *data, const struct pictures *pictures,
			      int size, int part, struct error *error)
{
	struct sheet sheet;
	enum status status = sheet_init(&sheet, size, 1, 1, true);
	if (status != STATUS_OK)
		return error_set(error, status, "cannot render: %s", status_str(status));
	char *file = page_part_path(path, part);
	draw(&sheet, data, pictures, part);
	status =
		file ? image_write_png(file, &sheet.image, error) : error_set(error, STATUS_NO_MEMORY, "out of memory");
	free(file);
	sheet_free(&sheet);
	return status;
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
	for (int f = 0; f < data->n; f++)
		model[f] = (struct pictures_model){&data->fit[f].model, data->fit[f].error};
	const struct measurement *measurement = data->turned.scattered ? &data->turned : &data->measurement;
	enum status status = pictures_render(measurement, data->fit[0].options.criterion.bins, model, data->n,
					     SAMPLING_VISIBLE, environment, &sphere, &pictures);
	if (status != STATUS_OK)
		return error_set(error, status, "cannot render: %s", status_str(status));
	for (int part = 0; part <= data->n && status == STATUS_OK; part++)
		status = write_part(path, data, &pictures, options->size, part, error);
	for (int f = 0; f < data->n && status == STATUS_OK; f++)
		picture[f] = pictures.error[f];
	pictures_free(&pictures);
	return status;
}
