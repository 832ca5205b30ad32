/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/measurement.h"
#include "data_readers/rgl.h"
#include "src/names.h"
#include <stdio.h>
#include <stdlib.h>
#include <sys/mman.h>

/* The planes are one block, aligned and offered to the kernel as huge pages: with small ones, the first touch of each
 * costs more than reading the file does. The size of a plane is a multiple of a cache line. */
enum { HUGE_PAGE = 2 << 20 };

static const char *const bins_names[BINS_COUNT] = {[BINS_NODE] = "node", [BINS_CENTRE] = "centre"};

static const char *const symmetry_names[SYMMETRY_COUNT] = {
	[SYMMETRY_ISOTROPIC] = "isotropic", [SYMMETRY_PLANE] = "plane", [SYMMETRY_ANISOTROPIC] = "anisotropic"};

const char *symmetry_name(enum symmetry symmetry)
{
	return names_at(symmetry_names, SYMMETRY_COUNT, (int)symmetry);
}

enum status symmetry_find(const char *name, enum symmetry *symmetry)
{
	const int found = names_find(symmetry_names, SYMMETRY_COUNT, name);

	if (found < 0)
		return STATUS_DOMAIN;
	*symmetry = (enum symmetry)found;
	return STATUS_OK;
}

const char *bins_name(enum bins bins)
{
	return names_at(bins_names, BINS_COUNT, (int)bins);
}

enum status bins_find(const char *name, enum bins *bins)
{
	const int found = names_find(bins_names, BINS_COUNT, name);

	if (found < 0)
		return STATUS_DOMAIN;
	*bins = (enum bins)found;
	return STATUS_OK;
}

enum status measurement_reserve(struct measurement *measurement, int n_phi_d)
{
	*measurement = (struct measurement){0};
	if (n_phi_d != 180 && n_phi_d != 360)
		return STATUS_DOMAIN;

	const size_t count = (size_t)MERL_THETA_H * MERL_THETA_D * (size_t)n_phi_d;
	const size_t size = (MERL_CHANNELS * count * sizeof(float) + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
	float *planes = aligned_alloc(HUGE_PAGE, size);
	if (!planes)
		return STATUS_NO_MEMORY;
	madvise(planes, size, MADV_HUGEPAGE); /* a wish: that it cannot be granted does no harm */
	measurement->n_phi_d = n_phi_d;
	for (int c = 0; c < MERL_CHANNELS; c++)
		measurement->value[c] = planes + (size_t)c * count;
	return STATUS_OK;
}

enum status measurement_alloc(struct measurement *measurement, int n_phi_d)
{
	const enum status status = measurement_reserve(measurement, n_phi_d);

	if (status != STATUS_OK)
		return status;
	for (int c = 0; c < MERL_CHANNELS; c++)
		for (size_t e = 0; e < measurement_count(measurement); e++)
			measurement->value[c][e] = NAN;
	return STATUS_OK;
}

static void scattered_free(struct scattered *scattered)
{
	if (!scattered)
		return;
	free(scattered->wi);
	free(scattered->wo);
	free(scattered->value[0]);
	free(scattered->solid_angle);
	free(scattered);
}

enum status measurement_scattered(struct measurement *measurement, size_t n)
{
	struct scattered *s = calloc(1, sizeof *s);

	*measurement = (struct measurement){.scattered = s};
	if (!s || n > SIZE_MAX / sizeof *s->wi) {
		measurement_free(measurement);
		return STATUS_NO_MEMORY;
	}
	s->n = n;
	s->wi = malloc(n * sizeof *s->wi);
	s->wo = malloc(n * sizeof *s->wo);
	s->value[0] = malloc(n * MERL_CHANNELS * sizeof *s->value[0]);
	s->solid_angle = malloc(n * sizeof *s->solid_angle);
	if (!s->wi || !s->wo || !s->value[0] || !s->solid_angle) {
		measurement_free(measurement);
		return STATUS_NO_MEMORY;
	}
	for (int c = 1; c < MERL_CHANNELS; c++)
		s->value[c] = s->value[0] + (size_t)c * n;
	return STATUS_OK;
}

enum status measurement_require_table(const struct measurement *measurement, const char *what, struct error *why)
{
	return measurement->scattered
		       ? error_set(why, STATUS_UNSUPPORTED, "%s takes a table, these are scattered samples", what)
		       : STATUS_OK;
}

void measurement_free(struct measurement *measurement)
{
	scattered_free(measurement->scattered);
	rgl_free(measurement->rgl);
	free(measurement->value[0]);
	*measurement = (struct measurement){0};
}

/* From an index to the middle of its bin. */
static double shift_of(enum bins bins)
{
	return bins == BINS_CENTRE ? 0.5 : 0.0;
}

/* The angles of entry (i, j, k) in degrees, all exact. Only this file converts between indices and angles. */
struct bin_centre {
	double theta_h_times_90, theta_d, phi_d;
};

static struct bin_centre bin_centre(enum bins bins, int i, int j, int k)
{
	const double shift = shift_of(bins);

