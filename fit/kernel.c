/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "kernel.h"
#include <math.h>

/* Compiled twice, see the Makefile: KERNEL_NAME is kernel_plain or kernel_avx2. */
#ifndef KERNEL_NAME
#define KERNEL_NAME kernel_plain
#endif
#define TEXT(x) #x
#define NAME_TEXT(x) TEXT(x)

/* Floats are summed over runs this long only, then in double: rounding errors stay near 1e-8 of the sum. */
enum { RUN = 256 };

static inline float g1_at(const struct kernel_g1 *g1, const float *restrict value, int32_t q)
{
	const int32_t at = q - g1->q_min;
	const int32_t index = at >> g1->shift;
	const float fraction = (float)(at & ((1 << g1->shift) - 1)) * (1.0F / (float)(1 << g1->shift));

	return value[index] + fraction * (value[index + 1] - value[index]);
}

static void lobe_separable(const struct kernel_g1 *g1, const float *restrict row, const struct kernel_slots *slots,
			   float *restrict s)
{
	const struct kernel_g1 table = *g1;
	const float *restrict value = g1->value, *restrict geo = slots->geo;
	const int32_t *restrict q_i = slots->q_i, *restrict q_o = slots->q_o;
	const uint16_t *restrict at = slots->row;

#pragma omp simd
	for (int n = 0; n < KERNEL_BLOCK; n++)
		s[n] = geo[n] * row[at[n]] * g1_at(&table, value, q_i[n]) * g1_at(&table, value, q_o[n]);
}

static void lobe_correlated(const struct kernel_g1 *g1, const float *restrict row, const struct kernel_slots *slots,
			    float *restrict s)
{
	const struct kernel_g1 table = *g1;
	const float *restrict value = g1->value, *restrict geo = slots->geo;
	const int32_t *restrict q_i = slots->q_i, *restrict q_o = slots->q_o;
	const uint16_t *restrict at = slots->row;

#pragma omp simd
	for (int n = 0; n < KERNEL_BLOCK; n++) {
		const float i = g1_at(&table, value, q_i[n]), o = g1_at(&table, value, q_o[n]);
		/* 1/(1/i + 1/o - 1), without the division by a G1 that may be 0. */
		const float below = i + o - i * o;

		s[n] = geo[n] * row[at[n]] * (below > 0 ? i * o / below : 0);
	}
}

static void lobe_static(const float *restrict row, const struct kernel_slots *slots, float *restrict s)
{
	const float *restrict geo = slots->geo;
	const uint16_t *restrict at = slots->row;

#pragma omp simd
	for (int n = 0; n < KERNEL_BLOCK; n++)
		s[n] = geo[n] * row[at[n]];
}

static void lobe(enum kernel_gaf gaf, const struct kernel_g1 *g1, const float *row, const struct kernel_slots *slots,
		 float *s)
{
	switch (gaf) {
	case KERNEL_SEPARABLE:
		lobe_separable(g1, row, slots, s);
		break;
	case KERNEL_CORRELATED:
		lobe_correlated(g1, row, slots, s);
		break;
	case KERNEL_STATIC:
		lobe_static(row, slots, s);
		break;
	}
}

/* One run of a channel: members m (and m2 when `pair`), sums added to `sums`. Constant arguments are folded in. */
__attribute__((always_inline)) static inline void run(bool pair, bool curved, const float *restrict m,
						      const float *restrict m2, const float *restrict w,
						      const float *restrict s, float d, float ks, float tau,
						      struct kernel_sums *sums)
{
	float error = 0, slope_d = 0, slope_s = 0, dd = 0, ds = 0, ss = 0;

#pragma omp simd reduction(+ : error, slope_d, slope_s, dd, ds, ss)
	for (int n = 0; n < RUN; n++) {
		const float f = d * w[n] + ks * s[n];
		const float r = m[n] - f;
		float sign = copysignf(1, r);

		error += fabsf(r);
		if (pair) {
			const float r2 = m2[n] - f;

			sign += copysignf(1, r2);
			error += fabsf(r2);
			if (curved) {
				const float near = (fabsf(r) < tau * f ? 1.0F : 0.0F) + (fabsf(r2) < tau * f ? 1.0F : 0.0F);
				const float density = near / (f + 1e-30F);

				dd += density * w[n] * w[n];
				ds += density * w[n] * s[n];
				ss += density * s[n] * s[n];
			}
		} else if (curved) {
			const float density = (fabsf(r) < tau * f ? 1.0F : 0.0F) / (f + 1e-30F);

			dd += density * w[n] * w[n];
			ds += density * w[n] * s[n];
			ss += density * s[n] * s[n];
		}
		slope_d -= sign * w[n];
		slope_s -= sign * s[n];
	}
	sums->error += (double)error;
	sums->slope[0] += (double)slope_d;
	sums->slope[1] += (double)slope_s;
	if (curved) {
		sums->curvature[0] += (double)dd;
		sums->curvature[1] += (double)ds;
		sums->curvature[2] += (double)ss;
	}
}

static void pass(bool pair, const float *value, const float *w, const float *s, double d, double ks, double tau,
		 struct kernel_sums *sums)
{
	const float *second = pair ? value + KERNEL_BLOCK : value;
	const float fd = (float)d, fs = (float)ks, ft = (float)tau;

	*sums = (struct kernel_sums){0};
	for (int at = 0; at < KERNEL_BLOCK; at += RUN) {
		const float *m = value + at, *m2 = second + at;

		if (pair && tau > 0)
			run(true, true, m, m2, w + at, s + at, fd, fs, ft, sums);
		else if (pair)
			run(true, false, m, m2, w + at, s + at, fd, fs, ft, sums);
		else if (tau > 0)
			run(false, true, m, m2, w + at, s + at, fd, fs, ft, sums);
		else
			run(false, false, m, m2, w + at, s + at, fd, fs, ft, sums);
	}
	if (tau > 0)
		for (int n = 0; n < 3; n++)
			sums->curvature[n] /= tau;
}

const struct kernel KERNEL_NAME = {NAME_TEXT(KERNEL_NAME), lobe, pass};
