/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ndf.h"
#include "ndf_class.h"
#include <string.h>

static const struct ndf_class *const classes[] = {
	&ndf_class_std,
	&ndf_class_ggx,
	&ndf_class_beckmann,
};

enum { CLASSES = sizeof(classes) / sizeof(classes[0]) };

const struct ndf_class *ndf_at(int index)
{
	return index >= 0 && index < CLASSES ? classes[index] : NULL;
}

const struct ndf_class *ndf_find(const char *name)
{
	for (int i = 0; name && i < CLASSES; i++) {
		if (strcmp(classes[i]->name, name) == 0)
			return classes[i];
	}
	return NULL;
}

const char *ndf_name(const struct ndf_class *class)
{
	return class->name;
}

bool ndf_has_gamma(const struct ndf_class *class)
{
	return class->has_gamma;
}

static bool sigma_valid(double sigma)
{
	return sigma >= NDF_SIGMA_MIN && sigma <= NDF_SIGMA_MAX;
}

static bool gamma_valid(const struct ndf_class *class, double gamma)
{
	return !class->has_gamma || (gamma > class->gamma_min && gamma <= class->gamma_max);
}

enum status ndf_init(struct ndf *ndf, const struct ndf_class *class, double sigma_x, double sigma_y, double gamma)
{
	if (!class || !sigma_valid(sigma_x) || !sigma_valid(sigma_y) || !gamma_valid(class, gamma))
		return STATUS_DOMAIN;
	*ndf = (struct ndf){
		.class = class,
		.sigma_x = sigma_x,
		.sigma_y = sigma_y,
		.gamma = class->has_gamma ? gamma : class->gamma,
	};
	if (class->prepare)
		class->prepare(ndf);
	return STATUS_OK;
}

double ndf_D(const struct ndf *ndf, struct vec3 m)
{
	return m.z <= 0.0 ? 0.0 : ndf->class->D(ndf, m);
}

double ndf_lambda(const struct ndf *ndf, struct vec3 w)
{
	return w.z <= 0.0 ? INFINITY : ndf->class->lambda(ndf, w);
}

double ndf_G1(const struct ndf *ndf, struct vec3 w)
{
	return 1.0 / (1.0 + ndf_lambda(ndf, w));
}
