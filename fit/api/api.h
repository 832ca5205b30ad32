/* SPDX-License-Identifier: GPL-3.0-or-later */
/* api - what the files behind the public header share. */
#ifndef API_H
#define API_H

#include "fit/search/fit.h"
#include "fit/stdfit.h"
#include "src/pwl.h"

struct stdfit_ndf {
	struct ndf ndf;
	struct pwl pwl; /* the table of ndf, if that is pl */
};

struct stdfit_measurement {
	struct measurement grid;
};

/* api_explain - the text of a failure; error may be NULL. */
void api_explain(struct stdfit_error *error, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* api_fail - a failure with its text; its value is `status`, which static analysis can see because this is a macro. */
#define api_fail(error, status, ...) (api_explain(error, __VA_ARGS__), (enum stdfit_status)(status))
/* api_unknown - the failure of a name of `what` that is not known. */
MUST_CHECK enum stdfit_status api_unknown(struct stdfit_error *error, const char *what, const char *name);
/* api_end - the public form of an internal end; `why` may be empty. */
enum stdfit_status api_end(struct stdfit_error *error, enum status status, const struct error *why);

/* api_names - G and F of their names; api_fresnel knows the forms that are functions of n and k, api_model_fresnel f82 too. */
MUST_CHECK enum stdfit_status api_gaf(const char *name, enum gaf *gaf, struct stdfit_error *error);
MUST_CHECK enum stdfit_status api_fresnel(const char *name, enum fresnel *fresnel, struct stdfit_error *error);
MUST_CHECK enum stdfit_status api_model_fresnel(const char *name, enum fresnel *fresnel, struct stdfit_error *error);
MUST_CHECK enum stdfit_status api_bins(const char *name, enum bins *bins, struct stdfit_error *error);

/* api_directions - whether n directions are there and unit vectors. */
MUST_CHECK enum stdfit_status api_directions(const char *what, size_t n, const double *directions,
					     struct stdfit_error *error);
/* api_pairs - whether n pairs of directions are there, and room for what is made of them: `out`, called `name`. */
MUST_CHECK enum stdfit_status api_pairs(size_t n, const double *wi, const double *wo, const double *out,
					const char *name, struct stdfit_error *error);
/* api_numbers - whether n numbers are there and in [0, 1). */
MUST_CHECK enum stdfit_status api_numbers(size_t n, const double *u, struct stdfit_error *error);
/* api_ndf - the NDF as the models know it.
 * api_level_ndf - the same, of facets that are level on average; else STDFIT_UNSUPPORTED. */
MUST_CHECK enum stdfit_status api_ndf(const struct stdfit_ndf *ndf, const struct ndf **inner,
				      struct stdfit_error *error);
MUST_CHECK enum stdfit_status api_level_ndf(const struct stdfit_ndf *ndf, const struct ndf **inner,
					    struct stdfit_error *error);
/* api_index - whether n and k are in the range of this form of F. */
MUST_CHECK enum stdfit_status api_index(enum fresnel fresnel, double n, double k, struct stdfit_error *error);
/* api_model - a model, checked. */
MUST_CHECK enum stdfit_status api_model(const struct stdfit_model *model, const struct stdfit_ndf *ndf,
					struct cook_torrance *inner, struct stdfit_error *error);

/* api_isotropic - whether D is the same at all azimuths. */
MUST_CHECK enum stdfit_status api_isotropic(const struct ndf *ndf, struct stdfit_error *error);

static inline void api_put(double *out, struct vec3 v)
{
	out[0] = v.x;
	out[1] = v.y;
	out[2] = v.z;
}

static inline struct vec3 api_vec(const double *d)
{
	return (struct vec3){d[0], d[1], d[2]};
}

#endif
