/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/kernel.h"
#include <math.h>
#include <stddef.h>
#include <string.h>

/* Compiled once for each width of vectors, see the Makefile: KERNEL_NAME is kernel_plain, kernel_avx2 or kernel_avx512. */
#ifndef KERNEL_NAME
#define KERNEL_NAME kernel_plain
#endif
#ifndef KERNEL_LANES
#define KERNEL_LANES 8
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
__attribute__((always_inline)) static inline void tabulated(enum kernel_gaf gaf, const struct kernel_g1 *g1,
							    const float *restrict row,
							    const struct kernel_samples *samples, float *restrict s)
{
	const struct kernel_g1 table = *g1;
	const float *restrict value = g1->value, *restrict geometric_factor = samples->geometric_factor;
	const int32_t *restrict q_i = samples->q_i, *restrict q_o = samples->q_o;
	const uint16_t *restrict at = samples->row;

#pragma omp simd
	for (int n = 0; n < KERNEL_BLOCK; n++) {
		float f = geometric_factor[n] * row[at[n]];

		if (gaf != KERNEL_STATIC) {
			const float i = g1_at(&table, value, q_i[n]), o = g1_at(&table, value, q_o[n]);
			/* 1/(1/i + 1/o - 1), without the division by a G1 that may be 0. */
			const float below = i + o - i * o;

			if (gaf == KERNEL_SEPARABLE)
				f = f * i * o;
			else
				f *= gaf == KERNEL_SUM ? i + o : below > 0 ? i * o / below : 0;
		}
		s[n] = f;
	}
}

/* Each form of G gets a loop of its own. */
static void lobe(enum kernel_gaf gaf, const struct kernel_g1 *g1, const float *row,
		 const struct kernel_samples *samples, float *s)
{
	switch (gaf) {
	case KERNEL_SEPARABLE:
		tabulated(KERNEL_SEPARABLE, g1, row, samples, s);
		break;
	case KERNEL_CORRELATED:
		tabulated(KERNEL_CORRELATED, g1, row, samples, s);
		break;
	case KERNEL_SUM:
		tabulated(KERNEL_SUM, g1, row, samples, s);
		break;
	case KERNEL_STATIC:
		tabulated(KERNEL_STATIC, g1, row, samples, s);
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

			/* As in tabulated(). */
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
	case KERNEL_SUM: /* has no table of scattered entries */
	case KERNEL_STATIC:
		scattered(KERNEL_STATIC, shape, samples, s);
		break;
	}
}

/* Eight lanes or sixteen; a compiler without registers this wide makes two operations of each. Sixteen samples are always
 * added in two groups of eight, lane by lane: so all kernels add in the same order. */
enum { LANES = KERNEL_LANES, GROUP = 8, GROUPS = 2, VECTORS = GROUPS * GROUP / LANES };
typedef float lanes __attribute__((vector_size(4 * LANES), may_alias));
typedef int32_t lanes_int __attribute__((vector_size(4 * LANES), may_alias));
typedef uint32_t lanes_unsigned __attribute__((vector_size(4 * LANES), may_alias));
typedef float group __attribute__((vector_size(4 * GROUP)));
typedef double group_double __attribute__((vector_size(8 * GROUP)));

struct lane_evaluation {
	lanes x[KERNEL_TERMS], tau, floor;
};

struct accumulator {
	lanes error[VECTORS], slope[KERNEL_TERMS][VECTORS], curvature[KERNEL_SECOND][VECTORS];
};

/* 1/x to about 1 %, x > 0: the curvature is an estimate, and a division takes longer than all the rest. */
__attribute__((always_inline)) static inline lanes rough_inverse(lanes x)
{
	/* Unsigned, so that an x < 0, of a model below 0 on the way of a search, gives a number as well: it is not used. */
	const lanes y = (lanes)(0x7ef311c7U - (lanes_unsigned)x);

	return y * (2 - x * y);
}

