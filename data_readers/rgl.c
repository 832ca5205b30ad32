/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/rgl.h"
#include "data_readers/entry_list.h"
#include "data_readers/regular_file.h"
#include "data_readers/spectrum.h"
#include "data_readers/tensor_file.h"
#include "data_readers/text_quote.h"
#include "data_readers/warp.h"
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

static const size_t max_file_size = (size_t)4 << 30;

/* struct rgl - the fields of a file that evaluation needs. */
struct rgl {
	float *phi_i, *theta_i; /* radians, ascending */
	size_t n_phi, n_theta;
	float *ndf_value, *sigma_value, *vndf_value;
	float *rgb_value;               /* [phi_i][theta_i][channel][y][x] */
	struct grid ndf, sigma;         /* over (theta, phi) of the half vector, and of wi */
	struct warp vndf;               /* of visible half vectors, by (phi_i, theta_i) */
	struct grid rgb[MERL_CHANNELS]; /* f cos_o, over the warped square */
	bool divided;                   /* by D/(4 sigma) */
	bool gray;
	int n_channels; /* of the file */
};

void rgl_free(struct rgl *rgl)
{
	if (!rgl)
		return;
	warp_free(&rgl->vndf);
	free(rgl->phi_i);
	free(rgl->theta_i);
	free(rgl->ndf_value);
	free(rgl->sigma_value);
	free(rgl->vndf_value);
	free(rgl->rgb_value);
	free(rgl);
}

/* One azimuth of incidence, or the two ends of the circle: nothing depends on it. */
static bool is_isotropic(const struct rgl *rgl)
{
	return rgl->n_phi <= 2;
}

/* How often the range of measured azimuths goes into the circle: 2 and 4 stand for a symmetry of the sample. */
static double azimuth_repeats(const struct rgl *rgl)
{
	return round(2 * M_PI / ((double)rgl->phi_i[rgl->n_phi - 1] - (double)rgl->phi_i[0]));
}

/* theta and phi of a direction in the unit square, and back. */
static struct square_point to_square(double theta, double phi)
{
	const double v = (phi + M_PI) / (2 * M_PI);

	return (struct square_point){sqrt(theta * (2 / M_PI)), v - floor(v)};
}

static double theta_of(struct square_point p)
{
	return p.x * p.x * (M_PI / 2);
}

static double phi_of(struct square_point p)
{
	return 2 * M_PI * p.y - M_PI;
}

static double polar_angle(struct vec3 w)
{
	return atan2(hypot(w.x, w.y), w.z);
}

/* Where the azimuths cover a part of the circle, both directions are reflected until wi is in it: of a sample that
 * equals its mirror images (4), or itself turned by 180 degrees (2). */
static void fold(const struct rgl *rgl, struct vec3 *wi, struct vec3 *wo)
{
	const double repeats = is_isotropic(rgl) ? 1 : azimuth_repeats(rgl);

	if (repeats < 2)
		return;
	const double flip_y = wi->y > 0 ? -1 : 1;
	const double flip_x = repeats >= 4 ? (wi->x > 0 ? -1 : 1) : flip_y;

	wi->x *= flip_x;
	wo->x *= flip_x;
	wi->y *= flip_y;
	wo->y *= flip_y;
}

bool rgl_f(const struct rgl *rgl, struct vec3 wi, struct vec3 wo, double f[MERL_CHANNELS])
{
	if (!(wi.z > 0) || !(wo.z > 0))
		return false;
	fold(rgl, &wi, &wo);
	const struct vec3 m = vec3_unit(vec3_add(wi, wo));
	const double theta_i = polar_angle(wi), phi_i = atan2(wi.y, wi.x);
	const double phi_m = atan2(m.y, m.x) - (is_isotropic(rgl) ? phi_i : 0);
	const struct square_point at_m = to_square(polar_angle(m), phi_m), at_i = to_square(theta_i, phi_i);
	const double param[WARP_PARAMS] = {phi_i, theta_i};
	const struct square_point u = warp_invert(&rgl->vndf, at_m, param);
	const double factor =
		rgl->divided ? grid_at(&rgl->ndf, at_m, param) / (4 * grid_at(&rgl->sigma, at_i, param)) : 1;

	for (int c = 0; c < MERL_CHANNELS; c++)
		f[c] = grid_at(&rgl->rgb[c], u, param) * factor / wo.z;
	return true;
}

