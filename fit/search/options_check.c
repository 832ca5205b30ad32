/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/options_check.h"
#include "fit/error/objective.h"
#include <math.h>

/* An enum's value as a number: one that a caller has made up may be negative. */
static bool is_one_of(long value, long count)
{
	return value >= 0 && value < count;
}

static bool free_or_within(double value, double low, double high)
{
	return isnan(value) || (value >= low && value <= high);
}

enum status fit_criterion_check(const struct fit_options *options, struct error *error)
{
	const struct criterion *c = &options->criterion;

	if (!is_one_of((long)c->gaf, GAF_COUNT) || !is_one_of((long)c->weight, WEIGHT_COUNT) ||
	    !is_one_of((long)c->bins, BINS_COUNT))
		return error_set(error, STATUS_DOMAIN, "gaf, weight or bins is none of the known ones");
	if (!(c->max_theta > 0 && c->max_theta <= 90))
		return error_set(error, STATUS_DOMAIN, "expected max_theta in (0, 90], found %g", c->max_theta);
	if (options->threads < 1 || options->threads > FIT_THREADS_MAX)
		return error_set(error, STATUS_DOMAIN, "expected threads in 1 .. %d, found %d", FIT_THREADS_MAX,
				 options->threads);
	return STATUS_OK;
}

static enum status check_ndfs(const struct fit_options *o, struct error *error)
{
	if (o->n_ndf < 1 || o->n_ndf > FIT_NDFS_MAX)
		return error_set(error, STATUS_DOMAIN, "expected 1 .. %d NDFs, found %d", FIT_NDFS_MAX, o->n_ndf);
	for (int n = 0; n < o->n_ndf; n++)
		if (!o->ndf[n])
			return error_set(error, STATUS_DOMAIN, "NDF number %d is NULL", n);
	return STATUS_OK;
}

static enum status check_ranges(const struct fit_options *o, struct error *error)
{
	enum status status = fit_criterion_check(o, error);

	if (status == STATUS_OK)
		status = check_ndfs(o, error);
	if (status != STATUS_OK)
		return status;
	if (!is_one_of((long)o->fresnel, FRESNEL_COUNT) || !is_one_of((long)o->lambda, LAMBDA_FORM_COUNT))
		return error_set(error, STATUS_DOMAIN, "fresnel or lambda is none of the known ones");
	if (!(o->blend >= 0 && o->blend < 1))
		return error_set(error, STATUS_DOMAIN, "expected blend in [0, 1), found %g", o->blend);
	if (!free_or_within(o->sigma, FIT_SIGMA_MIN, FIT_SIGMA_MAX))
		return error_set(error, STATUS_DOMAIN, "expected sigma in [%g, %g], found %g", FIT_SIGMA_MIN,
				 FIT_SIGMA_MAX, o->sigma);
	if (!free_or_within(o->sigma_y, FIT_SIGMA_MIN, FIT_SIGMA_MAX))
		return error_set(error, STATUS_DOMAIN, "expected sigma_y in [%g, %g], found %g", FIT_SIGMA_MIN,
				 FIT_SIGMA_MAX, o->sigma_y);
	if (isinf(o->angle))
		return error_set(error, STATUS_DOMAIN, "expected a finite angle, found %g", o->angle);
	if (!free_or_within(o->ior, fit_ior_min(o->fresnel), FIT_IOR_MAX))
		return error_set(error, STATUS_DOMAIN, "expected ior in [%g, %g], found %g", fit_ior_min(o->fresnel),
				 FIT_IOR_MAX, o->ior);
	if (o->gamma <= 0)
		return error_set(error, STATUS_DOMAIN, "expected gamma above 0, found %g", o->gamma);
	if (!free_or_within(o->grazing_exponent, FIT_GRAZING_MIN, FIT_GRAZING_MAX))
		return error_set(error, STATUS_DOMAIN, "expected exponent in [%g, %g], found %g", FIT_GRAZING_MIN,
				 FIT_GRAZING_MAX, o->grazing_exponent);
	if (o->lobes < 1 || o->lobes > 2)
		return error_set(error, STATUS_DOMAIN, "expected 1 or 2 lobes, found %d", o->lobes);
	if (o->starts < 0 || o->starts > FIT_STARTS_MAX)
		return error_set(error, STATUS_DOMAIN, "expected starts in 0 .. %d, found %d", FIT_STARTS_MAX,
				 o->starts);
	if (!(o->time_s > 0 && o->time_s <= FIT_TIME_MAX_S))
		return error_set(error, STATUS_DOMAIN, "expected time_s in (0, %g], found %g", FIT_TIME_MAX_S,
				 o->time_s);
	return STATUS_OK;
}

/* Whether an NDF takes the fixed gamma, exactly or in the chosen form of Lambda. */
static bool takes_gamma(const struct fit_options *o, const struct ndf_class *class)
{
	const struct shape shape = {.sigma = 0.1, .gamma = o->gamma};
	struct ndf ndf;

	return isnan(o->gamma) || !ndf_has_gamma(class) || shape_ndf(&shape, class, o->lambda, &ndf) == STATUS_OK;
}

