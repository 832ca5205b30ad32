/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rgl_write - makes files of the format of rgl.h, isotropic and anisotropic, with all fields that renderers ask for.
 *
 * Half vectors are warped in x alone, where theta_m = pi/2 x^2, by one density for all wi: the mean over the azimuths.
 * Azimuths stand evenly. Of an anisotropic file values are divided by the density itself, which leaves little that is
 * sharp. */
#ifndef RGL_WRITE_H
#define RGL_WRITE_H

#include "data_readers/merl.h"
#include "src/vec3.h"

/* struct rgl_layout - what a file is made of. */
struct rgl_layout {
	const char *description;
	bool spectra;   /* spectra and wavelengths, whose colour under D65 is that of f_cos; else rgb, linear sRGB */
	size_t n_phi;   /* 1: isotropic; else phi_i, from -180 to 0 or to 180 degrees, at least 3 */
	bool half;      /* to 0: what is written equals itself turned by 180 degrees */
	size_t n_theta; /* theta_i, from 0 to 89.9 degrees; at least 2 */
	size_t n_nodes; /* along each side of the warped square; at least 2 */
	int threads;
	/* The density of half vectors that makes the warp, and by which values are divided, per solid angle up to a
	 * factor; above 0. Of an isotropic file m.y is 0. */
	double (*density)(const void *context, struct vec3 m);
	/* The BRDF times cos_o at a half vector m of wi; wo may be below the horizon, where values are used for
	 * interpolation alone. */
	void (*f_cos)(const void *context, struct vec3 wi, struct vec3 m, double f_cos[MERL_CHANNELS]);
	const void *context;
};

/* rgl_layout_size - about how many bytes a file has. */
size_t rgl_layout_size(const struct rgl_layout *layout);

/* rgl_encode - the bytes of the file, newly allocated. STATUS_NO_MEMORY, STATUS_DOMAIN (a value is not finite). */
MUST_CHECK enum status rgl_encode(const struct rgl_layout *layout, unsigned char **bytes, size_t *size);

#endif
