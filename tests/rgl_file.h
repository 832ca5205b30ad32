/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rgl_file - writes RGL files of a known BRDF, whose warp has a closed form: an independent check of the reader.
 *
 * The density of half vectors over the unit square is (1 + a (2x - 1)) (1 + b (2y - 1)), which is bilinear, so that no grid
 * is too coarse for it; a and b change with theta_i. */
#ifndef RGL_FILE_H
#define RGL_FILE_H

#include "check.h"
#include "src/vec3.h"

struct rgl_spec {
	int n_phi, n_theta, n_nodes, n_channels; /* channels: 3 of RGB, or wavelengths from 400 nm in steps of 25 nm */
	double phi_first, phi_last, theta_last;
	bool spectral, divided;
	/* The BRDF in a channel. */
	double (*f)(struct vec3 wi, struct vec3 wo, int channel);
};

struct rgl_bytes {
	unsigned char *bytes;
	size_t size, capacity;
};

static inline void rgl_put(struct rgl_bytes *to, const void *from, size_t size)
{
	if (to->size + size > to->capacity) {
		to->capacity = 2 * (to->size + size) + 4096;
		to->bytes = realloc(to->bytes, to->capacity);
		assert_non_null(to->bytes);
	}
	memcpy(to->bytes + to->size, from, size);
	to->size += size;
}

static inline void rgl_put_float(struct rgl_bytes *to, double value)
{
	const float single = (float)value;

	rgl_put(to, &single, sizeof single);
}

static inline double rgl_skew_x(double theta_i)
{
	return 0.5 - 0.2 * theta_i;
}

static inline double rgl_skew_y(double theta_i)
{
	return 0.3 * theta_i;
}

/* The t in [0, 1] at which the integral of 1 + a (2t - 1) is u. */
static inline double rgl_inverse(double a, double u)
{
	return a == 0 ? u : (a - 1 + sqrt((1 - a) * (1 - a) + 4 * a * u)) / (2 * a);
}

static inline double rgl_phi(const struct rgl_spec *spec, int n)
{
	return spec->n_phi == 1 ? spec->phi_first
				: spec->phi_first + (spec->phi_last - spec->phi_first) * n / (spec->n_phi - 1);
}

static inline double rgl_theta(const struct rgl_spec *spec, int n)
{
	return spec->n_theta == 1 ? 0 : spec->theta_last * n / (spec->n_theta - 1);
}

static inline double rgl_ndf(double x)
{
	return 2 - x;
}

static inline double rgl_sigma(double x)
{
	return 0.3 + 0.2 * x;
}

/* rgl_direction - wo of node (x, y) in [0, 1]^2 of the warped square. */
static inline struct vec3 rgl_direction(const struct rgl_spec *spec, double phi_i, double theta_i, double x, double y,
					double *square_x)
{
	const double p = rgl_inverse(rgl_skew_x(theta_i), x), q = rgl_inverse(rgl_skew_y(theta_i), y);
	const double pi = 3.14159265358979323846;
	const double theta = p * p * pi / 2, phi = 2 * pi * q - pi + (spec->n_phi <= 2 ? phi_i : 0);
	const struct vec3 wi = {sin(theta_i) * cos(phi_i), sin(theta_i) * sin(phi_i), cos(theta_i)};
	const struct vec3 m = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};

	*square_x = p;
	return vec3_sub(vec3_scale(m, 2 * vec3_dot(wi, m)), wi);
}

static inline void rgl_put_colours(struct rgl_bytes *to, const struct rgl_spec *spec, double phi_i, double theta_i)
{
	const struct vec3 wi = {sin(theta_i) * cos(phi_i), sin(theta_i) * sin(phi_i), cos(theta_i)};
	const double pi = 3.14159265358979323846;

	for (int c = 0; c < spec->n_channels; c++)
		for (int y = 0; y < spec->n_nodes; y++)
			for (int x = 0; x < spec->n_nodes; x++) {
				double p;
				const double last = spec->n_nodes - 1;
				const struct vec3 wo = rgl_direction(spec, phi_i, theta_i, x / last, y / last, &p);
				const double divisor =
					spec->divided ? rgl_ndf(p) / (4 * rgl_sigma(sqrt(2 / pi * theta_i))) : 1;

				rgl_put_float(to, wo.z > 0 ? spec->f(wi, wo, c) * wo.z / divisor : 0);
			}
}

