/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/within.h"
#include "fit/search/ladder.h"
#include "fit/search/options_check.h"
#include "fit/search/second_lobe.h"
#include <stdlib.h>

/* A variant: what it has. Bits of what makes a model richer, so that one variant lies inside another if its bits do. */
enum part {
	PART_DIFFUSE = 1 << 0,
	PART_SPECULAR = 1 << 1,
	PART_COLOUR = 1 << 2,          /* of kd, or of ks where it is alone */
	PART_COLOUR_SPECULAR = 1 << 3, /* of ks; not without the one before */
	PART_FRESNEL = 1 << 4,
	PART_AXES = 1 << 5, /* sigma_x, sigma_y and their angle */
	PART_GRAZING = 1 << 6,
	PART_F82 = 1 << 7, /* in the place of PART_FRESNEL, which does not lie inside it */
	PART_SECOND = 1 << 8,
	PARTS = 1 << 9
};

struct variant {
	unsigned parts;
	int ndf; /* index into the options' list */
};

/* What a model as it was asked for has. */
static unsigned asked_parts(const struct fit_options *options)
{
	const bool specular = options->specular, f82 = options->fresnel == FRESNEL_F82;

	return (options->diffuse ? PART_DIFFUSE : 0u) | (specular ? PART_SPECULAR : 0u) |
	       (options->gray ? 0u : PART_COLOUR) |
	       (options->gray || options->gray_specular || !specular ? 0u : PART_COLOUR_SPECULAR) |
	       (specular && fresnel_has_ior(options->fresnel) ? PART_FRESNEL : 0u) | (specular && f82 ? PART_F82 : 0u) |
	       (options->anisotropic ? PART_AXES : 0u) | (options->grazing ? PART_GRAZING : 0u) |
	       (specular && options->lobes > 1 ? PART_SECOND : 0u);
}

/* What a model of the family may have. */
static unsigned family_parts(const struct fit_options *options, unsigned richer)
{
	return asked_parts(options) | (richer & WITHIN_BURLEY ? PART_GRAZING : 0u) |
	       (richer & WITHIN_F82 ? PART_F82 : 0u) | (richer & WITHIN_TWO_LOBES ? PART_SECOND : 0u);
}

/* The shape's free parameters that an NDF has besides sigma. */
static bool has_free_gamma(const struct fit_options *options, int ndf)
{
	return ndf_has_gamma(options->ndf[ndf]) && isnan(options->gamma);
}

/* A lobe alone is gray or coloured; without one there is nothing to tell NDFs or Fresnel terms apart. */
static bool is_whole(struct variant v)
{
	const bool diffuse = v.parts & PART_DIFFUSE, specular = v.parts & PART_SPECULAR;
	const bool colour = v.parts & PART_COLOUR, colour_specular = v.parts & PART_COLOUR_SPECULAR;

	if ((v.parts & PART_GRAZING && !diffuse) || (v.parts & PART_FRESNEL && v.parts & PART_F82))
		return false;
	if (!specular)
		return diffuse && v.ndf == 0 &&
		       !(v.parts & (PART_FRESNEL | PART_AXES | PART_COLOUR_SPECULAR | PART_F82 | PART_SECOND));
	return diffuse ? colour || !colour_specular : colour == colour_specular;
}

static struct fit_options variant_options(const struct fit_options *options, struct variant v);

static bool is_variant(const struct fit_options *options, unsigned family, struct variant v)
{
	struct error why;

	if ((v.parts & ~family) || !is_whole(v))
		return false;
	const struct fit_options own = variant_options(options, v);

	return fit_options_rule(&own, &why) == FIT_RULE_KEPT;
}

static int parameters(const struct fit_options *options, struct variant v)
{
	const struct fit_options own = variant_options(options, v);

	return ladder_parameters(&own);
}

/* Whether each model of `inner` is one of `outer`. Fresnel's term goes to a constant as the index grows. */
static bool is_inside(const struct fit_options *options, struct variant inner, struct variant outer)
{
	if (inner.parts & ~outer.parts)
		return false;
	return !(inner.parts & PART_SPECULAR) || inner.ndf == outer.ndf || has_free_gamma(options, outer.ndf);
}

/* Order of trial: fewest parameters first, then the terms that stay. */
static bool is_before(const struct fit_options *options, struct variant a, struct variant b)
{
	const int n_a = parameters(options, a), n_b = parameters(options, b);
	if (n_a != n_b)
		return n_a < n_b;
	return a.parts != b.parts ? a.parts > b.parts : a.ndf < b.ndf;
}

enum { VARIANTS_MAX = PARTS * FIT_NDFS_MAX };

struct variants {
	struct variant v[VARIANTS_MAX];
	int n;
};

