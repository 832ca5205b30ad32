/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ndf_class - what one distribution supplies. Private to src/: everybody else goes through ndf.h.
 * To add a distribution: write ndf_<name>.c with one such struct, declare it here, add it to the table in ndf.c. */
#ifndef NDF_CLASS_H
#define NDF_CLASS_H

#include "src/ndf.h"

struct ndf_class {
	const char *name;
	/* Named parameters; the second, where there is one, has the domain of gamma. */
	int n_params;
	struct ndf_param param[NDF_PARAMS_MAX];
	double gamma;   /* of a class with no shape */
	bool isotropic; /* sigma_x = sigma_y only */
	/* Slopes p, q with the density P22 = (gamma-1)/(pi a sigma_x sigma_y) (1 + q/a)^-gamma: see student_t.h. */
	bool student_t;
	/* GGX of the same sigma/stretch at gamma = 2. Each class that takes gamma = INFINITY is Beckmann there. */
	bool ggx_at_2;
	/* Where param[] is not sigma, gamma: from sigma and gamma to param[], and back. */
	void (*to_params)(struct ndf *ndf);
	void (*from_params)(struct ndf *ndf);
	/* ndf_tilt() takes it. */
	bool tilts;
	/* Called last, to fill in what is cached. Returns false where the parameters do not go together. NULL =
	 * nothing. */
	bool (*prepare)(struct ndf *ndf);
	/* Called with m.z > 0 and w.z > 0 (or NaN) only. */
	double (*D)(const struct ndf *ndf, struct vec3 m);
	double (*lambda)(const struct ndf *ndf, struct vec3 w);
	/* vndf_area(), for w.z of any sign, where Lambda does not tell it; NULL: it does. */
	double (*area)(const struct ndf *ndf, struct vec3 w);
	/* Density of the slope q where the roughness is s. */
	double (*P2)(const struct ndf *ndf, double s, double q);
	/* In its place where the azimuth, radians from the first axis, matters otherwise than by the roughness. */
	double (*P2_along)(const struct ndf *ndf, double phi, double q);
	/* tan(theta_m) of the share u of normals, in units of sigma; below it lies the share u. NULL for pl. */
	double (*tilt)(const struct ndf *ndf, double u);
	/* Its inverse: the share of normals whose tan(theta_m) is below s, in units of sigma. NULL for pl. */
	double (*share)(const struct ndf *ndf, double s);
};

/* Parameters that many classes have. */
#define NDF_PARAM_SIGMA                                                                                                \
	{                                                                                                              \
		.name = "sigma", .role = NDF_ROLE_SIGMA, .min = NDF_SIGMA_MIN, .max = NDF_SIGMA_MAX,                   \
		.min_included = true, .search_min = 1e-4, .search_max = 4.0                                            \
	}

extern const struct ndf_class ndf_class_beckmann;
extern const struct ndf_class ndf_class_ellipsoid;
extern const struct ndf_class ndf_class_ggx;
extern const struct ndf_class ndf_class_gtr;
extern const struct ndf_class ndf_class_hyper_cauchy;
extern const struct ndf_class ndf_class_low;
extern const struct ndf_class ndf_class_pl;
extern const struct ndf_class ndf_class_std;
extern const struct ndf_class ndf_class_t_family;

#endif
