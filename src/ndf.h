/* SPDX-License-Identifier: GPL-3.0-or-later */
/* ndf - normal distribution functions (NDFs) of microfacet theory, behind one interface.
 *
 * D(m) is the density of microfacet normals per solid angle and macroscopic area: the integral of D(m) m.z over the
 * hemisphere is 1. Smith's Lambda(w) follows from the slopes of those normals along w.
 *     beckmann       Gaussian slopes
 *     ggx            Trowbridge-Reitz
 *     std            Student-t slopes with a shape gamma: ggx at gamma = 2, to the bit, beckmann at gamma = infinity
 *     hyper-cauchy   the same slopes, scaled such that f = 1 in the general family below
 *     t-family       the same, f = 1/(gamma - x) with a second shape x, 2 unless given
 *     gtr            generalised Trowbridge-Reitz, D = c (sigma^2 cos^2 + sin^2)^-gamma
 *     low            the ABC distribution of Low et al., D = A (1 + B (1 - cos))^-C
 *     pl             piecewise linear in theta between nodes (pwl.h); made by ndf_from_pwl() only
 *     ellipsoid      normals of an ellipsoid (ellipsoid.h): ggx, and with ndf_tilt() ggx whose facets lean on average
 *
 * The general family D^G(B, C) = (C-1) B (1 + B tan^2)^-C / (pi cos^4), with B = f/sigma^2 and C = gamma, is that of
 * Student-t slopes: std is f = 1/(gamma-1). When isotropic, its members are one set of distributions under different
 * names of their roughness.
 *
 * Accuracy of std, ggx, beckmann, with the given unit vector taken as exact: relative error of D at most 2e-15, of
 * Lambda 3e-14 where it exceeds 1e-20 and 1e-12 down to 1e-300, of G1 1e-15. The rounding of the vector itself changes
 * a far tail of D by more: with vec3_from_spherical_deg() by up to 2.3e-16 |ln D|, 1e-13 at D = 1e-200. The factor f of
 * hyper-cauchy and t-family adds 2e-16 (1 + gamma) to D and Lambda. gtr and low: D within 2e-15 + 1e-15 gamma (C);
 * G1, by quadrature, 1e-12. From gamma = 1e22 on std is beckmann. No function here raises an invalid operation, a
 * division by zero or, but for Lambda beyond the range of a double, an overflow. `make stability` measures all that. */
#ifndef NDF_H
#define NDF_H

#include "src/lambda_form.h"
#include "src/status.h"
#include "src/vec3.h"
#include <stdbool.h>

struct pwl;
struct ellipsoid;
struct ndf_class; /* one row of the table of distributions; see ndf_class.h */

/* Domain of a roughness: far beyond use, but inside it nothing overflows to NaN. */
#define NDF_SIGMA_MIN 1e-50
#define NDF_SIGMA_MAX 1e50

enum { NDF_PARAMS_MAX = 3 };

/* What a parameter is to a class: the roughness and the shape of ndf_init(), or one of its own. */
enum ndf_role { NDF_ROLE_OTHER, NDF_ROLE_SIGMA, NDF_ROLE_GAMMA };

/* struct ndf_param - one named parameter of a class. The search coordinate that keeps valleys straight is
 * ln(value - min) for all of them. */
struct ndf_param {
	const char *name;              /* "sigma", "gamma", "x", "B", "C" */
	enum ndf_role role;            /* of "sigma" and "gamma"; B, C and x have none */
	double min, max;               /* domain, max included */
	bool min_included;             /* whether min itself is allowed; no -> an open end */
	double search_min, search_max; /* where a fit should search; equal when it should leave the value as it is */
};

/* struct ndf - one distribution with its parameters; filled by ndf_init() or ndf_init_params(), then only read. */
struct ndf {
#ifdef __cplusplus
	const struct ndf_class *class_; /* a keyword there */
#else
	const struct ndf_class *class;
#endif
	double sigma_x, sigma_y;      /* roughness along x and y, > 0; equal when isotropic */
	double gamma;                 /* shape; 2 for ggx, INFINITY for beckmann, C for low */
	double param[NDF_PARAMS_MAX]; /* as ndf_param_at() names them; the first is sigma_x where the class has sigma */
	enum lambda_form lambda_form; /* how Lambda is computed, */
	double lambda_K;              /* and the K below for it; 0 for LAMBDA_EXACT */
	const struct pwl *pwl;        /* pl: the table, not owned; else NULL */
	/* Cached; 0 where unused. */
	double K;         /* Gamma(gamma-1/2) / (sqrt(pi) Gamma(gamma-1)) */
	double a;         /* Student-t slopes: 1/f */
	double stretch;   /* sqrt((gamma-1)/a), else 1: in terms of std roughness is sigma/stretch */
	double A;         /* gtr, low: factor of D */
	double log_width; /* gtr, low: ln of the median slope, */
	double far;       /* and a slope beyond which D hardly changes up to the horizon */
	/* Set by ndf_turn(). */
	double angle; /* of the axis of sigma_x: its azimuth in degrees, (-90, 90]; 0: the axes are x and y */
	double turn_cos, turn_sin; /* of it; read only where angle is not 0 */
	/* Set by ndf_tilt(): */
	double tilt_x, tilt_y; /* means of m.x/m.z and m.y/m.z; 0 but for the ellipsoid */
	double lean_x, lean_y; /* the same along the axes */
};