static void list_variants(const struct fit_options *options, unsigned family, struct variants *list)
{
	list->n = 0;
	for (unsigned parts = 0; parts < PARTS; parts++) {
		for (int ndf = 0; ndf < options->n_ndf; ndf++) {
			const struct variant v = {parts, ndf};

			if (!is_variant(options, family, v))
				continue;
			int at = list->n++;

			for (; at > 0 && is_before(options, v, list->v[at - 1]); at--)
				list->v[at] = list->v[at - 1];
			list->v[at] = v;
		}
	}
}

static struct fit_options variant_options(const struct fit_options *options, struct variant v)
{
	struct fit_options o = *options;
	o.ndf[0] = options->ndf[v.ndf];
	o.n_ndf = 1;
	o.diffuse = v.parts & PART_DIFFUSE;
	o.specular = v.parts & PART_SPECULAR;
	o.gray = !(v.parts & PART_COLOUR);
	o.gray_specular = o.specular && !o.gray && !(v.parts & PART_COLOUR_SPECULAR);
	if (!(v.parts & PART_AXES)) {
		o.anisotropic = false;
		o.sigma = isnan(o.sigma_y) ? o.sigma : NAN;
		o.sigma_y = o.angle = NAN;
	}
	if (o.specular)
		o.fresnel = v.parts & PART_F82 ? FRESNEL_F82 : v.parts & PART_FRESNEL ? o.fresnel : FRESNEL_NONE;
	else if (o.fresnel == FRESNEL_F82)
		o.fresnel = FRESNEL_NONE;
	o.grazing = v.parts & PART_GRAZING;
	o.lobes = v.parts & PART_SECOND ? 2 : 1;
	/* Where ks has no colour, n and k have none. */
	o.per_channel_ior &= o.fresnel == FRESNEL_CONDUCTOR && (v.parts & PART_COLOUR_SPECULAR);
	return o;
}

/* Drops what lies inside a variant that was not good enough. */
static void drop_inside(const struct fit_options *options, struct variants *list, struct variant failed)
{
	int kept = 0;
	for (int i = 0; i < list->n; i++)
		if (!is_inside(options, list->v[i], failed))
			list->v[kept++] = list->v[i];
	list->n = kept;
}

/* The place of a variant in the list; -1 if it is not there. */
static int find_variant(const struct variants *list, unsigned parts, int ndf)
{
	for (int i = 0; i < list->n; i++)
		if (list->v[i].parts == parts && list->v[i].ndf == ndf)
			return i;
	return -1;
}

/* What is known of a variant. */
struct known {
	bool estimated, fitted;
	double estimate; /* of E; NaN: there is none */
	struct shape shape;
	struct fit_result result;
};

struct selection {
	const struct fit_context *context;
	const struct measurement *measurement;
	const struct fit_options *options;
	double percent;
	struct multiresolution samples;
	struct known *known[PARTS][FIT_NDFS_MAX]; /* of what has been looked at */
	struct variants all;
	struct variants list; /* those that may still be chosen */
	double best;          /* least E of the family: an estimate, or exact */
	bool exact;
	bool has_best; /* the variant of the exact one */
	struct variant best_variant;
};

static struct known *known_of(struct selection *s, struct variant v)
{
	struct known **at = &s->known[v.parts][v.ndf];

	if (!*at)
		*at = calloc(1, sizeof **at);
	return *at;
}

static enum status fit_variant(struct selection *s, struct variant v, const struct known **fitted, struct error *error)
{
	const struct fit_options o = variant_options(s->options, v);
	struct known *k = known_of(s, v);

	if (!k)
		return error_set(error, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	*fitted = k;
	if (k->fitted)
		return STATUS_OK;
	const enum status status = fit_run(s->context, s->measurement, &o, &k->result, error);

	k->fitted = status == STATUS_OK;
	return status;
}

/* Starts of the second lobe that an estimate takes. */
enum { LOBE_STARTS = 6 };

static enum status estimate_variant(struct selection *s, struct variant v, struct known **estimated);

/* The estimate of a richer variant, from what a simpler one ends with. */
static enum status estimate_richer(struct selection *s, const struct fit_options *o, struct variant simpler,
				   struct known *k)
{
	struct shape start[1 + LOBE_STARTS];
	struct known *from;
	long evaluations = 0;
	int n = 1;
	enum status status = estimate_variant(s, simpler, &from);

