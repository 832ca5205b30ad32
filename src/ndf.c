/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "src/ndf.h"
#include "src/ndf_class.h"
#include "src/ndf_formulas.h"
#include "src/pwl.h"
#include "src/student_t.h"
#include <string.h>

static const struct ndf_class *const classes[] = {
	&ndf_class_std,      &ndf_class_ggx, &ndf_class_beckmann, &ndf_class_gtr,       &ndf_class_hyper_cauchy,
	&ndf_class_t_family, &ndf_class_low, &ndf_class_pl,       &ndf_class_ellipsoid,
};

enum { CLASSES = sizeof(classes) / sizeof(classes[0]) };

const struct ndf_class *ndf_at(int index)
{
	return index >= 0 && index < CLASSES ? classes[index] : NULL;
}

const struct ndf_class *ndf_find(const char *name)
{
	for (int i = 0; name && i < CLASSES; i++) {
		if (strcmp(classes[i]->name, name) == 0)
			return classes[i];
	}
	return NULL;
}

const char *ndf_name(const struct ndf_class *class)
{
	return class->name;
}

bool ndf_has_gamma(const struct ndf_class *class)
{
	return class->n_params > 1;
}

bool ndf_is_tabulated(const struct ndf_class *class)
{
	return class->n_params == 0;
}

bool ndf_has_lambda_forms(const struct ndf_class *class)
{
	return class->student_t;
}

bool ndf_has_anisotropy(const struct ndf_class *class)
{
	return !class->isotropic;
}

bool ndf_has_tilt(const struct ndf_class *class)
{
	return class->tilts;
}

bool ndf_is_student_t(const struct ndf_class *class)
{
	return class->student_t;
}

const struct ndf_param *ndf_param_at(const struct ndf_class *class, int index)
{
	return index >= 0 && index < class->n_params ? &class->param[index] : NULL;
}

static bool param_valid(const struct ndf_param *param, double value)
{
	return (param->min_included ? value >= param->min : value > param->min) && value <= param->max;
}

/* Everything but *out is in place: checks it, prepares it, hands it out. */
static enum status finish(const struct ndf *filled, struct ndf *out)
{
	struct ndf ndf = *filled;
	for (int i = 0; i < ndf.class->n_params; i++) {
		if (!param_valid(&ndf.class->param[i], ndf.param[i]))
			return STATUS_DOMAIN;
	}
	if (ndf.class->prepare && !ndf.class->prepare(&ndf))
		return STATUS_DOMAIN;
	*out = ndf;
	return STATUS_OK;
}

static bool sigma_valid(double sigma)
{
	return sigma >= NDF_SIGMA_MIN && sigma <= NDF_SIGMA_MAX;
}

enum status ndf_init(struct ndf *ndf, const struct ndf_class *class, double sigma_x, double sigma_y, double gamma)
{
	if (!class || ndf_is_tabulated(class) || !sigma_valid(sigma_x) || !sigma_valid(sigma_y) ||
	    (class->isotropic && sigma_x != sigma_y))
		return STATUS_DOMAIN;
	struct ndf filled = {
		.class = class,
		.sigma_x = sigma_x,
		.sigma_y = sigma_y,
		.gamma = ndf_has_gamma(class) ? gamma : class->gamma,
		.param = {sigma_x, gamma},
		.stretch = 1.0,
	};
	if (class->to_params)
		class->to_params(&filled);
	return finish(&filled, ndf);
}

enum status ndf_init_params(struct ndf *ndf, const struct ndf_class *class, const double value[])
{
	if (!class || ndf_is_tabulated(class))
		return STATUS_DOMAIN;
	struct ndf filled = {
		.class = class,
		.sigma_x = value[0],
		.sigma_y = value[0],
		.stretch = 1.0,
		.gamma = ndf_has_gamma(class) ? value[1] : class->gamma,
	};
	memcpy(filled.param, value, (size_t) class->n_params * sizeof(value[0]));
	if (class->from_params)
		class->from_params(&filled);
	return finish(&filled, ndf);
}

enum status ndf_init_params_anisotropic(struct ndf *ndf, const struct ndf_class *class, const double value[],
					double sigma_y)
{
	struct ndf filled;
	if (!class || class->isotropic || !sigma_valid(sigma_y) || ndf_init_params(&filled, class, value) != STATUS_OK)
		return STATUS_DOMAIN;
	filled.sigma_y = sigma_y;
	*ndf = filled;
	return STATUS_OK;
}