/* ---- Reading ---- */

static enum status expected(struct error *why, const char *name, const char *what, const struct tensor *found)
{
	if (!found)
		return error_set(why, STATUS_FORMAT, "expected a field '%s', found none", name);
	return error_set(why, STATUS_FORMAT, "field '%s': expected %s", name, what);
}

static enum status read_axis(const struct tensor_file *file, const char *name, double least, double most,
			     float **values, size_t *n, struct error *why)
{
	const struct tensor *tensor = tensor_file_find(file, name);

	if (!tensor || tensor->dims != 1)
		return expected(why, name, "one dimension", tensor);
	const enum status status = tensor_floats(tensor, values, why);
	if (status != STATUS_OK)
		return status;
	*n = tensor->count;
	for (size_t a = 0; a < *n; a++) {
		const double value = (double)(*values)[a];

		if (value < least || value > most || (a > 0 && (*values)[a] <= (*values)[a - 1]))
			return error_set(why, STATUS_FORMAT,
					 "field '%s': expected ascending numbers in %g .. %g, found %g as number %zu",
					 name, least, most, value, a);
	}
	return STATUS_OK;
}

/* A field whose last two dimensions are a grid and whose others are as given. */
static enum status read_grid(const struct tensor_file *file, const char *name, int n_outer, const size_t outer[],
			     float **values, struct grid *grid, struct error *why)
{
	const struct tensor *tensor = tensor_file_find(file, name);

	if (!tensor || tensor->dims != n_outer + 2)
		return expected(why, name, n_outer ? "as many dimensions as the format has" : "two dimensions", tensor);
	for (int d = 0; d < n_outer; d++)
		if (tensor->shape[d] != outer[d])
			return error_set(why, STATUS_FORMAT, "field '%s': expected %zu in dimension %d, found %" PRIu64,
					 name, outer[d], d, tensor->shape[d]);
	grid->height = tensor->shape[n_outer];
	grid->width = tensor->shape[n_outer + 1];
	if (grid->width < 2 || grid->height < 2)
		return error_set(why, STATUS_FORMAT, "field '%s': expected at least 2 x 2 nodes, found %zu x %zu", name,
				 grid->height, grid->width);
	const enum status status = tensor_floats(tensor, values, why);
	grid->value = *values;
	grid->stride = grid->width * grid->height;
	return status;
}

static const float nothing[1] = {0};

static void without_params(struct grid *grid)
{
	grid->param[0] = grid->param[1] = (struct warp_axis){nothing, 1};
}

static void with_params(const struct rgl *rgl, struct grid *grid)
{
	grid->param[0] = (struct warp_axis){rgl->phi_i, rgl->n_phi};
	grid->param[1] = (struct warp_axis){rgl->theta_i, rgl->n_theta};
}

static enum status read_warps(const struct tensor_file *file, struct rgl *rgl, struct error *why)
{
	const size_t outer[] = {rgl->n_phi, rgl->n_theta};
	struct grid density;
	enum status status = read_grid(file, "ndf", 0, NULL, &rgl->ndf_value, &rgl->ndf, why);

	if (status == STATUS_OK)
		status = read_grid(file, "sigma", 0, NULL, &rgl->sigma_value, &rgl->sigma, why);
	if (status == STATUS_OK)
		status = read_grid(file, "vndf", 2, outer, &rgl->vndf_value, &density, why);
	if (status != STATUS_OK)
		return status;
	without_params(&rgl->ndf);
	without_params(&rgl->sigma);
	with_params(rgl, &density);
	struct error reason;
	status = warp_init(&rgl->vndf, &density, &reason);
	return status == STATUS_OK ? status : error_set(why, status, "field 'vndf': %s", reason.text);
}

/* The planes of a spectral file, summed to those of RGB: between nodes all is linear, so it comes to the same. */
static enum status sum_spectra(struct rgl *rgl, const float *spectra, const float *wavelength, size_t n, size_t plane,
			       struct error *why)
{
	const size_t slices = rgl->n_phi * rgl->n_theta;
	double *nm = malloc(n * sizeof *nm), *weight = malloc(MERL_CHANNELS * n * sizeof *weight);
	enum status status = STATUS_NO_MEMORY;