/* Why these options make no anisotropic fit; NULL: they do, or ask for none. */
static const char *anisotropic_fault(const struct fit_options *o)
{
	if (!o->anisotropic)
		return isnan(o->sigma_y) && isnan(o->angle) ? NULL
							    : "sigma_y and angle are those of an anisotropic fit";
	if (!o->specular)
		return "an anisotropic fit needs a specular term";
	if (o->algorithm)
		return "an anisotropic fit needs the default algorithm";
	if (isnan(o->sigma) != isnan(o->sigma_y))
		return "an anisotropic fit fixes both roughnesses or none";
	if (o->sigma > FIT_RATIO_MAX * o->sigma_y || o->sigma_y > FIT_RATIO_MAX * o->sigma)
		return "sigma_x and sigma_y are too far apart";
	return NULL;
}

static bool keeps_anisotropic_rule(const struct fit_options *o, struct error *error)
{
	const char *fault = anisotropic_fault(o);

	for (int n = 0; n < o->n_ndf && o->anisotropic && !fault; n++)
		if (!ndf_has_anisotropy(o->ndf[n])) {
			error_set(error, STATUS_DOMAIN, "%s has one roughness: it cannot be anisotropic",
				  ndf_name(o->ndf[n]));
			return false;
		}
	if (fault)
		error_set(error, STATUS_DOMAIN, "%s", fault);
	return !fault;
}

/* Whether a model of more terms than two can be fitted. */
static bool keeps_richer_rule(const struct fit_options *o, struct error *error)
{
	const bool f82 = o->fresnel == FRESNEL_F82, richer = f82 || o->grazing || o->lobes > 1;
	const char *fault = NULL;

	if (!richer)
		return true;
	if (o->grazing && !o->diffuse)
		fault = "a burley term needs a diffuse one";
	else if (term_list_of(o).n == 0)
		fault = "too many terms: a second lobe goes without f82";
	else if (o->algorithm)
		fault = "f82, a second lobe and a burley term need the default algorithm";
	else if (o->lobes > 1 && (o->anisotropic || !o->specular || !isnan(o->sigma) || !isnan(o->gamma)))
		fault = "two lobes need a specular term, isotropic, with free sigma and gamma";
	else if (o->lobes > 1 && o->lambda != LAMBDA_EXACT)
		fault = "two lobes need the exact form of Lambda";
	for (int n = 0; n < o->n_ndf && !fault; n++)
		if (ndf_is_tabulated(o->ndf[n]))
			fault = "pl goes with a diffuse term and one lobe only";
	if (fault)
		error_set(error, STATUS_DOMAIN, "%s", fault);
	return !fault;
}

/* Whether each channel can have an index of its own. */
static bool keeps_index_rule(const struct fit_options *o, struct error *error)
{
	const char *fault = NULL;

	if (!o->per_channel_ior)
		return true;
	if (o->fresnel != FRESNEL_CONDUCTOR || !o->specular)
		fault = "an index for each channel needs a specular term with F conductor";
	else if (!isnan(o->ior))
		fault = "an index for each channel goes without a fixed one";
	else if (o->gray)
		fault = "an index for each channel goes without gray";
	else if (o->grazing || o->lobes > 1 || o->anisotropic)
		fault = "an index for each channel goes with one isotropic lobe beside Lambert's term";
	else if (o->algorithm)
		fault = "an index for each channel needs the default algorithm";
	for (int n = 0; n < o->n_ndf && !fault; n++)
		if (ndf_is_tabulated(o->ndf[n]))
			fault = "pl has one index for all channels";
	if (fault)
		error_set(error, STATUS_DOMAIN, "%s", fault);
	return !fault;
}

enum fit_rule fit_options_rule(const struct fit_options *o, struct error *error)
{
	if (check_ranges(o, error) != STATUS_OK)
		return FIT_RULE_RANGE;
	if (!o->diffuse && !o->specular) {
		error_set(error, STATUS_DOMAIN, "neither a diffuse nor a specular term: nothing to fit");
		return FIT_RULE_TERMS;
	}
	if (o->blend > 0 && o->unbounded) {
		error_set(error, STATUS_DOMAIN, "blend and unbounded exclude each other");
		return FIT_RULE_BLEND;
	}
	if (!keeps_anisotropic_rule(o, error))
		return FIT_RULE_ANISOTROPIC;
	if (!keeps_index_rule(o, error))
		return FIT_RULE_RICHER;
	if (!keeps_richer_rule(o, error))
		return FIT_RULE_RICHER;
	for (int n = 0; n < o->n_ndf; n++) {
		if (ndf_is_tabulated(o->ndf[n]) && (!o->specular || o->algorithm)) {
			error_set(error, STATUS_DOMAIN, "%s needs a specular term and the default algorithm",
				  ndf_name(o->ndf[n]));
			return FIT_RULE_TABULATED;
		}
		if (!takes_gamma(o, o->ndf[n])) {
			error_set(error, STATUS_DOMAIN, "gamma %g: %s with lambda %s does not take it", o->gamma,
				  ndf_name(o->ndf[n]), lambda_form_name(o->lambda));
			return FIT_RULE_GAMMA;
		}
	}
	return FIT_RULE_KEPT;
}

enum status fit_options_check(const struct fit_options *options, struct error *error)
{
	return fit_options_rule(options, error) == FIT_RULE_KEPT ? STATUS_OK : STATUS_DOMAIN;
}
