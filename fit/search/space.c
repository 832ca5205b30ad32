/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/space.h"
#include <math.h>
#include <string.h>

double *space_index(const struct space *s, struct shape *shape, int channel, int which)
{
	if (s->per_channel)
		return which ? &shape->channel_k[channel] : &shape->channel_ior[channel];
	return which ? &shape->k : &shape->ior;
}

double *space_parameter(const struct space *s, int d, struct shape *shape)
{
	switch (s->coordinate[d]) {
	case COORDINATE_SIGMA:
		return &shape->sigma;
	case COORDINATE_GAMMA:
		return &shape->gamma;
	case COORDINATE_IOR:
		return space_index(s, shape, s->channel[d], 0);
	case COORDINATE_K:
		return space_index(s, shape, s->channel[d], 1);
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
static const struct axis scan_k = {{0, 0.15, 0.4, 0.8, 1.4, 2.2, 3.4, 5.5, 10, 30}, 10};
/* Of a conductor. Metals are where the phase is 0.3 to 0.8. */
static const struct axis scan_length = {{0.03, 0.1, 0.25, 0.5, 0.75, 0.92, 0.985}, 7};
static const struct axis scan_phase = {{0, 0.35, 0.75, 1.3, 2.1, 3.1}, 6};
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

static void set_dim(struct space *s, int d, enum coordinate c, double lowest, double highest, const struct axis *axis)
{
	s->coordinate[d] = c;
	s->lowest[d] = lowest;
	s->highest[d] = highest;
	s->lo[d] = to_coordinate(c, s->least_gamma, lowest);
	s->hi[d] = to_coordinate(c, s->least_gamma, highest);
	s->axis[d] = *axis;
}

static void add_dim(struct space *s, enum coordinate c, double lowest, double highest, const struct axis *axis)
{
	set_dim(s, s->dims++, c, lowest, highest, axis);
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

/* The amplitude of the least n and the largest k is 1 less about this. */
static void add_amplitude(struct space *s, int channel)
{
	const double most = 1 - 2 * FIT_CONDUCTOR_IOR_MIN / (FIT_K_MAX * FIT_K_MAX);

	s->has_amplitude[channel] = true;
	s->channel[s->dims] = s->channel[s->dims + 1] = channel;
	add_dim(s, COORDINATE_LENGTH, (FIT_IOR_MIN - 1) / (FIT_IOR_MIN + 1), most, &scan_length);
	add_dim(s, COORDINATE_PHASE, 0, M_PI, &scan_phase);
}

static void add_index(struct space *s, const struct fit_options *o)
{
	const bool conductor = o->fresnel == FRESNEL_CONDUCTOR;

	if (conductor && isnan(o->ior))
		for (int c = 0; c < (o->per_channel_ior ? MERL_CHANNELS : 1); c++)
			add_amplitude(s, c);
	else if (conductor)
		add_dim(s, COORDINATE_K, 0, FIT_K_MAX, &scan_k);
	else if (fresnel_has_ior(o->fresnel) && isnan(o->ior))
		add_dim(s, COORDINATE_IOR, FIT_IOR_MIN, FIT_IOR_MAX, &scan_ior);
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
	s->per_channel = o->per_channel_ior;
	add_index(s, o);
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

bool space_is_of_ior(const struct space *s, int d)
{
	return s->coordinate[d] == COORDINATE_IOR || s->coordinate[d] == COORDINATE_LENGTH;
}

static bool is_of_pair(enum coordinate c)
{
	return c == COORDINATE_STRETCH_COS || c == COORDINATE_STRETCH_SIN;
}

static bool is_of_amplitude(enum coordinate c)
{
	return c == COORDINATE_LENGTH || c == COORDINATE_PHASE;
}

/* r = (m - 1)/(m + 1), m = (1 + r)/(1 - r). */
static void set_index(const double amplitude[2], double *n, double *k)
{
	const double length = amplitude[0], x = 1 - length * cos(amplitude[1]), y = length * sin(amplitude[1]),
		     square = x * x + y * y;

	*n = fmin(fmax((1 - length) * (1 + length) / square, FIT_CONDUCTOR_IOR_MIN), FIT_IOR_MAX);
	*k = fmin(2 * y / square, FIT_K_MAX);
}

static double length_of(double n, double k)
{
	return hypot(n - 1, k) / hypot(n + 1, k);
}

static double phase_of(double n, double k)
{
	return atan2(2 * k, (n - 1) * (n + 1) + k * k);
}

bool space_is_of_axes(const struct space *s, int d)
{
	const enum coordinate c = s->coordinate[d];

	return is_of_pair(c) || c == COORDINATE_STRETCH || c == COORDINATE_TILT_X || c == COORDINATE_TILT_Y;
}

struct shape space_shape(const struct space *s, const double x[])
{
	struct shape shape = s->fixed;
	double stretch[2] = {s->stretch[0], s->stretch[1]}, amplitude[MERL_CHANNELS][2];

	memcpy(amplitude, s->amplitude, sizeof amplitude);
	for (int d = 0; d < s->dims; d++)
		if (is_of_pair(s->coordinate[d]))
			stretch[s->coordinate[d] - COORDINATE_STRETCH_COS] = space_value(s, d, x[d]);
		else if (is_of_amplitude(s->coordinate[d]))
			amplitude[s->channel[d]][s->coordinate[d] - COORDINATE_LENGTH] = space_value(s, d, x[d]);
		else
			*space_parameter(s, d, &shape) = space_value(s, d, x[d]);
	if (stretch[0] != 0 || stretch[1] != 0) {
		shape.stretch = hypot(stretch[0], stretch[1]);
		shape.angle = atan2(stretch[1], stretch[0]) * 90 / M_PI;
	}
	for (int c = 0; c < MERL_CHANNELS; c++)
		if (s->has_amplitude[c])
			set_index(amplitude[c], space_index(s, &shape, c, 0), space_index(s, &shape, c, 1));
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
	for (int d = 0; d < s->dims; d++) {
		const double n = *space_index(s, &copy, s->channel[d], 0), k = *space_index(s, &copy, s->channel[d], 1);

		if (s->coordinate[d] == COORDINATE_STRETCH_COS)
			x[d] = space_x(s, d, shape->stretch * cos(twice));
		else if (s->coordinate[d] == COORDINATE_STRETCH_SIN)
			x[d] = space_x(s, d, shape->stretch * sin(twice));
		else if (s->coordinate[d] == COORDINATE_LENGTH)
			x[d] = space_x(s, d, length_of(n, k));
		else if (s->coordinate[d] == COORDINATE_PHASE)
			x[d] = space_x(s, d, phase_of(n, k));
		else
			x[d] = space_x(s, d, *space_parameter(s, d, &copy));
	}
}

void space_fix(struct space *s, int d, double value)
{
	if (is_of_pair(s->coordinate[d]))
		s->stretch[s->coordinate[d] - COORDINATE_STRETCH_COS] = value;
	else if (is_of_amplitude(s->coordinate[d]))
		s->amplitude[s->channel[d]][s->coordinate[d] - COORDINATE_LENGTH] = value;
	else
		*space_parameter(s, d, &s->fixed) = value;
	s->dims--;
	for (; d < s->dims; d++) {
		s->coordinate[d] = s->coordinate[d + 1];
		s->channel[d] = s->channel[d + 1];
		s->lo[d] = s->lo[d + 1];
		s->hi[d] = s->hi[d + 1];
		s->lowest[d] = s->lowest[d + 1];
		s->highest[d] = s->highest[d + 1];
		s->axis[d] = s->axis[d + 1];
	}
}

void space_fix_index(struct space *s, int channel, bool fix_k, double value)
{
	int d = 0;

	while (s->coordinate[d] != COORDINATE_LENGTH || s->channel[d] != channel)
		d++;
	space_fix(s, d + 1, 0); /* the phase stands behind the length */
	s->has_amplitude[channel] = false;
	*space_index(s, &s->fixed, channel, fix_k) = value;
	if (fix_k)
		set_dim(s, d, COORDINATE_IOR, FIT_CONDUCTOR_IOR_MIN, FIT_IOR_MAX, &scan_ior);
	else
		set_dim(s, d, COORDINATE_K, 0, FIT_K_MAX, &scan_k);
}

void space_plain_index(struct space *s)
{
	for (int d = 0; d < s->dims && !s->per_channel; d++) {
		if (s->coordinate[d] == COORDINATE_LENGTH)
			set_dim(s, d, COORDINATE_IOR, FIT_CONDUCTOR_IOR_MIN, FIT_IOR_MAX, &scan_ior);
		else if (s->coordinate[d] == COORDINATE_PHASE)
			set_dim(s, d, COORDINATE_K, 0, FIT_K_MAX, &scan_k);
	}
	s->has_amplitude[0] = s->has_amplitude[0] && s->per_channel;
}
