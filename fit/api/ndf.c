/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/api/api.h"
#include "src/ellipsoid.h"
#include "src/energy.h"
#include "src/ndf_class.h"
#include "src/ndf_slopes.h"
#include "src/vndf.h"
#include <math.h>
#include <stdlib.h>

/* An NDF to be filled in by the caller, freed and NULL again if that fails. */
static enum stdfit_status allocate(stdfit_ndf **ndf, struct stdfit_error *error)
{
	if (!ndf)
		return api_fail(error, STATUS_DOMAIN, "ndf is NULL");
	*ndf = calloc(1, sizeof **ndf);
	return *ndf ? STDFIT_OK : api_fail(error, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
}

static enum stdfit_status give_up(stdfit_ndf **ndf, enum stdfit_status status)
{
	if (status != STDFIT_OK) {
		free(*ndf);
		*ndf = NULL;
	}
	return status;
}

static enum stdfit_status init_class(struct stdfit_ndf *ndf, const char *name, double sigma_x, double sigma_y,
				     double gamma, const char *lambda, struct stdfit_error *error)
{
	const struct ndf_class *class = ndf_find(name);
	enum lambda_form form = LAMBDA_EXACT;

	if (!class || ndf_is_tabulated(class))
		return api_unknown(error, "ndf with parameters", name ? name : "(NULL)");
	if (lambda && lambda_form_find(lambda, &form) != STATUS_OK)
		return api_unknown(error, "lambda", lambda);
	if (!(sigma_x >= NDF_SIGMA_MIN && sigma_x <= NDF_SIGMA_MAX && sigma_y >= NDF_SIGMA_MIN &&
	      sigma_y <= NDF_SIGMA_MAX))
		return api_fail(error, STATUS_DOMAIN, "expected sigma in [%g, %g], found %g, %g", NDF_SIGMA_MIN,
				NDF_SIGMA_MAX, sigma_x, sigma_y);
	if (class->isotropic && sigma_x != sigma_y)
		return api_fail(error, STATUS_DOMAIN, "%s is isotropic: expected one sigma, found %g, %g", name,
				sigma_x, sigma_y);
	if (ndf_init(&ndf->ndf, class, sigma_x, sigma_y, gamma) != STATUS_OK)
		return api_fail(error, STATUS_DOMAIN, "gamma %g is outside the range of %s", gamma, name);
	const enum status status = ndf_set_lambda_form(&ndf->ndf, form);

	if (status != STATUS_OK)
		return api_fail(error, status, "%s of gamma %g has no Lambda in the form %s", name, ndf->ndf.gamma,
				lambda);
	return STDFIT_OK;
}

enum stdfit_status stdfit_ndf_new(stdfit_ndf **ndf, const char *name, double sigma_x, double sigma_y, double gamma,
				  const char *lambda, struct stdfit_error *error)
{
	const enum stdfit_status status = allocate(ndf, error);

	if (status != STDFIT_OK)
		return status;
	return give_up(ndf, init_class(*ndf, name, sigma_x, sigma_y, gamma, lambda, error));
}

static enum stdfit_status init_piecewise(struct pwl *pwl, int n_nodes, const double *theta, const double *Dx,
					 const double *Dy, struct stdfit_error *error)
{
	const enum status status = pwl_init(pwl, n_nodes, theta, Dx, Dy);

	if (status == STATUS_DOMAIN)
		return api_fail(error, status,
				"expected theta increasing from 0 to pi/2, and finite D >= 0 that are not all 0");
	return api_end(error, status, NULL);
}

enum stdfit_status stdfit_ndf_new_piecewise(stdfit_ndf **ndf, int n_nodes, const double *theta, const double *Dx,
					    const double *Dy, struct stdfit_error *error)
{
	enum stdfit_status status = allocate(ndf, error);

	if (status != STDFIT_OK)
		return status;
	if (!theta || !Dx || n_nodes < 2 || n_nodes > PWL_NODES_MAX)
		status = api_fail(error, STATUS_DOMAIN, "expected theta, Dx and 2 .. %d nodes, found %d", PWL_NODES_MAX,
				  n_nodes);
	else
		status = init_piecewise(&(*ndf)->pwl, n_nodes, theta, Dx, Dy, error);
	if (status == STDFIT_OK)
		ndf_from_pwl(&(*ndf)->ndf, &(*ndf)->pwl);
	return give_up(ndf, status);
}

enum stdfit_status stdfit_ndf_new_ellipsoid(stdfit_ndf **ndf, const double A[9], struct stdfit_error *error)
{
	enum stdfit_status status = allocate(ndf, error);

	if (status != STDFIT_OK)
		return status;
	if (!A)
		return give_up(ndf, api_fail(error, STATUS_DOMAIN, "A is NULL"));
	const double rows[3][3] = {{A[0], A[1], A[2]}, {A[3], A[4], A[5]}, {A[6], A[7], A[8]}};
	struct ellipsoid ellipsoid;

