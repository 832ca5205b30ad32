/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/kernel.h"
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

/* The specular term as cook_torrance_from_G1() puts it together, in float and from tables;
 * kernel_and_metrics_match_the_reference in tests/test_objective.c holds both against cook_torrance_f(). */
static void lobe_separable(const struct kernel_g1 *g1, const float *restrict row, const struct kernel_samples *samples,
			   float *restrict s)
{
	const struct kernel_g1 table = *g1;
	const float *restrict value = g1->value, *restrict geometric_factor = samples->geometric_factor;
	const int32_t *restrict q_i = samples->q_i, *restrict q_o = samples->q_o;
	const uint16_t *restrict at = samples->row;

#pragma omp simd
	for (int n = 0; n < KERNEL_BLOCK; n++)
		s[n] = geometric_factor[n] * row[at[n]] * g1_at(&table, value, q_i[n]) * g1_at(&table, value, q_o[n]);
}

static void lobe_correlated(const struct kernel_g1 *g1, const float *restrict row, const struct kernel_samples *samples,
			    float *restrict s)
{
	const struct kernel_g1 table = *g1;
	const float *restrict value = g1->value, *restrict geometric_factor = samples->geometric_factor;
	const int32_t *restrict q_i = samples->q_i, *restrict q_o = samples->q_o;
	const uint16_t *restrict at = samples->row;

#pragma omp simd
	for (int n = 0; n < KERNEL_BLOCK; n++) {
		const float i = g1_at(&table, value, q_i[n]), o = g1_at(&table, value, q_o[n]);
		/* 1/(1/i + 1/o - 1), without the division by a G1 that may be 0. */
		const float below = i + o - i * o;

		s[n] = geometric_factor[n] * row[at[n]] * (below > 0 ? i * o / below : 0);
	}
}

static void lobe_static(const float *restrict row, const struct kernel_samples *samples, float *restrict s)
{
	const float *restrict geometric_factor = samples->geometric_factor;
	const uint16_t *restrict at = samples->row;

#pragma omp simd
	for (int n = 0; n < KERNEL_BLOCK; n++)
		s[n] = geometric_factor[n] * row[at[n]];
}

static void lobe(enum kernel_gaf gaf, const struct kernel_g1 *g1, const float *row,
		 const struct kernel_samples *samples, float *s)
{
	switch (gaf) {
	case KERNEL_SEPARABLE:
		lobe_separable(g1, row, samples, s);
		break;
	case KERNEL_CORRELATED:
		lobe_correlated(g1, row, samples, s);
		break;
	case KERNEL_STATIC:
		lobe_static(row, samples, s);
		break;
	}
}

static inline float curve_at(const struct kernel_curve *curve, const float *restrict value, float x)
{
	const float y = x + curve->offset, above = y > curve->first ? y : curve->first;
	const union {
		float f;
		int32_t i;
	} bits = {above < curve->last ? above : curve->last};
	const int32_t at = bits.i - curve->first_bits, index = at >> curve->shift;
	const float fraction = (float)(at & ((1 << curve->shift) - 1)) * (1.0F / (float)(1 << curve->shift));

	return value[index] + fraction * (value[index + 1] - value[index]);
}

static inline float form_at(const struct kernel_form *form, float x, float y)
{
	const float a = form->xx * x + form->xy * y, b = form->yx * x + form->yy * y;

	return a * a + b * b;
}

/* The largest that s may be: a sum of some is still a float. Only entries within 1e-6 of the horizon come near. */
#define LOBE_MAX 1e30F