/* Adds the members m[0], m[KERNEL_BLOCK], ... of a vector of samples, those from `from` on in each term, to the sums' v-th
 * vectors. Constant arguments are folded in. */
__attribute__((always_inline)) static inline void add_lanes(int terms, int members, bool curved, const float *m,
							    const float *const term[], int from,
							    const struct lane_evaluation *at, int v,
							    struct accumulator *sum)
{
	lanes a[KERNEL_TERMS], f;

	a[0] = *(const lanes *)(term[0] + from);
	f = at->x[0] * a[0];
	for (int t = 1; t < terms; t++) {
		a[t] = *(const lanes *)(term[t] + from);
		f += at->x[t] * a[t];
	}
	const lanes wide = f + at->floor * a[0], window = at->tau * wide;
	/* Half of sum sign(r): half of the members, less 1 for each below the model. */
	lanes_int whole = (lanes_int){0} + members / 2, near = {0};

	for (int n = 0; n < members; n++) {
		const lanes r = *(const lanes *)(m + from + n * KERNEL_BLOCK) - f;
		const lanes size = (lanes)((lanes_int)r & 0x7fffffff);

		sum->error[v] += size;
		whole += r < 0;
		if (curved)
			near += size < window;
	}
	lanes half = __builtin_convertvector(whole, lanes);

	if (members % 2)
		half += 0.5F;
	for (int t = 0; t < terms; t++)
		sum->slope[t][v] += half * a[t];
	if (curved) {
		const lanes density = -__builtin_convertvector(near, lanes) * rough_inverse(wide);
		int second = 0;

		for (int t = 0; t < terms; t++) {
			const lanes part = density * a[t];

			for (int u = t; u < terms; u++)
				sum->curvature[second++][v] += part * a[u];
		}
	}
}

/* The sums of a block, a lane of a group each, in double. */
struct lane_sums {
	group_double error, slope[KERNEL_TERMS], curvature[KERNEL_SECOND];
};

/* Both groups together. */
__attribute__((always_inline)) static inline group_double widen(const lanes *a)
{
	group both[GROUPS];

	memcpy(both, a, sizeof both);
	return __builtin_convertvector(both[0] + both[1], group_double);
}

static inline double total(const group_double *a)
{
	double sum = 0;

	for (int n = 0; n < GROUP; n++)
		sum += (*a)[n];
	return sum;
}

/* A run. The groups have accumulators of their own, so that one addition need not wait for the other. */
__attribute__((always_inline)) static inline void run(int terms, int members, bool curved, const float *m,
						      const float *const term[], int from,
						      const struct lane_evaluation *at, struct lane_sums *sums)
{
	struct accumulator a = {0};

	for (int n = from; n < from + RUN; n += GROUPS * GROUP) {
		/* What comes next in memory, the next channel or block: the processor's own prefetching ends at each page. */
		for (int member = members; member < 2 * members; member++)
			__builtin_prefetch(m + n + member * KERNEL_BLOCK);
		for (int v = 0; v < VECTORS; v++)
			add_lanes(terms, members, curved, m, term, n + v * LANES, at, v, &a);
	}
	sums->error += widen(a.error);
	for (int t = 0; t < terms; t++)
		sums->slope[t] += widen(a.slope[t]);
	if (curved)
		for (int t = 0; t < terms * (terms + 1) / 2; t++)
			sums->curvature[t] += widen(a.curvature[t]);
}

__attribute__((always_inline)) static inline void block(int terms, int members, bool curved, const float *m,
							const float *const term[], const struct kernel_evaluation *at,
							struct kernel_sums *sums)
{
	const lanes zero = {0};
	struct lane_evaluation all = {.tau = zero + (float)at->tau, .floor = zero + (float)at->floor};
	struct lane_sums lane = {0};