/* ndf_find - the class called `name` ("std", "ggx", ...), or NULL. */
const struct ndf_class *ndf_find(const char *name);
/* ndf_at - the classes in the order of the table, index 0, 1, ...; NULL past the last. */
const struct ndf_class *ndf_at(int index);
const char *ndf_name(const struct ndf_class *ndf_class);
/* ndf_has_gamma - whether the class has a shape beside its roughness: the argument gamma of ndf_init() matters. */
bool ndf_has_gamma(const struct ndf_class *ndf_class);
/* ndf_is_tabulated - whether the class has no parameters but a table: ndf_init() refuses it. */
bool ndf_is_tabulated(const struct ndf_class *ndf_class);
/* ndf_has_lambda_forms - whether the class has Student-t slopes of a free gamma, and with them the forms of Lambda of
 * lambda_form.h. */
bool ndf_has_lambda_forms(const struct ndf_class *ndf_class);
/* ndf_has_anisotropy - whether sigma_x and sigma_y may differ. */
bool ndf_has_anisotropy(const struct ndf_class *ndf_class);
/* ndf_has_tilt - whether ndf_tilt() takes it: the ellipsoid. */
bool ndf_has_tilt(const struct ndf_class *ndf_class);
/* ndf_is_student_t - whether the slopes are Student-t (std, hyper-cauchy, t-family): the other forms of Lambda exist, and
 * gamma begins at 1.5. */
bool ndf_is_student_t(const struct ndf_class *ndf_class);
/* ndf_param_at - the named parameters of a class, index 0, 1, ...; NULL past the last. */
const struct ndf_param *ndf_param_at(const struct ndf_class *ndf_class, int index);

/* ndf_init - prepares a distribution from a roughness and a shape: coordinates in which all classes can be searched
 * alike. low takes C = gamma and B = 2/(gamma sigma^2), which makes sigma the width of its peak; t-family takes x = 2.
 * Given:   sigma_x, sigma_y in [NDF_SIGMA_MIN, NDF_SIGMA_MAX]; gamma in the class's domain, read only by classes that
 *          have one: (1.5, INFINITY] for std, (1.5, 1e6] for hyper-cauchy, at least 1.5 and x + 1e-6 for t-family, the
 *          open end excluded, (0, 1000] for gtr and low; for gtr sigma^(2 gamma) below 1e260
 * Returns: STATUS_OK, or STATUS_DOMAIN with *ndf untouched: an argument outside its range, NaN, sigma_x != sigma_y
 *          for a class without anisotropy, or a NULL class. */
MUST_CHECK enum status ndf_init(struct ndf *ndf, const struct ndf_class *ndf_class, double sigma_x, double sigma_y,
				double gamma);

/* ndf_init_params - prepares an isotropic distribution from its own parameters: value[i] for ndf_param_at(ndf_class, i).
 * A struct ndf's param[] given back makes the same distribution, to the bit.
 * Returns: as ndf_init(). */
MUST_CHECK enum status ndf_init_params(struct ndf *ndf, const struct ndf_class *ndf_class, const double value[]);

/* ndf_init_params_anisotropic - the same with the roughness value[0] along x and sigma_y along y, so that t-family is
 * anisotropic with any x. Returns: as ndf_init(). */
MUST_CHECK enum status ndf_init_params_anisotropic(struct ndf *ndf, const struct ndf_class *ndf_class,
						   const double value[], double sigma_y);

/* ndf_from_pwl - the piecewise-linear distribution *pwl, which has to outlive *ndf; anisotropic if its tables are. */
void ndf_from_pwl(struct ndf *ndf, const struct pwl *pwl);

/* ndf_set_lambda_form - the form of Lambda that ndf_lambda() and ndf_G1() use from now on; exact after ndf_init().
 * Returns: STATUS_OK; STATUS_UNSUPPORTED for a class with nothing but its exact form (not ndf_is_student_t(); pl has
 *          LAMBDA_TRAPEZOID); STATUS_DOMAIN where gamma is none that the form can do (lambda_form.h). *ndf is untouched
 *          then. */
MUST_CHECK enum status ndf_set_lambda_form(struct ndf *ndf, enum lambda_form form);

