/* SPDX-License-Identifier: GPL-3.0-or-later */
/* options - what a fit is asked for: how its error is defined, which models it may use, and how it reports. Beneath all
 * that reads them: the error, the search, and what comes after. */
#ifndef FIT_OPTIONS_H
#define FIT_OPTIONS_H

#include "data_readers/measurement.h"
#include "src/cook_torrance.h"
#include <stdatomic.h>
#include <stdbool.h>

/* How an entry counts in the error E = sum w |m - f| / sum w m. */
enum weight {
	WEIGHT_NONE,        /* 1 */
	WEIGHT_COSINE,      /* cos_i cos_o */
	WEIGHT_SOLID_ANGLE, /* cos_i cos_o times the cell's measure */
	WEIGHT_COUNT
};

const char *weight_name(enum weight weight); /* "none", "cosine", "solid-angle" */
/* weight_find - the reverse; STATUS_DOMAIN, *weight untouched, for another name. */
MUST_CHECK enum status weight_find(const char *name, enum weight *weight);

/* struct criterion - which entries of a measurement a model is compared with, and how they count. Together with n_phi_d
 * it is all that the geometry of a fit depends on. */
struct criterion {
	enum gaf gaf; /* of the model: that of V-grooves is a factor of the geometry */
	enum weight weight;
	enum bins bins;
	double max_theta;     /* degrees, (0, 90]; entries with theta_i or theta_o above it are dropped; 90 = none */
	bool zero_is_missing; /* entries that are 0 in all channels count as not measured */
};

/* criterion_equal - whether two are the same in every field. */
static inline bool criterion_equal(const struct criterion *a, const struct criterion *b)
{
	return a->gaf == b->gaf && a->weight == b->weight && a->bins == b->bins && a->max_theta == b->max_theta &&
	       a->zero_is_missing == b->zero_is_missing;
}

/* Domain of the fit. */
#define FIT_SIGMA_MIN 1e-4
#define FIT_SIGMA_MAX 4.0
#define FIT_RATIO_MAX 50.0 /* of sigma_x and sigma_y */
#define FIT_TILT_MAX 1.5
#define FIT_GAMMA_MIN 1.5001
#define FIT_GAMMA_MAX 1000.0
#define FIT_IOR_MIN 1.0001
#define FIT_IOR_MAX 100.0
#define FIT_CONDUCTOR_IOR_MIN 0.01 /* a conductor's n may be below 1 */
#define FIT_K_MAX 100.0
#define FIT_GRAZING_MIN 1.0 /* exponent of the grazing term */
#define FIT_GRAZING_MAX 20.0
#define FIT_FACTOR_MAX 1e6 /* kd, ks when unbounded: far beyond any material */

enum { FIT_NDFS_MAX = 16, FIT_THREADS_MAX = 1024 };

struct algorithm;

/* struct fit_trace - a step of a search. */
struct fit_trace {
	const struct ndf_class *ndf;
	const char *stage;           /* "scan", "thin-1" .. "thin-3" (ever larger samples of the table), "full" */
	double sigma, gamma, ior, k; /* the shape; NaN where the model has none */
	double error;                /* E on the stage's table: on a thinned one an estimate */
	long evaluations;            /* shapes evaluated so far in searching for this NDF */
	double seconds;              /* spent on that */
};

/* struct fit_options - everything that changes a result; see fit_options_default(). NaN = free. */
struct fit_options {
	const struct ndf_class *ndf[FIT_NDFS_MAX]; /* the NDFs to fit, in this order */
	int n_ndf;
	struct criterion criterion;
	enum fresnel fresnel;
	enum lambda_form lambda; /* of STD and its family; the other NDFs have their exact form only */
	bool unbounded;          /* kd, ks in [0, inf) instead of [0, 1] */
	double blend;       /* in (0, 1): kd in [0, 1 - blend], ks in [0, blend], not unbounded; 0 (default): not so */
	bool diffuse;       /* false: kd = 0 */
	bool specular;      /* false: ks = 0, no shape is searched */
	bool gray;          /* one kd and one ks for the three channels */
	bool gray_specular; /* one ks (and what else is specular) for the three channels, but three kd; not with gray */
	int lobes;          /* 1, or 2: a second lobe of the same NDF, with a sigma and gamma of its own */
	bool grazing;       /* a diffuse term of grazing directions beside Lambert's, see cook_torrance_grazing(); */
	double grazing_exponent;  /* its exponent, or NaN */
	double ior, gamma, sigma; /* fixed value, or NaN */
	bool per_channel_ior;     /* FRESNEL_CONDUCTOR: an n and k for each channel; ior is NaN then */
	bool anisotropic;         /* sigma_x and sigma_y may differ; the isotropic fit is made beside it */
	double sigma_y;           /* anisotropic: fixed with sigma, which is sigma_x then, or NaN */
	double angle;             /* anisotropic: fixed azimuth of the axis of sigma_x, degrees, or NaN */
	int starts;               /* extra random starts, which skip the coarsest table; 0 by default */
	uint64_t seed;
	int threads;                       /* threads of one fit; changes no result */
	const struct algorithm *algorithm; /* NULL: the default search; else one of algorithms.h, */
	double time_s;                     /* which ends after this many seconds */
	/* Called whenever a search finds a better shape on the table it is working on, by one thread at a time; NULL: never. */
	void (*trace)(void *trace_data, const struct fit_trace *point);
	void *trace_data;
	/* Set to true, or to other than 0, from a signal handler or another thread to stop; may be NULL. The second is for
	 * callers who know no C11 atomics. */
	const atomic_bool *cancel;
	const volatile int *stop;
};

/* fit_cancelled - whether the fit is to stop. */
static inline bool fit_cancelled(const struct fit_options *options)
{
	return (options->cancel && atomic_load_explicit(options->cancel, memory_order_relaxed)) ||
	       (options->stop && __atomic_load_n(options->stop, __ATOMIC_RELAXED));
}

/* fit_ior_min - the least n that a fit with this Fresnel term takes. */
static inline double fit_ior_min(enum fresnel fresnel)
{
	return fresnel == FRESNEL_CONDUCTOR ? FIT_CONDUCTOR_IOR_MIN : FIT_IOR_MIN;
}

/* struct fit_options' defaults: STD, GGX and Beckmann, the paper's model and error, as many threads as OpenMP
 * would take, FIT_THREADS_MAX at most. */
struct fit_options fit_options_default(void);

#endif