	if (status != STATUS_OK)
		return status;
	start[0] = from->shape;
	start[0].grazing = isnan(o->grazing_exponent) ? 5 : o->grazing_exponent;
	if (o->lobes > 1)
		n = second_lobe_starts(&s->samples, o, o->ndf[0], &start[0], start, LOBE_STARTS, &evaluations, &status);
	if (status == STATUS_OK)
		status = search_estimate(&s->samples, o, o->ndf[0], start, n, &k->shape, &k->estimate);
	if (status == STATUS_OK && !(k->estimate < from->estimate)) {
		k->estimate = from->estimate;
		k->shape = from->shape;
	}
	return status;
}

/* Whether the least E of a variant can be estimated: forms of Lambda that exist at some gammas only have no space to
 * search. */
static bool has_estimate(const struct fit_options *o)
{
	return !(o->specular && isnan(o->gamma) && (o->lambda == LAMBDA_INTEGER || o->lambda == LAMBDA_HALF_INTEGER) &&
		 ndf_has_lambda_forms(o->ndf[0]));
}

static enum status estimate_variant(struct selection *s, struct variant v, struct known **estimated)
{
	const struct fit_options o = variant_options(s->options, v);
	struct known *k = known_of(s, v);
	struct variant simpler = v;
	enum status status = STATUS_OK;

	*estimated = k;
	if (!k || k->estimated)
		return k ? STATUS_OK : STATUS_NO_MEMORY;
	if (v.parts & PART_SECOND)
		simpler.parts &= ~(unsigned)PART_SECOND;
	else if (v.parts & PART_SPECULAR)
		simpler.parts &= ~(unsigned)PART_GRAZING;
	if (!has_estimate(&o))
		k->estimate = NAN;
	else if (simpler.parts != v.parts)
		status = estimate_richer(s, &o, simpler, k);
	else
		status = search_estimate(&s->samples, &o, o.ndf[0], NULL, 0, &k->shape, &k->estimate);
	k->estimated = status == STATUS_OK;
	return status;
}

/* Estimates of a variant and of the best one are of the same samples. What a search of these misses of one that goes
 * on to the full table. */
#define MISSED 1.01
/* By how much the estimate of the best may be wrong. */
#define UNSURE 0.003

/* Whether a variant is out of the question; then all inside it are, too. */
static enum status rule_out(struct selection *s, struct variant v, bool *out, struct error *error)
{
	struct known *k;
	const enum status status = estimate_variant(s, v, &k);

	*out = false;
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	*out = k->estimate > s->best * (1 + s->percent / 100) * MISSED;
	if (*out)
		drop_inside(s->options, &s->list, v);
	return STATUS_OK;
}

/* Whether no other variant has v inside. */
static bool is_richest(const struct selection *s, struct variant v)
{
	for (int i = 0; i < s->all.n; i++) {
		const struct variant other = s->all.v[i];
		const bool same = other.parts == v.parts && other.ndf == v.ndf;

		if (!same && is_inside(s->options, v, other) && !is_inside(s->options, other, v))
			return false;
	}
	return true;
}

/* The best of the family, by an estimate of each of the richest. */
static enum status estimate_best(struct selection *s, struct error *error)
{
	s->best = INFINITY;
	for (int i = 0; i < s->all.n; i++) {
		struct known *k;

		if (!is_richest(s, s->all.v[i]))
			continue;
		const enum status status = estimate_variant(s, s->all.v[i], &k);

		if (status != STATUS_OK)
			return error_set(error, status, "%s", status_str(status));
		s->best = fmin(s->best, isnan(k->estimate) ? 0 : k->estimate);
	}
	return STATUS_OK;
}

/* The same by fits, of those that may be the best. */
static enum status find_best(struct selection *s, struct error *error)
{
	const double enough = s->best * MISSED;
	enum status status = STATUS_OK;

	s->best = INFINITY;
	s->exact = true;
	for (int i = 0; i < s->all.n && status == STATUS_OK; i++) {
		const struct variant v = s->all.v[i];
		const struct known *fitted;

		if (!is_richest(s, v) || (enough > 0 && s->known[v.parts][v.ndf]->estimate > enough))
			continue;
		status = fit_variant(s, v, &fitted, error);
		if (status == STATUS_OK && fitted->result.error < s->best) {
			s->best = fitted->result.error;
			s->best_variant = v;
			s->has_best = true;
		}
	}
	return status;
}

/* Whether an E is within the limit. Where an estimate of the best does not tell, the best is fitted. */
static enum status is_within(struct selection *s, double E, bool *within, struct error *error)
{
	const double limit = s->best * (1 + s->percent / 100);
	enum status status = STATUS_OK;