	if (ellipsoid_init(&ellipsoid, rows) != STATUS_OK || ndf_from_ellipsoid(&(*ndf)->ndf, &ellipsoid) != STATUS_OK)
		status = api_fail(error, STATUS_DOMAIN, "A is singular, or not finite");
	return give_up(ndf, status);
}

void stdfit_ndf_free(stdfit_ndf *ndf)
{
	if (ndf)
		pwl_free(&ndf->pwl);
	free(ndf);
}

enum stdfit_status api_ndf(const struct stdfit_ndf *ndf, const struct ndf **inner, struct stdfit_error *error)
{
	if (!ndf)
		return api_fail(error, STATUS_DOMAIN, "ndf is NULL");
	*inner = &ndf->ndf;
	return STDFIT_OK;
}

enum stdfit_status api_level_ndf(const struct stdfit_ndf *ndf, const struct ndf **inner, struct stdfit_error *error)
{
	const enum stdfit_status status = api_ndf(ndf, inner, error);

	if (status == STDFIT_OK && ndf_is_tilted(*inner))
		return api_fail(error, STATUS_UNSUPPORTED, "not of facets that lean on average");
	return status;
}

static double value_of(const struct ndf *ndf, enum stdfit_ndf_quantity quantity, struct vec3 m)
{
	switch (quantity) {
	case STDFIT_LAMBDA:
		return ndf_lambda(ndf, m);
	case STDFIT_G1:
		return ndf_G1(ndf, m);
	case STDFIT_PDF:
		return ndf_pdf(ndf, m);
	default:
		return ndf_D(ndf, m);
	}
}

enum stdfit_status stdfit_ndf_evaluate(const stdfit_ndf *ndf, enum stdfit_ndf_quantity quantity, size_t n,
				       const double *directions, double *value, struct stdfit_error *error)
{
	const long q = (long)quantity;

	if (!ndf || (!value && n > 0))
		return api_fail(error, STATUS_DOMAIN, "ndf or value is NULL");
	if (q < STDFIT_D || q > STDFIT_PDF)
		return api_fail(error, STATUS_DOMAIN, "expected a quantity in %d .. %d, found %ld", STDFIT_D,
				STDFIT_PDF, q);
	const enum stdfit_status status = api_directions("direction", n, directions, error);

	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		value[i] = value_of(&ndf->ndf, quantity, api_vec(directions + 3 * i));
	return status;
}

enum stdfit_status stdfit_ndf_G(const stdfit_ndf *ndf, const char *gaf, size_t n, const double *wi, const double *wo,
				double *G, struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	enum gaf form = GAF_UNCORRELATED;
	enum stdfit_status status = api_ndf(ndf, &inner, error);

	if (status == STDFIT_OK)
		status = api_gaf(gaf, &form, error);
	if (status == STDFIT_OK)
		status = api_pairs(n, wi, wo, G, "G", error);
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		G[i] = gaf_G(form, inner, api_vec(wi + 3 * i), api_vec(wo + 3 * i));
	return status;
}

enum stdfit_status api_numbers(size_t n, const double *u, struct stdfit_error *error)
{
	if (n > 0 && !u)
		return api_fail(error, STATUS_DOMAIN, "u is NULL");
	for (size_t i = 0; i < n; i++)
		if (!(u[i] >= 0 && u[i] < 1))
			return api_fail(error, STATUS_DOMAIN, "expected u in [0, 1), found %g", u[i]);
	return STDFIT_OK;
}

static enum stdfit_status check_numbers(size_t n, const double *u, const double *normals, struct stdfit_error *error)
{
	if (n > 0 && !normals)
		return api_fail(error, STATUS_DOMAIN, "normals is NULL");
	return api_numbers(2 * n, u, error);
}

enum stdfit_status stdfit_ndf_sample(const stdfit_ndf *ndf, size_t n, const double *u, double *normals,
				     struct stdfit_error *error)
{
	enum stdfit_status status;

