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

enum { ALPHA_X, ALPHA_Y, THETA_X, THETA_Y, THETA_Z, TILT_X, TILT_Y, MATRIX, OF_ELLIPSOID = MATRIX + 9 };

static const char *const ellipsoid_params[OF_ELLIPSOID] = {[ALPHA_X] = "alpha_x",
							   [ALPHA_Y] = "alpha_y",
							   [THETA_X] = "theta_x",
							   [THETA_Y] = "theta_y",
							   [THETA_Z] = "theta_z",
							   [TILT_X] = "tilt_x",
							   [TILT_Y] = "tilt_y",
							   "A11",
							   "A12",
							   "A13",
							   "A21",
							   "A22",
							   "A23",
							   "A31",
							   "A32",
							   "A33"};

static bool is_of_ellipsoid(const char *name, const void *context)
{
	(void)context;
	return names_find(ellipsoid_params, OF_ELLIPSOID, name) >= 0;
}

/* How many of the values from one on are given. */
static int count_given(const double *value, int n)
{
	int count = 0;
	for (int i = 0; i < n; i++)
		count += !isnan(value[i]);
	return count;
}

static double or_zero(double x)
{
	return isnan(x) ? 0 : x;
}

static enum status ellipsoid_of_matrix(const double A[9], struct ndf *ndf)
{
	const double rows[3][3] = {{A[0], A[1], A[2]}, {A[3], A[4], A[5]}, {A[6], A[7], A[8]}};
	struct ellipsoid ellipsoid;
	const enum status status = ellipsoid_init(&ellipsoid, rows);
	return status == STATUS_OK ? ndf_from_ellipsoid(ndf, &ellipsoid) : status;
}

static enum status ellipsoid_of_angles(const double value[], struct ndf *ndf)
{
	const double radians = M_PI / 180;
	struct ellipsoid ellipsoid;
	const enum status status =
		ellipsoid_init_angles(&ellipsoid, value[ALPHA_X], value[ALPHA_Y], radians * or_zero(value[THETA_X]),
				      radians * or_zero(value[THETA_Y]), radians * or_zero(value[THETA_Z]));
	return status == STATUS_OK ? ndf_from_ellipsoid(ndf, &ellipsoid) : status;
}

static enum status ellipsoid_of_axes(const double value[], double angle, struct ndf *ndf)
{
	enum status status = ndf_init(ndf, ndf_find("ellipsoid"), value[ALPHA_X], value[ALPHA_Y], NAN);
	if (status == STATUS_OK)
		status = ndf_turn(ndf, or_zero(angle));
	return status == STATUS_OK ? ndf_tilt(ndf, or_zero(value[TILT_X]), or_zero(value[TILT_Y])) : status;
}

