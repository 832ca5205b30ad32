/* SPDX-License-Identifier: GPL-3.0-or-later */
/* report_spheres - the spheres of one material, a picture each. */
#ifndef REPORT_SPHERES_H
#define REPORT_SPHERES_H

#include "fit/render/environment.h"
#include "fit/render/picture_error.h"
#include "fit/sources/materials.h"

/* report_spheres - PNGs of spheres in the same light, page_part_path() of `path`: part 0 as measured, with the legend of the
 * false colours; part f + 1 as fit f has it, and below that its difference from the measured one in false colours.
 * Returns: in picture[] the error of each fit's sphere against the measured one
 * Errors:  STATUS_UNSUPPORTED: a build without libpng; STATUS_IO, STATUS_NO_MEMORY, STATUS_INTERRUPTED */
MUST_CHECK enum status report_spheres(const char *path, const struct material_data *data,
				      const struct environment *environment, const struct options *options,
				      struct picture_error picture[FIT_NDFS_MAX], struct error *error);

#endif