enum status ndf_set_lambda_form(struct ndf *ndf, enum lambda_form form)
{
	if (form == LAMBDA_TRAPEZOID && ndf->pwl) {
		ndf->lambda_form = form;
		return STATUS_OK;
	}
	if (form != LAMBDA_EXACT && !ndf->class->student_t)
		return STATUS_UNSUPPORTED;
	if (!lambda_form_takes(form, ndf->gamma))
		return STATUS_DOMAIN;
	ndf->lambda_form = form;
	ndf->lambda_K = form == LAMBDA_EXACT ? 0.0 : student_t_K(ndf->gamma);
	return STATUS_OK;
}

bool ndf_is_tilted(const struct ndf *ndf)
{
	return ndf->tilt_x != 0.0 || ndf->tilt_y != 0.0;
}

bool ndf_is_anisotropic(const struct ndf *ndf)
{
	return ndf->sigma_x != ndf->sigma_y || ndf_is_tilted(ndf) || (ndf->pwl && ndf->pwl->anisotropic);
}

bool ndf_plain(const struct ndf *ndf, struct ndf *plain)
{
	const bool ggx = ndf->gamma == 2.0 && ndf->class->ggx_at_2;
	if ((!ggx && !isinf(ndf->gamma)) || ndf_is_tilted(ndf) || ndf->lambda_form == LAMBDA_RATIONAL)
		return false;
	const struct ndf_class *class = ggx ? &ndf_class_ggx : &ndf_class_beckmann;
	if (ndf_init(plain, class, ndf->sigma_x / ndf->stretch, ndf->sigma_y / ndf->stretch, NAN) != STATUS_OK)
		return false;
	plain->angle = ndf->angle;
	plain->turn_cos = ndf->turn_cos;
	plain->turn_sin = ndf->turn_sin;
	return true;
}

/* The tilt along the axes. */
static void set_lean(struct ndf *ndf)
{
	const struct vec3 lean = ndf_to_axes(ndf, (struct vec3){ndf->tilt_x, ndf->tilt_y, 0.0});
	ndf->lean_x = lean.x;
	ndf->lean_y = lean.y;
}

enum status ndf_turn(struct ndf *ndf, double degrees)
{
	if (!isfinite(degrees))
		return STATUS_DOMAIN;
	const double angle = remainder(degrees, 180.0); /* exact; -90 and 90 are one axis */
	double sine, cosine;

	sincos_deg(fabs(angle), &sine, &cosine);
	ndf->angle = angle == -90.0 ? 90.0 : angle;
	ndf->turn_cos = cosine;
	ndf->turn_sin = ndf->angle < 0.0 ? -sine : sine;
	set_lean(ndf);
	return STATUS_OK;
}

enum status ndf_tilt(struct ndf *ndf, double x, double y)
{
	if (!ndf->class->tilts)
		return STATUS_UNSUPPORTED;
	if (!(fabs(x) <= NDF_SIGMA_MAX && fabs(y) <= NDF_SIGMA_MAX))
		return STATUS_DOMAIN;
	ndf->tilt_x = x;
	ndf->tilt_y = y;
	set_lean(ndf);
	return STATUS_OK;
}

double ndf_D(const struct ndf *ndf, struct vec3 m)
{
	return m.z <= 0.0 ? 0.0 : ndf->class->D(ndf, ndf_to_axes(ndf, m));
}

double ndf_lambda(const struct ndf *ndf, struct vec3 w)
{
	if (w.z <= 0.0)
		return INFINITY;
	w = ndf_to_axes(ndf, w);
	if (ndf->lambda_form == LAMBDA_TRAPEZOID)
		return fmax(1.0 / pwl_G1_trapezoid(ndf->pwl, w) - 1.0, 0.0);
	if (ndf->lambda_form != LAMBDA_EXACT)
		return lambda_form_lambda(ndf->lambda_form, ndf->gamma, ndf->lambda_K, student_t_z(ndf, w));
	return ndf->class->lambda(ndf, w);
}

double ndf_G1(const struct ndf *ndf, struct vec3 w)
{
	return 1.0 / (1.0 + ndf_lambda(ndf, w));
}

struct vec3 ndf_sample(const struct ndf *ndf, double u1, double u2)
{
	if (ndf->pwl)
		return ndf_from_axes(ndf, pwl_sample(ndf->pwl, u1, u2));
	const double s = ndf->class->tilt(ndf, u2);
	const double turn = 2.0 * M_PI * u1;
	const struct vec3 m = {ndf->sigma_x * s * cos(turn), ndf->sigma_y * s * sin(turn), 1.0};
	return ndf_from_axes(ndf, vec3_unit(ndf_tilted_normal(ndf, m)));
}

double ndf_pdf(const struct ndf *ndf, struct vec3 m)
{
	return ndf_D(ndf, m) * m.z;
}
