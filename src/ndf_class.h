/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ndf_class - what one distribution supplies. Private to src/: everybody else goes through ndf.h.
 * To add a distribution: write ndf_<name>.c with one such struct, declare it here, add it to the table in ndf.c. */
#ifndef NDF_CLASS_H
#define NDF_CLASS_H

#include "ndf.h"

struct ndf_class {
	const char *name;
	/* Shape parameter: free in (gamma_min, gamma_max] when has_gamma, else always `gamma`. */
	bool has_gamma;
	double gamma_min, gamma_max;
	double gamma;
	/* Called by ndf_init() after sigma and gamma are set, to fill in what is cached; NULL = nothing. */
	void (*prepare)(struct ndf *ndf);
	/* Called with m.z > 0 and w.z > 0 (or NaN) only. */
	double (*D)(const struct ndf *ndf, struct vec3 m);
	double (*lambda)(const struct ndf *ndf, struct vec3 w);
};

extern const struct ndf_class ndf_class_beckmann;
extern const struct ndf_class ndf_class_ggx;
extern const struct ndf_class ndf_class_std;

#endif