__attribute__((always_inline)) static inline void scattered(enum kernel_gaf gaf, const struct kernel_shape *shape,
							    const struct kernel_scattered *samples, float *restrict s)
{
	const struct kernel_shape of = *shape;
	const float *restrict P22 = of.P22.value, *restrict G1 = of.G1.value, *restrict F = of.F.value;
	const float *restrict h_x = samples->plane[KERNEL_H_X], *restrict h_y = samples->plane[KERNEL_H_Y],
			      *restrict i_x = samples->plane[KERNEL_I_X], *restrict i_y = samples->plane[KERNEL_I_Y],
			      *restrict o_x = samples->plane[KERNEL_O_X], *restrict o_y = samples->plane[KERNEL_O_Y],
			      *restrict cos_d = samples->plane[KERNEL_COS_D],
			      *restrict geometric_factor = samples->geometric_factor;

#pragma omp simd
	for (int n = 0; n < KERNEL_BLOCK; n++) {
		float G = 1;

		if (gaf != KERNEL_STATIC) {
			const float i = curve_at(&of.G1, G1, form_at(&of.masking, i_x[n], i_y[n])),
				    o = curve_at(&of.G1, G1, form_at(&of.masking, o_x[n], o_y[n])),
				    below = i + o - i * o;

			/* As in lobe_correlated(). */
			G = gaf == KERNEL_SEPARABLE ? i * o : below > 0 ? i * o / below : 0;
		}
		const float P = of.scale * curve_at(&of.P22, P22, form_at(&of.slopes, h_x[n], h_y[n]));
		const float value = geometric_factor[n] * (P * curve_at(&of.F, F, cos_d[n]) * G);

		s[n] = value < LOBE_MAX ? value : LOBE_MAX;
	}
}

static void lobe_scattered(enum kernel_gaf gaf, const struct kernel_shape *shape,
			   const struct kernel_scattered *samples, float *s)
{
	switch (gaf) {
	case KERNEL_SEPARABLE:
		scattered(KERNEL_SEPARABLE, shape, samples, s);
		break;
	case KERNEL_CORRELATED:
		scattered(KERNEL_CORRELATED, shape, samples, s);
		break;
	case KERNEL_STATIC:
		scattered(KERNEL_STATIC, shape, samples, s);
		break;
	}
}

/* Eight lanes, whatever the machine has: a compiler without registers this wide makes two operations of each. Sums
 * are kept lane by lane, so both kernels add in the same order. */
typedef float lanes __attribute__((vector_size(32), may_alias));
typedef int32_t lanes_int __attribute__((vector_size(32), may_alias));
typedef double lanes_double __attribute__((vector_size(64)));
enum { LANES = 8 };

struct lane_evaluation {
	lanes d, ks, tau, floor;
};

struct accumulator {
	lanes error, slope_w, slope_s, dd, ds, ss;
};

/* 1/x to about 1 %, x > 0: the curvature is an estimate, and a division takes longer than all the rest. */
__attribute__((always_inline)) static inline lanes rough_inverse(lanes x)
{
	const lanes y = (lanes)(0x7ef311c7 - (lanes_int)x);

	return y * (2 - x * y);
}

/* Adds the members m[0], m[KERNEL_BLOCK], ... of eight samples. Constant arguments are folded in. */
__attribute__((always_inline)) static inline void add_lanes(int members, bool curved, const float *m, const float *w_at,
							    const float *s_at, const struct lane_evaluation *at,
							    struct accumulator *sum)
{
	const lanes w = *(const lanes *)w_at, s = *(const lanes *)s_at, f = at->d * w + at->ks * s;
	const lanes wide = f + at->floor * w, window = at->tau * wide;
	/* Half of sum sign(r): half of the members, less 1 for each below the model. */
	lanes_int whole = (lanes_int){0} + members / 2, near = {0};

	for (int a = 0; a < members; a++) {
		const lanes r = *(const lanes *)(m + a * KERNEL_BLOCK) - f;
		const lanes size = (lanes)((lanes_int)r & 0x7fffffff);

		sum->error += size;
		whole += r < 0;
		if (curved)
			near += size < window;
	}
	lanes half = __builtin_convertvector(whole, lanes);

