/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/render/measured_bsdf.h"
#include "data_readers/atomic_file.h"
#include "data_readers/rgl.h"
#include "data_readers/rgl_write.h"
#include "fit/error/entry_at.h"
#include "fit/error/error_sum.h"
#include "fit/render/measured.h"
#include <stdlib.h>

enum { PROFILE = 256, TURNS = 12, PARTS = 64 };

/* What rgl_write() asks for. */
struct context {
	struct measured measured;
	double profile[PROFILE + 1]; /* over theta_m = pi/2 x^2, a density of half vectors */
};

static double theta_of(double x)
{
	return x * x * M_PI / 2;
}

/* The mean of the channels where both directions are 20 degrees from a half vector, in and across its plane, over turns of the
 * sample. */
static double brightness(const struct measured *measured, double theta)
{
	const double angle = 20 * M_PI / 180;
	double sum = 0;
	for (int n = 0; n < TURNS; n++) {
		const double phi = 2 * M_PI * n / TURNS, c = cos(phi), s = sin(phi);
		const struct vec3 h = {sin(theta) * c, sin(theta) * s, cos(theta)}, across = {-s, c, 0};
		const struct vec3 along = vec3_scale(h, cos(angle)), aside = vec3_scale(across, sin(angle));
		double f[MERL_CHANNELS];
		measured_f(measured, vec3_add(along, aside), vec3_sub(along, aside), f);
		sum += (f[0] + f[1] + f[2]) / 3 / TURNS;
	}
	return sum;
}

/* Normalises it as D is: the integral of profile cos is 1. */
static void set_profile(struct context *context)
{
	double sum = 0;
	for (int i = 0; i <= PROFILE; i++) {
		const double x = (double)i / PROFILE, theta = theta_of(x);
		/* Towards the horizon a measurement may rise without bound. */
		context->profile[i] = brightness(&context->measured, fmin(theta, 70 * M_PI / 180));
		sum += context->profile[i] * 2 * M_PI * sin(theta) * cos(theta) * M_PI * x / PROFILE;
	}
	for (int i = 0; i <= PROFILE; i++)
		context->profile[i] = sum > 0 ? context->profile[i] / sum : 0;
}

static double density(const void *data, struct vec3 m)
{
	const struct context *context = data;
	const double x = sqrt(acos(fmin(m.z, 1)) * 2 / M_PI) * PROFILE;
	const int i = (int)fmin(x, PROFILE - 1);
	const double t = fmin(x - i, 1);
	return 0.5 * ((1 - t) * context->profile[i] + t * context->profile[i + 1] + 1 / M_PI);
}

static void f_cos(const void *data, struct vec3 wi, struct vec3 m, double f[MERL_CHANNELS])
{
	const struct context *context = data;
	const struct vec3 wo = vec3_unit(vec3_sub(vec3_scale(m, 2 * vec3_dot(wi, m)), wi));
	measured_f(&context->measured, wi, wo, f);
	for (int c = 0; c < MERL_CHANNELS; c++)
		f[c] *= fmax(wo.z, 0);
}

/* Sums over parts of the entries in their order, so that the number of threads changes nothing. */
static double distance(const struct rgl *rgl, const struct measurement *measurement, enum bins bins, int threads)
{
	const struct entries entries = entries_make(bins, measurement->n_phi_d);
	const struct criterion criterion = {.bins = bins, .weight = WEIGHT_SOLID_ANGLE, .max_theta = 90};
	const size_t n = measurement_count(measurement);
	double difference[PARTS] = {0}, norm[PARTS] = {0};
#pragma omp parallel for schedule(dynamic) num_threads(threads)
	for (size_t part = 0; part < PARTS; part++)
		for (size_t at = part * n / PARTS; at < (part + 1) * n / PARTS; at++) {
			struct entry_at entry;
			double f[MERL_CHANNELS];
			if (!entry_at(measurement, &entries, &criterion, at, &entry) ||
			    !rgl_f(rgl, entry.wi, entry.wo, f))
				continue;
			for (int c = 0; c < MERL_CHANNELS; c++) {
				difference[part] += error_term(entry.weight, entry.value[c], f[c]);
				norm[part] += entry.weight * entry.value[c];
			}
		}
	for (int part = 1; part < PARTS; part++) {
		difference[0] += difference[part];
		norm[0] += norm[part];
	}
	return error_ratio(difference[0], norm[0]);
}

static enum status write_bytes(const char *path, const unsigned char *bytes, size_t size, struct error *why)
{
	struct atomic_file file;
	const enum status status = atomic_file_open(&file, path, why);
	if (status != STATUS_OK)
		return status;
	fwrite(bytes, 1, size, file.stream);
	return atomic_file_commit(&file, why);
}

static enum status encode(const struct context *context, const char *description, int threads, unsigned char **bytes,
			  size_t *size)
{
	const bool turns = context->measured.turned.scattered;
	const struct rgl_layout layout = {.description = description,
					  .n_phi = turns ? 33 : 1,
					  .n_theta = turns ? 12 : 48,
					  .n_nodes = turns ? 32 : 96,
					  .threads = threads,
					  .density = density,
					  .f_cos = f_cos,
					  .context = context};
	return rgl_encode(&layout, bytes, size);
}

enum status measured_bsdf_write(const char *path, const struct measurement *measurement, enum bins bins,
				const char *description, int threads, double *error, struct error *why)
{
	struct context *context = calloc(1, sizeof *context);
	unsigned char *bytes = NULL;
	size_t size = 0;
	struct rgl *rgl = NULL;
	enum status status = context ? measured_init(&context->measured, measurement, bins, threads) : STATUS_NO_MEMORY;
	if (status == STATUS_OK) {
		set_profile(context);
		status = encode(context, description, threads, &bytes, &size);
		measured_free(&context->measured);
	}
	free(context);
	if (status != STATUS_OK)
		return error_set(why, status, "%s", status_str(status));
	status = rgl_parse(bytes, size, &rgl, why);
	if (status == STATUS_OK) {
		*error = distance(rgl, measurement, bins, threads);
		rgl_free(rgl);
		status = write_bytes(path, bytes, size, why);
	}
	free(bytes);
	return status;
}