	rgl->rgb_value = calloc(slices * MERL_CHANNELS * plane, sizeof *rgl->rgb_value);
	if (nm && weight && rgl->rgb_value) {
		for (size_t j = 0; j < n; j++)
			nm[j] = (double)wavelength[j];
		status = spectrum_weights(nm, n, weight);
		rgl->gray = !spectrum_has_colour(nm, n);
		rgl->n_channels = (int)n;
	}
	for (size_t slice = 0; slice < slices && status == STATUS_OK; slice++)
		for (size_t c = 0; c < MERL_CHANNELS; c++) {
			float *to = rgl->rgb_value + (slice * MERL_CHANNELS + c) * plane;

			for (size_t at = 0; at < plane; at++) {
				double sum = 0;

				for (size_t j = 0; j < n; j++)
					sum += weight[c * n + j] * (double)spectra[(slice * n + j) * plane + at];
				to[at] = (float)sum;
			}
		}
	free(nm);
	free(weight);
	return status == STATUS_OK ? status : error_set(why, status, "%s", status_str(status));
}

static enum status read_spectra(const struct tensor_file *file, struct rgl *rgl, struct grid *grid, struct error *why)
{
	float *wavelength = NULL, *spectra = NULL;
	size_t n = 0;
	*grid = (struct grid){.value = NULL};
	enum status status = read_axis(file, "wavelengths", 1, 1e6, &wavelength, &n, why);

	if (status == STATUS_OK) {
		const size_t outer[] = {rgl->n_phi, rgl->n_theta, n};

		status = read_grid(file, "spectra", 3, outer, &spectra, grid, why);
	}
	if (status == STATUS_OK)
		status = sum_spectra(rgl, spectra, wavelength, n, grid->stride, why);
	free(wavelength);
	free(spectra);
	return status;
}

static enum status read_colours(const struct tensor_file *file, struct rgl *rgl, struct error *why)
{
	const size_t outer[] = {rgl->n_phi, rgl->n_theta, MERL_CHANNELS};
	struct grid grid = {.value = NULL};
	const enum status status = tensor_file_find(file, "rgb")
					   ? read_grid(file, "rgb", 3, outer, &rgl->rgb_value, &grid, why)
				   : tensor_file_find(file, "spectra")
					   ? read_spectra(file, rgl, &grid, why)
					   : error_set(why, STATUS_FORMAT, "expected a field 'rgb' or 'spectra'");

	if (status != STATUS_OK)
		return status;
	if (rgl->n_channels == 0)
		rgl->n_channels = MERL_CHANNELS;
	with_params(rgl, &grid);
	for (size_t c = 0; c < MERL_CHANNELS; c++) {
		rgl->rgb[c] = grid;
		rgl->rgb[c].value = rgl->rgb_value + c * grid.stride;
		rgl->rgb[c].stride = MERL_CHANNELS * grid.stride;
	}
	return STATUS_OK;
}

static enum status read_fields(const struct tensor_file *file, struct rgl *rgl, struct error *why)
{
	const double slack = 1e-5; /* angles are floats */
	const struct tensor *jacobian = tensor_file_find(file, "jacobian");
	enum status status =
		read_axis(file, "phi_i", -2 * M_PI - slack, 2 * M_PI + slack, &rgl->phi_i, &rgl->n_phi, why);

	if (status == STATUS_OK)
		status = read_axis(file, "theta_i", 0, M_PI / 2 + slack, &rgl->theta_i, &rgl->n_theta, why);
	if (status != STATUS_OK || !rgl->phi_i)
		return status;
	const double repeats = is_isotropic(rgl) ? 1 : azimuth_repeats(rgl);
	if (repeats != 1 && repeats != 2 && repeats != 4)
		return error_set(why, STATUS_FORMAT,
				 "field 'phi_i': expected the whole circle, a half or a quarter, found %g to %g",
				 (double)rgl->phi_i[0], (double)rgl->phi_i[rgl->n_phi - 1]);
	if (!jacobian || jacobian->type != TENSOR_UINT8)
		return expected(why, "jacobian", "a byte", jacobian);
	rgl->divided = jacobian->data[0] != 0;
	status = read_warps(file, rgl, why);
	return status == STATUS_OK ? read_colours(file, rgl, why) : status;
}

