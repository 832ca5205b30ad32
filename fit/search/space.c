/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/space.h"
#include <math.h>

static double *parameter(struct shape *shape, enum coordinate c)
{
	switch (c) {
	case COORDINATE_SIGMA:
		return &shape->sigma;
	case COORDINATE_GAMMA:
		return &shape->gamma;
	case COORDINATE_IOR:
		return &shape->ior;
	case COORDINATE_K:
		return &shape->k;
	case COORDINATE_GRAZING:
		return &shape->grazing;
	case COORDINATE_SECOND_SIGMA:
		return &shape->second_sigma;
	case COORDINATE_SECOND_GAMMA:
		return &shape->second_gamma;
	case COORDINATE_ANGLE:
		return &shape->angle;
	case COORDINATE_TILT_X:
		return &shape->tilt_x;
	case COORDINATE_TILT_Y:
		return &shape->tilt_y;
	default:
		return &shape->stretch;
	}
}

#define TILT_UNIT 0.05

static double to_coordinate(enum coordinate c, double least_gamma, double value)
{
	switch (c) {
	case COORDINATE_SIGMA:
	case COORDINATE_SECOND_SIGMA:
	case COORDINATE_GRAZING:
		return log(value);
	case COORDINATE_GAMMA:
	case COORDINATE_SECOND_GAMMA:
		return log(value - least_gamma);
	case COORDINATE_IOR:
		return (value - 1) / (value + 1);
	case COORDINATE_K:
		return value / (value + 1);
	case COORDINATE_TILT_X:
	case COORDINATE_TILT_Y:
		return asinh(value / TILT_UNIT);
	default:
		return value;
	}
}

static double from_coordinate(enum coordinate c, double least_gamma, double x)
{
	switch (c) {
	case COORDINATE_SIGMA:
	case COORDINATE_SECOND_SIGMA:
	case COORDINATE_GRAZING:
		return exp(x);
	case COORDINATE_GAMMA:
	case COORDINATE_SECOND_GAMMA:
		return least_gamma + exp(x);
	case COORDINATE_IOR:
		return (1 + x) / (1 - x);
	case COORDINATE_K:
		return x / (1 - x);
	case COORDINATE_TILT_X:
	case COORDINATE_TILT_Y:
		return TILT_UNIT * sinh(x);
	default:
		return x;
	}
}

/* The grid of the scan. Where the lobe is as narrow as the first bins of theta_h, 0.01 to 0.3 deg wide, the error has valleys
 * in sigma that a coarser grid steps over. Places in gamma are those of STD, above its least gamma; other NDFs get as many
 * between the ends of theirs, up to 50. */
static const struct axis scan_sigma = {{1e-4,   2e-4,   4e-4,   7e-4,   1e-3,   1.2e-3, 1.5e-3, 1.8e-3, 2.2e-3,
					2.7e-3, 3.2e-3, 3.8e-3, 4.6e-3, 5.5e-3, 6.5e-3, 7.7e-3, 9e-3,   0.0125,
					0.0175, 0.025,  0.035,  0.05,   0.07,   0.1,    0.14,   0.2,    0.28,
					0.4,    0.55,   0.8,    1.2,    2,      4},
				       33};
static const struct axis scan_gamma = {{1e-4, 1e-3, 0.005, 0.015, 0.04, 0.1, 0.25, 0.7, 2, 6.5, 48.5}, 11};
static const struct axis scan_ior = {{1.03, 1.15, 1.35, 1.8, 3, 8, 60}, 7};
static const struct axis scan_k = {{0, 0.5, 2, 6, 30}, 5};
/* The scan is of isotropic shapes, unless the roughnesses are fixed. */
static const struct axis scan_stretch = {{0}, 1}, scan_tilt = {{0}, 1};
/* Of the grazing term and the second lobe there is no scan: fit.c knows where to begin. */
static const struct axis scan_grazing = {{5}, 1};
static const struct axis scan_second = {{0.3}, 1}, scan_second_gamma = {{3}, 1};
static const struct axis scan_angle = {{-75, -60, -45, -30, -15, 0, 15, 30, 45, 60, 75, 90}, 12};

