/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/distribution.h"
#include "data_readers/text_quote.h"
#include "fit/cli/nearest.h"
#include "fit/cli/nodes.h"
#include "fit/results/csv_number.h"
#include "fit/results/result.h"
#include "fit/search/free_form.h"
#include "src/names.h"
#include "src/ndf_cdf.h"
#include "src/ndf_slopes.h"
#include "src/vndf.h"

#include <stdlib.h>

static bool given(const char *word)
{
	return word && *word;
}

/* A number from a word; `otherwise` where there is none; NaN where the word is no number, with the reason in `error`. */
static enum status number(const char *what, const char *word, double otherwise, double *value, struct error *error)
{
	char shown[TEXT_QUOTE_SIZE];
	*value = otherwise;
	if (!given(word) || csv_parse_number(word, value))
		return STATUS_OK;
	text_quote(word, shown, sizeof shown);
	return error_set(error, STATUS_DOMAIN, "bad %s '%s': expected a number", what, shown);
}

/* Every name=value has to be known: an unknown one would be ignored. */
static enum status check_params(const char *params, bool (*known)(const char *name, const void *context),
				const void *context, struct error *error)
{
	for (const char *at = given(params) ? params : NULL; at; at = strchr(at, ';')) {
		char name[32], word[TEXT_QUOTE_SIZE], shown[TEXT_QUOTE_SIZE];
		double value;
		at += *at == ';';
		snprintf(name, sizeof name, "%.*s", (int)strcspn(at, "=;"), at);
		if (known(name, context) && result_param(at, name, &value) && !isnan(value))
			continue;
		snprintf(word, sizeof word, "%.*s", (int)strcspn(at, ";"), at);
		text_quote(word, shown, sizeof shown);
		return error_set(error, STATUS_DOMAIN,
				 "bad parameter '%.60s': the distribution has no such name, or that is no number",
				 shown);
	}
	return STATUS_OK;
}

static enum status does_not_take(const char *name, struct error *error)
{
	return error_set(error, STATUS_DOMAIN, "%s does not take these parameters", name);
}

/* Checks the parameters of a class, value[i] for ndf_param_at(class, i); NaN: not checked. */
static enum status refuse_params(const struct ndf_class *class, const double value[], struct error *error)
{
	for (int i = 0; i < NDF_PARAMS_MAX && ndf_param_at(class, i); i++) {
		const struct ndf_param *p = ndf_param_at(class, i);
		if (value[i] < p->min || (value[i] == p->min && !p->min_included) || value[i] > p->max)
			return error_set(error, STATUS_DOMAIN, "bad %s %.6g: %s takes one %s %g, up to %g", p->name,
					 value[i], ndf_name(class), p->min_included ? "from" : "above", p->min, p->max);
	}
	return does_not_take(ndf_name(class), error);
}

/* pl */

static bool is_node(const char *name, const void *context)
{
	char *end;
	(void)context;
	const long i = name[0] == 'D' && name[1] >= '0' && name[1] <= '9' ? strtol(name + 1, &end, 10) : -1;
	return i >= 0 && i < FREE_FORM_VALUES && !*end;
}

/* From D0 to D90. */
static enum status pl_of_params(const struct distribution_words *words, struct pwl *pwl, struct error *error)
{
	double D[FREE_FORM_VALUES];
	enum status status = check_params(words->params, is_node, NULL, error);
	for (int i = 0; i < FREE_FORM_VALUES && status == STATUS_OK; i++) {
		char name[16];
		snprintf(name, sizeof name, "D%d", i);
		if (!given(words->params) || !result_param(words->params, name, &D[i]))
			status = error_set(error, STATUS_DOMAIN,
					   "pl needs --nodes, or the parameters D0 to D%d: %s is missing",
					   FREE_FORM_VALUES - 1, name);
	}
	if (status != STATUS_OK)
		return status;
	status = free_form_pwl(BINS_NODE, D, pwl);
	return status != STATUS_OK ? error_set(error, status, "pl takes no such values: %s", status_str(status))
				   : STATUS_OK;
}

static enum status make_pl(const struct distribution_words *words, struct distribution *distribution,
			   struct error *error)
{
	if (given(words->nodes) && given(words->params))
		return error_set(error, STATUS_DOMAIN, "pl takes nodes or params, not both");
	distribution->pwl = calloc(1, sizeof *distribution->pwl);
	if (!distribution->pwl)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	const enum status status = given(words->nodes) ? nodes_read(words->nodes, distribution->pwl, error)
						       : pl_of_params(words, distribution->pwl, error);
	if (status == STATUS_OK)
		ndf_from_pwl(&distribution->ndf, distribution->pwl);
	return status;
}