	if (!ndf)
		return api_fail(error, STATUS_DOMAIN, "ndf is NULL");
	status = check_numbers(n, u, normals, error);
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		api_put(normals + 3 * i, ndf_sample(&ndf->ndf, u[2 * i], u[2 * i + 1]));
	return status;
}

/* wi above the horizon, and an NDF that has visible normals. */
static enum stdfit_status check_visible(const struct stdfit_ndf *ndf, const double wi[3], struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	enum stdfit_status status = api_ndf(ndf, &inner, error);

	if (status == STDFIT_OK)
		status = api_directions("wi", 1, wi, error);
	if (status == STDFIT_OK && !(wi[2] > 0))
		status = api_fail(error, STATUS_DOMAIN, "wi is at or below the horizon");
	return status;
}

enum stdfit_status stdfit_ndf_sample_visible(const stdfit_ndf *ndf, const double wi[3], size_t n, const double *u,
					     double *normals, struct stdfit_error *error)
{
	enum stdfit_status status = check_visible(ndf, wi, error);

	if (status != STDFIT_OK)
		return status;
	if (!vndf_supports(&ndf->ndf))
		return api_fail(error, STATUS_UNSUPPORTED, "%s has no samples of visible normals",
				ndf_name(ndf->ndf.class));
	status = check_numbers(n, u, normals, error);
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		api_put(normals + 3 * i, vndf_sample(&ndf->ndf, api_vec(wi), u[2 * i], u[2 * i + 1]));
	return status;
}

enum stdfit_status stdfit_ndf_pdf_visible(const stdfit_ndf *ndf, const double wi[3], size_t n, const double *normals,
					  double *pdf, struct stdfit_error *error)
{
	enum stdfit_status status = check_visible(ndf, wi, error);

	if (status == STDFIT_OK)
		status = api_directions("normal", n, normals, error);
	if (status == STDFIT_OK && !pdf && n > 0)
		status = api_fail(error, STATUS_DOMAIN, "pdf is NULL");
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		pdf[i] = vndf_pdf(&ndf->ndf, api_vec(wi), api_vec(normals + 3 * i));
	return status;
}

enum stdfit_status stdfit_ndf_weight(const stdfit_ndf *ndf, const char *gaf, const double wi[3], size_t n,
				     const double *normals, const double *pdf, double *weight,
				     struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	enum gaf form = GAF_UNCORRELATED;
	enum stdfit_status status = api_ndf(ndf, &inner, error);

	if (status == STDFIT_OK)
		status = check_visible(ndf, wi, error);
	if (status == STDFIT_OK)
		status = api_gaf(gaf, &form, error);
	if (status == STDFIT_OK)
		status = api_directions("normal", n, normals, error);
	if (status == STDFIT_OK && n > 0 && (!pdf || !weight))
		status = api_fail(error, STATUS_DOMAIN, "pdf or weight is NULL");
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		if (!(pdf[i] > 0 && isfinite(pdf[i])))
			status = api_fail(error, STATUS_DOMAIN, "expected a finite pdf above 0, found %g", pdf[i]);
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		weight[i] = vndf_weight(inner, form, api_vec(wi), api_vec(normals + 3 * i), pdf[i]);
	return status;
}

enum stdfit_status stdfit_ndf_P22(const stdfit_ndf *ndf, double p, double q, double *density,
				  struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	const enum stdfit_status status = api_ndf(ndf, &inner, error);

	if (status != STDFIT_OK)
		return status;
	if (!density || !isfinite(p) || !isfinite(q))
		return api_fail(error, STATUS_DOMAIN, "expected finite slopes and room for the density");
	*density = ndf_P22(inner, p, q);
	return STDFIT_OK;
}

enum stdfit_status stdfit_ndf_P2(const stdfit_ndf *ndf, double phi, double q, double *density,
				 struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	const enum stdfit_status status = api_ndf(ndf, &inner, error);

	if (status != STDFIT_OK)
		return status;
	if (!density || !isfinite(phi) || !isfinite(q))
		return api_fail(error, STATUS_DOMAIN, "expected finite phi and slope, and room for the density");
	*density = ndf_P2(inner, phi, q);
	return STDFIT_OK;
}

enum stdfit_status stdfit_ndf_moment(const stdfit_ndf *ndf, double phi, int order, double *moment,
				     struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	const enum stdfit_status status = api_ndf(ndf, &inner, error);

	if (status != STDFIT_OK)
		return status;
	if (!moment || !isfinite(phi) || order < 0 || order % 2)
		return api_fail(error, STATUS_DOMAIN, "expected a finite phi, an even order, and room for the moment");
	if (inner->pwl)
		return api_fail(error, STATUS_UNSUPPORTED, "a piecewise distribution has no moments here");
	if (ndf_moment(inner, phi, order, moment) != STATUS_OK)
		return api_fail(error, STATUS_DOMAIN, "the moment of order %d does not exist", order);
	return STDFIT_OK;
}

enum stdfit_status stdfit_ndf_excess_kurtosis(const stdfit_ndf *ndf, double *kurtosis, struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	const enum stdfit_status status = api_ndf(ndf, &inner, error);

	if (status != STDFIT_OK)
		return status;
	if (!kurtosis)
		return api_fail(error, STATUS_DOMAIN, "kurtosis is NULL");
	if (inner->pwl)
		return api_fail(error, STATUS_UNSUPPORTED, "a piecewise distribution has no kurtosis here");
	if (ndf_excess_kurtosis(inner, kurtosis) != STATUS_OK)
		return api_fail(error, STATUS_DOMAIN, "%s of gamma %g has no kurtosis", ndf_name(inner->class),
				inner->gamma);
	return STDFIT_OK;
}

enum stdfit_status stdfit_ndf_furnace(const stdfit_ndf *ndf, const char *gaf, double *balance,
				      struct stdfit_error *error)
{
	struct stdfit_model mirror = stdfit_model_default();
	struct cook_torrance inner;

	mirror.gaf = gaf;
	mirror.fresnel = "none";
	enum stdfit_status status = api_model(&mirror, ndf, &inner, error);

	if (status == STDFIT_OK && !balance)
		status = api_fail(error, STATUS_DOMAIN, "balance is NULL");
	if (status == STDFIT_OK)
		status = api_isotropic(&inner.ndf, error);
	return status == STDFIT_OK ? api_end(error, energy_furnace(&inner, balance), NULL) : status;
}
