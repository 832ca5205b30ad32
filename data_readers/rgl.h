/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rgl - reads `.bsdf` files of the RGL material database, isotropic and anisotropic, RGB and spectral [Dupuy and Jakob
 * 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering"].
 *
 * A file gives, for each of its directions wi, f cos_o over the unit square, divided by D/(4 sigma). The square is
 * warped to half vectors by the density of visible normals of a distribution D that was measured by retroreflection. */
#ifndef RGL_H
#define RGL_H

#include "data_readers/measurement.h"
#include "data_readers/quantity.h"

/* rgl_read - one scattered entry per node of the file that lies above the horizon and was measured; its solid angle is
 * that of its cell. Spectra become RGB as spectrum.h has it; a negative value is out of gamut, and `gamut` says what
 * becomes of it. The measurement keeps an interpolant, measurement->rgl. Errors as measurement_read(). */
MUST_CHECK enum status rgl_read(const char *path, enum gamut gamut, struct measurement *measurement,
				struct error *error);

/* rgl_parse - the fields of a file in memory, without entries: *rgl, for rgl_f(), is to be freed. STATUS_FORMAT with a
 * text that does not name the file; STATUS_NO_MEMORY. */
MUST_CHECK enum status rgl_parse(const unsigned char *bytes, size_t size, struct rgl **rgl, struct error *why);

/* rgl_f - the BRDF, 1/sr, between the nodes as the database's own evaluator has it; a channel that is out of gamut is
 * negative. Given: unit vectors. Returns: false, f untouched, where a direction is at or below the horizon. */
bool rgl_f(const struct rgl *rgl, struct vec3 wi, struct vec3 wo, double f[MERL_CHANNELS]);

void rgl_free(struct rgl *rgl);

#endif
