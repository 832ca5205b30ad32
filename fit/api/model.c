/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/api/api.h"
#include "fit/error/objective.h"
#include "src/energy.h"
#include "src/halfdiff.h"
#include <math.h>
#include <string.h>

/* Beyond these nothing is promised of F, and of the fits' factors. */
#define INDEX_MAX 1e75

struct stdfit_model stdfit_model_default(void)
{
	return (struct stdfit_model){.n = 1.5, .ks = {1, 1, 1}};
}

enum stdfit_status api_index(enum fresnel fresnel, double n, double k, struct stdfit_error *error)
{
	if (fresnel != FRESNEL_NONE && !(n > 0 && n <= INDEX_MAX))
		return api_fail(error, STATUS_DOMAIN, "expected n in (0, %g], found %g", INDEX_MAX, n);
	if (fresnel == FRESNEL_CONDUCTOR && !(k >= 0 && k <= INDEX_MAX))
		return api_fail(error, STATUS_DOMAIN, "expected k in [0, %g], found %g", INDEX_MAX, k);
	return STDFIT_OK;
}

static bool is_within(const double value[3], double most)
{
	return value[0] >= 0 && value[0] <= most && value[1] >= 0 && value[1] <= most && value[2] >= 0 &&
	       value[2] <= most;
}

/* The second lobe of a model, of the class of the first. */
static enum stdfit_status set_second(const struct stdfit_model *model, struct cook_torrance *inner,
				     struct stdfit_error *error)
{
	const struct ndf_class *class = inner->ndf.class;
	const struct shape shape = {.sigma = model->sigma2,
				    .gamma = ndf_has_gamma(class) ? model->gamma2 : inner->ndf.gamma};

	memcpy(inner->ks_second, model->ks2, sizeof inner->ks_second);
	if (!cook_torrance_has_second(inner))
		return STDFIT_OK;
	if (ndf_is_tabulated(class))
		return api_fail(error, STATUS_UNSUPPORTED, "a second lobe needs an NDF with sigma");
	if (!(shape.sigma >= NDF_SIGMA_MIN && shape.sigma <= NDF_SIGMA_MAX) ||
	    shape_ndf(&shape, class, LAMBDA_EXACT, &inner->second) != STATUS_OK)
		return api_fail(error, STATUS_DOMAIN, "%s takes neither sigma2 %g nor gamma2 %g, or one of them not",
				ndf_name(class), model->sigma2, model->gamma2);
	return STDFIT_OK;
}

/* What richer models have. */
static enum stdfit_status set_terms(const struct stdfit_model *model, struct cook_torrance *inner,
				    struct stdfit_error *error)
{
	const bool f82 = inner->fresnel == FRESNEL_F82;

	if (!is_within(model->kg, FIT_FACTOR_MAX) || !is_within(model->ks2, FIT_FACTOR_MAX))
		return api_fail(error, STATUS_DOMAIN, "expected kg and ks2 in [0, %g]", FIT_FACTOR_MAX);
	if (f82 && !(is_within(model->f0, 1) && is_within(model->f82, 1) && is_within(model->f90, 1)))
		return api_fail(error, STATUS_DOMAIN, "expected f0, f82 and f90 in [0, 1]");
	memcpy(inner->kg, model->kg, sizeof inner->kg);
	inner->grazing = model->exponent;
	if (cook_torrance_has_grazing(inner) &&
	    !(model->exponent >= FIT_GRAZING_MIN && model->exponent <= FIT_GRAZING_MAX))
		return api_fail(error, STATUS_DOMAIN, "expected exponent in [%g, %g], found %g", FIT_GRAZING_MIN,
				FIT_GRAZING_MAX, model->exponent);
	for (int c = 0; c < 3 && f82; c++) {
		inner->reflectance[c][0] = model->f0[c];
		inner->reflectance[c][1] = model->f82[c];
		inner->reflectance[c][2] = model->f90[c];
	}
	return set_second(model, inner, error);
}

enum stdfit_status api_model(const struct stdfit_model *model, const struct stdfit_ndf *ndf,
			     struct cook_torrance *inner, struct stdfit_error *error)
{
	const struct ndf *distribution;
	enum stdfit_status status = api_ndf(ndf, &distribution, error);

	if (status != STDFIT_OK)
		return status;
	if (!model)
		return api_fail(error, STATUS_DOMAIN, "model is NULL");
	*inner = (struct cook_torrance){.ndf = *distribution, .n = model->n, .k = model->k};
	status = api_gaf(model->gaf, &inner->gaf, error);
	if (status == STDFIT_OK)
		status = api_model_fresnel(model->fresnel, &inner->fresnel, error);
	if (status == STDFIT_OK)
		status = fresnel_has_ior(inner->fresnel) ? api_index(inner->fresnel, model->n, model->k, error)
							 : STDFIT_OK;
	for (int c = 0; c < 3 && status == STDFIT_OK; c++) {
		inner->kd[c] = model->kd[c];
		inner->ks[c] = model->ks[c];
		if (!(model->kd[c] >= 0 && model->kd[c] <= FIT_FACTOR_MAX && model->ks[c] >= 0 &&
		      model->ks[c] <= FIT_FACTOR_MAX))
			status = api_fail(error, STATUS_DOMAIN, "expected kd and ks in [0, %g], found %g and %g",
					  FIT_FACTOR_MAX, model->kd[c], model->ks[c]);
	}
	return status == STDFIT_OK ? set_terms(model, inner, error) : status;
}

