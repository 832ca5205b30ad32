/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/picture_error.h"
#include "fit/render/colour.h"
#include "fit/render/ssim.h"
#include <math.h>
#include <stdlib.h>

/* What a screen shows of a linear colour, linear still. */
static void shown(const float rgb[3], double out[3])
{
	for (int c = 0; c < 3; c++)
		out[c] = fmin(fmax((double)rgb[c], 0), 1);
}

double picture_delta_e(const float a[3], const float b[3])
{
	double rgb[3], lab_a[3], lab_b[3];
	shown(a, rgb);
	colour_lab(rgb, lab_a);
	shown(b, rgb);
	colour_lab(rgb, lab_b);
	return delta_e_2000(lab_a, lab_b);
}

static double encoded_luminance(const float rgb[3])
{
	double out[3];
	shown(rgb, out);
	return srgb_encode(colour_luminance(out));
}

/* Sums over the pixels; those of the means first, then what SSIM wants. */
static void compare(const struct sphere *a, const struct sphere *b, double *x, double *y, bool *inside,
		    struct picture_error *error)
{
	const size_t n = (size_t)a->light.width * (size_t)a->light.height;
	double square = 0, delta_e = 0;
	size_t count = 0;
	for (size_t i = 0; i < n; i++) {
		const float *p = a->light.rgb + 3 * i, *q = b->light.rgb + 3 * i;
		inside[i] = a->coverage[i] == 1;
		x[i] = encoded_luminance(p);
		y[i] = encoded_luminance(q);
		if (!inside[i])
			continue;
		for (int c = 0; c < 3; c++)
			square += ((double)p[c] - (double)q[c]) * ((double)p[c] - (double)q[c]);
		delta_e += picture_delta_e(p, q);
		count++;
	}
	error->rmse = count ? sqrt(square / (3 * (double)count)) : (double)NAN;
	error->delta_e = count ? delta_e / (double)count : (double)NAN;
	error->ssim = ssim(x, y, inside, a->light.width, a->light.height);
}

enum status picture_error_compute(const struct sphere *a, const struct sphere *b, struct picture_error *error)
{
	const size_t n = (size_t)a->light.width * (size_t)a->light.height;
	double *x = malloc(2 * n * sizeof *x);
	bool *inside = malloc(n * sizeof *inside);
	const bool room = x && inside;
	if (room)
		compare(a, b, x, x + n, inside, error);
	free(x);
	free(inside);
	return room ? STATUS_OK : STATUS_NO_MEMORY;
}