/* ndf_from_ellipsoid - the distribution of an ellipsoid: its roughnesses, axes and tilt. *ellipsoid is only read.
 * Returns: STATUS_OK, or STATUS_DOMAIN, *ndf untouched: a roughness is out of the domain of ndf_init(). Relative error of D
 *          1e-14 times the condition of A. */
MUST_CHECK enum status ndf_from_ellipsoid(struct ndf *ndf, const struct ellipsoid *ellipsoid);

/* ndf_tilt - leans the facets of the ellipsoid: the mean of m.x/m.z and m.y/m.z is (x, y), whatever the angle of the axes, 0 after
 * ndf_init(). Such facets are not those of a surface that is level on average: Smith's masking would exceed 1 for some
 * directions. So Lambda there is 0, while visible normals have the exact density [ellipsoid_pdf()].
 * Given:   |x|, |y| up to NDF_SIGMA_MAX
 * Returns: STATUS_OK; STATUS_UNSUPPORTED for another class, STATUS_DOMAIN for other numbers; *ndf is untouched then. */
MUST_CHECK enum status ndf_tilt(struct ndf *ndf, double x, double y);

/* ndf_is_tilted - whether ndf_tilt() has been given other than 0, 0.
 * ndf_is_anisotropic - whether D changes with the azimuth: that, two roughnesses, or two tables of pl. */
bool ndf_is_tilted(const struct ndf *ndf);
bool ndf_is_anisotropic(const struct ndf *ndf);

/* ndf_plain - GGX or Beckmann, into *plain, where a distribution is one of them under another name: the same D
 * and Lambda to rounding. Returns: false, *plain untouched, where it is neither, or has the rational form of Lambda. */
bool ndf_plain(const struct ndf *ndf, struct ndf *plain);

/* ndf_turn - turns the axes of the roughness about the normal: that of sigma_x, which is x after ndf_init(), gets the
 * azimuth `degrees`. In all that follows a direction's azimuth counts from there.
 * Given:   degrees finite; turns of 180 degrees make no difference
 * Returns: STATUS_DOMAIN, *ndf untouched, for NaN and infinities. */
MUST_CHECK enum status ndf_turn(struct ndf *ndf, double degrees);

/* ndf_D - density of microfacet normals, 1/sr.
 *     beckmann   exp(-q) / (pi sigma_x sigma_y cos^4)                        q = tan^2 (cos^2 phi/sigma_x^2 +
 *     ggx        (1 + q)^-2 / (pi sigma_x sigma_y cos^4)                             sin^2 phi/sigma_y^2)
 *     std        (1 + q/(gamma-1))^-gamma / (pi sigma_x sigma_y cos^4)       [Ribardiere et al. 2017]
 *     hyper-cauchy, t-family     f (gamma-1) (1 + f q)^-gamma / (pi sigma_x sigma_y cos^4)     [same, supplement]
 *     gtr, low   as above
 * Given:   m a unit vector
 * Returns: D >= 0; 0 for m.z <= 0; NaN in gives NaN out. The limit at the horizon is 0 for Student-t slopes of
 *          gamma > 2, infinite for gamma < 2, finite else. */
double ndf_D(const struct ndf *ndf, struct vec3 m);

/* ndf_lambda - Smith's Lambda(w), dimensionless: (1/mu) integral over q > mu of (q - mu) P2(q), where mu = cot(theta)
 * and P2 is the density of the slopes along w; anisotropic through sigma^2 = sigma_x^2 cos^2 phi + sigma_y^2 sin^2 phi.
 * Given:   w a unit vector
 * Returns: Lambda >= 0; 0 at normal incidence (but for the rational form); INFINITY for w.z <= 0, and where K/z
 *          overflows, for w.z below 1e-275 max(1, sigma) only; NaN in gives NaN out. */
double ndf_lambda(const struct ndf *ndf, struct vec3 w);

/* ndf_G1 - Smith's masking 1/(1 + Lambda(w)), in [0, 1]: 1 at normal incidence, 0 for w.z <= 0. */
double ndf_G1(const struct ndf *ndf, struct vec3 w);

/* ndf_sample - a microfacet normal with the density ndf_pdf(), from two uniform numbers: u1 turns, u2 tilts.
 * Given:   u1, u2 in [0, 1)
 * Returns: a unit vector, z >= 0. u2 = 0 gives the normal +z, for gtr with sigma > 1 too. low inverts by Newton's
 *          method, the others in closed form; relative error of the slope 1e-14 where the cosine exceeds 1e-6
 *          (3e-13 where the roughnesses are as 1000 to 1). */
struct vec3 ndf_sample(const struct ndf *ndf, double u1, double u2);

/* ndf_pdf - D(m) m.z, 1/sr: the density of ndf_sample(). */
double ndf_pdf(const struct ndf *ndf, struct vec3 m);

#endif
