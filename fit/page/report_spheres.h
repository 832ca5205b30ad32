/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report_spheres - the spheres of one material, side by side in one picture. */
#ifndef REPORT_SPHERES_H
#define REPORT_SPHERES_H

#include "fit/render/environment.h"
#include "fit/render/picture_error.h"
#include "fit/sources/materials.h"

/* report_spheres - a PNG of spheres in the same light: as measured, then as each fit has it, and below each of these its
 * difference from the measured one in false colours.
 * Returns: in picture[] the error of each fit's sphere against the measured one
 * Errors:  STATUS_UNSUPPORTED: a build without libpng; STATUS_IO, STATUS_NO_MEMORY, STATUS_INTERRUPTED */
MUST_CHECK enum status report_spheres(const char *path, const struct material_data *data,
				      const struct environment *environment, const struct options *options,
				      struct picture_error picture[FIT_NDFS_MAX], struct error *error);

#endif