	return (struct bin_centre){(i + shift) * (i + shift), j + shift, k + shift};
}

struct bins_indices bins_indices(enum bins bins, struct halfdiff angles)
{
	const double degrees = 180 / M_PI, shift = shift_of(bins);

	return (struct bins_indices){sqrt(90 * degrees * angles.theta_h) - shift, degrees * angles.theta_d - shift,
				     degrees * angles.phi_d - shift};
}

int bins_mirror(enum bins bins, int k)
{
	return (bins == BINS_CENTRE ? 179 : 180) - k;
}

struct halfdiff bins_angles(enum bins bins, int i, int j, int k)
{
	static const double radian = 3.14159265358979323846 / 180.0;
	const struct bin_centre at = bin_centre(bins, i, j, k);

	return (struct halfdiff){at.theta_h_times_90 / 90.0 * radian, at.theta_d * radian, at.phi_d * radian};
}

struct halfdiff_trig bins_trig(enum bins bins, int i, int j, int k)
{
	const struct bin_centre at = bin_centre(bins, i, j, k);
	struct halfdiff_trig t;

	/* theta_h is rounded, so near 90 degrees its cosine is more accurate from the complement, which is rounded
	 * separately. */
	if (at.theta_h_times_90 <= 45.0 * 90.0)
		sincos_deg(at.theta_h_times_90 / 90.0, &t.sin_h, &t.cos_h);
	else
		sincos_deg((90.0 * 90.0 - at.theta_h_times_90) / 90.0, &t.cos_h, &t.sin_h);
	sincos_deg(at.theta_d, &t.sin_d, &t.cos_d);
	sincos_deg(at.phi_d, &t.sin_phi, &t.cos_phi);
	return t;
}

double cell_measure(int i, int j)
{
	const struct halfdiff low = bins_angles(BINS_NODE, i, j, 0), high = bins_angles(BINS_NODE, i + 1, j + 1, 0);
	const double h0 = low.theta_h, h1 = high.theta_h, d0 = low.theta_d, d1 = high.theta_d;
	/* cos a - cos b and (sin^2 b - sin^2 a)/2 as products: no cancellation in narrow cells. */
	const double w_h = 2 * M_PI * 2 * sin((h0 + h1) / 2) * sin((h1 - h0) / 2);
	const double w_d = sin(d0 + d1) * sin(d1 - d0) / 2;

	/* phi_d is one degree wide in both variants of the table. */
	return 4 * w_h * w_d * (M_PI / 180);
}

const char *measurement_left_out(const struct measurement *measurement, enum left_out which, bool masked,
				 char text[MEASUREMENT_LEFT_OUT])
{
	const struct {
		size_t n;
		const char *what;
	} left[] = {{measurement->n_negative, "negative"},
		    {measurement->n_nonfinite, "not finite"},
		    {which != LEFT_OUT_VALUES ? measurement->n_missing : 0, "not measured"},
		    {measurement->n_below_horizon, "at or below the horizon"},
		    {masked ? measurement->n_out_of_gamut : 0, "out of gamut"}};
	const bool told = measurement->scattered || which == LEFT_OUT_OF_TABLE;
	size_t used = 0;

	text[0] = '\0';
	for (size_t i = 0; told && i < sizeof left / sizeof *left; i++)
		if (left[i].n)
			used += (size_t)snprintf(text + used, MEASUREMENT_LEFT_OUT - used, "%s%zu %s", used ? "; " : "",
						 left[i].n, left[i].what);
	return text;
}