	if (members % 2)
		half += 0.5F;
	sum->slope_w += half * w;
	sum->slope_s += half * s;
	if (curved) {
		const lanes density = -__builtin_convertvector(near, lanes) * rough_inverse(wide);
		const lanes dw = density * w, ds = density * s;

		sum->dd += dw * w;
		sum->ds += dw * s;
		sum->ss += ds * s;
	}
}

/* The sums of a block, a lane each, in double. */
struct lane_sums {
	lanes_double error, slope_w, slope_s, dd, ds, ss;
};

__attribute__((always_inline)) static inline lanes_double widen(lanes a, lanes b)
{
	return __builtin_convertvector(a + b, lanes_double);
}

static inline double total(const lanes_double *a)
{
	double sum = 0;

	for (int n = 0; n < LANES; n++)
		sum += (*a)[n];
	return sum;
}

/* A run, with two accumulators in turn, so that one addition need not wait for the other. */
__attribute__((always_inline)) static inline void run(int members, bool curved, const float *m, const float *w,
						      const float *s, const struct lane_evaluation *at,
						      struct lane_sums *sums)
{
	struct accumulator a = {0}, b = {0};

	for (int n = 0; n < RUN; n += 2 * LANES) {
		/* What comes next in memory, the next channel or block: the processor's own prefetching ends at each page. */
		for (int member = members; member < 2 * members; member++)
			__builtin_prefetch(m + n + member * KERNEL_BLOCK);
		add_lanes(members, curved, m + n, w + n, s + n, at, &a);
		add_lanes(members, curved, m + n + LANES, w + n + LANES, s + n + LANES, at, &b);
	}
	sums->error += widen(a.error, b.error);
	sums->slope_w += widen(a.slope_w, b.slope_w);
	sums->slope_s += widen(a.slope_s, b.slope_s);
	if (curved) {
		sums->dd += widen(a.dd, b.dd);
		sums->ds += widen(a.ds, b.ds);
		sums->ss += widen(a.ss, b.ss);
	}
}

__attribute__((always_inline)) static inline void block(int members, bool curved, const float *m, const float *w,
							const float *s, const struct kernel_evaluation *at,
							struct kernel_sums *sums)
{
	const lanes zero = {0};
	const struct lane_evaluation all = {zero + (float)at->d, zero + (float)at->ks, zero + (float)at->tau,
					    zero + (float)at->floor};
	struct lane_sums lane = {0};

	for (int from = 0; from < KERNEL_BLOCK; from += RUN)
		run(members, curved, m + from, w + from, s + from, &all, &lane);
	*sums = (struct kernel_sums){
		.error = total(&lane.error),
		.slope = {-2 * total(&lane.slope_w), -2 * total(&lane.slope_s)},
	};
	if (curved) {
		sums->curvature[0] = total(&lane.dd) / at->tau;
		sums->curvature[1] = total(&lane.ds) / at->tau;
		sums->curvature[2] = total(&lane.ss) / at->tau;
	}
}

__attribute__((always_inline)) static inline void either_block(int members, const float *m, const float *w,
							       const float *s, const struct kernel_evaluation *at,
							       struct kernel_sums *sums)
{
	if (at->tau > 0)
		block(members, true, m, w, s, at, sums);
	else
		block(members, false, m, w, s, at, sums);
}

/* Each count of members gets a loop of its own. */
static void pass(int members, const float *m, const float *w, const float *s, const struct kernel_evaluation *at,
		 struct kernel_sums *sums)
{
	switch (members) {
	case 1:
		either_block(1, m, w, s, at, sums);
		break;
	case 2:
		either_block(2, m, w, s, at, sums);
		break;
	case 3:
		either_block(3, m, w, s, at, sums);
		break;
	case 6:
		either_block(6, m, w, s, at, sums);
		break;
	}
}

const struct kernel KERNEL_NAME = {NAME_TEXT(KERNEL_NAME), lobe, lobe_scattered, pass};
