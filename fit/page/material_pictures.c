/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/page/material_pictures.h"
#include "fit/cli/options.h"
#include "fit/cli/text_stream.h"

const struct page_picture material_pictures[PICTURES] = {
	[PICTURE_SPHERES] = {.type = "image/png", .alt = "sphere, "},
	[PICTURE_SLICES] =
		{.type = "image/png",
		 .plot = true,
		 .alt = "measured and fitted BRDF over theta_h, on a logarithmic scale, per channel, for theta_d of 0, "
			"15, "
			"30, 45, 60 and 75 degrees at phi_d = 90 degrees.",
		 .caption =
			 "Slices, measured and fitted, at right angles to the mirror plane: \xcf\x86_d = 90\xc2\xb0, "
			 "six \xce\xb8_d."},
	[PICTURE_SLICES_0] = {.type = "image/png",
			      .plot = true,
			      .alt = "measured and fitted BRDF over theta_h, on a logarithmic scale, per channel, for "
				     "theta_d of 0, 15, "
				     "30, 45, 60 and 75 degrees at phi_d = 0.",
			      .caption = "The same in the mirror plane: \xcf\x86_d = 0. Lines end at the horizon."},
	[PICTURE_MAP] = {.type = "image/png",
			 .plot = true,
			 .alt = "heat maps of the error over theta_h and theta_d, one a fit; the errors in all are in "
				"the table of parameters.",
			 .caption =
				 "Where each fit errs: E of each row (\xce\xb8_h, \xce\xb8_d) of the table by itself; "
				 "gray: nothing measured."},
	[PICTURE_NDF] = {.type = "image/svg+xml",
			 .plot = true,
			 .alt = "D of each fit over theta_h against the D that the fit reads off the data, and G1 over "
				"theta.",
			 .caption =
				 "D of each fit against the D that it reads off the data at small \xce\xb8_d, and G\xe2"
				 "\x82\x81."},
};

/* The light, and how many samples of it: what the spheres depend on beside the fits. */
static void put_light(FILE *file, const struct options *options)
{
	const bool map = options_given(options, "environment") || !options->light;
	fprintf(file, "%s%s%s%s", map ? options->environment : "", map && options->light ? ", " : "",
		options->light ? "lights " : "", options->light ? options->light : "");
	if (options->exposure != 0)
		fprintf(file, ", exposure %g", options->exposure);
	fprintf(file, "; %d samples a pixel", options->pixel_samples);
}

char *material_spheres_caption(const struct options *options, const struct material_data *data,
			       const struct picture_error *difference)
{
	struct text_stream caption;
	if (!text_stream_open(&caption))
		return NULL;
	FILE *file = caption.file;
	fputs("Spheres in the same light (", file);
	put_light(file, options);
	fputs("), and in false colours how far each fit's is from the measured one. Mean CIEDE2000 and SSIM:", file);
	for (int f = 0; f < data->n; f++)
		fprintf(file, "%s %s %.2f, %.4f", f ? ";" : "", data->fit[f].ndf, difference[f].delta_e,
			difference[f].ssim);
	fputs(".", file);
	return text_stream_close(&caption);
}