static struct axis gamma_axis(double least, double low, bool student_t)
{
	struct axis axis = scan_gamma;
	const double first = low - least, ratio = pow(50 / first, 1.0 / (axis.count - 1));

	for (int n = 0; n < axis.count; n++)
		axis.value[n] = least + (student_t ? axis.value[n] : first * pow(ratio, n));
	return axis;
}

static void add_dim(struct space *s, enum coordinate c, double lowest, double highest, const struct axis *axis)
{
	const int d = s->dims++;

	s->coordinate[d] = c;
	s->lowest[d] = lowest;
	s->highest[d] = highest;
	s->lo[d] = to_coordinate(c, s->least_gamma, lowest);
	s->hi[d] = to_coordinate(c, s->least_gamma, highest);
	s->axis[d] = *axis;
}

static void add_axes(struct space *s, const struct fit_options *o)
{
	const double l = log(FIT_RATIO_MAX);

	s->fixed.angle = isnan(o->angle) ? 0 : o->angle;
	if (!isnan(o->sigma_y)) {
		s->fixed.sigma = sqrt(o->sigma * o->sigma_y);
		s->fixed.stretch = log(o->sigma / o->sigma_y);
		/* Both ends are beyond a half turn: none is where a minimum may be. */
		if (isnan(o->angle))
			add_dim(s, COORDINATE_ANGLE, -180, 180, &scan_angle);
	} else if (!isnan(o->angle)) {
		add_dim(s, COORDINATE_STRETCH, -l, l, &scan_stretch);
	} else {
		add_dim(s, COORDINATE_STRETCH_COS, -l, l, &scan_stretch);
		add_dim(s, COORDINATE_STRETCH_SIN, -l, l, &scan_stretch);
	}
}

static void add_grazing(struct space *s, const struct fit_options *o)
{
	if (o->grazing && isnan(o->grazing_exponent))
		add_dim(s, COORDINATE_GRAZING, FIT_GRAZING_MIN, FIT_GRAZING_MAX, &scan_grazing);
}

static void add_second(struct space *s, const struct ndf_class *class)
{
	add_dim(s, COORDINATE_SECOND_SIGMA, FIT_SIGMA_MIN, FIT_SIGMA_MAX, &scan_second);
	if (!ndf_has_gamma(class))
		return;
	const struct ndf_param *gamma = ndf_param_at(class, 1);

	if (s->least_gamma == 0)
		s->least_gamma = gamma->min;
	add_dim(s, COORDINATE_SECOND_GAMMA, gamma->search_min, gamma->search_max, &scan_second_gamma);
}

void space_init(struct space *s, const struct fit_options *o, const struct ndf_class *class)
{
	const double exponent = isnan(o->grazing_exponent) ? scan_grazing.value[0] : o->grazing_exponent;

	*s = (struct space){.fixed = {.sigma = o->sigma, .gamma = o->gamma, .ior = o->ior, .grazing = exponent}};
	if (!o->specular) {
		/* Any valid shape will do: ks is 0. */
		s->fixed = (struct shape){.sigma = 1, .gamma = 2, .ior = 1.5, .grazing = exponent};
		add_grazing(s, o);
		return;
	}
	if (isnan(o->sigma) && ndf_has_gamma(class) && ndf_has_lambda_forms(class))
		s->of_std = class;
	if (isnan(o->sigma))
		add_dim(s, COORDINATE_SIGMA, FIT_SIGMA_MIN, FIT_SIGMA_MAX, &scan_sigma);
	if (ndf_has_gamma(class) && isnan(o->gamma)) {
		const struct ndf_param *gamma = ndf_param_at(class, 1);
		const bool student_t = ndf_has_lambda_forms(class);

		/* t-family's gamma goes down to 2, where its D degenerates, not to STD's 1.5. */
		s->least_gamma = student_t ? gamma->search_min - (FIT_GAMMA_MIN - 1.5) : gamma->min;
		const struct axis axis = gamma_axis(s->least_gamma, gamma->search_min, student_t);

		add_dim(s, COORDINATE_GAMMA, gamma->search_min, gamma->search_max, &axis);
	}
	if (fresnel_has_ior(o->fresnel) && isnan(o->ior))
		add_dim(s, COORDINATE_IOR, FIT_IOR_MIN, FIT_IOR_MAX, &scan_ior);
	if (o->fresnel == FRESNEL_CONDUCTOR)
		add_dim(s, COORDINATE_K, 0, FIT_K_MAX, &scan_k);
	if (o->anisotropic)
		add_axes(s, o);
	if (o->anisotropic && ndf_has_tilt(class)) {
		add_dim(s, COORDINATE_TILT_X, -FIT_TILT_MAX, FIT_TILT_MAX, &scan_tilt);
		add_dim(s, COORDINATE_TILT_Y, -FIT_TILT_MAX, FIT_TILT_MAX, &scan_tilt);
	}
	add_grazing(s, o);
	if (o->lobes > 1)
		add_second(s, class);
}

