/* SPDX-License-Identifier: GPL-3.0-or-later */
/* space - the shapes among which a fit searches: the free parameters among sigma, gamma, ior, k and the axes, in coordinates in
 * which the valleys of the error are nearly straight. */
#ifndef SPACE_H
#define SPACE_H

#include "fit/error/objective.h"

enum { SPACE_DIMS = 8, SPACE_VALUES = 34, SPACE_SECOND = SPACE_DIMS * (SPACE_DIMS + 1) / 2 };

enum coordinate {
	COORDINATE_SIGMA,        /* ln sigma, of STD's sigma for the distributions that are STD with another sigma */
	COORDINATE_GAMMA,        /* ln(gamma - the least gamma of the NDF) */
	COORDINATE_IOR,          /* sqrt(F0) = (n - 1)/(n + 1) */
	COORDINATE_K,            /* k/(k + 1) */
	COORDINATE_GRAZING,      /* ln of the grazing term's exponent */
	COORDINATE_SECOND_SIGMA, /* as sigma and gamma, */
	COORDINATE_SECOND_GAMMA, /* of the second lobe */
	/* Of a conductor's m = n + i k the amplitude (m - 1)/(m + 1) of its reflection at the normal. F0 is the square of the
	 * length; where it is the same, the angle decides how F changes towards grazing incidence. */
	COORDINATE_LENGTH, /* as it is: of k = 0 that is COORDINATE_IOR */
	COORDINATE_PHASE,  /* the angle, 0 .. pi; at 0 and pi k is 0, n above 1 and below */
	/* Of the axes: with l = ln(sigma_x/sigma_y) and the angle a */
	COORDINATE_STRETCH_COS, /* l cos 2a, */
	COORDINATE_STRETCH_SIN, /* l sin 2a: isotropy is a point like others, and no angle the end of a range */
	COORDINATE_STRETCH,     /* l itself, where a is fixed */
	COORDINATE_ANGLE,       /* a, where l is fixed */
	COORDINATE_TILT_X,      /* asinh(tilt_x/0.05): tilts of sharp lobes are small */
	COORDINATE_TILT_Y,      /* likewise */
};

/* struct axis - values of one parameter, ascending: points of a grid. */
struct axis {
	double value[SPACE_VALUES];
	int count;
};

struct space {
	int dims; /* 0 .. SPACE_DIMS */
	enum coordinate coordinate[SPACE_DIMS];
	double lo[SPACE_DIMS], hi[SPACE_DIMS];          /* of each coordinate */
	double lowest[SPACE_DIMS], highest[SPACE_DIMS]; /* of the parameters themselves */
	double least_gamma;
	/* Where not NULL, sigma stands in the space as STD's sigma of the same distribution: hyper-cauchy and t-family are STD,
	 * and along their own sigma and gamma the error has a long curved valley. */
	const struct ndf_class *of_std;
	struct axis axis[SPACE_DIMS];
	struct shape fixed; /* values of the parameters that are not searched */
	double stretch[2];  /* the same of the first two coordinates of the axes */
	/* Of n and k: whether each channel has its own (else all of it is of channel 0), whose they are in each dimension, and
	 * COORDINATE_LENGTH and COORDINATE_PHASE where these are fixed. has_amplitude: n and k follow from them. */
	bool per_channel, has_amplitude[MERL_CHANNELS];
	int channel[SPACE_DIMS];
	double amplitude[MERL_CHANNELS][2];
};

/* struct space_point - a point of a space, and E there on the table at hand. */
struct space_point {
	double x[SPACE_DIMS];
	double error;
	struct linear linear; /* kd and ks there; its error is 0 where they are not known */
	/* Second derivatives of E, lengths in spacings of the scan: row by row from the diagonal on; all 0: not known. */
	float curvature[SPACE_SECOND];
};

/* space_init - what the options leave free for an NDF; nothing without a specular term. */
void space_init(struct space *space, const struct fit_options *options, const struct ndf_class *class);
/* space_shape - the shape at a point; space_from_shape - the reverse, values out of range moved to the nearest end. */
struct shape space_shape(const struct space *space, const double x[]);
void space_from_shape(const struct space *space, const struct shape *shape, double x[]);
/* space_sigma_scale - sigma of a shape over the sigma that stands for it in the space; 1 where it is the same. */
double space_sigma_scale(const struct space *space, double gamma);
/* space_x - dimension d's coordinate of a value of its parameter; space_value - the reverse. */
double space_x(const struct space *space, int d, double value);
double space_value(const struct space *space, int d, double x);
/* space_is_of_ior - whether dimension d, a conductor's COORDINATE_LENGTH included, says how high F is. */
bool space_is_of_ior(const struct space *space, int d);
/* space_is_of_axes - whether dimension d is one of the axes' coordinates but COORDINATE_ANGLE, or of the tilt. */
bool space_is_of_axes(const struct space *space, int d);
/* space_fix - takes dimension d out: its parameter has this value from now on, gamma = inf included. */
void space_fix(struct space *space, int d, double value);
/* space_fix_index - puts the other of n and k in the place of COORDINATE_LENGTH and COORDINATE_PHASE of a channel: n, or k, has this
 * value from now on. */
void space_fix_index(struct space *space, int channel, bool fix_k, double value);
/* space_plain_index - puts n and k that all channels share in the place of COORDINATE_LENGTH and COORDINATE_PHASE. */
void space_plain_index(struct space *space);
/* space_parameter - the parameter of dimension d within a shape; not of the coordinates that stand for two. */
double *space_parameter(const struct space *space, int d, struct shape *shape);
/* space_index - n (0) or k (1) of a channel within a shape of this space. */
double *space_index(const struct space *space, struct shape *shape, int channel, int which);

#endif
