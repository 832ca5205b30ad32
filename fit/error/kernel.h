/* SPDX-License-Identifier: GPL-3.0-or-later */
/* kernel - the two loops in which a fit spends its time. Mathematics only: no threads, no allocation.
 *
 * A sample is one value of the model; it stands for one measured entry (single) or for two (pair), since
 * phi_d -> 180 deg - phi_d swaps wi and wo and leaves the model as it is. Samples come in blocks of
 * KERNEL_BLOCK, all of one sort, padded with samples whose members are all zero: those add nothing.
 * The file is compiled for any machine, for AVX2 and for AVX-512; kernel_pick() chooses at run time. All give the same
 * bits: no sum depends on the width of a register, and no multiplication is joined with an addition. */
#ifndef KERNEL_H
#define KERNEL_H

#include <stdbool.h>
#include <stdint.h>

enum { KERNEL_BLOCK = 1024 };

/* The masking function G1 of one shape, tabulated over q = log2 cot theta for linear interpolation:
 * a direction whose fixed-point q is `q` lies between entries (q - q_min) >> shift and the one above. */
struct kernel_g1 {
	const float *value;
	int32_t q_min;
	int shift;
};

enum kernel_gaf {
	KERNEL_SEPARABLE,  /* G1(i) G1(o) */
	KERNEL_CORRELATED, /* 1 / (1/G1(i) + 1/G1(o) - 1) */
	KERNEL_SUM,        /* G1(i) + G1(o): no masking, but the grazing term's function of either direction */
	KERNEL_STATIC,     /* G depends on the geometry alone and stands in geometric_factor already */
};

/* Geometry of one block of samples; see struct sample_set. */
struct kernel_samples {
	const int32_t *q_i, *q_o;
	const float *geometric_factor;
	const uint16_t *row;
};

/* A function of one number x, tabulated over octaves of y = x + offset: entry (bits of y - first_bits) >> shift of `value` and the
 * one above, between which one interpolates linearly. y below `first` counts as that, y above `last` as that. */
struct kernel_curve {
	const float *value;
	float offset, first, last;
	int32_t first_bits;
	int shift;
};

/* The geometry of scattered entries: slopes of h (normal of a facet that reflects wi to wo) along x and y, tan theta of wi and
 * wo times cosine and sine of their azimuth, and cos theta_d. */
enum kernel_plane {
	KERNEL_H_X,
	KERNEL_H_Y,
	KERNEL_I_X,
	KERNEL_I_Y,
	KERNEL_O_X,
	KERNEL_O_Y,
	KERNEL_COS_D,
	KERNEL_PLANES
};

/* One block of scattered samples. */
struct kernel_scattered {
	const float *plane[KERNEL_PLANES];
	const float *geometric_factor; /* w / (4 cos_i cos_o cos_h^4), times G for KERNEL_STATIC */
};

/* x^2 + y^2 of a matrix times a vector. */
struct kernel_form {
	float xx, xy, yx, yy;
};

/* The lobe of one shape for them: `scale` times P22 over the form `slopes` of h, G1 over the form `masking` of wi and wo, F over
 * cos_d. */
struct kernel_shape {
	float scale;
	struct kernel_form slopes, masking;
	struct kernel_curve P22, G1, F;
};

/* A model is a sum of so many terms at most, each a fixed number a sample times a coefficient: the diffuse term, w itself, first. */
enum { KERNEL_TERMS = 5, KERNEL_SECOND = KERNEL_TERMS * (KERNEL_TERMS + 1) / 2 };

/* Where a pass evaluates the error: the coefficients, kd/pi first. tau: relative width of the window in which the curvature is
 * estimated, 0 for none; floor: added to the model, in units of the weight, where the window's width is concerned. */
struct kernel_evaluation {
	double x[KERNEL_TERMS], tau, floor;
};

/* What one pass returns for one channel. With f = sum x_t a_t over the terms a_t and r = m - f over the members of the
 * block: error = sum |r|; slope_t = -sum sign(r) a_t, a subgradient of the error by x; curvature (a_t a_u for t <= u, row by row): an
 * estimate of its second derivatives from the members with |r| < tau (f + floor w). */
struct kernel_sums {
	double error, slope[KERNEL_TERMS], curvature[KERNEL_SECOND];
};

struct kernel {
	const char *name;
	/* lobe - s = geometric_factor row[.] G for one block. */
	void (*lobe)(enum kernel_gaf gaf, const struct kernel_g1 *g1, const float *row,
		     const struct kernel_samples *samples, float *s);
	/* lobe_scattered - the same of scattered samples: s = geometric_factor scale P22 F G. */
	void (*lobe_scattered)(enum kernel_gaf gaf, const struct kernel_shape *shape,
			       const struct kernel_scattered *samples, float *s);
	/* pass - sums of one block for a model of 2 .. KERNEL_TERMS terms; those beyond are not set. Of each sample it takes `members`
	 * values, KERNEL_BLOCK apart: 1 of a single and 2 of a pair for one channel, 3 or 6 for the three channels under the same
	 * coefficients. */
	void (*pass)(int terms, int members, const float *value, const float *const term[],
		     const struct kernel_evaluation *at, struct kernel_sums *sums);
	/* signs - of each sample of one block the sum of sign(r) over the members, for the coefficients x; times x_t it is
	 * added to weight[t] for t >= 1. */
	void (*signs)(int terms, int members, const float *value, const float *const term[], const double x[],
		      float *const weight[]);
	/* change - the sum of weight (to - from) of one block. */
	double (*change)(const float *weight, const float *from, const float *to);
};

extern const struct kernel kernel_plain;
#ifdef KERNEL_HAVE_AVX2
extern const struct kernel kernel_avx2;
extern const struct kernel kernel_avx512;
#endif

/* kernel_pick - the fastest kernel that this processor can run. */
const struct kernel *kernel_pick(void);

#endif