double space_sigma_scale(const struct space *s, double gamma)
{
	struct ndf ndf;

	return s->of_std && ndf_init(&ndf, s->of_std, 1, 1, gamma) == STATUS_OK ? ndf.stretch : 1;
}

double space_value(const struct space *s, int d, double x)
{
	return fmin(fmax(from_coordinate(s->coordinate[d], s->least_gamma, x), s->lowest[d]), s->highest[d]);
}

static bool is_of_pair(enum coordinate c)
{
	return c == COORDINATE_STRETCH_COS || c == COORDINATE_STRETCH_SIN;
}

bool space_is_of_axes(const struct space *s, int d)
{
	const enum coordinate c = s->coordinate[d];

	return is_of_pair(c) || c == COORDINATE_STRETCH || c == COORDINATE_TILT_X || c == COORDINATE_TILT_Y;
}

struct shape space_shape(const struct space *s, const double x[])
{
	struct shape shape = s->fixed;
	double stretch[2] = {s->stretch[0], s->stretch[1]};

	for (int d = 0; d < s->dims; d++)
		if (is_of_pair(s->coordinate[d]))
			stretch[s->coordinate[d] - COORDINATE_STRETCH_COS] = space_value(s, d, x[d]);
		else
			*parameter(&shape, s->coordinate[d]) = space_value(s, d, x[d]);
	if (stretch[0] != 0 || stretch[1] != 0) {
		shape.stretch = hypot(stretch[0], stretch[1]);
		shape.angle = atan2(stretch[1], stretch[0]) * 90 / M_PI;
	}
	shape.sigma *= space_sigma_scale(s, shape.gamma);
	return shape;
}

double space_x(const struct space *s, int d, double value)
{
	return to_coordinate(s->coordinate[d], s->least_gamma, fmin(fmax(value, s->lowest[d]), s->highest[d]));
}

void space_from_shape(const struct space *s, const struct shape *shape, double x[])
{
	struct shape copy = *shape;
	const double twice = shape->angle * M_PI / 90;

	copy.sigma /= space_sigma_scale(s, copy.gamma);
	for (int d = 0; d < s->dims; d++)
		if (s->coordinate[d] == COORDINATE_STRETCH_COS)
			x[d] = space_x(s, d, shape->stretch * cos(twice));
		else if (s->coordinate[d] == COORDINATE_STRETCH_SIN)
			x[d] = space_x(s, d, shape->stretch * sin(twice));
		else
			x[d] = space_x(s, d, *parameter(&copy, s->coordinate[d]));
}

void space_fix(struct space *s, int d, double value)
{
	if (is_of_pair(s->coordinate[d]))
		s->stretch[s->coordinate[d] - COORDINATE_STRETCH_COS] = value;
	else
		*parameter(&s->fixed, s->coordinate[d]) = value;
	s->dims--;
	for (; d < s->dims; d++) {
		s->coordinate[d] = s->coordinate[d + 1];
		s->lo[d] = s->lo[d + 1];
		s->hi[d] = s->hi[d + 1];
		s->lowest[d] = s->lowest[d + 1];
		s->highest[d] = s->highest[d + 1];
		s->axis[d] = s->axis[d + 1];
	}
}