/* sigma and sigma_y stand for alpha_x and alpha_y. */
static enum status make_ellipsoid(const struct distribution_words *words, double sigma_x, double sigma_y, double angle,
				  struct ndf *ndf, struct error *error)
{
	double value[OF_ELLIPSOID];
	enum status status = check_params(words->params, is_of_ellipsoid, NULL, error);
	if (status != STATUS_OK)
		return status;
	for (int i = 0; i < OF_ELLIPSOID; i++) {
		value[i] = i == ALPHA_X ? sigma_x : i == ALPHA_Y ? sigma_y : NAN;
		if (given(words->params))
			(void)result_param(words->params, ellipsoid_params[i], &value[i]);
	}
	if (isnan(value[ALPHA_Y]))
		value[ALPHA_Y] = value[ALPHA_X];
	const int elements = count_given(value + MATRIX, 9), angles = count_given(value + THETA_X, 3),
		  others = count_given(value, MATRIX) + !isnan(angle);
	if (elements && (elements < 9 || others))
		return error_set(error, STATUS_DOMAIN,
				 "the ellipsoid needs A11 to A33, all nine, and nothing beside them");
	if (angles && (count_given(value + TILT_X, 2) || !isnan(angle)))
		return error_set(error, STATUS_DOMAIN,
				 "the ellipsoid takes theta_x, theta_y and theta_z, or an angle, tilt_x and tilt_y");
	if (!elements && (isnan(value[ALPHA_X]) || isnan(value[ALPHA_Y])))
		return error_set(error, STATUS_DOMAIN,
				 "the ellipsoid needs alpha_x and alpha_y, or sigma, or a matrix");
	status = elements ? ellipsoid_of_matrix(value + MATRIX, ndf)
		 : angles ? ellipsoid_of_angles(value, ndf)
			  : ellipsoid_of_axes(value, angle, ndf);
	return status != STATUS_OK ? does_not_take("ellipsoid", error) : STATUS_OK;
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

static enum status no_such_ndf(const char *name, struct error *error)
{
	char shown[TEXT_QUOTE_SIZE];
	const int near = nearest_word(name ? name : "", distribution_name_at, NULL);
	text_quote(name ? name : "", shown, sizeof shown);
	return error_set(error, STATUS_DOMAIN, "there is no NDF '%s'%s%s%s", shown, near < 0 ? "" : ": did you mean ",
			 near < 0 ? "" : distribution_name_at(NULL, near), near < 0 ? "" : "?");
}

static enum status make(const struct distribution_words *words, struct distribution *distribution, struct error *error)
{
	const struct ndf_class *class = ndf_find(words->name);
	struct ndf *ndf = &distribution->ndf;
	double sigma_x, sigma_y, gamma, angle;
	enum status status = number("sigma", words->sigma, NAN, &sigma_x, error);
	if (status == STATUS_OK)
		status = number("sigma_y", words->sigma_y, sigma_x, &sigma_y, error);
	if (status == STATUS_OK)
		status = number("gamma", words->gamma, NAN, &gamma, error);
	if (status == STATUS_OK)
		status = number("angle", words->angle, NAN, &angle, error);
	if (status != STATUS_OK)
		return status;
	if (!class)
		return no_such_ndf(words->name, error);
	distribution->name = ndf_name(class);
	if (given(words->nodes) && !ndf_is_tabulated(class))
		return error_set(error, STATUS_DOMAIN, "nodes are for pl, not for %s", ndf_name(class));
	if (ndf_has_tilt(class) && !isnan(gamma))
		status = error_set(error, STATUS_DOMAIN, "%s has no gamma", ndf_name(class));
	else if (ndf_has_tilt(class))
		status = make_ellipsoid(words, sigma_x, sigma_y, angle, ndf, error);
	else if (ndf_is_tabulated(class))
		status = make_pl(words, distribution, error);
	else
		status = make_class(words, class, sigma_x, sigma_y, gamma, ndf, error);
	if (status == STATUS_OK && !isnan(angle) && !ndf_has_tilt(class) && ndf_turn(ndf, angle) != STATUS_OK)
		status = error_set(error, STATUS_DOMAIN, "bad angle %g: expected a finite one", angle);
	return status != STATUS_OK ? status : set_lambda(words->lambda, ndf, error);
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

struct distribution_cdf distribution_cdf(const struct distribution *distribution, struct vec3 wi, double theta,
					 double phi)
{
	const double radians = M_PI / 180;
	const struct ndf *ndf = &distribution->ndf;
	struct distribution_cdf cdf = {.phi = ndf_cdf_phi(ndf, phi * radians),
				       .theta = ndf_cdf_theta(ndf, theta * radians, phi * radians),
				       .joint = ndf_cdf(ndf, theta * radians, phi * radians)};
	vndf_cdf(ndf, wi, vec3_from_spherical_deg(theta, phi), &cdf.along, &cdf.across);
	return cdf;
}

double distribution_moment(const struct distribution *distribution, double phi, int order)
{
	double moment = NAN;
	return ndf_moment(&distribution->ndf, phi, order, &moment) == STATUS_OK ? moment : NAN;
}

double distribution_kurtosis(const struct distribution *distribution)
{
	double kurtosis = NAN;
	return ndf_excess_kurtosis(&distribution->ndf, &kurtosis) == STATUS_OK ? kurtosis : NAN;
}

struct vec3 distribution_direction(double theta_i, double phi_i)
{
	struct vec3 wi = vec3_from_spherical_deg(theta_i, phi_i);
	if (wi.z < 1e-100)
		wi.z = 1e-100;
	return wi;
}