/* The ellipsoid */

static const char *const ellipsoid_params[] = {"alpha_x", "alpha_y", "theta_x", "theta_y", "theta_z"};

static bool is_of_ellipsoid(const char *name, const void *context)
{
	(void)context;
	return names_find(ellipsoid_params, 5, name) >= 0;
}

/* sigma and sigma_y stand for alpha_x and alpha_y. */
static enum status make_ellipsoid(const struct distribution_words *words, double sigma_x, double sigma_y,
				  struct distribution *distribution, struct error *error)
{
	double value[5] = {sigma_x, sigma_y, 0, 0, 0};
	const enum status status = check_params(words->params, is_of_ellipsoid, NULL, error);
	if (status != STATUS_OK)
		return status;
	for (int i = 0; i < 5 && given(words->params); i++)
		(void)result_param(words->params, ellipsoid_params[i], &value[i]);
	if (isnan(value[0]) || isnan(value[1]))
		return error_set(error, STATUS_DOMAIN, "the ellipsoid needs alpha_x and alpha_y, or sigma");
	distribution->is_ellipsoid = true;
	const double radians = M_PI / 180;
	return ellipsoid_init_angles(&distribution->ellipsoid, value[0], value[1], value[2] * radians,
				     value[3] * radians, value[4] * radians) != STATUS_OK
		       ? does_not_take("ellipsoid", error)
		       : STATUS_OK;
}

/* The parametric classes */

static bool is_of_class(const char *name, const void *context)
{
	for (int i = 0; ndf_param_at(context, i); i++)
		if (!strcmp(ndf_param_at(context, i)->name, name))
			return true;
	return false;
}

/* All its own parameters, from the words sigma and gamma and from params. */
static enum status from_params(const struct distribution_words *words, const struct ndf_class *class, double sigma,
			       double sigma_y, double gamma, struct ndf *ndf, struct error *error)
{
	double value[NDF_PARAMS_MAX] = {NAN, NAN, NAN};
	for (int i = 0; ndf_param_at(class, i); i++) {
		const struct ndf_param *param = ndf_param_at(class, i);
		value[i] = param->role == NDF_ROLE_SIGMA ? sigma : param->role == NDF_ROLE_GAMMA ? gamma : NAN;
		(void)result_param(words->params, param->name, &value[i]);
		if (isnan(value[i]))
			return error_set(error, STATUS_DOMAIN, "%s needs %s", ndf_name(class), param->name);
	}
	const enum status status = sigma_y == sigma || isnan(sigma)
					   ? ndf_init_params(ndf, class, value)
					   : ndf_init_params_anisotropic(ndf, class, value, sigma_y);
	if (status == STATUS_OK)
		return STATUS_OK;
	if (!isnan(sigma_y) && !(sigma_y >= NDF_SIGMA_MIN && sigma_y <= NDF_SIGMA_MAX))
		value[0] = sigma_y;
	return refuse_params(class, value, error);
}

/* The same for the words sigma, sigma_y and gamma, which is C of low. */
static enum status refuse_words(const struct ndf_class *class, double sigma_x, double sigma_y, double gamma,
				struct error *error)
{
	const double sigma = sigma_x >= NDF_SIGMA_MIN && sigma_x <= NDF_SIGMA_MAX ? sigma_y : sigma_x;
	double value[NDF_PARAMS_MAX] = {NAN, NAN, NAN};
	/* The second parameter has the domain of gamma, whatever its name. */
	for (int i = 0; ndf_param_at(class, i); i++)
		value[i] = ndf_param_at(class, i)->role == NDF_ROLE_SIGMA ? sigma : i == 1 ? gamma : NAN;
	return refuse_params(class, value, error);
}

