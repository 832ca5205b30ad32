/* SPDX-License-Identifier: GPL-3.0-or-later */
/* objective - the error of a shape: the best that any coefficients of its terms make of it on a table. */
#ifndef OBJECTIVE_H
#define OBJECTIVE_H

#include "fit/error/bundle.h"
#include "fit/error/masking.h"
#include "fit/error/sample_set.h"
#include "fit/error/scattered_lobe.h"

/* struct shape - what a fit searches: the parameters in which the model is not linear. */
struct shape {
	double sigma, gamma, ior, k;       /* sigma: sqrt(sigma_x sigma_y) where they differ */
	double channel_ior[MERL_CHANNELS]; /* of options->per_channel_ior, in place of ior and k; else 0 */
	double channel_k[MERL_CHANNELS];
	double stretch;                    /* ln(sigma_x/sigma_y); 0: isotropic */
	double angle;                      /* of the axis of sigma_x, degrees */
	double tilt_x, tilt_y;             /* ndf_tilt() */
	double second_sigma, second_gamma; /* of the second lobe */
	double grazing;                    /* exponent of the grazing term */
};

/* shape_of - the shape of a model; shape_spread_index - gives each channel the ior and k that all share. */
struct shape shape_of(const struct cook_torrance *model);
void shape_spread_index(struct shape *shape);

/* shape_ndf - the distribution of a shape, with Lambda in the given form where the class has it, else exact.
 * Returns STATUS_DOMAIN where the class does not take the shape, or the form not its gamma.
 * shape_second - the shape of its second lobe. */
MUST_CHECK enum status shape_ndf(const struct shape *shape, const struct ndf_class *class, enum lambda_form lambda,
				 struct ndf *ndf);
struct shape shape_second(const struct shape *shape);

/* The terms of a model: each a fixed number at a sample times a coefficient of each channel. */
enum term {
	TERM_DIFFUSE, /* kd; its coefficient is kd/pi */
	TERM_LOBE,    /* ks, or of FRESNEL_F82 what F0 is the coefficient of */
	TERM_F82,
	TERM_F90,
	TERM_SECOND,
	TERM_GRAZING,
	TERM_COUNT
};

/* struct term_list - those of a fit, the diffuse one and a lobe first; a term that the options leave out has coefficient 0. */
struct term_list {
	int n;
	enum term term[KERNEL_TERMS];
};

/* term_list_of - the terms of a fit. n is 0 where they would be too many: more than KERNEL_TERMS, or more unknowns than
 * BUNDLE_VARIABLES. */
struct term_list term_list_of(const struct fit_options *options);

/* struct linear - the parameters in which it is linear, and how good they are. */
struct linear {
	double kd[MERL_CHANNELS];
	double coefficient[MERL_CHANNELS][KERNEL_TERMS]; /* by the term list's order; [0] is kd/pi */
	double error;                                    /* E */
	double h[MERL_CHANNELS][BUNDLE_SECOND];          /* what the solve has learnt of the second derivatives */
	struct shape shape;                              /* whose they are */
	double channel[MERL_CHANNELS]; /* the part of E that each problem has: a channel, or the first all of them */
	double lower_bound; /* no coefficients of this shape go below it (certified evaluations only; else 0) */
};

/* linear_set_model - gives a model the coefficients. */
void linear_set_model(const struct linear *linear, const struct fit_options *options, struct cook_torrance *model);

/* An error that no fit can have (all coefficients 0 gives 1), finite as nlopt wants it. */
#define OBJECTIVE_NO_FIT 1e3

/* Where channels have an F of their own, the lobe of green and of blue stand behind the terms. */
enum { OBJECTIVE_LOBES = 2, OBJECTIVE_ARRAYS = KERNEL_TERMS + MERL_CHANNELS - 1 };