static inline void rgl_put_data(struct rgl_bytes *to, const struct rgl_spec *spec, int field)
{
	const double last = spec->n_nodes - 1;

	switch (field) {
	case 0:
		for (int n = 0; n < spec->n_phi; n++)
			rgl_put_float(to, rgl_phi(spec, n));
		return;
	case 1:
		for (int n = 0; n < spec->n_theta; n++)
			rgl_put_float(to, rgl_theta(spec, n));
		return;
	case 2:
	case 3:
		for (int n = 0; n < 2 * spec->n_nodes; n++) {
			const double x = n % spec->n_nodes / last;

			rgl_put_float(to, field == 2 ? rgl_ndf(x) : rgl_sigma(x));
		}
		return;
	case 4:
		for (int n = 0; n < spec->n_phi * spec->n_theta; n++) {
			const double theta_i = rgl_theta(spec, n % spec->n_theta);

			for (int y = 0; y < spec->n_nodes; y++)
				for (int x = 0; x < spec->n_nodes; x++)
					/* Its scale is nobody's business. */
					rgl_put_float(to, (3 + n) * (1 + rgl_skew_x(theta_i) * (2 * x / last - 1)) *
								  (1 + rgl_skew_y(theta_i) * (2 * y / last - 1)));
		}
		return;
	case 5:
		for (int n = 0; n < spec->n_phi * spec->n_theta; n++)
			rgl_put_colours(to, spec, rgl_phi(spec, n / spec->n_theta), rgl_theta(spec, n % spec->n_theta));
		return;
	case 6:
		rgl_put(to, spec->divided ? "\1" : "\0", 1);
		return;
	default:
		for (int n = 0; n < spec->n_channels; n++)
			rgl_put_float(to, 400 + 25 * n);
	}
}

/* rgl_make - the bytes of a file, to be freed. */
static inline struct rgl_bytes rgl_make(const struct rgl_spec *spec)
{
	const uint64_t phi = (uint64_t)spec->n_phi, theta = (uint64_t)spec->n_theta, nodes = (uint64_t)spec->n_nodes;
	const struct {
		const char *name;
		unsigned char type;
		uint16_t dims;
		uint64_t shape[5];
	} field[] = {
		{"phi_i", 10, 1, {phi}},
		{"theta_i", 10, 1, {theta}},
		{"ndf", 10, 2, {2, nodes}},
		{"sigma", 10, 2, {2, nodes}},
		{"vndf", 10, 4, {phi, theta, nodes, nodes}},
		{spec->spectral ? "spectra" : "rgb", 10, 5, {phi, theta, (uint64_t)spec->n_channels, nodes, nodes}},
		{"jacobian", 1, 1, {1}},
		{"wavelengths", 10, 1, {(uint64_t)spec->n_channels}}};
	const uint32_t n_fields = spec->spectral ? 8 : 7;
	struct rgl_bytes data = {NULL, 0, 0}, file = {NULL, 0, 0};
	uint64_t offset[8], header = 18;

	for (uint32_t n = 0; n < n_fields; n++)
		header += 2 + strlen(field[n].name) + 2 + 1 + 8 + 8 * (uint64_t)field[n].dims;
	for (uint32_t n = 0; n < n_fields; n++) {
		offset[n] = header + data.size;
		rgl_put_data(&data, spec, (int)n);
	}
	rgl_put(&file, "tensor_file\0\1\0", 14);
	rgl_put(&file, &n_fields, 4);
	for (uint32_t n = 0; n < n_fields; n++) {
		const uint16_t length = (uint16_t)strlen(field[n].name);

		rgl_put(&file, &length, 2);
		rgl_put(&file, field[n].name, length);
		rgl_put(&file, &field[n].dims, 2);
		rgl_put(&file, &field[n].type, 1);
		rgl_put(&file, &offset[n], 8);
		rgl_put(&file, field[n].shape, 8 * (size_t)field[n].dims);
	}
	assert_int_equal(file.size, header);
	rgl_put(&file, data.bytes, data.size);
	free(data.bytes);
	return file;
}

#endif
