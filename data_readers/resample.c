/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/resample.h"
#include "data_readers/interpolant.h"
#include "data_readers/rgl.h"
#include <stdlib.h>
#include <string.h>

enum { TURNS = 8 }; /* about the normal, over which a sample that is not isotropic is averaged */

#define DEGREES (180 / M_PI)

/* The cosine of a degree beyond that angle, on this side of the horizon. */
static double beyond(double cosine)
{
	return cos(fmin(acos(cosine) + 1 / DEGREES, M_PI_2));
}

/* The smallest cosines that were measured. */
static void find_ends(const struct scattered *s, double *wi, double *wo)
{
	*wi = *wo = 1;
	for (size_t e = 0; e < s->n; e++) {
		*wi = fmin(*wi, s->wi[e].z);
		*wo = fmin(*wo, s->wo[e].z);
	}
}

/* What filling a table takes. */
struct filling {
	const struct scattered *scattered;
	const struct rgl *rgl;                 /* if the measurement has an interpolant of its own, */
	const struct interpolant *interpolant; /* else this */
	enum bins bins;
	enum gaps gaps;
	double min_z;  /* of both directions, */
	double min_wi; /* and of wi */
	struct measurement *table;
};

static struct vec3 turned(struct vec3 v, double phi, bool mirrored)
{
	const double c = cos(phi), s = sin(phi), y = mirrored ? -v.y : v.y;
	return (struct vec3){c * v.x - s * y, s * v.x + c * y, v.z};
}

/* The interpolant's mean over both sides of the plane of incidence, over both orders of wi and wo unless the table
 * tells them apart, and over turns of the sample; a channel out of gamut is 0. Only orders whose wi is not below
 * `least` take part. */
static struct interpolated mean_at(const struct filling *f, struct vec3 wi, struct vec3 wo, double least)
{
	const int turns = f->scattered->symmetry == SYMMETRY_ISOTROPIC ? 1 : TURNS;
	const int orders = f->table->n_phi_d == 180 ? 2 : 1;
	struct interpolated v = {.inside = true};
	for (int i = 0; i < turns * orders * 2; i++) {
		const double phi = 2 * M_PI * (i / (2 * orders)) / turns;
		const struct vec3 a = turned(wi, phi, i % 2), b = turned(wo, phi, i % 2);
		const bool swapped = i / 2 % orders;
		double value[MERL_CHANNELS];
		if ((swapped ? b.z : a.z) < least || !rgl_f(f->rgl, swapped ? b : a, swapped ? a : b, value))
			continue;
		for (int c = 0; c < MERL_CHANNELS; c++)
			v.sum[c] += fmax(0, value[c]);
		v.weight += 1;
	}
	return v;
}

/* Where no order was measured, both are taken. */
static struct interpolated file_at(const struct filling *f, struct vec3 wi, struct vec3 wo)
{
	struct interpolated v = mean_at(f, wi, wo, f->min_wi);
	if (v.weight == 0) {
		v = mean_at(f, wi, wo, 0);
		v.inside = false;
	}
	return v;
}

/* Returns 1 if the entry is among what was measured, -1 if it is not, 0 below the horizon. */
static int fill_entry(const struct filling *f, int i, int j, int k)
{
	const size_t at = measurement_at(f->table->n_phi_d, i, j, k);
	struct vec3 wi, wo;
	halfdiff_trig_dirs(bins_trig(f->bins, i, j, k), &wi, &wo);
	if (!(wi.z > 1e-9 && wo.z > 1e-9))
		return 0;
	const struct interpolated v = f->rgl ? file_at(f, wi, wo) : interpolant_at(f->interpolant, wi, wo);
	const bool inside = v.inside && fmin(wi.z, wo.z) >= f->min_z;
	for (int c = 0; c < MERL_CHANNELS && v.weight > 0 && (inside || f->gaps == GAPS_FILLED); c++)
		f->table->value[c][at] = (float)(v.sum[c] / v.weight);
	return inside ? 1 : -1;
}

/* The k of the entry that is the mirror image of entry k; may be n_phi_d. */
static int mirror_of(const struct filling *f, int k)
{
	return bins_mirror(f->bins, k) + (f->table->n_phi_d == 180 ? 0 : 180);
}