/* ---- Entries ---- */

/* The part of an axis that is nearer to value n than to the others, in terms of a rising function of it. */
static double share_of_axis(const float *value, size_t n_values, size_t n, double (*rising)(double))
{
	const size_t before = n > 0 ? n - 1 : 0, after = n + 1 < n_values ? n + 1 : n;

	return rising(0.5 * ((double)value[n] + (double)value[after])) -
	       rising(0.5 * ((double)value[before] + (double)value[n]));
}

static double one_minus_cos(double theta)
{
	return 1 - cos(theta);
}

static double itself(double phi)
{
	return phi;
}

/* The solid angle of the directions wi that stand nearest to a measured one. */
static double incident_measure(const struct rgl *rgl, size_t phi, size_t theta)
{
	const double cap = share_of_axis(rgl->theta_i, rgl->n_theta, theta, one_minus_cos);

	if (is_isotropic(rgl))
		return 2 * M_PI * cap;
	return azimuth_repeats(rgl) * cap * share_of_axis(rgl->phi_i, rgl->n_phi, phi, itself);
}

/* struct mask - a bit per node that says whether it was measured, the first in the highest bit of the first byte. Some
 * files of the database mark what is missing instead: that is always the smaller part. */
struct mask {
	const struct tensor *valid; /* NULL: all were */
	unsigned measured;          /* the bit of a node that was */
};

static unsigned mask_bit(const struct mask *mask, size_t node)
{
	return (unsigned)mask->valid->data[node / 8] >> (7 - node % 8) & 1u;
}

static struct mask mask_of(const struct tensor *valid, size_t n_nodes)
{
	struct mask mask = {valid, 1};
	size_t n_set = 0;

	if (!valid || valid->type != TENSOR_UINT8 || valid->count < (n_nodes + 7) / 8)
		return (struct mask){NULL, 1};
	for (size_t node = 0; node < n_nodes; node++)
		n_set += mask_bit(&mask, node);
	mask.measured = n_set >= n_nodes - n_set;
	return mask;
}

static bool was_measured(const struct mask *mask, size_t node)
{
	return !mask->valid || mask_bit(mask, node) == mask->measured;
}

/* The entry of node (x, y) of the square. Nodes that stand for one direction count once: x = 0 is the macroscopic
 * normal for every y, and the last y is the first again. */
static enum status node_entry(const struct rgl *rgl, const double param[], double measure, size_t slice, size_t x,
			      size_t y, struct entry_list *list)
{
	const struct grid *grid = &rgl->rgb[0];
	const size_t width = grid->width, height = grid->height;
	const double sine = sin(param[1]);
	const struct vec3 wi = {sine * cos(param[0]), sine * sin(param[0]), cos(param[1])};
	const struct square_point u = {(double)x / (double)(width - 1), (double)y / (double)(height - 1)};
	double pdf;
	const struct square_point p = warp_sample(&rgl->vndf, u, param, &pdf);
	const double theta = theta_of(p), phi = phi_of(p) + (is_isotropic(rgl) ? param[0] : 0);
	const struct vec3 m = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
	const double dot = vec3_dot(wi, m);
	struct entry entry = {.wi = wi, .wo = vec3_sub(vec3_scale(m, 2 * dot), wi)};
	const double factor = rgl->divided ? grid_at(&rgl->ndf, p, param) /
						     (4 * grid_at(&rgl->sigma, to_square(param[1], param[0]), param))
					   : 1;
	for (int c = 0; c < MERL_CHANNELS; c++)
		entry.value[c] =
			(double)rgl->rgb[c].value[slice * rgl->rgb[c].stride + y * width + x] * factor / entry.wo.z;
	/* The cell of the square, through the warp, theta = pi/2 x^2 and phi = 2 pi y, and the reflection. Where the
	 * warp folds, the cell has no size. */
	const double edge = x == 0 || x + 1 == width ? 0.5 : 1;
	const double square = pdf > 0 ? edge / ((double)(width - 1) * (double)(height - 1) * pdf) : 0;
	entry.solid_angle = fmin(square * 2 * M_PI * M_PI * p.x * sin(theta) * 4 * dot * measure, 4 * M_PI * M_PI);
	return entry_list_add(list, &entry, true);
}

