/* SPDX-License-Identifier: GPL-3.0-or-later */
/* picture_error - how different two spheres look. */
#ifndef PICTURE_ERROR_H
#define PICTURE_ERROR_H

#include "fit/render/sphere.h"

/* struct picture_error - over the pixels that show nothing but the sphere. */
struct picture_error {
	double rmse;    /* root of the mean square of the difference of linear values, all three channels */
	double delta_e; /* mean CIEDE2000 of the colours that a screen shows: values clipped to [0, 1] */
	double ssim;    /* of the same colours' luminance as sRGB encodes it; ssim.h */
};

/* picture_error_compute - of two spheres of one size. All NaN where no pixel shows the sphere alone.
 * STATUS_NO_MEMORY. */
MUST_CHECK enum status picture_error_compute(const struct sphere *a, const struct sphere *b,
					     struct picture_error *error);

/* picture_delta_e - CIEDE2000 between two linear colours as a screen shows them. */
double picture_delta_e(const float a[3], const float b[3]);

#endif
