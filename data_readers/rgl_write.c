/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/rgl_write.h"
#include "data_readers/spectrum.h"
#include "data_readers/tensor_file.h"
#include "data_readers/warp.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Fine enough for a peak at theta_m = 0.1 degrees; they cost little. */
enum { DENSITY_NODES = 1024, DENSITY_AZIMUTHS = 361, WARP_NODES = 256, WAVELENGTHS = 2 * SPECTRUM_BANDS };

static const double theta_last = 89.9 * M_PI / 180;

/* struct content - the arrays of the file. */
struct content {
	size_t n_colours;  /* planes */
	size_t n_azimuths; /* rows of the density */
	float *phi, *theta, *density, *mean, *warp, *luminance,
		*colour; /* mean: of the density, over the azimuths; two rows */
	struct spectrum_bands bands;
};

static bool allocate(struct content *content, const struct rgl_layout *layout)
{
	const size_t plane = layout->n_nodes * layout->n_nodes, n_slices = layout->n_phi * layout->n_theta;

	content->n_azimuths = layout->n_phi > 1 ? DENSITY_AZIMUTHS : 2;
	content->n_colours = layout->spectra ? WAVELENGTHS : MERL_CHANNELS;
	content->theta = malloc(layout->n_theta * sizeof(float));
	content->phi = malloc(layout->n_phi * sizeof(float));
	content->density = malloc(content->n_azimuths * DENSITY_NODES * sizeof(float));
	content->mean = malloc((size_t)2 * DENSITY_NODES * sizeof(float));
	content->warp = malloc(n_slices * 2 * WARP_NODES * sizeof(float));
	content->luminance = malloc(n_slices * plane * sizeof(float));
	content->colour = malloc(n_slices * content->n_colours * plane * sizeof(float));
	return content->phi && content->theta && content->density && content->mean && content->warp &&
	       content->luminance && content->colour;
}

static void free_content(struct content *content)
{
	free(content->phi);
	free(content->theta);
	free(content->density);
	free(content->mean);
	free(content->warp);
	free(content->luminance);
	free(content->colour);
}

static double theta_of(double x)
{
	return x * x * (M_PI / 2);
}

static double phi_of(double y)
{
	return 2 * M_PI * y - M_PI;
}

static struct vec3 half_vector(struct square_point p)
{
	const double theta = theta_of(p.x), phi = phi_of(p.y);