enum stdfit_status api_isotropic(const struct ndf *ndf, struct stdfit_error *error)
{
	if (ndf->sigma_x != ndf->sigma_y)
		return api_fail(error, STATUS_DOMAIN, "expected an isotropic NDF: sigma_x is %g and sigma_y %g",
				ndf->sigma_x, ndf->sigma_y);
	if (ndf_is_anisotropic(ndf))
		return api_fail(error, STATUS_DOMAIN, "expected an isotropic NDF: this %s is not",
				ndf_name(ndf->class));
	return STDFIT_OK;
}

enum stdfit_status stdfit_model_evaluate(const struct stdfit_model *model, const stdfit_ndf *ndf, size_t n,
					 const double *wi, const double *wo, double *f, struct stdfit_error *error)
{
	struct cook_torrance inner;
	enum stdfit_status status = api_model(model, ndf, &inner, error);

	if (status == STDFIT_OK)
		status = api_pairs(n, wi, wo, f, "f", error);
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		cook_torrance_f(&inner, api_vec(wi + 3 * i), api_vec(wo + 3 * i), f + 3 * i);
	return status;
}

enum stdfit_status stdfit_model_albedo(const struct stdfit_model *model, const stdfit_ndf *ndf, double cos_i,
				       double albedo[3], struct stdfit_error *error)
{
	struct cook_torrance inner;
	const enum stdfit_status status = api_model(model, ndf, &inner, error);

	if (status != STDFIT_OK)
		return status;
	if (!albedo || !(cos_i >= 0 && cos_i <= 1))
		return api_fail(error, STATUS_DOMAIN, "expected cos_i in [0, 1] and room for the albedo, found %g",
				cos_i);
	const enum stdfit_status isotropic = api_isotropic(&inner.ndf, error);

	return isotropic == STDFIT_OK ? api_end(error, energy_albedo(&inner, cos_i, albedo), NULL) : isotropic;
}

enum stdfit_status stdfit_model_albedo_max(const struct stdfit_model *model, const stdfit_ndf *ndf, double albedo[3],
					   double *theta_i, struct stdfit_error *error)
{
	struct cook_torrance inner;
	enum stdfit_status status = api_model(model, ndf, &inner, error);

	if (status == STDFIT_OK && (!albedo || !theta_i))
		status = api_fail(error, STATUS_DOMAIN, "albedo or theta_i is NULL");
	if (status == STDFIT_OK)
		status = api_isotropic(&inner.ndf, error);
	return status == STDFIT_OK ? api_end(error, energy_albedo_max(&inner, albedo, theta_i), NULL) : status;
}

enum stdfit_status stdfit_fresnel(const char *fresnel, double cos_d, double n, double k, double *F,
				  struct stdfit_error *error)
{
	enum fresnel form;
	enum stdfit_status status = api_fresnel(fresnel, &form, error);

	if (status == STDFIT_OK)
		status = api_index(form, n, k, error);
	if (status != STDFIT_OK)
		return status;
	if (!F || !(cos_d >= 0 && cos_d <= 1))
		return api_fail(error, STATUS_DOMAIN, "expected cos_d in [0, 1] and room for F, found %g", cos_d);
	*F = fresnel_F(form, cos_d, n, k);
	return STDFIT_OK;
}

enum stdfit_status stdfit_angles_to_directions(size_t n, const double *angles, double *wi, double *wo,
					       struct stdfit_error *error)
{
	if (n > 0 && (!angles || !wi || !wo))
		return api_fail(error, STATUS_DOMAIN, "angles, wi or wo is NULL");
	for (size_t i = 0; i < n; i++) {
		const double *a = angles + 3 * i;

		if (!(a[0] >= 0 && a[0] <= M_PI / 2 && a[1] >= 0 && a[1] <= M_PI / 2 && fabs(a[2]) <= 2 * M_PI))
			return api_fail(
				error, STATUS_DOMAIN,
				"expected theta_h, theta_d in [0, pi/2], phi_d in [-2 pi, 2 pi], found %g, %g, %g",
				a[0], a[1], a[2]);
	}
	for (size_t i = 0; i < n; i++) {
		const double *a = angles + 3 * i;
		struct vec3 to_light, to_viewer;

		halfdiff_to_dirs((struct halfdiff){a[0], a[1], a[2]}, &to_light, &to_viewer);
		api_put(wi + 3 * i, to_light);
		api_put(wo + 3 * i, to_viewer);
	}
	return STDFIT_OK;
}

enum stdfit_status stdfit_angles_from_directions(size_t n, const double *wi, const double *wo, double *angles,
						 struct stdfit_error *error)
{
	const enum stdfit_status status = api_pairs(n, wi, wo, angles, "angles", error);

	for (size_t i = 0; i < n && status == STDFIT_OK; i++) {
		const struct halfdiff a = halfdiff_from_dirs(api_vec(wi + 3 * i), api_vec(wo + 3 * i));

		api_put(angles + 3 * i, (struct vec3){a.theta_h, a.theta_d, a.phi_d});
	}
	return status;
}
