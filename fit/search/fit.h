/* SPDX-License-Identifier: GPL-3.0-or-later */
/* fit - from a table of measurements to the parameters of a Cook-Torrance model, and how good they are. */
#ifndef FIT_H
#define FIT_H

#include "fit/error/metrics.h"
#include "fit/search/interval.h"

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
	BOUND_ANGLE = 1 << 10,
	BOUND_GRAZING = 1 << 11,
	BOUND_SECOND_SIGMA = 1 << 12,
	BOUND_SECOND_GAMMA = 1 << 13,
	/* Of options->per_channel_ior, in place of BOUND_IOR and BOUND_K */
	BOUND_IOR_R = 1 << 14,
	BOUND_IOR_G = 1 << 15,
	BOUND_IOR_B = 1 << 16,
	BOUND_K_R = 1 << 17,
	BOUND_K_G = 1 << 18,
	BOUND_K_B = 1 << 19,
};

/* A parameter is undetermined when, at every value of its domain, with the other parameters refitted, E is at most
 * (1 + FIT_UNDETERMINED) times that of the fit, or FIT_UNDETERMINED_FLOOR above it: E near 0 is rounding. */
#define FIT_UNDETERMINED 1e-3
#define FIT_UNDETERMINED_FLOOR 1e-6

struct multiresolution;

struct fit_result {
	struct cook_torrance model; /* parameters; n is meaningless for FRESNEL_NONE or without a specular term */
	struct pwl *pwl;            /* pl: the table of model.ndf, owned by the result; else NULL */
	bool diffuse, specular;     /* what the model has, as in the options */
	double error;               /* E under the fit's own weight */
	double error_correlated; /* of fit_run()'s best: E with correlated G is below this, much below `error`; else NaN */
	double error_isotropic; /* of an anisotropic fit: E of the isotropic one, which is never below; else NaN */
	double lower_bound;     /* certified: no kd, ks of this shape goes below it */
	struct fit_metrics metrics;
	enum fit_end end;
	int starts, starts_agreeing; /* local searches run; those that ended within 0.1 % of the best */
	unsigned at_bound;           /* enum fit_bound */
	/* The free parameters that are undetermined, enum fit_bound: shown at every value that the scan has of them
	 * and at the ends of their domain (of gamma's, 1000), while one where no refit comes near is taken as proof of the
	 * contrary. In a gray fit kd and ks have three bits each, all or none. Of pl: ior and k only, and these only
	 * when E is no higher without a specular term. None when another algorithm than the default one was used. */
	unsigned undetermined;
	struct interval_list interval[INTERVAL_PARAMETERS]; /* fit_intervals()'s; of fit_run() none */
	const struct fit_result *other_bins; /* the same fit with the other bins, the caller's; of fit_run() NULL */
	long evaluations;                    /* shapes evaluated, on thinned and full tables together */
	long passes;                         /* over the full table, those of kd and ks included */
	double seconds;
};

/* struct fit_context - the geometry of a kind of measurement under a criterion, shared by fits, read-only once made. It
 * owns what it was made for: n_phi_d and the criterion. */
struct fit_context;

/* fit_context_new - precomputes what depends on n_phi_d (0: scattered entries) and options->criterion only.
 * Errors: STATUS_DOMAIN (n_phi_d neither 0, 180 nor 360, or fit_criterion_check() refuses the options), STATUS_NO_MEMORY. */
MUST_CHECK enum status fit_context_new(struct fit_context **context, int n_phi_d, const struct fit_options *options);
void fit_context_free(struct fit_context *context);

/* fit_result_free - releases what a result owns; harmless on a zeroed one, and on any but pl's. */
void fit_result_free(struct fit_result *result);

/* fit_run - fits every NDF of the options; results[0 .. options->n_ndf - 1], in the options' order.
 * Anisotropic options: each NDF is fitted isotropic first, then with axes from there; *results has the second. A sigma and sigma_y
 * that are fixed leave nothing isotropic to fit. The angle is undetermined where the isotropic fit is as good.
 * Richer models never end above the nested ones: GGX's and Beckmann's optima are candidates of STD's. Other algorithms
 * than the default fit each NDF by itself.
 * pl, the piecewise-linear NDF, is fitted to the table itself (free_form.h), from the optima of STD, GGX and Beckmann.
 * On success each result is to be freed with fit_result_free(). 256 kB of stack are
 * enough for the caller; OpenMP gives its own threads theirs (OMP_STACKSIZE).
 * Errors: STATUS_DOMAIN (fit_options_check(), or the context was made for another n_phi_d or criterion; anisotropic
 * options and a table, which tells nothing of the azimuth of h), STATUS_NO_DATA (no valid entry, all
 * zero), STATUS_NO_MEMORY, STATUS_INTERRUPTED. */
MUST_CHECK enum status fit_run(const struct fit_context *context, const struct measurement *measurement,
			       const struct fit_options *options, struct fit_result *results, struct error *error);

/* fit_intervals - how certain the shapes of fit_run()'s results are: results[n].interval of each of the options'
 * NDFs, see interval_find(); percent > 0. Evaluations and seconds are added to those of the results. pl's stay
 * empty.
 * Errors: as fit_run() */
MUST_CHECK enum status fit_intervals(const struct fit_context *context, const struct measurement *measurement,
				     const struct fit_options *options, double percent, struct fit_result *results,
				     struct error *error);

/* fit_estimate - about the least error that any of the options' NDFs will end with, from samples of the table: within
 * 0.3 % as a rule, for a fraction of fit_run()'s work. INFINITY where one of them has no shape to search, or after an error.
 * Errors: as fit_run() */
MUST_CHECK enum status fit_estimate(const struct fit_context *context, const struct measurement *measurement,
				    const struct fit_options *options, double *estimate, struct error *error);

/* fit_samples_of - the measurement and samples of it, as the search sees them; to be freed with multiresolution_free(). Options with an algorithm have the measurement alone.
 * Errors: as fit_run() */
MUST_CHECK enum status fit_samples_of(const struct fit_context *context, const struct measurement *measurement,
				      const struct fit_options *options, struct multiresolution *multiresolution,
				      struct error *error);

/* fit_eval - the metrics of a given model against a measurement, no fit; an anisotropic one wants scattered entries. Of the options only criterion (but its gaf, which is the
 * model's) and threads are read, and checked. Errors as of fit_run(). */
MUST_CHECK enum status fit_eval(const struct measurement *measurement, const struct cook_torrance *model,
				const struct fit_options *options, struct fit_metrics *metrics, struct error *error);

#endif