static enum status make_class(const struct distribution_words *words, const struct ndf_class *class, double sigma_x,
			      double sigma_y, double gamma, struct ndf *ndf, struct error *error)
{
	enum status status = check_params(words->params, is_of_class, class, error);
	if (status != STATUS_OK)
		return status;
	if (sigma_x != sigma_y && !isnan(sigma_x) && !ndf_has_anisotropy(class))
		return error_set(error, STATUS_DOMAIN, "%s takes one sigma, the same in all directions",
				 ndf_name(class));
	if (given(words->params))
		return from_params(words, class, sigma_x, sigma_y, gamma, ndf, error);
	if (isnan(sigma_x))
		return error_set(error, STATUS_DOMAIN, "%s needs sigma", ndf_name(class));
	if (ndf_has_gamma(class) && isnan(gamma))
		return error_set(error, STATUS_DOMAIN, "%s needs gamma", ndf_name(class));
	if (!ndf_has_gamma(class) && !isnan(gamma))
		return error_set(error, STATUS_DOMAIN, "%s has no gamma", ndf_name(class));
	return ndf_init(ndf, class, sigma_x, sigma_y, gamma) != STATUS_OK
		       ? refuse_words(class, sigma_x, sigma_y, gamma, error)
		       : STATUS_OK;
}

static enum status set_lambda(const char *word, struct ndf *ndf, struct error *error)
{
	enum lambda_form form = LAMBDA_EXACT;
	if (given(word) && lambda_form_find(word, &form) != STATUS_OK)
		return error_set(error, STATUS_DOMAIN, "there is no form of Lambda of that name");
	if (form == LAMBDA_EXACT || ndf_set_lambda_form(ndf, form) == STATUS_OK)
		return STATUS_OK;
	return error_set(error, STATUS_DOMAIN, "%s has no Lambda %s, or not at this gamma", ndf_name(ndf->class), word);
}

static enum status make(const struct distribution_words *words, struct distribution *distribution, struct error *error)
{
	const struct ndf_class *class = ndf_find(words->name);
	double sigma_x, sigma_y, gamma;
	enum status status = number("sigma", words->sigma, NAN, &sigma_x, error);
	if (status == STATUS_OK)
		status = number("sigma_y", words->sigma_y, sigma_x, &sigma_y, error);
	if (status == STATUS_OK)
		status = number("gamma", words->gamma, NAN, &gamma, error);
	if (status != STATUS_OK)
		return status;
	distribution->name = class ? ndf_name(class) : "ellipsoid";
	if (words->name && !strcmp(words->name, "ellipsoid"))
		return make_ellipsoid(words, sigma_x, sigma_y, distribution, error);
	if (!class) {
		char shown[TEXT_QUOTE_SIZE];
		const int near = nearest_word(words->name ? words->name : "", distribution_name_at, NULL);
		text_quote(words->name ? words->name : "", shown, sizeof shown);
		return error_set(error, STATUS_DOMAIN, "there is no NDF '%s'%s%s%s", shown,
				 near < 0 ? "" : ": did you mean ", near < 0 ? "" : distribution_name_at(NULL, near),
				 near < 0 ? "" : "?");
	}
	if (given(words->nodes) && !ndf_is_tabulated(class))
		return error_set(error, STATUS_DOMAIN, "nodes are for pl, not for %s", ndf_name(class));
	status = ndf_is_tabulated(class) ? make_pl(words, distribution, error)
					 : make_class(words, class, sigma_x, sigma_y, gamma, &distribution->ndf, error);
	return status != STATUS_OK ? status : set_lambda(words->lambda, &distribution->ndf, error);
}

const char *distribution_name_at(const void *data, int i)
{
	(void)data;
	return ndf_at(i) ? ndf_name(ndf_at(i)) : NULL;
}

enum status distribution_make(const struct distribution_words *words, struct distribution *distribution,
			      struct error *error)
{
	*distribution = (struct distribution){0};
	const enum status status = make(words, distribution, error);
	if (status != STATUS_OK)
		distribution_free(distribution);
	return status;
}

void distribution_free(struct distribution *distribution)
{
	if (distribution->pwl)
		pwl_free(distribution->pwl);
	free(distribution->pwl);
	*distribution = (struct distribution){0};
}

/* Values */

double distribution_D(const struct distribution *distribution, struct vec3 m)
{
	return distribution->is_ellipsoid ? ellipsoid_D(&distribution->ellipsoid, m) : ndf_D(&distribution->ndf, m);
}

double distribution_P22(const struct distribution *distribution, double p, double q)
{
	if (!distribution->is_ellipsoid)
		return ndf_P22(&distribution->ndf, p, q);
	const struct vec3 m = vec3_unit((struct vec3){-p, -q, 1});
	return ellipsoid_D(&distribution->ellipsoid, m) * (m.z * m.z) * (m.z * m.z);
}