	return (struct vec3){sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
}

static double at_point(const float *value, size_t n_rows, struct square_point p)
{
	static const float nothing[1] = {0};
	const struct grid grid = {
		.param = {{nothing, 1}, {nothing, 1}}, .width = DENSITY_NODES, .height = n_rows, .value = value};

	return grid_at(&grid, p, (double[WARP_PARAMS]){0, 0});
}

static double density_at(const struct content *content, struct square_point p)
{
	return at_point(content->density, content->n_azimuths, p);
}

static double mean_at(const struct content *content, struct square_point p)
{
	return at_point(content->mean, 2, p);
}

/* The density at node x of theta_m, in all rows. */
static void fill_density(struct content *content, const struct rgl_layout *layout, size_t x)
{
	const double theta = theta_of((double)x / (DENSITY_NODES - 1));
	const struct vec3 plane = {sin(theta), 0, cos(theta)};
	const size_t n = content->n_azimuths;
	double sum = 0;

	for (size_t y = 0; y < n; y++) {
		const struct square_point p = {(double)x / (DENSITY_NODES - 1), (double)y / (double)(n - 1)};
		const double value = layout->density(layout->context, layout->n_phi > 1 ? half_vector(p) : plane);

		content->density[y * DENSITY_NODES + x] = (float)value;
		sum += y > 0 ? value : 0; /* the first row is the last */
	}
	content->mean[x] = content->mean[DENSITY_NODES + x] = (float)(sum / (double)(n - 1));
}

static void fill_axes(struct content *content, const struct rgl_layout *layout)
{
	const double last = layout->half ? 0 : M_PI;

	for (size_t t = 0; t < layout->n_theta; t++)
		content->theta[t] = (float)(theta_last * (double)t / (double)(layout->n_theta - 1));
	for (size_t p = 0; p < layout->n_phi; p++)
		content->phi[p] = (float)(-M_PI + (last + M_PI) * (double)p / (double)(layout->n_phi - 1));
	if (layout->n_phi == 1)
		content->phi[0] = 0;
}

static void fill_densities(struct content *content, const struct rgl_layout *layout)
{
#pragma omp parallel for num_threads(layout->threads)
	for (size_t x = 0; x < DENSITY_NODES; x++)
		fill_density(content, layout, x);
	/* All slices are equal: the density of theta_m, without the constant of its azimuth. The root of the cosine
	 * keeps nodes from the horizon, where most of them see nothing. */
	for (size_t at = 0; at < layout->n_phi * layout->n_theta * 2 * WARP_NODES; at++) {
		const size_t node = at % WARP_NODES;
		const double x = (double)node / (WARP_NODES - 1), theta = theta_of(x);
		const struct square_point p = {x, 0.5};
		const double density =
			layout->n_phi > 1 ? mean_at(content, p)
					  : layout->density(layout->context, (struct vec3){sin(theta), 0, cos(theta)});

		content->warp[at] = (float)(density * x * sin(theta) * sqrt(fmax(0, cos(theta))));
	}
}

/* The planes at one wi. Luminance is what importance sampling by the warp leaves to be done: f cos_o by the density of
 * wo that the warp makes, which goes as mean density(m) sqrt(cos_m) / (4 wi.m). The bound keeps it finite. */
static bool fill_slice(struct content *content, const struct rgl_layout *layout, const struct warp *warp, size_t slice)
{
	static const double luminance[MERL_CHANNELS] = {0.2126, 0.7152, 0.0722};
	const size_t n = layout->n_nodes, plane = n * n;
	const double theta_i = (double)content->theta[slice % layout->n_theta],
		     phi_i = (double)content->phi[slice / layout->n_theta], param[WARP_PARAMS] = {0, 0};
	const struct vec3 wi = {sin(theta_i) * cos(phi_i), sin(theta_i) * sin(phi_i), cos(theta_i)};
	float *light = content->luminance + slice * plane,
	      *colour = content->colour + slice * content->n_colours * plane;
	double total = 0;
	bool finite = true;

	for (size_t at = 0; at < plane; at++) {
		const struct square_point u = {(double)(at % n) / (double)(n - 1), (double)(at / n) / (double)(n - 1)};
		double pdf, f[MERL_CHANNELS], sum = 0;
		const struct square_point p = warp_sample(warp, u, param, &pdf);
		const struct vec3 m = half_vector(p);
		const double divisor = density_at(content, p); /* sigma is 1/4 */
		const double warped = layout->n_phi > 1 ? mean_at(content, p) : divisor;

		layout->f_cos(layout->context, wi, m, f);
		for (int c = 0; c < MERL_CHANNELS; c++)
			sum += luminance[c] * f[c] / warped;
		for (size_t c = 0; c < content->n_colours; c++) {
			const double *row = content->bands.from_rgb[c / 2];
			const double value = layout->spectra ? row[0] * f[0] + row[1] * f[1] + row[2] * f[2] : f[c];

			colour[c * plane + at] = (float)(value / divisor);
			finite = finite && isfinite(colour[c * plane + at]);
		}
		light[at] = (float)fmax(0, sum * vec3_dot(wi, m) / sqrt(fmax(m.z, 0.05)));
		total += (double)light[at];
	}
	for (size_t at = 0; at < plane && !(total > 0); at++)
		light[at] = 1;
	return finite;
}

static enum status fill(struct content *content, const struct rgl_layout *layout)
{
	static const float nothing[1] = {0};
	struct error why;
	struct warp warp;
	bool finite = true;
	fill_axes(content, layout);
	fill_densities(content, layout);
	const struct grid grid = {
		.param = {{nothing, 1}, {nothing, 1}}, .width = WARP_NODES, .height = 2, .value = content->warp};
	const enum status status = warp_init(&warp, &grid, &why);
	if (status != STATUS_OK)
		return status == STATUS_NO_MEMORY ? status : STATUS_DOMAIN;
#pragma omp parallel for schedule(dynamic) num_threads(layout->threads) reduction(&& : finite)
	for (size_t slice = 0; slice < layout->n_phi * layout->n_theta; slice++)
		finite = fill_slice(content, layout, &warp, slice) && finite;
	warp_free(&warp);
	return finite ? STATUS_OK : STATUS_DOMAIN;
}

static enum status encode(const struct content *content, const struct rgl_layout *layout, unsigned char **bytes,
			  size_t *size)
{
	static const float sigma[4] = {0.25F, 0.25F, 0.25F, 0.25F};
	static const unsigned char jacobian = 1, version[3] = {0, 4, 1}; /* as the database's files have it */
	const size_t n = layout->n_nodes, n_phi = layout->n_phi, n_theta = layout->n_theta,
		     length = strlen(layout->description);
	struct tensor_file file = {.n = 0};
	float wavelength[WAVELENGTHS];

	for (int j = 0; j < WAVELENGTHS; j++)
		wavelength[j] = (float)spectrum_band_nm[j];
	tensor_file_add(&file, "description", TENSOR_UINT8, 1, (size_t[]){length}, layout->description);
	tensor_file_add(&file, "version", TENSOR_UINT8, 1, (size_t[]){sizeof version}, version);
	tensor_file_add(&file, "jacobian", TENSOR_UINT8, 1, (size_t[]){1}, &jacobian);
	tensor_file_add(&file, "phi_i", TENSOR_FLOAT32, 1, (size_t[]){n_phi}, content->phi);
	tensor_file_add(&file, "theta_i", TENSOR_FLOAT32, 1, (size_t[]){n_theta}, content->theta);
	tensor_file_add(&file, "sigma", TENSOR_FLOAT32, 2, (size_t[]){2, 2}, sigma);
	tensor_file_add(&file, "ndf", TENSOR_FLOAT32, 2, (size_t[]){content->n_azimuths, DENSITY_NODES},
			content->density);
	tensor_file_add(&file, "vndf", TENSOR_FLOAT32, 4, (size_t[]){n_phi, n_theta, 2, WARP_NODES}, content->warp);
	tensor_file_add(&file, "luminance", TENSOR_FLOAT32, 4, (size_t[]){n_phi, n_theta, n, n}, content->luminance);
	tensor_file_add(&file, layout->spectra ? "spectra" : "rgb", TENSOR_FLOAT32, 5,
			(size_t[]){n_phi, n_theta, content->n_colours, n, n}, content->colour);
	if (layout->spectra)
		tensor_file_add(&file, "wavelengths", TENSOR_FLOAT32, 1, (size_t[]){WAVELENGTHS}, wavelength);
	return tensor_file_encode(&file, bytes, size);
}

size_t rgl_layout_size(const struct rgl_layout *layout)
{
	const size_t planes = 1 + (layout->spectra ? WAVELENGTHS : MERL_CHANNELS);

	return sizeof(float) * (layout->n_phi * layout->n_theta *
					(planes * layout->n_nodes * layout->n_nodes + 2 * WARP_NODES) +
				(size_t)(layout->n_phi > 1 ? DENSITY_AZIMUTHS : 2) * DENSITY_NODES) +
	       2048;
}

enum status rgl_encode(const struct rgl_layout *layout, unsigned char **bytes, size_t *size)
{
	struct content content = {.n_colours = 0};
	enum status status = STATUS_NO_MEMORY;

	if (allocate(&content, layout))
		status = spectrum_bands(&content.bands);
	if (status == STATUS_OK)
		status = fill(&content, layout);
	if (status == STATUS_OK)
		status = encode(&content, layout, bytes, size);
	free_content(&content);
	return status;
}
