/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/api/api.h"
#include "src/dielectric.h"
#include "src/random_walk.h"
#include "src/splitmix.h"
#include "src/vndf.h"
#include <math.h>

static enum stdfit_status check_interface(enum status status, double index, struct stdfit_error *error)
{
	if (status == STATUS_DOMAIN)
		return api_fail(error, status, "expected an index in [%g, %g] other than 1, found %g",
				1 / DIELECTRIC_INDEX_MAX, DIELECTRIC_INDEX_MAX, index);
	if (status == STATUS_UNSUPPORTED)
		return api_fail(error, status, "v-groove is of reflection alone");
	return STDFIT_OK;
}

static enum stdfit_status make_interface(const stdfit_ndf *ndf, const char *gaf, double index,
					 struct dielectric *dielectric, struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	enum gaf form = GAF_UNCORRELATED;
	enum stdfit_status status = api_level_ndf(ndf, &inner, error);

	if (status == STDFIT_OK)
		status = api_gaf(gaf, &form, error);
	return status == STDFIT_OK ? check_interface(dielectric_init(dielectric, inner, form, index), index, error)
				   : status;
}

/* Normals that this distribution can draw. */
static enum stdfit_status find_sampling(const struct ndf *ndf, const char *name, enum sampling *sampling,
					struct stdfit_error *error)
{
	*sampling = SAMPLING_VISIBLE;
	if (name && sampling_find(name, sampling) != STATUS_OK)
		return api_unknown(error, "sampling", name);
	if (*sampling == SAMPLING_VISIBLE && !vndf_supports(ndf))
		return api_fail(error, STATUS_UNSUPPORTED, "%s has no samples of visible normals",
				ndf_name(ndf->class));
	return STDFIT_OK;
}

static enum stdfit_status check_origin(const double wi[3], bool below, struct stdfit_error *error)
{
	const enum stdfit_status status = api_directions("wi", 1, wi, error);

	if (status == STDFIT_OK && !(below ? wi[2] != 0 : wi[2] > 0))
		return api_fail(error, STATUS_DOMAIN,
				below ? "wi lies in the horizon" : "wi is at or below the horizon");
	return status;
}

enum stdfit_status stdfit_dielectric_evaluate(const stdfit_ndf *ndf, const char *gaf, double index, size_t n,
					      const double *wi, const double *wo, double *f, struct stdfit_error *error)
{
	struct dielectric dielectric;
	enum stdfit_status status = make_interface(ndf, gaf, index, &dielectric, error);

	if (status == STDFIT_OK)
		status = api_pairs(n, wi, wo, f, "f", error);
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		f[i] = dielectric_f(&dielectric, api_vec(wi + 3 * i), api_vec(wo + 3 * i));
	return status;
}

/* What samples from wi need. */
static enum stdfit_status make_sampler(const stdfit_ndf *ndf, const char *gaf, double index, const char *sampling,
				       const double wi[3], struct dielectric *dielectric, enum sampling *normals,
				       struct stdfit_error *error)
{
	enum stdfit_status status = make_interface(ndf, gaf, index, dielectric, error);

	if (status == STDFIT_OK)
		status = find_sampling(&ndf->ndf, sampling, normals, error);
	return status == STDFIT_OK ? check_origin(wi, true, error) : status;
}

enum stdfit_status stdfit_dielectric_sample(const stdfit_ndf *ndf, const char *gaf, double index, const char *sampling,
					    const double wi[3], size_t n, const double *u, double *wo, double *weight,
					    struct stdfit_error *error)
{
	struct dielectric dielectric;
	enum sampling normals = SAMPLING_VISIBLE;
	enum stdfit_status status = make_sampler(ndf, gaf, index, sampling, wi, &dielectric, &normals, error);

	if (status == STDFIT_OK && n > 0 && (!wo || !weight))
		status = api_fail(error, STATUS_DOMAIN, "wo or weight is NULL");
	if (status == STDFIT_OK)
		status = api_numbers(3 * n, u, error);
	for (size_t i = 0; i < n && status == STDFIT_OK; i++) {
		const struct dielectric_sample sample = dielectric_sample(&dielectric, normals, api_vec(wi), u + 3 * i);

		api_put(wo + 3 * i, sample.wo);
		weight[i] = sample.weight;
	}
	return status;
}

