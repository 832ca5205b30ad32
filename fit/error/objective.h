/* SPDX-License-Identifier: GPL-3.0-or-later */
/* objective - the error of a shape: the best that any kd and ks make of it on a table. */
#ifndef OBJECTIVE_H
#define OBJECTIVE_H

#include "fit/error/l1.h"
#include "fit/error/masking.h"
#include "fit/error/sample_set.h"
#include "fit/error/scattered_lobe.h"

/* struct shape - what a fit searches: the parameters in which the model is not linear. */
struct shape {
	double sigma, gamma, ior, k; /* sigma: sqrt(sigma_x sigma_y) where they differ */
	double stretch;              /* ln(sigma_x/sigma_y); 0: isotropic */
	double angle;                /* of the axis of sigma_x, degrees */
};

/* shape_of - the shape of a model. */
struct shape shape_of(const struct cook_torrance *model);

/* shape_ndf - the distribution of a shape, with Lambda in the given form where the class has it, else exact.
 * Returns STATUS_DOMAIN where the class does not take the shape, or the form not its gamma. */
MUST_CHECK enum status shape_ndf(const struct shape *shape, const struct ndf_class *class, enum lambda_form lambda,
				 struct ndf *ndf);

/* struct linear - the parameters in which it is, and how good they are. */
struct linear {
	double kd[MERL_CHANNELS], ks[MERL_CHANNELS];
	double error;                  /* E */
	double h[MERL_CHANNELS][3];    /* what the solve has learnt of the second derivatives by (kd/pi, ks) */
	struct shape shape;            /* whose they are */
	double channel[MERL_CHANNELS]; /* the part of E that each has; of a gray fit the first stands for all */
	double lower_bound;            /* no kd, ks of this shape goes below it (certified evaluations only; else 0) */
};

/* An error that no fit can have (kd = ks = 0 gives 1), finite as nlopt wants it. */
#define OBJECTIVE_NO_FIT 1e3

struct objective {
	const struct sample_set *table;
	const struct fit_options *options;
	const struct ndf_class *class;
	const struct kernel *kernel;
	int threads;                     /* more than 1: called by one thread of an OpenMP team, whose others help */
	struct masking masking;          /* G1 of the shape */
	struct scattered_lobe scattered; /* in its place for scattered entries */
	struct cook_torrance exact;      /* the shape itself, where is_exact */
	bool is_exact;                   /* scattered entries, few enough to have the lobe at each without tables */
	float *s;                        /* the lobe, a float a sample */
	struct kernel_sums (*sums)[MERL_CHANNELS]; /* one set a block */
	double D[MERL_THETA_H];
	float row[MERL_ROWS];
	bool given;             /* objective_use() has said which D and G1 */
	struct shape tabulated; /* the shape that masking and D stand for, ior and k aside */
	long passes;            /* over the table, so far */
	struct linear start;    /* where the next inner solve begins: the last one's end */
	struct objective_box {
		double lo[2], hi[2]; /* of kd/pi and ks */
	} box[MERL_CHANNELS];        /* as the options have it, but for what is fixed */
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
/* objective_fix - holds kd (or ks) of a channel, of all of them in a gray fit, at a value from now on;
 * objective_unfix - all are free again. */
void objective_fix(struct objective *objective, int channel, bool specular, double value);
void objective_unfix(struct objective *objective);

/* objective_use - from now on the given isotropic distribution, whatever sigma and gamma a shape has, from tables; *ndf is only
 * read during the call. */
void objective_use(struct objective *objective, const struct ndf *ndf);

/* objective_lobe - the specular term of a shape for ks = 1, sample by sample, into objective->s.
 * Returns STATUS_DOMAIN outside the NDF's domain. */
MUST_CHECK enum status objective_lobe(struct objective *objective, const struct shape *shape);

/* objective_eval - minimises E over kd and ks in the box of the options, to `tolerance` (relative to the sum of w m):
 * by Newton's estimate, or certified. Returns E, or OBJECTIVE_NO_FIT outside the NDF's domain. */
double objective_eval(struct objective *objective, const struct shape *shape, double tolerance, bool certify,
		      struct linear *linear);

/* objective_error - E at given kd and ks, in one pass; OBJECTIVE_NO_FIT outside the NDF's domain. */
double objective_error(struct objective *objective, const struct shape *shape, const double kd[], const double ks[]);

#endif
