/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/within.h"
#include "fit/error/objective.h"

/* A variant: what it has. Bits of what makes a model richer, so that one variant lies inside another if its bits do. */
enum part {
	PART_DIFFUSE = 1 << 0,
	PART_SPECULAR = 1 << 1,
	PART_COLOUR = 1 << 2,          /* of kd, or of ks where it is alone */
	PART_COLOUR_SPECULAR = 1 << 3, /* of ks; not without the one before */
	PART_FRESNEL = 1 << 4,
	PART_AXES = 1 << 5, /* sigma_x, sigma_y and their angle */
	PARTS = 1 << 6
};

struct variant {
	unsigned parts;
	int ndf; /* index into the options' list */
};

static unsigned all_parts(const struct fit_options *options)
{
	const bool fresnel = options->specular && options->fresnel != FRESNEL_NONE;
	return (options->diffuse ? PART_DIFFUSE : 0u) | (options->specular ? PART_SPECULAR : 0u) |
	       (options->gray ? 0u : PART_COLOUR) |
	       (options->gray || options->gray_specular || !options->specular ? 0u : PART_COLOUR_SPECULAR) |
	       (fresnel ? PART_FRESNEL : 0u) | (options->anisotropic ? PART_AXES : 0u);
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

	if (!specular)
		return diffuse && v.ndf == 0 && !(v.parts & (PART_FRESNEL | PART_AXES | PART_COLOUR_SPECULAR));
	return diffuse ? colour || !colour_specular : colour == colour_specular;
}

static struct fit_options variant_options(const struct fit_options *options, struct variant v);

static bool is_variant(const struct fit_options *options, struct variant v)
{
	if ((v.parts & ~all_parts(options)) || !is_whole(v))
		return false;
	const struct fit_options own = variant_options(options, v);

	return term_list_of(&own).n > 0;
}