struct objective {
	const struct sample_set *table;
	const struct fit_options *options;
	const struct ndf_class *class;
	const struct kernel *kernel;
	enum masking_density density;
	int threads; /* more than 1: called by one thread of an OpenMP team, whose others help */
	struct term_list terms;
	struct objective_lobe {
		struct masking masking; /* G1 of the shape */
		double D[MERL_THETA_H];
		struct ndf exact;       /* the shape itself, where is_exact */
		bool given;             /* objective_use() has said which D and G1 */
		struct shape tabulated; /* the shape that masking and D stand for, ior and k aside */
	} lobe[OBJECTIVE_LOBES];
	int n_arrays;                     /* of `term` and `row`: one a term, and those of green and blue */
	struct scattered_lobe *scattered; /* for scattered entries, in their place: one an array */
	struct masking grazing;           /* the grazing term's function of a direction, */
	double grazing_exponent;          /* for this exponent */
	struct cook_torrance optics;      /* F of the shape, and G */
	bool is_exact; /* scattered entries whose terms are had without tables: few, or of tilted facets */
	float *term[OBJECTIVE_ARRAYS];             /* a float a sample; [0] is not used: it is the weight */
	float (*row)[MERL_ROWS];                   /* one an array */
	struct kernel_sums (*sums)[MERL_CHANNELS]; /* one set a block */
	long passes;                               /* over the table, so far */
	struct linear start;                       /* where the next inner solve begins: the last one's end */
	struct objective_box {
		double lo[KERNEL_TERMS], hi[KERNEL_TERMS]; /* of the coefficients */
	} box[MERL_CHANNELS];                              /* as the options have it, but for what is fixed */
};

/* Up to so many scattered entries, a MASKING_FINE objective has the lobe exactly, rounded to float. */
enum { OBJECTIVE_EXACT_SAMPLES = 16384 };

/* objective_init - buffers for one table and one NDF. */
MUST_CHECK enum status objective_init(struct objective *objective, const struct sample_set *table,
				      const struct fit_options *options, const struct ndf_class *class, int threads,
				      enum masking_density density);
void objective_free(struct objective *objective);
/* objective_forget - lets the next inner solve begin from nothing, not where the last one ended;
 * objective_begin - or where that of a shape ended, on this table or a sample of it; error 0: from nothing. */
void objective_forget(struct objective *objective);
void objective_begin(struct objective *objective, const struct linear *linear);

/* objective_upper_bound - the upper end of kd, or of ks: far beyond any material when unbounded. */
double objective_upper_bound(const struct fit_options *options, bool specular);
/* objective_fix - holds kd (or the coefficient of the lobe) of a channel, or of all that share it, at a value from now on;
 * objective_unfix - all are free again. */
void objective_fix(struct objective *objective, int channel, bool specular, double value);
void objective_unfix(struct objective *objective);

/* objective_use - from now on the given isotropic distribution, whatever sigma and gamma a shape has, from tables; *ndf is only
 * read during the call. */
void objective_use(struct objective *objective, const struct ndf *ndf);

/* objective_tabulate - the tables of a shape from which its terms are computed. Returns STATUS_DOMAIN outside the NDF's domain.
 * objective_term_block - array >= 1 of one block of samples, from them. */
MUST_CHECK enum status objective_tabulate(struct objective *objective, const struct shape *shape);
void objective_term_block(const struct objective *objective, int array, int block, float *term);
/* objective_array - the array of a term for one channel. */
int objective_array(const struct objective *objective, int term, int channel);

/* objective_slices - a solve goes over slices: a channel each, or one that stands for all. */
int objective_slices(const struct objective *objective);

/* objective_lobe - the terms of a shape, sample by sample, into objective->term: [1] is the lobe for ks = 1.
 * Returns STATUS_DOMAIN outside the NDF's domain. */
MUST_CHECK enum status objective_lobe(struct objective *objective, const struct shape *shape);

/* objective_eval - minimises E over the coefficients in the box of the options, to `tolerance` (relative to the sum of w m):
 * by Newton's estimate, or certified. Returns E, or OBJECTIVE_NO_FIT outside the NDF's domain. */
double objective_eval(struct objective *objective, const struct shape *shape, double tolerance, bool certify,
		      struct linear *linear);

/* objective_error - E at given coefficients, in one pass; OBJECTIVE_NO_FIT outside the NDF's domain. */
double objective_error(struct objective *objective, const struct shape *shape, const struct linear *linear);

#endif
