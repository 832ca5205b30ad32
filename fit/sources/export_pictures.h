/* SPDX-License-Identifier: GPL-3.0-or-later */
/* export_pictures - how different a model and what stands in its place look. */
#ifndef EXPORT_PICTURES_H
#define EXPORT_PICTURES_H

#include "fit/export/export.h"

/* export_pictures - after export_prepare(): renders spheres in the built-in studio light, 64 pixels wide, of the measurement, of
 * the model, and of what the target shows of its substitute, and puts their differences, delta E and SSIM [picture_error.h],
 * into export->pictures. Without a measurement (NULL) the model is what the substitute is compared with. Scattered entries
 * of the measurement become a table. Does nothing where nothing stands in the model's place.
 * Returns STATUS_OK; STATUS_NO_MEMORY, STATUS_INTERRUPTED. */
MUST_CHECK enum status export_pictures(struct export *export, struct measurement *measurement);

#endif