	if (!s->exact && E > limit * (1 - UNSURE) && !(limit > 0 && E > limit * (1 + UNSURE)))
		status = find_best(s, error);
	*within = status == STATUS_OK && E <= s->best * (1 + s->percent / 100);
	return status;
}

/* The model without anything richer than what was asked for, and that less one part: where it fails, it spares all
 * inside. */
static enum status prune(struct selection *s, struct error *error)
{
	static const unsigned richer = PART_GRAZING | PART_F82 | PART_SECOND;
	const unsigned asked = asked_parts(s->options);
	const unsigned whole = asked & PART_F82 ? asked & ~(unsigned)(PART_GRAZING | PART_SECOND) : asked & ~richer;
	int ndf = 0;
	bool out;
	enum status status;

	for (int i = 0; i < s->options->n_ndf; i++)
		ndf = has_free_gamma(s->options, i) ? i : ndf;
	if (find_variant(&s->list, whole, ndf) < 0)
		return STATUS_OK;
	status = rule_out(s, (struct variant){whole, ndf}, &out, error);
	for (unsigned part = 1; part < PARTS && status == STATUS_OK; part <<= 1) {
		const unsigned with_it = part == PART_COLOUR ? part | PART_COLOUR_SPECULAR : part;
		const struct variant less = {whole & ~with_it, ndf};

		if ((part & whole) && find_variant(&s->list, less.parts, ndf) >= 0)
			status = rule_out(s, less, &out, error);
	}
	/* What is gray, all at once. */
	for (int i = 0; i < s->all.n && status == STATUS_OK; i++) {
		struct variant gray = s->all.v[i];

		if (!is_richest(s, gray) || !(gray.parts & PART_COLOUR))
			continue;
		gray.parts &= ~(unsigned)(PART_COLOUR | PART_COLOUR_SPECULAR);
		if (find_variant(&s->list, gray.parts, gray.ndf) >= 0)
			status = rule_out(s, gray, &out, error);
	}
	return status;
}

/* Tries the simplest variant that is left. */
static enum status try_first(struct selection *s, const struct known **chosen, struct error *error)
{
	const struct variant v = s->list.v[0];
	const struct known *fitted;
	bool out, within;
	enum status status = rule_out(s, v, &out, error);

	if (status != STATUS_OK || out)
		return status;
	status = fit_variant(s, v, &fitted, error);
	if (status == STATUS_OK)
		status = is_within(s, fitted->result.error, &within, error);
	if (status != STATUS_OK)
		return status;
	if (within)
		*chosen = fitted;
	else
		drop_inside(s->options, &s->list, v);
	return STATUS_OK;
}

static enum status choose(struct selection *s, struct fit_options *chosen, struct fit_result *result,
			  struct error *error)
{
	const struct known *found = NULL;
	struct variant variant = {0, 0};
	enum status status = estimate_best(s, error);

	if (status == STATUS_OK && s->best == 0)
		status = find_best(s, error);
	/* Lambert alone first: where it will do, nothing else is looked at. */
	for (int i = 0; i < s->all.n && !found && status == STATUS_OK; i++)
		if (!(s->all.v[i].parts & (PART_SPECULAR | PART_GRAZING)) &&
		    find_variant(&s->list, s->all.v[i].parts, s->all.v[i].ndf) == 0) {
			variant = s->list.v[0];
			status = try_first(s, &found, error);
		}
	if (!found && status == STATUS_OK)
		status = prune(s, error);
	while (!found && s->list.n > 0 && status == STATUS_OK) {
		variant = s->list.v[0];
		status = try_first(s, &found, error);
	}
	if (!found && status == STATUS_OK && !s->has_best)
		status = find_best(s, error);
	if (!found && status == STATUS_OK) {
		variant = s->best_variant;
		status = fit_variant(s, variant, &found, error);
	}
	if (status != STATUS_OK)
		return status;
	*chosen = variant_options(s->options, variant);
	*result = found->result;
	return STATUS_OK;
}

enum status within_run(const struct fit_context *context, const struct measurement *measurement,
		       const struct fit_options *options, unsigned richer, double percent, struct fit_options *chosen,
		       struct fit_result *result, struct error *error)
{
	const struct fit_options asked = *options; /* *chosen may be the same */
	struct selection *s = calloc(1, sizeof *s);
	enum status status;

	if (!s)
		return error_set(error, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
	s->context = context;
	s->measurement = measurement;
	s->options = &asked;
	s->percent = percent;
	status = fit_samples_of(context, measurement, options, &s->samples, error);
	if (status == STATUS_OK) {
		list_variants(&asked, family_parts(&asked, richer), &s->all);
		s->list = s->all;
		status = choose(s, chosen, result, error);
		multiresolution_free(&s->samples);
	}
	for (int parts = 0; parts < PARTS; parts++)
		for (int n = 0; n < FIT_NDFS_MAX; n++)
			free(s->known[parts][n]);
	free(s);
	return status;
}
