/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fit - from a table of measurements to the parameters of a Cook-Torrance model, and how good they are. */
#ifndef FIT_H
#define FIT_H

#include "data_readers/measurement.h"
#include "src/cook_torrance.h"
#include <stdbool.h>
#ifdef __cplusplus
#include <atomic>
using std::atomic_bool;
#else
#include <stdatomic.h>
#endif

/* How an entry counts in the error E = sum w |m - f| / sum w m. */
enum weight {
	WEIGHT_NONE,        /* 1 */
	WEIGHT_COSINE,      /* cos_i cos_o */
	WEIGHT_SOLID_ANGLE, /* cos_i cos_o times the cell's measure */
	WEIGHT_COUNT
};

const char *weight_name(enum weight weight); /* "none", "cosine", "solid-angle" */
MUST_CHECK enum status weight_find(const char *name, enum weight *weight);

/* Domain of the fit. */
#define FIT_SIGMA_MIN 1e-4
#define FIT_SIGMA_MAX 4.0
#define FIT_GAMMA_MIN 1.5001
#define FIT_GAMMA_MAX 1000.0
#define FIT_IOR_MIN 1.0001
#define FIT_IOR_MAX 100.0
#define FIT_K_MAX 100.0
#define FIT_FACTOR_MAX 1e6 /* kd, ks when unbounded: far beyond any material */

enum { FIT_NDFS_MAX = 16 };

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
	enum gaf gaf;
	enum fresnel fresnel;
	enum lambda_form lambda; /* of STD and its family; the other NDFs have their exact form only */
	enum weight weight;
	enum bins bins;
	double max_theta; /* degrees; entries with theta_i or theta_o above it are dropped; 90 = none */
	bool unbounded;   /* kd, ks in [0, inf) instead of [0, 1] */
	double blend;     /* in (0, 1): kd in [0, 1 - blend], ks in [0, blend], not unbounded; 0 (default): not so */
	bool diffuse;     /* false: kd = 0 */
	bool specular;    /* false: ks = 0, no shape is searched */
	bool gray;        /* one kd and one ks for the three channels */
	double ior, gamma, sigma; /* fixed value, or NaN */
	int starts;               /* extra random starts, which skip the coarsest table; 0 by default */
	uint64_t seed;
	int threads;                       /* threads of one fit; changes no result */
	const struct algorithm *algorithm; /* NULL: the default search; else one of algorithms.h, */
	double time_s;                     /* which ends after this many seconds */
	/* Called whenever a search finds a better shape on the table it is working on, by one thread at a time; NULL: never. */
	void (*trace)(void *trace_data, const struct fit_trace *point);
	void *trace_data;
	/* Set to true from a signal handler or another thread to stop; may be NULL. */
	const atomic_bool *cancel;
};

/* struct fit_options' defaults: STD, GGX and Beckmann, the paper's model and error, all processors. */
struct fit_options fit_options_default(void);

/* struct fit_metrics - how far a model is from the table. */
struct fit_metrics {
	double error[WEIGHT_COUNT]; /* E under each weight */
	double rms_cosine;          /* RMS of c (m - f), c = cos_i cos_o */
	double rms_cube_root;       /* RMS of cbrt(c m) - cbrt(c f) */
	double log_error;           /* mean |ln((c m + 1e-3)/(c f + 1e-3))| */
	size_t samples;             /* table entries (of three channels) compared */
};

enum fit_end {
	FIT_CONVERGED,
	FIT_LIMIT, /* a limit on evaluations or time ended the search */
};

/* Bits of fit_result.at_bound, and their names for the result table. */
enum fit_bound {
	BOUND_SIGMA = 1 << 0,
	BOUND_GAMMA = 1 << 1,
	BOUND_IOR = 1 << 2,
	BOUND_KD_R = 1 << 3,
	BOUND_KD_G = 1 << 4,
	BOUND_KD_B = 1 << 5,
	BOUND_KS_R = 1 << 6,
	BOUND_KS_G = 1 << 7,
	BOUND_KS_B = 1 << 8,
	BOUND_K = 1 << 9,
};

/* A parameter is undetermined when, at every value of its domain, with the other parameters refitted, E is at most
 * (1 + FIT_UNDETERMINED) times that of the fit, or FIT_UNDETERMINED_FLOOR above it: E near 0 is rounding. */
#define FIT_UNDETERMINED 1e-3
#define FIT_UNDETERMINED_FLOOR 1e-6

struct fit_result {
	struct cook_torrance model; /* parameters; n is meaningless for FRESNEL_NONE or without a specular term */
	struct pwl *pwl;            /* pl: the table of model.ndf, owned by the result; else NULL */
	bool diffuse, specular;     /* what the model has, as in the options */
	double error;               /* E under the fit's own weight */
	double lower_bound;         /* certified: no kd, ks of this shape goes below it */
	struct fit_metrics metrics;
	enum fit_end end;
	int starts, starts_agreeing; /* local searches run; those that ended within 0.1 % of the best */
	unsigned at_bound;           /* enum fit_bound */
	/* The free parameters that are undetermined, enum fit_bound: shown at every value that the scan has of them
	 * and at the ends of their domain (of gamma's, 1000), while one where no refit comes near is taken as proof of the
	 * contrary. In a gray fit kd and ks have three bits each, all or none. Of pl: ior and k only, and these only
	 * when E is no higher without a specular term. None when another algorithm than the default one was used. */
	unsigned undetermined;
	long evaluations; /* shapes evaluated, on thinned and full tables together */
	long passes;      /* over the full table, those of kd and ks included */
	double seconds;
};

/* struct fit_context - the geometry of a kind of table under given options, shared by fits, read-only once made. */
struct fit_context;

/* fit_context_new - precomputes what depends on (n_phi_d, bins, weight, max_theta, gaf) only. */
MUST_CHECK enum status fit_context_new(struct fit_context **context, int n_phi_d, const struct fit_options *options);
void fit_context_free(struct fit_context *context);

/* fit_result_free - releases what a result owns; harmless on a zeroed one, and on any but pl's. */
void fit_result_free(struct fit_result *result);

/* fit_run - fits every NDF of the options; results[0 .. options->n_ndf - 1], in the options' order.
 * Richer models never end above the nested ones: GGX's and Beckmann's optima are candidates of STD's. Other algorithms
 * than the default fit each NDF by itself.
 * pl, the piecewise-linear NDF, is fitted to the table itself (free_form.h), from the optima of STD, GGX and Beckmann.
 * On success each result is to be freed with fit_result_free(). Wants 400 kB of stack.
 * Errors: STATUS_NO_DATA (no valid entry, all zero), STATUS_NO_MEMORY, STATUS_INTERRUPTED. */
MUST_CHECK enum status fit_run(const struct fit_context *context, const struct measurement *measurement,
			       const struct fit_options *options, struct fit_result *results, struct error *error);

/* fit_estimate - about the least error that any of the options' NDFs will end with, from samples of the table: within
 * 0.3 % as a rule, for a fraction of fit_run()'s work. INFINITY where one of them has no shape to search.
 * Errors: as fit_run() */
MUST_CHECK enum status fit_estimate(const struct fit_context *context, const struct measurement *measurement,
				    const struct fit_options *options, double *error);

/* fit_eval - the metrics of a given model against a table, no fit. */
MUST_CHECK enum status fit_eval(const struct measurement *measurement, const struct cook_torrance *model,
				const struct fit_options *options, struct fit_metrics *metrics, struct error *error);

#endif
