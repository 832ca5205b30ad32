/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The half vector's slopes are those of the isotropic distribution, exp(v) at azimuth phi, stretched along the axes: there
 * again D depends on v alone. Directions lie in the plane of an axis, so both sides of it are alike. */
#include "src/energy_axes.h"
#include "src/quadrature.h"

#define V_BELOW 18.0 /* as in energy.c */

struct ring {
	struct energy_axes *axes;
	struct vec3 wi;
	double along, across; /* stretch in the plane of incidence and across it */
	double lambda_i;
	double t;         /* exp(v) */
	double front;     /* P22 t^2 / cos_i; that over cos_h is D/cos_i dh/(dv dphi) */
	double tolerance; /* absolute, of the outer integral; the inner ones have a share of it */
};

enum status energy_axes_init(struct energy_axes *axes, const struct cook_torrance *model, double median)
{
	const struct ndf *ndf = &model->ndf;
	const double mean = sqrt(ndf->sigma_x * ndf->sigma_y);
	if (model->gaf == GAF_V_GROOVE || ndf->pwl || ndf_is_tilted(ndf))
		return STATUS_UNSUPPORTED;
	enum status status = ndf_init(&axes->round, ndf->class, mean, mean, ndf->gamma);
	if (status == STATUS_OK && ndf->lambda_form != LAMBDA_EXACT)
		status = ndf_set_lambda_form(&axes->round, ndf->lambda_form);
	if (status != STATUS_OK)
		return status;
	axes->model = model;
	axes->stretch[0] = ndf->sigma_x / mean;
	axes->stretch[1] = ndf->sigma_y / mean;
	axes->median = median;
	smith_table_init(&axes->G1, &axes->round, median);
	return STATUS_OK;
}

/* G1 of a direction is that of the isotropic distribution from a stretched one. */
static double lambda_of(const struct ring *ring, struct vec3 w)
{
	const struct vec3 stretched = vec3_unit((struct vec3){ring->along * w.x, ring->across * w.y, w.z});
	return 1.0 / smith_table_G1(&ring->axes->G1, stretched) - 1.0;
}

/* f cos_o d wo / (dv dphi) = F G (wi.h) D/cos_i dh/(dv dphi) */
static double at_azimuth(double phi, void *params)
{
	const struct ring *ring = params;
	const struct cook_torrance *model = ring->axes->model;
	const struct vec3 slopes = {ring->along * ring->t * cos(phi), ring->across * ring->t * sin(phi), 1.0};
	const struct vec3 h = vec3_unit(slopes);
	const double cos_d = vec3_dot(ring->wi, h);
	const struct vec3 wo = vec3_sub(vec3_scale(h, 2.0 * cos_d), ring->wi);
	if (!(wo.z > 0.0))
		return 0.0;
	const double G = gaf_smith(model->gaf, ring->lambda_i, lambda_of(ring, wo));
	return cook_torrance_F(model, ring->axes->channel, cos_d) * G * cos_d * ring->front / h.z;
}

/* wo reaches the horizon where A x^2 + B x + C = 0, x = cos(phi): the azimuths of these in [0, pi], ascending, between
 * both ends. Returns how many there are with the ends. */
static int horizon(const struct ring *ring, double at[4])
{
	const double t = ring->t, z = ring->wi.z, a = ring->along, b = ring->across;
	const double A = z * t * t * (a - b) * (a + b), B = -ring->wi.x * a * t, C = z * (t * t * b * b - 1.0);
	const double inside = B * B - A * C;
	int n = 0;
	at[n++] = 0.0;
	if (inside >= 0.0) {
		const double q = -(B + copysign(sqrt(inside), B)),
			     x[2] = {A != 0.0 ? q / A : 2.0, q != 0.0 ? C / q : 2.0};
		const bool first_larger = x[0] > x[1];
		for (int i = 0; i < 2; i++) {
			const double root = x[first_larger == (i == 0) ? 0 : 1];
			if (root > -1.0 && root < 1.0)
				at[n++] = acos(root);
		}
	}
	at[n++] = M_PI;
	return n;
}

static double at_slope(double v, void *params)
{
	struct ring *ring = params;
	double at[4], sum = 0.0;
	ring->t = exp(v);
	const double cos_h = 1.0 / sqrt(1.0 + ring->t * ring->t);
	const double D = ndf_D(&ring->axes->round, (struct vec3){ring->t * cos_h, 0.0, cos_h});
	ring->front = D * pow(cos_h, 4) * ring->t * ring->t / ring->wi.z;
	const int n = horizon(ring, at);
	for (int i = 0; i + 1 < n; i++)
		if (at_azimuth(0.5 * (at[i] + at[i + 1]), ring) > 0.0)
			sum += quadrature_adaptive(at_azimuth, ring, at[i], at[i + 1], 0.02 * ring->tolerance);
	return 2.0 * sum;
}

/* Inserts x into the ascending at[0..n-1], kept inside its ends. */
static void insert(double at[], int n, double x)
{
	x = fmin(fmax(x, at[0]), at[n - 1]);
	for (; at[n - 1] > x; n--)
		at[n] = at[n - 1];
	at[n] = x;
}

double energy_axes_lobe(struct energy_axes *axes, int axis, double cos_i, double tolerance)
{
	struct ring ring = {.axes = axes,
			    .along = axes->stretch[axis],
			    .across = axes->stretch[1 - axis],
			    .wi = {sqrt((1.0 - cos_i) * (1.0 + cos_i)), 0.0, cos_i},
			    .tolerance = tolerance};
	ring.lambda_i = lambda_of(&ring, ring.wi);
	/* Where wo leaves on the far side, on both sides, and on this one. */
	const double theta_i = atan2(ring.wi.x, ring.wi.z), last = tan(0.5 * (0.5 * M_PI + theta_i));
	const double kinks[] = {axes->median, tan(0.5 * (0.5 * M_PI - theta_i)) / ring.along, 1.0 / ring.across,
				last / ring.along};
	const double end = log(last / fmin(ring.along, ring.across));
	double at[8] = {fmin(log(axes->median), end) - V_BELOW, end}, sum = 0.0;
	for (int i = 0; i < 4; i++)
		insert(at, 2 + i, log(kinks[i]));
	for (int i = 0; i < 5; i++)
		sum += quadrature_adaptive(at_slope, &ring, at[i], at[i + 1], tolerance);
	return sum;
}
