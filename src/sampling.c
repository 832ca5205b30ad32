/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/sampling.h"
#include "src/names.h"
#include "src/vndf.h"

static const char *const sampling_names[SAMPLING_COUNT] = {"visible", "ndf", "pseudo", "rational"};

const char *sampling_name(enum sampling sampling)
{
	return names_at(sampling_names, SAMPLING_COUNT, (int)sampling);
}

enum status sampling_find(const char *name, enum sampling *sampling)
{
	const int i = names_find(sampling_names, SAMPLING_COUNT, name);
	if (i < 0)
		return STATUS_DOMAIN;
	*sampling = (enum sampling)i;
	return STATUS_OK;
}

static bool supports(const struct ndf *ndf, enum sampling sampling)
{
	return sampling == SAMPLING_NDF ||
	       (sampling == SAMPLING_RATIONAL ? vndf_rational_supports(ndf) : vndf_supports(ndf));
}

enum status sampler_init(struct sampler *sampler, const struct ndf *ndf, enum sampling sampling)
{
	struct vndf_pseudo pseudo = {*ndf, sampling == SAMPLING_VISIBLE};
	if (!supports(ndf, sampling) || (sampling == SAMPLING_PSEUDO && vndf_pseudo_init(&pseudo, ndf) != STATUS_OK))
		return STATUS_UNSUPPORTED;
	*sampler = (struct sampler){pseudo.proposal, sampling == SAMPLING_RATIONAL ? SAMPLING_RATIONAL
						     : pseudo.visible              ? SAMPLING_VISIBLE
										   : SAMPLING_NDF};
	sampler->proposal.lambda_form = LAMBDA_EXACT;
	return STATUS_OK;
}

enum sampling sampler_init_near(struct sampler *sampler, const struct ndf *ndf, enum sampling sampling)
{
	const enum sampling in_turn[] = {sampling, SAMPLING_VISIBLE, SAMPLING_NDF};
	int n = 0;
	while (sampler_init(sampler, ndf, in_turn[n]) != STATUS_OK)
		n++; /* all normals of any distribution can be drawn */
	return in_turn[n];
}

struct vec3 sampler_sample(const struct sampler *sampler, struct vec3 wi, double u1, double u2)
{
	const struct ndf *ndf = &sampler->proposal;
	if (sampler->procedure == SAMPLING_RATIONAL)
		return vndf_rational_sample(ndf, wi, u1, u2);
	return sampler->procedure == SAMPLING_NDF ? ndf_sample(ndf, u1, u2) : vndf_sample(ndf, wi, u1, u2);
}

double sampler_pdf(const struct sampler *sampler, struct vec3 wi, struct vec3 m)
{
	const struct ndf *ndf = &sampler->proposal;
	if (sampler->procedure == SAMPLING_RATIONAL)
		return vndf_rational_pdf(ndf, wi, m);
	return sampler->procedure == SAMPLING_NDF ? ndf_pdf(ndf, m) : vndf_pdf(ndf, wi, m);
}