static enum status list_entries(const struct rgl *rgl, const struct mask *mask, struct entry_list *list)
{
	const size_t width = rgl->rgb[0].width, height = rgl->rgb[0].height;
	const size_t n_phi = is_isotropic(rgl) ? 1 : rgl->n_phi;
	enum status status = STATUS_OK;

	for (size_t slice = 0; slice < n_phi * rgl->n_theta; slice++) {
		const size_t phi = slice / rgl->n_theta, theta = slice % rgl->n_theta;
		const double param[] = {(double)rgl->phi_i[phi], (double)rgl->theta_i[theta]};
		const double measure = incident_measure(rgl, phi, theta);

		for (size_t y = 0; y + 1 < height; y++)
			for (size_t x = y == 0 ? 0 : 1; x < width && status == STATUS_OK; x++) {
				if (was_measured(mask, (slice * height + y) * width + x))
					status = node_entry(rgl, param, measure, slice, x, y, list);
				else
					list->n_missing++;
			}
	}
	return status;
}

static enum status make_entries(const struct rgl *rgl, const struct tensor *valid, enum gamut gamut,
				struct measurement *measurement, struct error *why)
{
	const struct mask mask = mask_of(valid, rgl->n_phi * rgl->n_theta * rgl->rgb[0].width * rgl->rgb[0].height);
	struct entry_list list = {.from_grid = true,
				  .gamut = gamut,
				  .gray = rgl->gray,
				  .n_channels = rgl->n_channels,
				  .has_symmetry = true,
				  .symmetry = is_isotropic(rgl)           ? SYMMETRY_ISOTROPIC
					      : azimuth_repeats(rgl) >= 4 ? SYMMETRY_PLANE
									  : SYMMETRY_ANISOTROPIC};
	enum status status = list_entries(rgl, &mask, &list);

	if (status == STATUS_OK)
		status = entry_list_finish(&list, measurement, why);
	entry_list_free(&list);
	return status;
}

static enum status parse(const unsigned char *bytes, size_t size, struct tensor_file *file, struct rgl **rgl,
			 struct error *why)
{
	*rgl = calloc(1, sizeof **rgl);
	if (!*rgl)
		return STATUS_NO_MEMORY;
	enum status status = tensor_file_parse(bytes, size, file, why);
	if (status == STATUS_OK)
		status = read_fields(file, *rgl, why);
	if (status != STATUS_OK) {
		rgl_free(*rgl);
		*rgl = NULL;
	}
	return status;
}

enum status rgl_parse(const unsigned char *bytes, size_t size, struct rgl **rgl, struct error *why)
{
	struct tensor_file file;

	return parse(bytes, size, &file, rgl, why);
}

static enum status read_bytes(const unsigned char *bytes, size_t size, enum gamut gamut,
			      struct measurement *measurement, struct error *why)
{
	struct rgl *rgl;
	struct tensor_file file;
	enum status status = parse(bytes, size, &file, &rgl, why);

	if (status != STATUS_OK)
		return status;
	status = make_entries(rgl, tensor_file_find(&file, "valid"), gamut, measurement, why);
	if (status != STATUS_OK) {
		rgl_free(rgl);
		return status;
	}
	measurement->rgl = rgl;
	measurement->file_size = size;
	measurement->file_hash = XXH3_64bits(bytes, size);
	return STATUS_OK;
}

enum status rgl_read(const char *path, enum gamut gamut, struct measurement *measurement, struct error *error)
{
	struct error why = {{0}};
	unsigned char *bytes;
	size_t size;

	*measurement = (struct measurement){0};
	enum status status = regular_file_read(path, "an RGL file", max_file_size, &bytes, &size, &why);
	if (status == STATUS_OK)
		status = read_bytes(bytes, size, gamut, measurement, &why);
	free(bytes);
	if (status == STATUS_OK)
		return status;
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	measurement_free(measurement);
	return error_set(error, status, "cannot read '%s': %s", name, why.text[0] ? why.text : status_str(status));
}