	for (int t = 0; t < terms; t++)
		all.x[t] = zero + (float)at->x[t];
	for (int from = 0; from < KERNEL_BLOCK; from += RUN)
		run(terms, members, curved, m, term, from, &all, &lane);
	sums->error = total(&lane.error);
	for (int t = 0; t < terms; t++)
		sums->slope[t] = -2 * total(&lane.slope[t]);
	for (int t = 0; t < terms * (terms + 1) / 2; t++)
		sums->curvature[t] = curved ? total(&lane.curvature[t]) / at->tau : 0;
}

/* Each count of members gets a loop of its own. */
__attribute__((always_inline)) static inline void members_block(int terms, int members, bool curved, const float *m,
								const float *const term[],
								const struct kernel_evaluation *at,
								struct kernel_sums *sums)
{
	switch (members) {
	case 1:
		block(terms, 1, curved, m, term, at, sums);
		break;
	case 2:
		block(terms, 2, curved, m, term, at, sums);
		break;
	case 3:
		block(terms, 3, curved, m, term, at, sums);
		break;
	case 6:
		block(terms, 6, curved, m, term, at, sums);
		break;
	}
}

/* And so does each count of terms. */
#define PASS(terms)                                                                                                    \
	static void pass_##terms(int members, const float *m, const float *const term[],                               \
				 const struct kernel_evaluation *at, struct kernel_sums *sums)                         \
	{                                                                                                              \
		if (at->tau > 0)                                                                                       \
			members_block(terms, members, true, m, term, at, sums);                                        \
		else                                                                                                   \
			members_block(terms, members, false, m, term, at, sums);                                       \
	}
PASS(2)
PASS(3)
PASS(4)
PASS(5)

static void pass(int terms, int members, const float *m, const float *const term[], const struct kernel_evaluation *at,
		 struct kernel_sums *sums)
{
	static void (*const of[])(int, const float *, const float *const[], const struct kernel_evaluation *,
				  struct kernel_sums *) = {NULL, NULL, pass_2, pass_3, pass_4, pass_5};

	of[terms](members, m, term, at, sums);
}

__attribute__((always_inline)) static inline void
signs_of(int terms, int members, const float *m, const float *const term[], const double x[],
	 float *const weight[]) /* cppcheck-suppress constParameter; it is written through */
{
	const lanes zero = {0};

	for (int n = 0; n < KERNEL_BLOCK; n += LANES) {
		lanes f = (float)x[0] * *(const lanes *)(term[0] + n);
		lanes_int sign = {0};

		for (int t = 1; t < terms; t++)
			f += (float)x[t] * *(const lanes *)(term[t] + n);
		/* Each comparison is -1 where it holds. */
		for (int a = 0; a < members; a++) {
			const lanes r = *(const lanes *)(m + n + a * KERNEL_BLOCK) - f;

			sign += (r < zero) - (r > zero);
		}
		const lanes sum = __builtin_convertvector(sign, lanes);

		for (int t = 1; t < terms; t++)
			*(lanes *)(weight[t] + n) += (float)x[t] * sum;
	}
}

static void signs(int terms, int members, const float *m, const float *const term[], const double x[],
		  float *const weight[])
{
	if (terms == 2 && members == 2)
		signs_of(2, 2, m, term, x, weight);
	else if (terms == 2 && members == 1)
		signs_of(2, 1, m, term, x, weight);
	else
		signs_of(terms, members, m, term, x, weight);
}

static double change(const float *weight, const float *from, const float *to)
{
	group_double sum = {0};

	for (int n = 0; n < KERNEL_BLOCK; n += RUN) {
		lanes a[VECTORS] = {{0}};

		for (int i = n; i < n + RUN; i += GROUPS * GROUP)
			for (int v = 0; v < VECTORS; v++) {
				const int at = i + v * LANES;

				a[v] += *(const lanes *)(weight + at) *
					(*(const lanes *)(to + at) - *(const lanes *)(from + at));
			}
		sum += widen(a);
	}
	return total(&sum);
}

const struct kernel KERNEL_NAME = {NAME_TEXT(KERNEL_NAME), lobe, lobe_scattered, pass, signs, change};
