/* SPDX-License-Identifier: GPL-3.0-or-later */
/* RGL's tensor_file, which pbrt-v4 and Mitsuba 3 read as "measured": the values of any model on a grid that is refined until
 * our own reader, which holds to the database's evaluator, finds the error small enough. */
#include "data_readers/rgl.h"
#include "data_readers/rgl_write.h"
#include "fit/export/export_format.h"
#include <stdlib.h>

/* Half of the warp's density is D, half 1/pi: one for the lobe, one for the rest. Below cos 0.2, D stays what it is there:
 * where gamma < 2 it rises towards the horizon, and would draw all nodes there. */
static double warp_density(const void *context, struct vec3 m)
{
	const struct cook_torrance *model = context;
	const double cosine = fmax(m.z, 0.2), sine = hypot(m.x, m.y);
	const double scale = sine > 0 ? sqrt(1 - cosine * cosine) / sine : 0;
	const struct vec3 raised = {scale * m.x, scale * m.y, cosine};
	double D = export_max(model->ks) > 0 ? ndf_D(&model->ndf, raised) : 0;

	if (cook_torrance_has_second(model))
		D = 0.5 * (D + ndf_D(&model->second, raised));

	return 0.5 * (D + 1 / M_PI);
}

static void f_cos(const void *context, struct vec3 wi, struct vec3 m, double f[MERL_CHANNELS])
{
	const struct cook_torrance *model = context;
	const struct vec3 wo = vec3_unit(vec3_sub(vec3_scale(m, 2 * vec3_dot(wi, m)), wi));

	cook_torrance_f(model, wi, wo, f);
	for (int c = 0; c < MERL_CHANNELS; c++)
		f[c] *= fmax(wo.z, 0);
}

/* ---- The error ---- */

/* Midpoints in theta_h, denser towards 0, theta_d and phi_d. */
enum { HALF = 96, DIFFERENCE = 45, AZIMUTHS = 24 };

static bool directions(int h, int d, int p, struct vec3 *wi, struct vec3 *wo, double *measure)
{
	const double t = (h + 0.5) / HALF, theta_h = M_PI / 2 * t * t * t, theta_d = M_PI / 2 * (d + 0.5) / DIFFERENCE;
	const double phi = M_PI * (p + 0.5) / AZIMUTHS;
	const struct vec3 half = {sin(theta_h), 0, cos(theta_h)};
	const struct vec3 across = {cos(theta_h), 0, -sin(theta_h)}, y = {0, 1, 0};
	const struct vec3 away =
		vec3_scale(vec3_add(vec3_scale(across, cos(phi)), vec3_scale(y, sin(phi))), sin(theta_d));
	const struct vec3 along = vec3_scale(half, cos(theta_d));

	*wi = vec3_add(along, away);
	*wo = vec3_sub(along, away);
	/* dwi dwo = 4 cos_d dh dd, each per solid angle. */
	*measure = t * t * sin(theta_h) * sin(theta_d) * cos(theta_d);
	return wi->z > 0 && wo->z > 0;
}

enum { DIRECTIONS = HALF * DIFFERENCE * AZIMUTHS };

static struct vec3 turned(struct vec3 w, double c, double s)
{
	return (struct vec3){c * w.x - s * w.y, s * w.x + c * w.y, w.z};
}

/* Of an anisotropic model the pairs are turned about the normal, by multiples of the golden ratio. */
static bool directions_of(const struct cook_torrance *model, int n, struct vec3 *wi, struct vec3 *wo, double *measure)
{
	static const double golden = 0.6180339887498949;
	const bool above =
		directions(n / (DIFFERENCE * AZIMUTHS), n / AZIMUTHS % DIFFERENCE, n % AZIMUTHS, wi, wo, measure);

	if (export_has_axes(model)) {
		const double turn = 2 * M_PI * golden * n, c = cos(turn), s = sin(turn);

		*wi = turned(*wi, c, s);
		*wo = turned(*wo, c, s);
	}
	return above;
}

/* The model's values there, newly allocated: each refinement is held to them. NULL when out of memory. */
static double (*values_of(const struct cook_torrance *model, int threads))[MERL_CHANNELS]
{
	double(*value)[MERL_CHANNELS] = calloc(DIRECTIONS, sizeof *value);

#pragma omp parallel for schedule(dynamic, 256) num_threads(threads)
	for (int n = 0; n < DIRECTIONS; n++) {
		struct vec3 wi, wo;
		double measure;

		if (value && directions_of(model, n, &wi, &wo, &measure))
			cook_torrance_f(model, wi, wo, value[n]);
	}
	return value;
}

/* The L1 distance, weighted by cos_i cos_o, divided by the norm of the model. Sums go over HALF parts in their order, so
 * that the number of threads changes nothing. */