enum stdfit_status stdfit_dielectric_pdf(const stdfit_ndf *ndf, double index, const char *sampling, const double wi[3],
					 size_t n, const double *wo, double *pdf, struct stdfit_error *error)
{
	struct dielectric dielectric;
	enum sampling normals = SAMPLING_VISIBLE;
	enum stdfit_status status = make_sampler(ndf, NULL, index, sampling, wi, &dielectric, &normals, error);

	if (status == STDFIT_OK)
		status = api_directions("wo", n, wo, error);
	if (status == STDFIT_OK && n > 0 && !pdf)
		status = api_fail(error, STATUS_DOMAIN, "pdf is NULL");
	for (size_t i = 0; i < n && status == STDFIT_OK; i++)
		pdf[i] = dielectric_pdf(&dielectric, normals, api_vec(wi), api_vec(wo + 3 * i));
	return status;
}

struct stdfit_facets stdfit_facets_default(void)
{
	return (struct stdfit_facets){.fresnel = "none", .n = {1.5, 1.5, 1.5}};
}

static enum stdfit_status make_mirror(const struct stdfit_facets *facets, const struct ndf *ndf, enum fresnel fresnel,
				      struct random_walk *walk, struct stdfit_error *error)
{
	enum stdfit_status status = STDFIT_OK;

	for (int c = 0; c < 3 && status == STDFIT_OK; c++)
		status = api_index(fresnel, facets->n[c], facets->k[c], error);
	if (status != STDFIT_OK)
		return status;
	return api_end(error, random_walk_init_mirror(walk, ndf, fresnel, facets->n, facets->k), NULL);
}

static enum stdfit_status make_walk(const struct stdfit_facets *facets, const stdfit_ndf *ndf, struct random_walk *walk,
				    struct stdfit_error *error)
{
	const struct ndf *inner = NULL;
	enum fresnel fresnel = FRESNEL_DIELECTRIC;
	enum sampling visible;
	enum stdfit_status status = api_level_ndf(ndf, &inner, error);

	if (status == STDFIT_OK && !facets)
		status = api_fail(error, STATUS_DOMAIN, "facets is NULL");
	if (status == STDFIT_OK)
		status = api_fresnel(facets->fresnel, &fresnel, error);
	if (status == STDFIT_OK)
		status = find_sampling(inner, NULL, &visible, error);
	if (status != STDFIT_OK)
		return status;
	if (!facets->transmits)
		return make_mirror(facets, inner, fresnel, walk, error);
	if (fresnel != FRESNEL_DIELECTRIC)
		return api_fail(error, STATUS_DOMAIN, "facets that transmit are dielectric, not %s", facets->fresnel);
	return check_interface(random_walk_init_dielectric(walk, inner, facets->n[0]), facets->n[0], error);
}

static double next_number(void *state)
{
	return splitmix_uniform(state);
}

enum stdfit_status stdfit_scatter_evaluate(const struct stdfit_facets *facets, const stdfit_ndf *ndf, int events,
					   size_t n, const double *wi, const double *wo, uint64_t *random, double *f,
					   struct stdfit_error *error)
{
	struct random_walk walk;
	enum stdfit_status status = make_walk(facets, ndf, &walk, error);

	if (status == STDFIT_OK && (!random || events < 0))
		status = api_fail(error, STATUS_DOMAIN, "expected a state of random numbers and events >= 0, found %d",
				  events);
	if (status == STDFIT_OK)
		status = api_pairs(n, wi, wo, f, "f", error);
	if (status != STDFIT_OK)
		return status;
	const struct random_numbers numbers = {next_number, random};

	for (size_t i = 0; i < n; i++)
		random_walk_f(&walk, api_vec(wi + 3 * i), api_vec(wo + 3 * i), events, &numbers, f + 3 * i);
	return STDFIT_OK;
}

enum stdfit_status stdfit_scatter_sample(const struct stdfit_facets *facets, const stdfit_ndf *ndf, const double wi[3],
					 size_t n, uint64_t *random, double *wo, double *weight, int *events,
					 struct stdfit_error *error)
{
	struct random_walk walk;
	enum stdfit_status status = make_walk(facets, ndf, &walk, error);

	if (status == STDFIT_OK)
		status = check_origin(wi, walk.refracts, error);
	if (status == STDFIT_OK && (!random || (n > 0 && (!wo || !weight))))
		status = api_fail(error, STATUS_DOMAIN, "random, wo or weight is NULL");
	if (status != STDFIT_OK)
		return status;
	const struct random_numbers numbers = {next_number, random};

	for (size_t i = 0; i < n; i++) {
		const struct random_walk_exit out = random_walk_sample(&walk, api_vec(wi), &numbers);

		api_put(wo + 3 * i, out.wo);
		for (size_t c = 0; c < 3; c++)
			weight[3 * i + c] = out.weight[c];
		if (events)
			events[i] = out.events;
	}
	return STDFIT_OK;
}
