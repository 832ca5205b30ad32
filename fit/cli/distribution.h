/* SPDX-License-Identifier: GPL-3.0-or-later */
/* distribution - an NDF described by text: on a command line, or in a row of a table. */
#ifndef DISTRIBUTION_H
#define DISTRIBUTION_H

#include "src/ellipsoid.h"
#include "src/pwl.h"
#include "src/sampling.h"
#include "src/smith.h"

/* struct distribution_words - the description; empty or NULL: not given. All borrowed. */
struct distribution_words {
	const char *name;            /* of ndf.h, or "ellipsoid" */
	const char *sigma, *sigma_y; /* roughness; sigma_y: along y, if another */
	const char *gamma;
	const char *
		params; /* name=value;... for what sigma and gamma do not say: x of t-family; B and C of low, instead of
			     * sigma and gamma; D0 to D90 of pl at the nodes of MERL's theta_h (`bins` node) and at the horizon;
			     * alpha_x, alpha_y and theta_x, theta_y, theta_z (degrees, 0 if not given) of the ellipsoid */
	const char *lambda; /* form of Lambda; of pl "trapezoid" */
	const char *nodes;  /* pl: a CSV instead of params, nodes.h */
};

/* struct distribution - one of either kind; freed by distribution_free(). */
struct distribution {
	const char *name;
	bool is_ellipsoid;
	struct ndf ndf;
	struct pwl *pwl; /* the table of ndf, if that is pl */
	struct ellipsoid ellipsoid;
};

/* distribution_make - the NDF that the words describe. STATUS_DOMAIN, with what was expected, when they describe none;
 * STATUS_NO_MEMORY; those of nodes_read(). */
MUST_CHECK enum status distribution_make(const struct distribution_words *words, struct distribution *distribution,
					 struct error *error);
void distribution_free(struct distribution *distribution);

/* The same functions as in ndf.h, ndf_slopes.h, vndf.h and ellipsoid.h. NaN where one is not defined: P2 of
 * pl, and of the ellipsoid, whose Lambda is that of its Smith masking, G1 not bounded. */
double distribution_D(const struct distribution *distribution, struct vec3 m);
double distribution_P22(const struct distribution *distribution, double p, double q);
double distribution_P2(const struct distribution *distribution, double phi, double q);
double distribution_lambda(const struct distribution *distribution, struct vec3 w);
double distribution_G1(const struct distribution *distribution, struct vec3 w);
double distribution_visible_pdf(const struct distribution *distribution, struct vec3 wi, struct vec3 m);
/* distribution_weight - vndf_weight(); of the ellipsoid with G1(wi) G1(wo), whatever gaf. */
double distribution_weight(const struct distribution *distribution, enum gaf gaf, struct vec3 wi, struct vec3 m,
			   double pdf);

/* struct distribution_cdf - the CDFs of ndf_cdf.h and vndf.h at one normal; NaN where one is not defined, as for the
 * ellipsoid. */
struct distribution_cdf {
	double phi, theta, joint;
	double along, across; /* of the slopes seen from wi */
};
/* distribution_cdf - at the normal of theta and phi, degrees. wi.z = NaN: seen from nowhere. */
struct distribution_cdf distribution_cdf(const struct distribution *distribution, struct vec3 wi, double theta,
					 double phi);

/* distribution_moment - of P2 along phi, radians, as ndf_moment(); distribution_kurtosis - its excess kurtosis. NaN where it
 * does not exist. */
double distribution_moment(const struct distribution *distribution, double phi, int order);
double distribution_kurtosis(const struct distribution *distribution);

/* distribution_direction - from where normals are seen, degrees. At 90 it stands for the limit of grazing incidence: so
 * close to the horizon that nothing changes any more. */
struct vec3 distribution_direction(double theta_i, double phi_i);

/* struct distribution_sampler - a way to draw its normals. The distribution has to outlive it. */
struct distribution_sampler {
	const struct distribution *distribution;
	struct sampler sampler; /* unless it is an ellipsoid */
};
/* distribution_sampler_init - STATUS_UNSUPPORTED: it cannot be sampled so; the ellipsoid only as SAMPLING_VISIBLE. */
MUST_CHECK enum status distribution_sampler_init(struct distribution_sampler *sampler,
						 const struct distribution *distribution, enum sampling sampling);
struct vec3 distribution_sample(const struct distribution_sampler *sampler, struct vec3 wi, double u1, double u2);
/* distribution_pdf - the density of distribution_sample(), 1/sr. */
double distribution_pdf(const struct distribution_sampler *sampler, struct vec3 wi, struct vec3 m);

/* distribution_name_at - the name of NDF i, NULL past the last: for nearest_word(). */
const char *distribution_name_at(const void *data, int i);

#endif
