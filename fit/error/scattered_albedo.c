/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/scattered_albedo.h"
#include "data_readers/interpolant.h"

/* Of the half vector, over half of its azimuths where the sample is isotropic; and of wi where it is not. */
enum { RINGS = 40, AZIMUTHS = 24, TURNS = 6 };

/* An integral over the half vector about wi, dw_o = 4 cos theta_d dw_h, at the middle of cells in theta_h = 90 t^2 degrees.
 * own: takes the values, if there is one. Adds to albedo; returns the integral of the cosine over what was measured, *all over the hemisphere. */
static double integrate(const struct interpolant *ip, const struct interpolant *own, struct vec3 wi,
			double albedo[MERL_CHANNELS], double *all)
{
	const double turn = (ip->turns ? 2 : 1) * M_PI, from = atan2(wi.y, wi.x);
	double measured = 0;

	for (int r = 0; r < RINGS * AZIMUTHS; r++) {
		const int t = r / AZIMUTHS;
		const double low = M_PI / 2 * t * t / (RINGS * RINGS),
			     high = M_PI / 2 * (t + 1) * (t + 1) / (RINGS * RINGS);
		const double theta = (low + high) / 2, phi = from + turn * (r % AZIMUTHS + 0.5) / AZIMUTHS;
		const struct vec3 h = {sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)};
		const double cos_d = vec3_dot(h, wi);
		const struct vec3 wo = vec3_sub(vec3_scale(h, 2 * cos_d), wi);

		if (!(cos_d > 0 && wo.z > 0))
			continue;
		const double w = 4 * cos_d * wo.z * 2 * M_PI / AZIMUTHS * (cos(low) - cos(high));
		const struct interpolated value = interpolant_at(ip, wi, wo);
		*all += w;
		/* Among crowded entries the reach of one may end before a neighbour's begins. */
		if (!(value.inside || value.distance < 1.5) || !(value.weight > 0))
			continue;
		measured += w;
		double f[MERL_CHANNELS];
		if (own)
			interpolant_f(own, wi, wo, f);
		for (int c = 0; c < MERL_CHANNELS; c++)
			albedo[c] += w * (own ? f[c] : value.sum[c] / value.weight);
	}
	return measured;
}

static void integrate_all(const struct interpolant *ip, const struct interpolant *own, double theta_i,
			  double albedo[MERL_CHANNELS], double *measured)
{
	const int turns = ip->turns && theta_i > 0 ? TURNS : 1;
	double all = 0;

	*measured = 0;
	for (int i = 0; i < turns; i++) {
		const double phi = 2 * M_PI * i / turns;
		const struct vec3 wi = {sin(theta_i) * cos(phi), sin(theta_i) * sin(phi), cos(theta_i)};

		*measured += integrate(ip, own, wi, albedo, &all);
	}
	for (int c = 0; c < MERL_CHANNELS; c++)
		albedo[c] /= turns;
	*measured /= all;
}

/* The largest angle of either direction that was measured, degrees; NaN where that is nearly the horizon. */
static double end_of(const struct scattered *s)
{
	double lowest_i = 1, lowest_o = 1;

	for (size_t e = 0; e < s->n; e++) {
		lowest_i = fmin(lowest_i, s->wi[e].z);
		lowest_o = fmin(lowest_o, s->wo[e].z);
	}
	const double end = acos(fmax(lowest_i, lowest_o)) * 180 / M_PI;
	return end < 89 ? end : NAN;
}

enum status scattered_albedo(const struct measurement *measurement, const double theta_i[SUSPECTS_ALBEDOS],
			     struct suspects *suspects)
{
	struct measurement entries = *measurement;
	const bool turns = measurement_turns(measurement);
	struct interpolant ip, own = {0};

	/* A file's own interpolant does not tell what was measured. */
	entries.rgl = NULL;
	enum status status = interpolant_init(&ip, &entries, 180, turns, 1);
	if (status == STATUS_OK && measurement->rgl)
		status = interpolant_init(&own, measurement, 180, turns, 1);
	if (status != STATUS_OK)
		return status;
	for (int a = 0; a < SUSPECTS_ALBEDOS; a++)
		integrate_all(&ip, own.rgl ? &own : NULL, theta_i[a], suspects->albedo[a], &suspects->measured[a]);
	suspects->ends_at = end_of(measurement->scattered);
	interpolant_free(&ip);
	return STATUS_OK;
}
