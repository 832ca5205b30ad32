/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/vndf.h"
#include <stddef.h>

double vndf_weight(const struct ndf *ndf, enum gaf gaf, struct vec3 wi, struct vec3 m, double pdf)
{
	const double cos_d = vec3_dot(wi, m);
	const struct vec3 wo = vec3_sub(vec3_scale(m, 2.0 * cos_d), wi);
	if (!(cos_d > 0.0 && wo.z > 0.0))
		return 0.0;
	return gaf_G(gaf, ndf, wi, wo) * ndf_D(ndf, m) / pdf * cos_d / wi.z;
}

/* The class whose visible normals stand in, by name; NULL = none does. */
static const char *substitute(double sigma, double gamma)
{
	if (sigma <= 0.01)
		return NULL;
	if (gamma > 10.0)
		return "beckmann";
	const double ggx_up_to = fmin(5.0, 2.0 + sigma / 0.1);
	const double beckmann_from = fmax(5.0, 10.0 - 5.0 * fmax(0.0, sigma - 0.2) / 0.1);
	if (gamma <= ggx_up_to)
		return "ggx";
	return gamma >= beckmann_from ? "beckmann" : NULL;
}

enum status vndf_pseudo_init(struct vndf_pseudo *pseudo, const struct ndf *ndf)
{
	if (!vndf_supports(ndf))
		return STATUS_DOMAIN;
	if (ndf_is_tilted(ndf))
		return STATUS_DOMAIN;
	const double sigma_x = ndf->sigma_x / ndf->stretch, sigma_y = ndf->sigma_y / ndf->stretch; /* of std */
	const char *name = substitute(sqrt(sigma_x * sigma_y), ndf->gamma);
	*pseudo = (struct vndf_pseudo){*ndf, name != NULL};
	if (!name)
		return STATUS_OK;
	const enum status status = ndf_init(&pseudo->proposal, ndf_find(name), sigma_x, sigma_y, NAN);
	return status == STATUS_OK ? ndf_turn(&pseudo->proposal, ndf->angle) : status;
}

struct vec3 vndf_pseudo_sample(const struct vndf_pseudo *pseudo, struct vec3 wi, double u1, double u2)
{
	return pseudo->visible ? vndf_sample(&pseudo->proposal, wi, u1, u2) : ndf_sample(&pseudo->proposal, u1, u2);
}

double vndf_pseudo_pdf(const struct vndf_pseudo *pseudo, struct vec3 wi, struct vec3 m)
{
	return pseudo->visible ? vndf_pdf(&pseudo->proposal, wi, m) : ndf_pdf(&pseudo->proposal, m);
}
