/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/model_samples.h"

#define RADIANS (M_PI / 180)

/* The steps of the grid, degrees. */
struct grid {
	int n_theta_i, n_phi_i, n_theta_h, n_phi_h;
	double theta_i, phi_i, phi_h;
	bool half; /* azimuths of h to 180 degrees stand for the other half, too */
};

static const struct grid isotropic = {18, 1, 40, 19, 5, 360, 10, true},
			 anisotropic = {9, 18, 24, 24, 10, 20, 15, false};

/* A direction of the grid and the solid angle around it. */
struct node {
	struct vec3 w;
	double solid_angle;
};

static double theta_h_of(const struct grid *grid, double t)
{
	const double share = fmin(t / grid->n_theta_h, 1);

	return 90 * share * share;
}

/* The part of the sphere between two polar angles, over all azimuths. */
static double zone(double low, double high)
{
	return 2 * M_PI * (cos(RADIANS * low) - cos(RADIANS * high));
}

static struct node incident(const struct grid *grid, int t, int p)
{
	const double theta = grid->theta_i * t, low = fmax(theta - grid->theta_i / 2, 0);
	const int count = t == 0 ? 1 : grid->n_phi_i;

	return (struct node){vec3_from_spherical_deg(theta, grid->phi_i * p),
			     zone(low, fmin(theta + grid->theta_i / 2, 90)) / count};
}

static struct node half_vector(const struct grid *grid, double phi_i, int t, int p)
{
	const double theta = theta_h_of(grid, t), low = theta_h_of(grid, fmax(t - 0.5, 0));
	const double whole = zone(low, theta_h_of(grid, t + 0.5));
	const bool edge = grid->half && (p == 0 || p + 1 == grid->n_phi_h);
	const double count = t == 0 ? 1 : grid->half ? grid->n_phi_h - 1 : grid->n_phi_h;

	return (struct node){vec3_from_spherical_deg(theta, phi_i + grid->phi_h * p),
			     whole / count * (edge && t > 0 ? 0.5 : 1)};
}

/* Sets entry `at`, or nothing where wo is below the horizon. Returns whether it did. */
static bool set_entry(struct scattered *s, size_t at, const struct node *i, const struct node *h)
{
	const double cos_d = vec3_dot(i->w, h->w);
	const struct vec3 wo = vec3_sub(vec3_scale(h->w, 2 * cos_d), i->w);

	if (!(cos_d > 0 && wo.z > 1e-3))
		return false;
	s->wi[at] = i->w;
	s->wo[at] = vec3_unit(wo);
	s->solid_angle[at] = (float)(i->solid_angle * h->solid_angle * 4 * cos_d);
	return true;
}

/* All directions above the horizon; returns how many. */
static size_t set_directions(struct scattered *s, const struct grid *grid)
{
	size_t n = 0;

	for (int ti = 0; ti < grid->n_theta_i; ti++)
		for (int pi = 0; pi < (ti == 0 ? 1 : grid->n_phi_i); pi++) {
			const struct node i = incident(grid, ti, pi);

			for (int th = 0; th < grid->n_theta_h; th++)
				for (int ph = 0; ph < (th == 0 ? 1 : grid->n_phi_h); ph++) {
					const struct node h = half_vector(grid, grid->phi_i * pi, th, ph);

					n += set_entry(s, n, &i, &h);
				}
		}
	return n;
}

enum status model_samples(const struct cook_torrance *model, int threads, struct measurement *measurement)
{
	const bool axes = ndf_is_anisotropic(&model->ndf);
	const struct grid *grid = axes ? &anisotropic : &isotropic;
	const size_t most = (size_t)(grid->n_theta_i * grid->n_phi_i) * (size_t)(grid->n_theta_h * grid->n_phi_h);
	const enum status status = measurement_scattered(measurement, most);
	if (status != STATUS_OK)
		return status;
	struct scattered *s = measurement->scattered;
	s->symmetry = axes ? SYMMETRY_ANISOTROPIC : SYMMETRY_ISOTROPIC;
	s->n = set_directions(s, grid);
#pragma omp parallel for num_threads(threads)
	for (size_t e = 0; e < s->n; e++) {
		double f[MERL_CHANNELS];

		cook_torrance_f(model, s->wi[e], s->wo[e], f);
		for (int c = 0; c < MERL_CHANNELS; c++)
			s->value[c][e] = (float)f[c];
	}
	return STATUS_OK;
}
