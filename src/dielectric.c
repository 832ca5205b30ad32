/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/dielectric.h"
#include "src/vndf.h"

bool dielectric_takes(double n)
{
	return n >= 1.0 / DIELECTRIC_INDEX_MAX && n <= DIELECTRIC_INDEX_MAX && n != 1.0;
}

enum status dielectric_init(struct dielectric *dielectric, const struct ndf *ndf, enum gaf gaf, double n)
{
	if (!dielectric_takes(n))
		return STATUS_DOMAIN;
	if (gaf == GAF_V_GROOVE)
		return STATUS_UNSUPPORTED;
	const struct cook_torrance above = {.ndf = *ndf, .gaf = gaf, .fresnel = FRESNEL_DIELECTRIC, .n = n};
	dielectric->side[0] = dielectric->side[1] = above;
	dielectric->side[1].n = 1.0 / n;
	return STATUS_OK;
}

/* The model on the side of *wi, which is brought above, and *wo with it. */
static const struct cook_torrance *side_of(const struct dielectric *dielectric, struct vec3 *wi, struct vec3 *wo)
{
	const bool below = wi->z < 0.0;
	if (below) {
		*wi = vec3_opposite(*wi);
		*wo = vec3_opposite(*wo);
	}
	return &dielectric->side[below];
}

/* With g^2 = n^2 - s^2 as for Fresnel's formulas, n wo = (c - g) m - wi. */
bool dielectric_refract(struct vec3 wi, struct vec3 m, double n, struct vec3 *wo)
{
	const double c = vec3_dot(wi, m);
	const double g2 = (n - 1.0) * (n + 1.0) + c * c;
	if (!(g2 >= 0.0))
		return false;
	*wo = vec3_unit(vec3_sub(vec3_scale(m, c - sqrt(g2)), wi));
	return true;
}

struct dielectric_half dielectric_half(struct vec3 wi, struct vec3 wo, double n)
{
	const struct vec3 sum = vec3_add(wi, vec3_scale(wo, n));
	const double length = vec3_length(sum);
	const struct vec3 m = vec3_scale(sum, copysign(1.0, sum.z) / length);
	return (struct dielectric_half){m, vec3_dot(wi, m) > 0.0 && vec3_dot(wo, m) < 0.0 ? length : 0.0};
}

double dielectric_jacobian(const struct dielectric_half *half, struct vec3 wo, double n)
{
	const double ratio = n / half->length;
	return ratio * ratio * -vec3_dot(wo, half->m);
}

static double transmitted_f(const struct cook_torrance *side, struct vec3 wi, struct vec3 wo)
{
	const struct dielectric_half half = dielectric_half(wi, wo, side->n);
	if (half.length == 0.0)
		return 0.0;
	const double cos_d = vec3_dot(wi, half.m);
	const double G =
		gaf_smith_through(side->gaf, ndf_lambda(&side->ndf, wi), ndf_lambda(&side->ndf, vec3_opposite(wo)));
	return (1.0 - fresnel_dielectric(cos_d, side->n)) * ndf_D(&side->ndf, half.m) * (cos_d / wi.z) *
	       (dielectric_jacobian(&half, wo, side->n) * G / -wo.z);
}

double dielectric_f(const struct dielectric *dielectric, struct vec3 wi, struct vec3 wo)
{
	const struct cook_torrance *side = side_of(dielectric, &wi, &wo);
	if (wi.z > 0.0 && wo.z < 0.0)
		return transmitted_f(side, wi, wo);
	return cook_torrance_lobe(side, wi, wo);
}

static double facet_pdf(const struct ndf *ndf, enum sampling sampling, struct vec3 wi, struct vec3 m)
{
	struct sampler sampler;
	if (sampling == SAMPLING_VISIBLE)
		return vndf_pdf(ndf, wi, m);
	if (sampling == SAMPLING_NDF)
		return ndf_pdf(ndf, m);
	return sampler_init(&sampler, ndf, sampling) == STATUS_OK ? sampler_pdf(&sampler, wi, m) : NAN;
}

static struct vec3 facet_sample(const struct ndf *ndf, enum sampling sampling, struct vec3 wi, const double u[2])
{
	struct sampler sampler;
	if (sampling == SAMPLING_VISIBLE)
		return vndf_sample(ndf, wi, u[0], u[1]);
	if (sampling == SAMPLING_NDF)
		return ndf_sample(ndf, u[0], u[1]);
	if (sampler_init(&sampler, ndf, sampling) != STATUS_OK)
		return (struct vec3){NAN, NAN, NAN};
	return sampler_sample(&sampler, wi, u[0], u[1]);
}

double dielectric_pdf(const struct dielectric *dielectric, enum sampling sampling, struct vec3 wi, struct vec3 wo)
{
	const struct cook_torrance *side = side_of(dielectric, &wi, &wo);
	if (!(wi.z > 0.0) || wo.z == 0.0)
		return 0.0;
	if (wo.z > 0.0) {
		const struct vec3 m = vec3_unit(vec3_add(wi, wo));
		const double cos_d = vec3_dot(wi, m);
		return fresnel_dielectric(cos_d, side->n) * facet_pdf(&side->ndf, sampling, wi, m) / (4.0 * cos_d);
	}
	const struct dielectric_half half = dielectric_half(wi, wo, side->n);
	if (half.length == 0.0)
		return 0.0;
	return (1.0 - fresnel_dielectric(vec3_dot(wi, half.m), side->n)) * facet_pdf(&side->ndf, sampling, wi, half.m) *
	       dielectric_jacobian(&half, wo, side->n);
}

/* f |cos_o| over the density: both have the Fresnel factor and the Jacobian, which cancel. */
static double weight_of(const struct cook_torrance *side, enum sampling sampling, struct vec3 wi, struct vec3 m,
			struct vec3 wo, bool through)
{
	const double cos_d = vec3_dot(wi, m);
	if (!(cos_d > 0.0 && (through ? wo.z < 0.0 : wo.z > 0.0)))
		return 0.0;
	const double lambda_i = ndf_lambda(&side->ndf, wi);
	const double lambda_o = ndf_lambda(&side->ndf, through ? vec3_opposite(wo) : wo);
	const double G = (through ? gaf_smith_through : gaf_smith)(side->gaf, lambda_i, lambda_o);
	if (sampling == SAMPLING_VISIBLE)
		return G * (1.0 + lambda_i);
	if (sampling == SAMPLING_NDF)
		return G * (cos_d / (wi.z * m.z));
	return G * (cos_d / wi.z) * (ndf_D(&side->ndf, m) / facet_pdf(&side->ndf, sampling, wi, m));
}

struct dielectric_sample dielectric_sample(const struct dielectric *dielectric, enum sampling sampling, struct vec3 wi,
					   const double u[3])
{
	const bool below = wi.z < 0.0;
	const struct cook_torrance *side = &dielectric->side[below];
	struct dielectric_sample sample;
	if (below)
		wi = vec3_opposite(wi);
	const struct vec3 m = facet_sample(&side->ndf, sampling, wi, u);
	const bool through =
		u[2] >= fresnel_dielectric(vec3_dot(wi, m), side->n) && dielectric_refract(wi, m, side->n, &sample.wo);
	if (!through)
		sample.wo = vec3_unit(vec3_reflect(wi, m));
	sample.weight = weight_of(side, sampling, wi, m, sample.wo, through);
	if (below)
		sample.wo = vec3_opposite(sample.wo);
	return sample;
}
