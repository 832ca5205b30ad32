/* SPDX-License-Identifier: GPL-3.0-or-later */
/* surface - what a sphere is made of: its BRDF, and directions in which light matters to it. */
#ifndef SURFACE_H
#define SURFACE_H

#include "fit/error/masking.h"
#include "fit/render/measured.h"
#include "src/cook_torrance.h"
#include "src/sampling.h"

enum { SURFACE_LOBES = 2 };

struct surface {
	const struct cook_torrance *model; /* borrowed; directions are sampled by its lobes */
	const struct measured *measured;   /* borrowed; what light does, instead of the model. NULL: the model */
	/* The same by a function, 1/sr, which a caller may set after surface_init(), with its context. */
	void (*other)(const void *context, struct vec3 wi, struct vec3 wo, double f[3]);
	const void *context;
	struct surface_lobe {
		const struct ndf *ndf; /* of the model; NULL: it has no such lobe */
		struct sampler sampler;
		bool own;               /* it draws the model's own normals, whose D is at hand */
		bool turns;             /* G1 changes with the azimuth, and is computed; else */
		struct masking masking; /* it is tabulated */
	} lobe[SURFACE_LOBES];
};

/* struct view - what depends on the view direction alone. */
struct view {
	struct vec3 wo;
	struct view_lobe {
		double G1;       /* of the model */
		double G1_exact; /* of the sampler's NDF, if that is the model's own */
		double share;    /* among the sampled directions; the rest is cosine distributed */
	} lobe[SURFACE_LOBES];
};

/* surface_init - where the NDF cannot be sampled so (sampler_init()), visible normals are, or else all.
 * STATUS_NO_MEMORY. What is borrowed must outlive the surface. */
MUST_CHECK enum status surface_init(struct surface *surface, const struct cook_torrance *model,
				    const struct measured *measured, enum sampling sampling);
void surface_free(struct surface *surface);

/* SURFACE_HORIZON - a direction with a smaller cosine counts as below the horizon: that is a millionth of what is
 * above, and f cos_i is bounded. */
#define SURFACE_HORIZON 1e-6

/* surface_view - wo.z >= SURFACE_HORIZON. */
struct view surface_view(const struct surface *surface, struct vec3 wo);
/* surface_f - the BRDF, 1/sr: the model within 1e-7 of cook_torrance_f(). Returns the density with which
 * surface_sample() draws wi, 1/sr. Both are 0 for wi.z < SURFACE_HORIZON. */
double surface_f(const struct surface *surface, const struct view *view, struct vec3 wi, double f[3]);
/* surface_sample - a direction wi from two numbers in [0, 1). False: it lies below the horizon. */
bool surface_sample(const struct surface *surface, const struct view *view, const double u[2], struct vec3 *wi);

#endif
