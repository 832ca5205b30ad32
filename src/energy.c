/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The integral runs over the half vector h, at the slope tan(theta_h) = exp(v) and the azimuth phi from the plane of
 * incidence: d wo = 4 (wi.h) dh, and D, the only sharp factor, depends on v alone, with about the same width for all
 * sigma. wo lies above the horizon where sin_i sin(2 theta_h) cos(phi) + cos_i cos(2 theta_h) > 0. */
#include "energy.h"
#include "quadrature.h"

/* Absolute, of the outer integral; the inner ones have a share of it. The kinks of the V-groove would take for ever. */
static double tolerance_for(const struct cook_torrance *model)
{
	return model->gaf == GAF_V_GROOVE ? 1e-6 : 1e-8;
}

/* exp(v) down to exp(-18) of the median slope: 1e-15 of the normals lie below. */
#define V_BELOW 18.0

struct ring {
	const struct cook_torrance *model;
	struct vec3 wi;
	double sin_h, cos_h;
};

/* f cos_o d wo / (dv dphi), dh = sin_h^2 cos_h dv dphi. */
static double at_azimuth(double phi, void *params)
{
	const struct ring *ring = params;
	const struct vec3 h = {ring->sin_h * cos(phi), ring->sin_h * sin(phi), ring->cos_h};
	const double cos_d = vec3_dot(ring->wi, h);
	const struct vec3 wo = vec3_sub(vec3_scale(h, 2.0 * cos_d), ring->wi);
	const double measure = 4.0 * cos_d * ring->sin_h * ring->sin_h * ring->cos_h;
	return wo.z > 0.0 ? cook_torrance_lobe(ring->model, ring->wi, wo) * wo.z * measure : 0.0;
}

static double at_slope(double v, void *params)
{
	struct ring *ring = params;
	const double tangent = exp(v);
	ring->cos_h = 1.0 / sqrt(1.0 + tangent * tangent);
	ring->sin_h = tangent * ring->cos_h;
	const double sin_2h = 2.0 * ring->sin_h * ring->cos_h;
	const double cos_2h = (ring->cos_h - ring->sin_h) * (ring->cos_h + ring->sin_h);
	const double end = acos(fmax(-1.0, fmin(1.0, -ring->wi.z * cos_2h / (ring->wi.x * sin_2h))));
	return 2.0 * quadrature_adaptive(at_azimuth, ring, 0.0, end, 0.02 * tolerance_for(ring->model));
}

/* ln tan of half an angle */
static double log_tan_half(double angle)
{
	return log(tan(0.5 * angle));
}

/* Where all azimuths reach above the horizon, where one last does; the middle of D. */
static double integrate_slopes(struct ring *ring)
{
	const double theta_i = atan2(ring->wi.x, ring->wi.z);
	const double last = log_tan_half(0.5 * M_PI + theta_i);
	const double all = fmin(log_tan_half(atan2(ring->wi.z, ring->wi.x)), last);
	const struct vec3 m = ndf_sample(&ring->model->ndf, 0.0, 0.5);
	const double middle = fmin(log(m.x / m.z), last);
	const double at[] = {fmin(middle, all) - V_BELOW, fmin(middle, all), fmax(middle, all), last};
	double sum = 0.0;
	for (int i = 0; i < 3; i++)
		sum += quadrature_adaptive(at_slope, ring, at[i], at[i + 1], tolerance_for(ring->model));
	return sum;
}

enum status energy_lobe(const struct cook_torrance *model, double cos_i, double *albedo)
{
	if (!(cos_i > 0.0 && cos_i <= 1.0))
		return STATUS_DOMAIN;
	if (model->ndf.sigma_x != model->ndf.sigma_y)
		return STATUS_UNSUPPORTED;
	struct ring ring = {.model = model, .wi = {sqrt((1.0 - cos_i) * (1.0 + cos_i)), 0.0, cos_i}};
	*albedo = integrate_slopes(&ring);
	return STATUS_OK;
}

enum status energy_albedo(const struct cook_torrance *model, double cos_i, double albedo[3])
{
	double lobe;
	const enum status status = energy_lobe(model, cos_i, &lobe);
	if (status != STATUS_OK)
		return status;
	for (int c = 0; c < 3; c++)
		albedo[c] = model->kd[c] + model->ks[c] * lobe;
	return STATUS_OK;
}
