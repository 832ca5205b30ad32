/* SPDX-License-Identifier: GPL-3.0-or-later */
/* pwl - the piecewise-linear NDF, isotropic and anisotropic [Ribardiere et al. 2019, supplemental material].
 *
 * Dx(theta) and Dy(theta) are linear in theta between nodes 0 = theta_0 < ... < theta_n = pi/2, each normalised as an
 * isotropic distribution. Between the two axes they are blended so that the value at the normal is common:
 *     D(m) = (cos^2 phi Dy(0) Dx(theta) + sin^2 phi Dx(0) Dy(theta)) / c,   c = (Dx(0) + Dy(0))/2          [Eq. 1, 3]
 *     D(m) = cos^2 phi Dx(theta) + sin^2 phi Dy(theta)                      if Dx(0) = Dy(0) = 0
 * Where only Dx(0) = 0 the first line is 2 cos^2 phi Dx(theta): Dy plays no part; and the other way round. */
#ifndef PWL_H
#define PWL_H

#include "src/ndf.h"

enum { PWL_NODES_MAX = 1 << 20 };

/* One table of Gauss-Legendre nodes: cot(theta), and sin^2(theta) times (Fx + Fy) and (Fx - Fy)/3 times the weight. */
struct pwl_point {
	double cot, sum, difference;
};

/* A node and the segment above it, the factors Dy(0)/c and Dx(0)/c included in Fx and Fy. */
struct pwl_node {
	double theta;
	double Fx, Fy;           /* at the node */
	double slope_x, slope_y; /* per radian */
	double mass_x, mass_y;   /* 2 pi int F cos sin from 0 to the node: T of the paper */
	double sine2_x, sine2_y; /* int F sin^2 from 0 to the node: A of the paper */
};

/* struct pwl - one distribution; made by pwl_init() or pwl_from_*(), then only read, freed by pwl_free(). */
struct pwl {
	int n_nodes;
	struct pwl_node *nodes;
	bool anisotropic;         /* Dx and Dy differ somewhere */
	double blend;             /* (Dy(0) - Dx(0))/(Dy(0) + Dx(0)), of the CDF of phi */
	int n_cells;              /* segments, the longer ones divided, for quadrature */
	double *cells;            /* n_cells + 1 bounds */
	int *cell_node;           /* node at or below each cell */
	struct pwl_point *fine;   /* 8 points a cell */
	struct pwl_point *coarse; /* 4 points a cell */
};

/* pwl_init - from values at nodes.
 * Given:   n_nodes >= 2; theta[n_nodes] in radians, increasing strictly from 0 to pi/2 (to 1e-12);
 *          Dx[n_nodes], Dy[n_nodes] >= 0 in any unit: each is normalised here; Dy NULL = isotropic
 * Returns: STATUS_OK; STATUS_DOMAIN: any of that does not hold, NaN, infinity, or a table of zeros;
 *          STATUS_NO_MEMORY. On failure *pwl holds nothing. */
MUST_CHECK enum status pwl_init(struct pwl *pwl, int n_nodes, const double *theta, const double *Dx, const double *Dy);

/* pwl_from_function - from D(m) at the nodes, along phi = 0 (Dx) and phi = 90 deg (Dy). At the horizon m is exactly
 * horizontal; a value that is not finite there is replaced by the one at the node before. Status as pwl_init(). */
MUST_CHECK enum status pwl_from_function(struct pwl *pwl, int n_nodes, const double *theta,
					 double (*D)(struct vec3 m, const void *context), const void *context);

/* pwl_from_ndf - from another distribution; its limit at the horizon is taken where finite. Status as pwl_init(). */
MUST_CHECK enum status pwl_from_ndf(struct pwl *pwl, int n_nodes, const double *theta, const struct ndf *ndf);

/* pwl_free - frees what *pwl holds and leaves it empty; an empty one is left alone. */
void pwl_free(struct pwl *pwl);

/* pwl_D - density of microfacet normals, 1/sr; the integral of D cos is 1. 0 below the horizon, the last node's value
 * at m.z = 0; NaN in gives NaN out. */
double pwl_D(const struct pwl *pwl, struct vec3 m);

/* pwl_lambda - Smith's Lambda(o) = (int max(0, o.m) D dm)/cos(theta_o) - 1.
 * The facets turned away from o are integrated instead, all terms positive: with cos b = cot(theta_o) cot(theta),
 *     Lambda = tan(theta_o) int_E^{pi/2} sin^2(theta) ((Fx + Fy)(sin b - b cos b) + (Fx - Fy) cos(2 phi_o) sin^3(b)/3),
 * E = pi/2 - theta_o, Fx = Dx Dy(0)/c, Fy = Dy Dx(0)/c, by Gauss-Legendre rules on cells, those near E in a variable
 * in which the integrand has no square root.
 * Returns: Lambda >= 0, relative error 1e-12, from theta_o of 89.5 degrees on 5e-11; 0 at normal incidence, INFINITY for o.z <= 0; NaN in gives NaN out. */
double pwl_lambda(const struct pwl *pwl, struct vec3 o);

/* pwl_G1 - 1/(1 + Lambda(o)), in [0, 1]. Both directions together: G as in smith.h from Lambda or G1. */
double pwl_G1(const struct pwl *pwl, struct vec3 o);

/* pwl_G1_trapezoid - the same by the paper's own evaluation: closed parts and one trapezoid per segment [Eq. 28, with
 * its corrections]. Error O(h^2): 5e-4 for Beckmann and 30 segments, up to 3e-3 for 12 wild ones; may exceed 1. */
double pwl_G1_trapezoid(const struct pwl *pwl, struct vec3 o);

/* pwl_sample - a normal with density D(m) m.z per solid angle: phi, then theta given phi, by inversion of their CDFs.
 * Given:   u1, u2 in [0, 1), ends included
 * Returns: a unit vector with m.z >= 0. Each CDF differs from its number by at most 1e-14. */
struct vec3 pwl_sample(const struct pwl *pwl, double u1, double u2);

/* pwl_cdf_phi, pwl_cdf_theta - what pwl_sample() inverts: the CDF of phi in [0, 2 pi] [Eq. 7], and of theta in
 * [0, pi/2] given phi [Eq. 9 over its value at pi/2]. */
double pwl_cdf_phi(const struct pwl *pwl, double phi);
double pwl_cdf_theta(const struct pwl *pwl, double theta, double phi);

#endif
