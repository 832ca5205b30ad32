/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/options.h"
#include "src/names.h"
#include <omp.h>

static const char *const weight_names[WEIGHT_COUNT] = {
	[WEIGHT_NONE] = "none", [WEIGHT_COSINE] = "cosine", [WEIGHT_SOLID_ANGLE] = "solid-angle"};

const char *weight_name(enum weight weight)
{
	return names_at(weight_names, WEIGHT_COUNT, (int)weight);
}

enum status weight_find(const char *name, enum weight *weight)
{
	const int found = names_find(weight_names, WEIGHT_COUNT, name);

	if (found < 0)
		return STATUS_DOMAIN;
	*weight = (enum weight)found;
	return STATUS_OK;
}

struct fit_options fit_options_default(void)
{
	struct fit_options o = {
		.criterion = {.gaf = GAF_UNCORRELATED, .weight = WEIGHT_NONE, .bins = BINS_NODE, .max_theta = 90},
		.fresnel = FRESNEL_DIELECTRIC,
		.diffuse = true,
		.specular = true,
		.lobes = 1,
		.grazing_exponent = NAN,
		.ior = NAN,
		.gamma = NAN,
		.sigma = NAN,
		.sigma_y = NAN,
		.angle = NAN,
		.threads = omp_get_max_threads() < FIT_THREADS_MAX ? omp_get_max_threads() : FIT_THREADS_MAX,
		.time_s = 10};
	static const char *const names[] = {"std", "ggx", "beckmann"};

	for (int n = 0; n < 3; n++)
		o.ndf[o.n_ndf++] = ndf_find(names[n]);
	return o;
}