static double l1_error(const struct rgl *rgl, const struct cook_torrance *model, double (*value)[MERL_CHANNELS],
		       int threads)
{
	const int part = DIRECTIONS / HALF;
	double difference[HALF] = {0}, norm[HALF] = {0};

#pragma omp parallel for schedule(dynamic) num_threads(threads)
	for (int h = 0; h < HALF; h++)
		for (int n = h * part; n < (h + 1) * part; n++) {
			struct vec3 wi, wo;
			double measure, got[MERL_CHANNELS];

			if (!directions_of(model, n, &wi, &wo, &measure) || !rgl_f(rgl, wi, wo, got))
				continue;
			for (int c = 0; c < MERL_CHANNELS; c++) {
				difference[h] += fabs(got[c] - value[n][c]) * wi.z * wo.z * measure;
				norm[h] += value[n][c] * wi.z * wo.z * measure;
			}
		}
	for (int h = 1; h < HALF; h++) {
		difference[0] += difference[h];
		norm[0] += norm[h];
	}
	return norm[0] > 0 ? difference[0] / norm[0] : 0;
}

static enum status try_layout(const struct rgl_layout *layout, double (*value)[MERL_CHANNELS], double *error,
			      struct error *why)
{
	unsigned char *bytes;
	size_t size;
	struct rgl *rgl;
	enum status status = rgl_encode(layout, &bytes, &size);

	if (status != STATUS_OK)
		return error_set(why, status, "%s", status_str(status));
	status = rgl_parse(bytes, size, &rgl, why);
	free(bytes);
	if (status != STATUS_OK)
		return status;
	*error = l1_error(rgl, layout->context, value, layout->threads);
	rgl_free(rgl);
	return STATUS_OK;
}

/* theta_i are half as many as half vectors along each side, since more of them would gain less. With axes, azimuths of wi over
 * half of the circle cost as much as theta_i, and both gain less. pbrt-v4 wants the whole circle, and so do tilted facets. */
static struct rgl_layout layout_of(const struct export *export, size_t side, const char *description)
{
	const bool axes = export_has_axes(&export->model), tilted = ndf_is_tilted(&export->model.ndf);
	const bool half = export->format == EXPORT_BSDF_RGB && !(axes && tilted);
	const size_t n_phi = half ? side / 2 + 1 : side + 1;

	return (struct rgl_layout){.description = description,
				   .spectra = export->format == EXPORT_BSDF,
				   .n_phi = axes ? n_phi : 1,
				   .half = half,
				   .n_theta = axes ? side * 2 / 5 : side / 2,
				   .n_nodes = side,
				   .threads = export->source.fit->threads,
				   .density = warp_density,
				   .f_cos = f_cos,
				   .context = &export->model};
}

/* Half vectors along each side. */
static const size_t nodes[] = {16, 24, 32, 40, 48, 64, 80, 96, 112, 128, 160, 192, 256};

/* Sets nodes of the export; *found is the error of what has as many. */
static enum status refine(struct export *export, double (*value)[MERL_CHANNELS], double *found, struct error *error)
{
	for (size_t n = 0; n < sizeof nodes / sizeof *nodes; n++) {
		const struct rgl_layout layout = layout_of(export, nodes[n], "-");
		const double size = (double)rgl_layout_size(&layout);

		if (size > export->source.size)
			return n > 0 ? STATUS_OK
				     : error_set(error, STATUS_UNSUPPORTED, "the smallest file has %.0f bytes", size);
		const enum status status = try_layout(&layout, value, found, error);
		if (status != STATUS_OK)
			return status;
		export->nodes = nodes[n];
		if (export->source.fit->cancel && *export->source.fit->cancel)
			return STATUS_INTERRUPTED;
		if (*found <= export->source.accuracy / 100)
			return STATUS_OK;
	}
	return STATUS_OK;
}

static enum status bsdf_prepare(struct export *export, struct error *error)
{
	double found = 0, (*value)[MERL_CHANNELS] = values_of(&export->model, export->source.fit->threads);
	if (!value)
		return error_set(error, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	const enum status status = refine(export, value, &found, error);

	free(value);
	const struct rgl_layout layout = layout_of(export, export->nodes, "-");
	char azimuths[64] = "";
	if (layout.n_phi > 1)
		snprintf(azimuths, sizeof azimuths, "%zu phi_i, ", layout.n_phi);
	snprintf(export->why, sizeof export->why,
		 "a table of the model at %s%zu theta_i and %zu x %zu half vectors; error against the model %.2g %% "
		 "(L1, weight cosine)%s",
		 azimuths, layout.n_theta, export->nodes, export->nodes, 100 * found,
		 100 * found > export->source.accuracy ? ", the least of this size" : "");
	return status;
}

static enum status bsdf_write(const struct export *export, FILE *file, struct error *error)
{
	char model[EXPORT_TEXT], description[3 * EXPORT_TEXT];
	unsigned char *bytes;
	size_t size;

	export_describe(export, model);
	snprintf(description, sizeof description, "%s; %s; written by stdfit %s", model, export->why, STDFIT_VERSION);
	const struct rgl_layout layout = layout_of(export, export->nodes, description);
	const enum status status = rgl_encode(&layout, &bytes, &size);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	fwrite(bytes, 1, size, file);
	free(bytes);
	return STATUS_OK;
}

const struct export_target export_bsdf = {.name = "bsdf", .prepare = bsdf_prepare, .write = bsdf_write};
const struct export_target export_bsdf_rgb = {.name = "bsdf-rgb", .prepare = bsdf_prepare, .write = bsdf_write};