double distribution_P2(const struct distribution *distribution, double phi, double q)
{
	return distribution->is_ellipsoid ? NAN : ndf_P2(&distribution->ndf, phi, q);
}

double distribution_lambda(const struct distribution *distribution, struct vec3 w)
{
	return distribution->is_ellipsoid ? 1 / ellipsoid_smith(&distribution->ellipsoid, w) - 1
					  : ndf_lambda(&distribution->ndf, w);
}

double distribution_G1(const struct distribution *distribution, struct vec3 w)
{
	return distribution->is_ellipsoid ? ellipsoid_G1(&distribution->ellipsoid, w) : ndf_G1(&distribution->ndf, w);
}

double distribution_visible_pdf(const struct distribution *distribution, struct vec3 wi, struct vec3 m)
{
	return distribution->is_ellipsoid ? ellipsoid_pdf(&distribution->ellipsoid, wi, m)
					  : vndf_pdf(&distribution->ndf, wi, m);
}

double distribution_weight(const struct distribution *distribution, enum gaf gaf, struct vec3 wi, struct vec3 m,
			   double pdf)
{
	if (!distribution->is_ellipsoid)
		return vndf_weight(&distribution->ndf, gaf, wi, m, pdf);
	const double cos_d = vec3_dot(wi, m);
	const struct vec3 wo = vec3_sub(vec3_scale(m, 2 * cos_d), wi);
	if (!(cos_d > 0 && wo.z > 0))
		return 0;
	return ellipsoid_G1(&distribution->ellipsoid, wi) * ellipsoid_G1(&distribution->ellipsoid, wo) *
	       ellipsoid_D(&distribution->ellipsoid, m) / pdf * cos_d / wi.z;
}

struct distribution_cdf distribution_cdf(const struct distribution *distribution, struct vec3 wi, double theta,
					 double phi)
{
	const double radians = M_PI / 180;
	struct distribution_cdf cdf = {NAN, NAN, NAN, NAN, NAN};
	if (distribution->is_ellipsoid)
		return cdf;
	const struct ndf *ndf = &distribution->ndf;
	cdf.phi = ndf_cdf_phi(ndf, phi * radians);
	cdf.theta = ndf_cdf_theta(ndf, theta * radians, phi * radians);
	cdf.joint = ndf_cdf(ndf, theta * radians, phi * radians);
	vndf_cdf(ndf, wi, vec3_from_spherical_deg(theta, phi), &cdf.along, &cdf.across);
	return cdf;
}

double distribution_moment(const struct distribution *distribution, double phi, int order)
{
	double moment = NAN;
	if (distribution->is_ellipsoid || ndf_moment(&distribution->ndf, phi, order, &moment) != STATUS_OK)
		return NAN;
	return moment;
}

double distribution_kurtosis(const struct distribution *distribution)
{
	double kurtosis = NAN;
	if (distribution->is_ellipsoid || ndf_excess_kurtosis(&distribution->ndf, &kurtosis) != STATUS_OK)
		return NAN;
	return kurtosis;
}

/* Samples */

struct vec3 distribution_direction(double theta_i, double phi_i)
{
	struct vec3 wi = vec3_from_spherical_deg(theta_i, phi_i);
	if (wi.z < 1e-100)
		wi.z = 1e-100;
	return wi;
}

enum status distribution_sampler_init(struct distribution_sampler *sampler, const struct distribution *distribution,
				      enum sampling sampling)
{
	sampler->distribution = distribution;
	if (distribution->is_ellipsoid)
		return sampling == SAMPLING_VISIBLE ? STATUS_OK : STATUS_UNSUPPORTED;
	return sampler_init(&sampler->sampler, &distribution->ndf, sampling);
}

struct vec3 distribution_sample(const struct distribution_sampler *sampler, struct vec3 wi, double u1, double u2)
{
	if (sampler->distribution->is_ellipsoid)
		return ellipsoid_sample(&sampler->distribution->ellipsoid, wi, u1, u2);
	return sampler_sample(&sampler->sampler, wi, u1, u2);
}

double distribution_pdf(const struct distribution_sampler *sampler, struct vec3 wi, struct vec3 m)
{
	if (sampler->distribution->is_ellipsoid)
		return ellipsoid_pdf(&sampler->distribution->ellipsoid, wi, m);
	return sampler_pdf(&sampler->sampler, wi, m);
}
