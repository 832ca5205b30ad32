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
	const char *name;            /* of ndf.h */
	const char *sigma, *sigma_y; /* roughness; sigma_y: along y, if another */
	const char *angle;           /* azimuth of the first axis, degrees */
	const char *gamma;
	const char *
		params; /* name=value;... for what sigma and gamma do not say: x of t-family; B and C of low, instead of
			     * sigma and gamma; D0 to D90 of pl at the nodes of MERL's theta_h (`bins` node) and at the horizon;
			     * of the ellipsoid tilt_x and tilt_y of ndf_tilt(); or alpha_x, alpha_y (sigma, if not given),
			     * theta_x, theta_y, theta_z (degrees), 0 if not given; or A11 to A33, its matrix by rows */
	const char *lambda; /* form of Lambda; of pl "trapezoid" */
	const char *nodes;  /* pl: a CSV instead of params, nodes.h */
};

/* struct distribution - one with what it needs; freed by distribution_free(). */
struct distribution {
	const char *name;
	struct ndf ndf;
	struct pwl *pwl; /* the table of ndf, if that is pl */
};

/* distribution_make - the NDF that the words describe. STATUS_DOMAIN, with what was expected, when they describe none;
 * STATUS_NO_MEMORY; those of nodes_read(). */
MUST_CHECK enum status distribution_make(const struct distribution_words *words, struct distribution *distribution,
					 struct error *error);
void distribution_free(struct distribution *distribution);

/* struct distribution_cdf - the CDFs of ndf_cdf.h and vndf.h at one normal; NaN where one is not defined. */
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

/* distribution_name_at - the name of NDF i, NULL past the last: for nearest_word(). */
const char *distribution_name_at(const void *data, int i);

#endif