/* Entries that are each other's mirror image have one value: the first is computed, the other copied. */
static void fill_row(const struct filling *f, int i, int j, size_t *measured, size_t *outside)
{
	const int n = f->table->n_phi_d;
	for (int k = 0; k < n && k <= mirror_of(f, k); k++) {
		const int mirror = mirror_of(f, k), found = fill_entry(f, i, j, k);
		const bool twice = mirror < n && mirror != k;
		const size_t from = measurement_at(n, i, j, k);
		for (int c = 0; c < MERL_CHANNELS && twice; c++)
			f->table->value[c][measurement_at(n, i, j, mirror)] = f->table->value[c][from];
		*measured += found > 0 ? 1u + twice : 0;
		*outside += found < 0 ? 1u + twice : 0;
	}
}

static void fill_rows(const struct filling *f, int threads, struct resampled *result)
{
	size_t measured = 0, outside = 0;
#pragma omp parallel for num_threads(threads) schedule(dynamic) reduction(+ : measured, outside)
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			fill_row(f, i, j, &measured, &outside);
	result->n_measured = measured;
	result->n_outside = outside;
}

static enum status from_scattered(const struct measurement *measurement, const struct filling *filling, int threads,
				  struct resampled *result)
{
	const struct scattered *s = measurement->scattered;
	struct filling f = *filling;
	struct interpolant interpolant;
	const enum status status = interpolant_init(&interpolant, measurement, f.table->n_phi_d, false, threads);
	if (status != STATUS_OK)
		return status;
	f.interpolant = &interpolant;
	double lowest_i, lowest_o;
	find_ends(s, &lowest_i, &lowest_o);
	f.min_wi = beyond(lowest_i);
	/* An interpolant grows without bound towards the horizon. */
	f.min_z = f.rgl ? fmin(lowest_i, lowest_o) : beyond(fmin(lowest_i, lowest_o));
	fill_rows(&f, threads, result);
	result->symmetrised = true;
	interpolant_free(&interpolant);
	return STATUS_OK;
}

/* The mean of the values that are there; NaN if there is none. */
static float mean(float a, float b)
{
	if (isnan(a) || isnan(b))
		return isnan(a) ? b : a;
	return a / 2 + b / 2;
}

static void from_table(const struct measurement *from, struct measurement *to, struct resampled *result)
{
	const bool folds = from->n_phi_d == 360 && to->n_phi_d == 180;
	for (int i = 0; i < MERL_THETA_H; i++)
		for (int j = 0; j < MERL_THETA_D; j++)
			for (int k = 0; k < to->n_phi_d; k++) {
				const size_t at = measurement_at(to->n_phi_d, i, j, k);
				const size_t first = measurement_at(from->n_phi_d, i, j, k % from->n_phi_d);
				for (int c = 0; c < MERL_CHANNELS; c++)
					to->value[c][at] =
						folds ? mean(from->value[c][first], from->value[c][first + 180])
						      : from->value[c][first];
				result->n_measured += isnan(to->value[0][at]) ? 0 : 1;
			}
	result->symmetrised = folds;
}

enum status measurement_resample(const struct measurement *measurement, enum bins bins, int n_phi_d, enum gaps gaps,
				 int threads, struct measurement *table, struct resampled *result)
{
	struct resampled mine = {0};
	const int team = threads < 1 ? 1 : threads;
	enum status status = measurement_alloc(table, n_phi_d);
	if (status != STATUS_OK)
		return status;
	const struct filling filling = {.scattered = measurement->scattered,
					.rgl = measurement->rgl,
					.bins = bins,
					.gaps = gaps,
					.table = table};
	if (measurement->scattered)
		status = from_scattered(measurement, &filling, team, &mine);
	else
		from_table(measurement, table, &mine);
	if (status != STATUS_OK) {
		measurement_free(table);
		return status;
	}
	table->n_negative = measurement->n_negative;
	table->n_nonfinite = measurement->n_nonfinite;
	table->n_below_horizon = measurement->n_below_horizon;
	table->n_missing = measurement->n_missing;
	table->n_out_of_gamut = measurement->n_out_of_gamut;
	table->n_channels = measurement->n_channels;
	table->format = measurement->format;
	table->file_size = measurement->file_size;
	table->file_hash = measurement->file_hash;
	if (result)
		*result = mine;
	return STATUS_OK;
}

enum status measurement_fill(struct measurement *measurement, enum bins bins, int threads)
{
	struct measurement table;
	if (!measurement->scattered)
		return STATUS_OK;
	const enum status status = measurement_resample(measurement, bins, 180, GAPS_FILLED, threads, &table, NULL);
	if (status != STATUS_OK)
		return status;
	measurement_free(measurement);
	*measurement = table;
	return STATUS_OK;
}

enum status measurement_fill_isotropic(struct measurement *measurement, enum bins bins, int threads)
{
	return measurement_turns(measurement) ? STATUS_OK : measurement_fill(measurement, bins, threads);
}