static int parameters(const struct fit_options *options, struct variant v)
{
	const int kd = v.parts & PART_COLOUR ? MERL_CHANNELS : 1,
		  ks = v.parts & PART_COLOUR_SPECULAR ? MERL_CHANNELS : 1;
	int n = v.parts & PART_DIFFUSE ? kd : 0;

	if (!(v.parts & PART_SPECULAR))
		return n;
	n += ks + (isnan(options->sigma) ? 1 : 0) + (has_free_gamma(options, v.ndf) ? 1 : 0);
	if (v.parts & PART_AXES)
		n += (isnan(options->sigma_y) ? 1 : 0) + (isnan(options->angle) ? 1 : 0) +
		     (ndf_has_tilt(options->ndf[v.ndf]) ? 2 : 0);
	if ((v.parts & PART_FRESNEL) && options->per_channel_ior && (v.parts & PART_COLOUR_SPECULAR))
		n += 2 * MERL_CHANNELS;
	else if (v.parts & PART_FRESNEL)
		n += (isnan(options->ior) ? 1 : 0) + (options->fresnel == FRESNEL_CONDUCTOR ? 1 : 0);
	return n;
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

static struct variants list_variants(const struct fit_options *options)
{
	struct variants list = {.n = 0};
	for (unsigned parts = 0; parts < PARTS; parts++) {
		for (int ndf = 0; ndf < options->n_ndf; ndf++) {
			const struct variant v = {parts, ndf};
			if (!is_variant(options, v))
				continue;
			int at = list.n++;
			for (; at > 0 && is_before(options, v, list.v[at - 1]); at--)
				list.v[at] = list.v[at - 1];
			list.v[at] = v;
		}
	}
	return list;
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
	if (o.specular && !(v.parts & PART_FRESNEL))
		o.fresnel = FRESNEL_NONE;
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

struct selection {
	const struct fit_context *context;
	const struct measurement *measurement;
	const struct fit_options *options;
	double limit;
	struct fit_options *chosen;
	struct fit_result *result;
	struct variants list; /* those that may still be chosen: untried and simpler than *chosen */
};

static enum status try_variant(struct selection *s, int i, struct error *error)
{
	const struct variant v = s->list.v[i];
	const struct fit_options o = variant_options(s->options, v);
	struct fit_result result;
	const enum status status = fit_run(s->context, s->measurement, &o, &result, error);
	if (status != STATUS_OK)
		return status;
	if (result.error <= s->limit) {
		*s->chosen = o;
		*s->result = result;
		s->list.n = i;
	} else {
		drop_inside(s->options, &s->list, v);
	}
	return STATUS_OK;
}

/* The point of a variant in the list; -1 if it is not there. */
static int find_variant(const struct variants *list, unsigned parts, int ndf)
{
	for (int i = 0; i < list->n; i++)
		if (list->v[i].parts == parts && list->v[i].ndf == ndf)
			return i;
	return -1;
}

/* Takes the whole model's results: the best one sets the limit, each of them is a variant tried. Returns the NDF that
 * holds the others, if there is one. */
static int take_whole(struct selection *s, const struct fit_result *whole, double percent)
{
	int best = 0, richest = 0;
	for (int i = 0; i < s->options->n_ndf; i++) {
		if (whole[i].error < whole[best].error)
			best = i;
		if (has_free_gamma(s->options, i))
			richest = i;
	}
	s->limit = whole[best].error * (1 + percent / 100);
	*s->chosen = variant_options(s->options, (struct variant){all_parts(s->options), best});
	*s->result = whole[best];
	for (int i = 0; i < s->options->n_ndf; i++) {
		const struct variant v = {all_parts(s->options), i};
		const int point = find_variant(&s->list, v.parts, i);
		if (point < 0)
			continue;
		if (whole[i].error > s->limit) {
			drop_inside(s->options, &s->list, v);
			continue;
		}
		*s->chosen = variant_options(s->options, v);
		*s->result = whole[i];
		s->list.n = point;
	}
	return richest;
}

/* Whether Lambert alone will do, found out before anything else is fitted in full: against an estimate of the best error,
 * of which the samples may be wrong by a few thousandths. Then it is the choice. */
static enum status try_lambert(struct selection *s, double percent, bool *chosen, struct error *error)
{
	double best;
	enum status status = fit_estimate(s->context, s->measurement, s->options, &best, NULL);
	*chosen = false;
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	if (isinf(best))
		return STATUS_OK;
	s->limit = best * (1 + percent / 100) * 0.997;
	for (int i = 0; i < s->list.n && !*chosen && status == STATUS_OK; i++) {
		const struct variant v = s->list.v[i];
		if (v.parts & PART_SPECULAR)
			continue;
		const struct fit_options o = variant_options(s->options, v);
		status = fit_run(s->context, s->measurement, &o, s->result, error);
		*chosen = status == STATUS_OK && s->result->error <= s->limit;
		if (*chosen)
			*s->chosen = o;
	}
	return status;
}

enum status within_run(const struct fit_context *context, const struct measurement *measurement,
		       const struct fit_options *options, double percent, struct fit_options *chosen,
		       struct fit_result *result, struct error *error)
{
	struct fit_result whole[FIT_NDFS_MAX];
	struct selection s = {.context = context,
			      .measurement = measurement,
			      .options = options,
			      .chosen = chosen,
			      .result = result,
			      .list = list_variants(options)};
	bool lambert = false;
	enum status status = options->specular ? try_lambert(&s, percent, &lambert, error) : STATUS_OK;
	if (status || lambert)
		return status;
	status = fit_run(context, measurement, options, whole, error);
	if (status != STATUS_OK)
		return status;
	const int richest = take_whole(&s, whole, percent);
	const unsigned all = all_parts(options);
	/* First the whole model less one part: where that fails, it spares all variants inside. Then the simplest. */
	for (unsigned part = 1; part < PARTS && status == STATUS_OK; part <<= 1) {
		const unsigned with_it = part == PART_COLOUR ? part | PART_COLOUR_SPECULAR : part;
		const int i = (part & all) ? find_variant(&s.list, all & ~with_it, richest) : -1;
		if (i >= 0)
			status = try_variant(&s, i, error);
	}
	while (s.list.n > 0 && status == STATUS_OK)
		status = try_variant(&s, 0, error);
	return status;
}
