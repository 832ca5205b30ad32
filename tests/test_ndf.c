/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "src/ndf.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>

static struct ndf ndf_make(const char *name, double sigma_x, double sigma_y, double gamma)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find(name), sigma_x, sigma_y, gamma), STATUS_OK);
	return ndf;
}

/* Every class with shapes from its domain; the list ends with 0. */
static const struct {
	const char *name;
	double gamma[16];
} shapes[] = {
	{"std", {1.5001, 1.503, 1.72, 1.999, 2.0, 2.5, 3.0, 7.31, 32.9, 33.1, 170.0, 1e3, 1e6, INFINITY}},
	{"ggx", {2.0}},
	{"beckmann", {INFINITY}},
	{"hyper-cauchy", {1.5001, 1.72, 2.0, 3.0, 33.1, 1e3, 1e6}},
	{"t-family", {2.000002, 2.0001, 2.5, 7.31, 170.0, 1e6, INFINITY}},
	{"gtr", {0.05, 0.71, 1.0, 1.31, 2.0, 5.7, 60.0}},
	{"low", {0.05, 0.5, 1.0, 1.5, 2.0, 2.31, 60.0, 1e3}},
	{"ellipsoid", {2.0}},
};

enum { SHAPES = sizeof(shapes) / sizeof(shapes[0]) };

/* Calls check(&ndf) for every class over a grid of roughness and shape, isotropic and anisotropic. */
static void for_all(void (*check)(const struct ndf *ndf))
{
	const double sigmas[] = {1e-4, 0.0123, 0.31, 1.07, 4.0, 37.0};
	for (int c = 0; c < SHAPES; c++) {
		for (int g = 0; shapes[c].gamma[g] > 0.0; g++) {
			for (int s = 0; s < 6; s++) {
				const struct ndf round =
					ndf_make(shapes[c].name, sigmas[s], sigmas[s], shapes[c].gamma[g]);
				check(&round);
				if (!ndf_has_anisotropy(round.class))
					continue;
				const struct ndf oval =
					ndf_make(shapes[c].name, sigmas[s], 0.3 * sigmas[s], shapes[c].gamma[g]);
				check(&oval);
			}
		}
	}
}

/* Reference values. A far tail of D multiplies the rounding of the unit vector by |ln D|: where long double is no wider
 * than double (some machines, valgrind) the vectors are rounded twice, and 1e-13 is beyond reach. */
static double tolerance_D(void)
{
	return long_double_is_wide() ? 1e-13 : 3e-13;
}

static void check_golden_D(const struct golden *golden, const struct ndf *ndf, struct vec3 m, double want)
{
	if (want == 0.0) /* below 1e-300 */
		check_between(ndf_D(ndf, m), 0.0, 1e-300, golden->label);
	else
		check_rel(ndf_D(ndf, m), want, tolerance_D(), golden->label);
}

static void check_golden_smith(const struct golden *golden, const struct ndf *ndf, struct vec3 w, double lambda,
			       double G1)
{
	if (lambda == 0.0) /* below 1e-300 */
		check_between(ndf_lambda(ndf, w), 0.0, 1e-300, golden->label);
	else
		check_rel(ndf_lambda(ndf, w), lambda, lambda > 1e-20 ? 5e-14 : 1e-12, golden->label);
	check_rel(ndf_G1(ndf, w), G1, 2e-15, golden->label);
}

static void std_D_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/std_D.csv", "gamma,sigma,theta_deg,D");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make("std", v[1], v[1], v[0]);
		check_golden_D(&golden, &ndf, vec3_from_spherical_deg(v[2], 0.0), v[3]);
	}
}

static void std_Lambda_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/std_lambda.csv", "gamma,sigma,theta_deg,mu,Lambda,G1");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make("std", v[1], v[1], v[0]);
		check_golden_smith(&golden, &ndf, vec3_from_spherical_deg(v[2], 0.0), v[4], v[5]);
	}
}

static void golden_closed(const char *path, const char *name)
{
	struct golden golden = golden_open(path, "sigma,theta_deg,mu,D,Lambda,G1");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make(name, v[0], v[0], NAN);
		const struct vec3 w = vec3_from_spherical_deg(v[1], 0.0);
		check_golden_D(&golden, &ndf, w, v[3]);
		check_golden_smith(&golden, &ndf, w, v[4], v[5]);
	}
}

static void beckmann_matches_golden_rows(void **state)
{
	(void)state;
	golden_closed("tests/golden/beckmann_lambda.csv", "beckmann");
}

static void ggx_matches_golden_rows(void **state)
{
	(void)state;
	golden_closed("tests/golden/ggx_lambda.csv", "ggx");
}

static void anisotropic_std_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden =
		golden_open("tests/golden/aniso_std.csv", "gamma,sigma_x,sigma_y,theta_deg,phi_deg,D,Lambda,G1");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make("std", v[1], v[2], v[0]);
		const struct vec3 w = vec3_from_spherical_deg(v[3], v[4]);
		check_golden_D(&golden, &ndf, w, v[5]);
		check_golden_smith(&golden, &ndf, w, v[6], v[7]);
	}
}

static void anisotropic_classes_match_golden_rows(void **state)
{
	(void)state;
	struct golden golden =
		golden_open("tests/golden/vndf_pdf.csv",
			    "model,gamma,sigma_x,sigma_y,theta_i_deg,phi_i_deg,theta_m_deg,phi_m_deg,D,G1_i,D_wi");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make(golden.text[0], v[2], v[3], v[1]);
		check_golden_D(&golden, &ndf, vec3_from_spherical_deg(v[6], v[7]), v[8]);
		check_rel(ndf_G1(&ndf, vec3_from_spherical_deg(v[4], v[5])), v[9], 2e-15, golden.label);
	}
}

/* D of vectors taken as exact, far into the tails: there is no rounding of an angle in these. */
static void values_match_golden_vectors(void **state)
{
	(void)state;
	static const struct {
		double gamma, sigma_x, sigma_y;
		struct vec3 m;
		double D;
	} rows[] = {
		{INFINITY, 0.05, 0.05, {0.717, 0, 0.6970731668913961}, 8.7116726242074986419e-182},
		{INFINITY, 0.31, 0.31, {0.987, 0, 0.1607202538574403}, 1.8311265165552983854e-167},
		{INFINITY, 0.07, 0.03, {0.41, 0.553, 0.725321308111102}, 8.3075118762584425988e-307},
		{1000.0, 0.05, 0.05, {0.6931, 0, 0.7208414458117679}, 7.8992931825800857982e-135},
		{474.99, 0.0955, 0.0955, {0.96, 0.0, 0.28}, 6.2108007694611542061e-268},
		{183.45, 0.0232, 1.396, {0.871, 0.1313, 0.4734124100612488}, 9.32665558168153088e-283},
		{1e6, 0.4, 0.3, {0.777, 0.613, 0.14318519476538055}, 2.8764473725452453769e-165},
		{1000000000000.0, 0.041, 0.041, {0.71, 0.13, 0.692098258919931}, 8.1008650713673654849e-279},
		{60.0, 0.001, 0.001, {0.7, 0.1, 0.7071067811865476}, 2.2620044764499432528e-248},
		{1.52, 0.3, 0.3, {0.999999, 0.0, 0.0014142132088478148}, 18.31843126716188128},
	};
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		const struct ndf ndf = ndf_make("std", rows[i].sigma_x, rows[i].sigma_y, rows[i].gamma);
		check_rel(ndf_D(&ndf, rows[i].m), rows[i].D, 2e-15, "D of an exact vector");
	}
}

/* Properties. */

/* The normal of the slopes (sigma_x s cos phi, sigma_y s sin phi). */
static struct vec3 normal_of(const struct ndf *ndf, double s, double phi)
{
	return vec3_unit((struct vec3){ndf->sigma_x * s * cos(phi), ndf->sigma_y * s * sin(phi), 1.0});
}

struct ray {
	const struct ndf *ndf;
	double phi;
};

/* D cos dw = D cos^4 (slope area) = D cos^4 sigma_x sigma_y s ds dphi, and ds = s dv with s = exp(v). */
static double normalisation_integrand(double v, void *params)
{
	const struct ray *ray = params;
	const double s = exp(v);
	const struct vec3 m = normal_of(ray->ndf, s, ray->phi);
	const double cos4 = m.z * m.z * m.z * m.z;
	return 2.0 * M_PI * ndf_D(ray->ndf, m) * cos4 * ray->ndf->sigma_x * s * ray->ndf->sigma_y * s;
}

/* In stretched slopes every azimuth holds the same share. */
static void check_normalised(const struct ndf *ndf)
{
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(400);
	for (double phi = 0.1; phi < 6.2; phi += 1.7) {
		struct ray ray = {ndf, phi};
		gsl_function f = {normalisation_integrand, &ray};
		double sum = NAN, error;
		/* From far below the median slope, in units of sigma, to where 1e-13 of the normals is left. */
		const struct vec3 m = ndf_sample(ndf, 0.0, 0.5);
		const double middle = log(m.x / m.z / ndf->sigma_x);
		const double end = ndf_has_anisotropy(ndf->class) ? middle + 6.0 + 16.0 / (ndf->gamma - 1.0)
								  : fmax(middle, -log(ndf->sigma_x)) + 17.0;
		const int failed = gsl_integration_qag(&f, middle - 18.0, end, 0.0, 1e-12, 400, GSL_INTEG_GAUSS61,
						       workspace, &sum, &error);
		assert_int_equal(failed, GSL_SUCCESS);
		check_rel(sum, 1.0, 1e-11, ndf_name(ndf->class));
	}
	gsl_integration_workspace_free(workspace);
}

static void D_is_normalised(void **state)
{
	(void)state;
	for_all(check_normalised);
}

/* Smith's G1 from its definition, cos / (integral of <w.m> D dm), through D alone. In slopes (p along w, r across)
 * divided by their sigma the integral of <w.m> D is that of max(0, cos - sigma p sin) P22(p) P22(r|p). */
struct definition {
	const struct ndf *ndf;
	double mu, p;
	gsl_integration_workspace *inner;
};

static double slopes_pair(double r, void *params)
{
	const struct definition *d = params;
	const struct vec3 m = vec3_unit((struct vec3){d->p, r * d->ndf->sigma_y, 1.0});
	return ndf_D(d->ndf, m) * m.z * m.z * m.z * m.z * d->ndf->sigma_y;
}

static double slope_beyond(double p, void *params)
{
	struct definition *d = params;
	gsl_function f = {slopes_pair, d};
	double density = NAN, error;
	d->p = p;
	gsl_integration_qagi(&f, 0.0, 1e-10, 200, d->inner, &density, &error);
	return (p - d->mu) / d->mu * density;
}

static void Lambda_is_the_integral_that_defines_it(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		double gamma;
	} rows[] = {{"std", 1.72}, {"std", 2.5},           {"std", 7.3},          {"std", 1e3},
		    {"ggx", 2.0},  {"beckmann", INFINITY}, {"hyper-cauchy", 3.1}, {"t-family", 2.3},
		    {"gtr", 0.7},  {"gtr", 3.3},           {"low", 0.9},          {"low", 4.5}};
	gsl_integration_workspace *inner = gsl_integration_workspace_alloc(200);
	gsl_integration_workspace *outer = gsl_integration_workspace_alloc(200);
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		for (double theta = 35.0; theta < 90.0; theta += 22.0) {
			const double sigma_y = ndf_has_anisotropy(ndf_find(rows[i].name)) ? 0.25 : 0.6;
			const struct ndf ndf = ndf_make(rows[i].name, 0.6, sigma_y, rows[i].gamma);
			const struct vec3 w = vec3_from_spherical_deg(theta, 0.0);
			struct definition d = {&ndf, w.z / w.x, 0.0, inner};
			gsl_function f = {slope_beyond, &d};
			double lambda = NAN, error;
			gsl_integration_qagiu(&f, d.mu, 0.0, 1e-8, 200, outer, &lambda, &error);
			check_rel(ndf_lambda(&ndf, w), lambda, 1e-6, rows[i].name);
			check_rel(ndf_G1(&ndf, w), 1.0 / (1.0 + lambda), 1e-7, rows[i].name);
		}
	}
	gsl_integration_workspace_free(outer);
	gsl_integration_workspace_free(inner);
}

static void check_masking(const struct ndf *ndf)
{
	/* Quadrature is slower and less exact. */
	const bool closed = ndf_has_anisotropy(ndf->class);
	const double slack = closed ? 1e-14 : 1e-12, step = closed ? 0.25 : 2.5;
	for (double phi = 0.0; phi < (closed ? 360.0 : 67.0); phi += 67.0) {
		double lambda = 0.0, G1 = 1.0;
		check_abs(ndf_lambda(ndf, vec3_from_spherical_deg(0.0, phi)), 0.0, 0.0, "Lambda at normal incidence");
		check_abs(ndf_G1(ndf, vec3_from_spherical_deg(0.0, phi)), 1.0, 0.0, "G1 at normal incidence");
		for (double theta = step; theta < 90.0; theta += step) {
			const struct vec3 w = vec3_from_spherical_deg(theta, phi);
			/* Grows with the angle, but for rounding where it is large and flat. */
			check_between(ndf_lambda(ndf, w), lambda * (1.0 - slack), INFINITY, "Lambda grows");
			check_between(ndf_G1(ndf, w), 0.0, G1 * (1.0 + 0.1 * slack), "G1 falls");
			lambda = ndf_lambda(ndf, w);
			G1 = ndf_G1(ndf, w);
		}
		check_abs(ndf_lambda(ndf, vec3_from_spherical_deg(90.0, phi)), INFINITY, 0.0, "Lambda at the horizon");
		check_abs(ndf_G1(ndf, vec3_from_spherical_deg(90.0, phi)), 0.0, 0.0, "G1 at the horizon");
	}
}

static void masking_is_1_over_1_plus_Lambda(void **state)
{
	(void)state;
	for_all(check_masking);
}

/* D(-m with z kept) = D(m); zero below the horizon; NaN stays NaN. */
static void check_symmetry(const struct ndf *ndf)
{
	for (double theta = 1.0; theta < 90.0; theta += 11.0) {
		const struct vec3 m = vec3_from_spherical_deg(theta, 31.0);
		const struct vec3 opposite = {-m.x, -m.y, m.z};
		assert_true(ndf_D(ndf, m) == ndf_D(ndf, opposite));
		assert_true(ndf_lambda(ndf, m) == ndf_lambda(ndf, opposite));
		const struct vec3 below = {m.x, m.y, -m.z};
		check_abs(ndf_D(ndf, below), 0.0, 0.0, "D below the horizon");
		check_abs(ndf_G1(ndf, below), 0.0, 0.0, "G1 below the horizon");
	}
	const struct vec3 bad[] = {{NAN, 0.0, 1.0}, {0.0, NAN, 0.5}, {0.3, 0.2, NAN}, {NAN, NAN, NAN}};
	for (int i = 0; i < 4; i++) {
		assert_true(isnan(ndf_D(ndf, bad[i])));
		assert_true(isnan(ndf_lambda(ndf, bad[i])));
		assert_true(isnan(ndf_G1(ndf, bad[i])));
	}
}

static void D_and_Lambda_are_symmetric(void **state)
{
	(void)state;
	for_all(check_symmetry);
}

/* Limits between the models. */
static void ggx_is_std_2(void **state)
{
	(void)state;
	const double sigmas[] = {1e-4, 0.2385, 1.7, 40.0};
	for (int s = 0; s < 4; s++) {
		const struct ndf std2 = ndf_make("std", sigmas[s], 0.7, 2.0);
		const struct ndf ggx = ndf_make("ggx", sigmas[s], 0.7, NAN);
		const struct ndf std_inf = ndf_make("std", sigmas[s], 0.7, INFINITY);
		const struct ndf beckmann = ndf_make("beckmann", sigmas[s], 0.7, NAN);
		for (double theta = 0.0; theta <= 90.0; theta += 0.731) {
			const struct vec3 w = vec3_from_spherical_deg(theta, 53.0);
			assert_true(ndf_D(&std2, w) == ndf_D(&ggx, w));
			assert_true(ndf_lambda(&std2, w) == ndf_lambda(&ggx, w));
			assert_true(ndf_D(&std_inf, w) == ndf_D(&beckmann, w));
			assert_true(ndf_lambda(&std_inf, w) == ndf_lambda(&beckmann, w));
		}
	}
}

/* The general code meets the special cases: next to gamma = 2, and for gamma -> infinity as 1/gamma. */
static void limits_are_reached(void **state)
{
	(void)state;
	const struct ndf ggx = ndf_make("ggx", 0.4, 0.4, NAN), beckmann = ndf_make("beckmann", 0.4, 0.4, NAN);
	const struct ndf near_ggx[] = {ndf_make("std", 0.4, 0.4, nextafter(2.0, 1.0)),
				       ndf_make("std", 0.4, 0.4, nextafter(2.0, 3.0))};
	for (double theta = 0.37; theta < 90.0; theta += 0.37) {
		const struct vec3 w = vec3_from_spherical_deg(theta, 0.0);
		for (int i = 0; i < 2; i++) {
			check_rel(ndf_D(&near_ggx[i], w), ndf_D(&ggx, w), 2e-14, "D next to gamma = 2");
			check_rel(ndf_lambda(&near_ggx[i], w), ndf_lambda(&ggx, w), 3e-14, "Lambda next to gamma = 2");
		}
		const double tan_over_sigma = w.x / w.z / 0.4;
		const double q = tan_over_sigma * tan_over_sigma;
		for (double gamma = 1e4; gamma < 1e20; gamma *= 31.0) {
			/* ln D_std - ln D_beckmann = (q^2/2 - q)/gamma + O(q^3/gamma^2) */
			const struct ndf ndf = ndf_make("std", 0.4, 0.4, gamma);
			if (q < 30.0)
				check_rel(ndf_D(&ndf, w) / ndf_D(&beckmann, w), exp((0.5 * q * q - q) / gamma),
					  1e-14 + 30.0 * q * (1.0 + q * q) / (gamma * gamma), "D for large gamma");
			const double z2 = w.z * w.z / (w.x * w.x * 0.4 * 0.4);
			if (z2 < 30.0)
				check_rel(ndf_lambda(&ndf, w), ndf_lambda(&beckmann, w),
					  4e-14 + (2.0 + z2 * z2) / gamma, "Lambda for large gamma");
		}
	}
}

/* gtr is GGX at gamma = 2, its Lambda by quadrature. hyper-cauchy and t-family are std of another roughness, and to the
 * bit where that is the same. low with large C is Beckmann near the normal. */
static void classes_that_are_others_renamed_have_their_values(void **state)
{
	(void)state;
	for (double sigma = 1e-4; sigma < 5.0; sigma *= 2.9) {
		const double x1[] = {sigma, 3.7, 1.0};
		struct ndf t_family;
		assert_int_equal(ndf_init_params(&t_family, ndf_find("t-family"), x1), STATUS_OK);
		const struct ndf std = ndf_make("std", sigma, sigma, 3.7);
		const struct ndf hyper = ndf_make("hyper-cauchy", sigma, sigma, 5.0);
		const struct ndf narrow = ndf_make("std", 0.5 * sigma, 0.5 * sigma, 5.0);
		const struct ndf ggx = ndf_make("ggx", sigma, sigma, 2.0), gtr = ndf_make("gtr", sigma, sigma, 2.0);
		for (double z = 1e-6; z < 1e3; z *= 1.7) {
			const struct vec3 w = vec3_unit((struct vec3){1.0, 0.0, z});
			assert_true(ndf_D(&t_family, w) == ndf_D(&std, w));
			assert_true(ndf_lambda(&t_family, w) == ndf_lambda(&std, w));
			assert_true(ndf_D(&hyper, w) == ndf_D(&narrow, w));
			check_rel(ndf_lambda(&hyper, w), ndf_lambda(&narrow, w), 3e-14, "Hyper-Cauchy");
			check_rel(ndf_D(&gtr, w), ndf_D(&ggx, w), 4e-15, "D of gtr, gamma = 2");
			check_rel(ndf_lambda(&gtr, w), ndf_lambda(&ggx, w), 1e-12, "Lambda of gtr, gamma = 2");
		}
	}
	const struct ndf low = ndf_make("low", 0.01, 0.01, 1e3), beckmann = ndf_make("beckmann", 0.01, 0.01, 0.0);
	for (double theta = 0.0; theta < 0.8; theta += 0.1) {
		const struct vec3 w = vec3_from_spherical_deg(theta, 0.0);
		check_rel(ndf_D(&low, w), ndf_D(&beckmann, w), 2e-3, "D of low, large C");
	}
}

/* Integrand of Lambda over t = mu (1 + exp(x)): twice P22(t) t (r - atan(r)), r = sqrt((t/mu)^2 - 1). */
static double turned_away(double x, void *params)
{
	const struct definition *d = params;
	const double s = exp(x), t = d->mu * (1.0 + s), r = sqrt(s * (2.0 + s));
	const double excess = r < 1e-3 ? r * r * r * (1.0 / 3.0 - r * r / 5.0) : r - atan(r);
	const struct vec3 m = vec3_unit((struct vec3){t, 0.0, 1.0});
	return 2.0 * ndf_D(d->ndf, m) * m.z * m.z * m.z * m.z * t * excess * d->mu * s;
}

/* The trapezoid rule of smith_quadrature against an adaptive one in another variable. */
static void check_quadrature(const struct ndf *ndf)
{
	if (ndf_has_anisotropy(ndf->class))
		return;
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(400);
	for (double mu = 1e-4; mu < 1e3; mu *= 11.0) {
		struct definition d = {ndf, mu, 0.0, NULL};
		gsl_function f = {turned_away, &d};
		double lambda = NAN, error;
		gsl_integration_qag(&f, -45.0, 45.0 - log(mu), 0.0, 1e-10, 400, GSL_INTEG_GAUSS61, workspace, &lambda,
				    &error);
		const struct vec3 w = vec3_unit((struct vec3){1.0, 0.0, mu});
		if (lambda > 1e-200)
			check_rel(ndf_lambda(ndf, w), lambda, 2e-8, ndf_name(ndf->class));
		check_rel(ndf_G1(ndf, w), 1.0 / (1.0 + lambda), 1e-12, ndf_name(ndf->class));
	}
	gsl_integration_workspace_free(workspace);
}

static void G1_by_quadrature_matches_the_integral(void **state)
{
	(void)state;
	for_all(check_quadrature);
}

/* No step where one formula hands over to the next: z = 0.8, and gamma = 33 for the ratio of Gamma functions. */
static void no_step_where_formulas_meet(void **state)
{
	(void)state;
	const double gammas[] = {1.5001, 1.72, 2.5, 10.0, 1e3, 1e9, INFINITY};
	for (int g = 0; g < 7; g++) {
		const struct ndf ndf = ndf_make("std", 1.0, 1.0, gammas[g]);
		const double below = 0.8 - 1e-15, above = 0.8 + 1e-15;
		check_rel(ndf_lambda(&ndf, vec3_unit((struct vec3){1.0, 0.0, below})),
			  ndf_lambda(&ndf, vec3_unit((struct vec3){1.0, 0.0, above})), 5e-14, "Lambda at z = 0.8");
	}
	const struct ndf a = ndf_make("std", 0.5, 0.5, nextafter(33.0, 0.0)), b = ndf_make("std", 0.5, 0.5, 33.0);
	check_rel(a.K, b.K, 5e-15, "K at gamma = 33");
}

/* The corners of the domain: values may leave the range of a double, but never become NaN. */
static void check_corner(const struct ndf *ndf)
{
	const double cosines[] = {4.9e-324, 1e-308, 1e-200, 1e-99, 1e-50, 1e-8, 0.5};
	const double sines[] = {0.0, 4.9e-324, 1e-200, 1e-20, 0.5};
	for (int k = 0; k < 7 + 5; k++) {
		struct vec3 w = {0.0, k < 7 ? 0.0 : sines[k - 7], 1.0};
		if (k < 7)
			w = (struct vec3){sqrt(1.0 - cosines[k] * cosines[k]), 0.0, cosines[k]};
		check_between(ndf_D(ndf, w), 0.0, INFINITY, ndf_name(ndf->class));
		check_between(ndf_lambda(ndf, w), 0.0, INFINITY, ndf_name(ndf->class));
		check_between(ndf_G1(ndf, w), 0.0, 1.0, ndf_name(ndf->class));
	}
	for (double u = 0.0; u < 1.0; u = 0.5 * (1.0 + u) + 1e-17) {
		const struct vec3 m = ndf_sample(ndf, u, u);
		check_abs(vec3_length(m), 1.0, 1e-15, "length of a sample");
		check_between(m.z, 0.0, 1.0, "sample above the horizon");
	}
}

static void corners_of_the_domain_stay_finite(void **state)
{
	(void)state;
	const double sigmas[] = {NDF_SIGMA_MIN, 1e-20, 1.0, 1e20, NDF_SIGMA_MAX};
	static const struct {
		const char *name;
		double gamma[9];
	} extremes[] = {
		{"std", {1.5000000000000002, 1.75, 2.0, 2.5, 1e3, 1e17, 1e300, INFINITY}},
		{"ggx", {2.0}},
		{"beckmann", {INFINITY}},
		{"hyper-cauchy", {1.5000000000000002, 1.75, 2.0, 2.5, 1e3, 1e6}},
		{"t-family", {2.0000011, 2.5, 1e3, 1e17, 1e300, INFINITY}},
		{"gtr", {1e-300, 0.5, 0.9999999999999999, 1.0, 2.6}},
		{"low", {1e-15, 0.5, 0.9999999999999999, 1.0, 2.0, 1e3}},
		{"ellipsoid", {2.0}},
	};
	for (int c = 0; c < SHAPES; c++) {
		for (int g = 0; extremes[c].gamma[g] > 0.0; g++) {
			for (int i = 0; i < 5 * 5; i++) {
				struct ndf ndf;
				const struct ndf_class *class = ndf_find(extremes[c].name);
				const double x = sigmas[i % 5], y = sigmas[i / 5];
				if (x != y && !ndf_has_anisotropy(class))
					continue;
				assert_int_equal(ndf_init(&ndf, class, x, y, extremes[c].gamma[g]), STATUS_OK);
				check_corner(&ndf);
			}
		}
	}
}

/* Shapes outside each class's domain, 0 among them. */
static const struct {
	const char *name;
	double gamma[8];
} outside[] = {
	{"std", {1.5, 1.0, -3.0, NAN, -INFINITY}},
	{"hyper-cauchy", {1.5, 1.0, 1.1e6, INFINITY, NAN, -INFINITY}},
	{"t-family", {2.0, 1.75, 2.0000005, -1.0, NAN, -INFINITY}},
	{"gtr", {-1.0, 1001.0, INFINITY, NAN, -INFINITY}},
	{"low", {-1.0, 1001.0, INFINITY, NAN, -INFINITY}},
};

static void arguments_outside_the_domain_are_refused(void **state)
{
	(void)state;
	const double bad_sigmas[] = {0.0, -0.1, NAN, INFINITY, -INFINITY, 1e-51, 1e51};
	const struct ndf before = ndf_make("std", 0.25, 0.5, 3.0);
	struct ndf ndf = before;
	for (int c = 0; ndf_at(c); c++) {
		for (int i = 0; i < 7; i++) {
			assert_int_equal(ndf_init(&ndf, ndf_at(c), bad_sigmas[i], 0.3, 2.5), STATUS_DOMAIN);
			assert_int_equal(ndf_init(&ndf, ndf_at(c), 0.3, bad_sigmas[i], 2.5), STATUS_DOMAIN);
			assert_memory_equal(&ndf, &before, sizeof(ndf));
		}
	}
	for (size_t c = 0; c < sizeof(outside) / sizeof(outside[0]); c++) {
		for (int i = 0; i < 8; i++) {
			const struct ndf_class *class = ndf_find(outside[c].name);
			const double params[] = {0.3, outside[c].gamma[i], 2.0};
			assert_int_equal(ndf_init(&ndf, class, 0.3, 0.3, outside[c].gamma[i]), STATUS_DOMAIN);
			assert_int_equal(ndf_init_params(&ndf, class, params), STATUS_DOMAIN);
			assert_memory_equal(&ndf, &before, sizeof(ndf));
		}
	}
	const char *const round_only[] = {"gtr", "low"};
	for (int c = 0; c < 2; c++)
		assert_int_equal(ndf_init(&ndf, ndf_find(round_only[c]), 0.3, 0.31, 2.5), STATUS_DOMAIN);
	assert_int_equal(ndf_init(&ndf, ndf_find("gtr"), 4.0, 4.0, 300.0), STATUS_DOMAIN); /* 4^600 */
	const double bad_B[][2] = {{0.0, 2.0}, {-1.0, 2.0}, {NAN, 2.0}, {INFINITY, 2.0}, {3.0, 0.0}, {3.0, NAN}};
	for (int i = 0; i < 6; i++)
		assert_int_equal(ndf_init_params(&ndf, ndf_find("low"), bad_B[i]), STATUS_DOMAIN);
	const double bad_x[][3] = {{0.3, 3.0, 3.0}, {0.3, 3.0, 4.0}, {0.3, 3.0, NAN}, {0.3, 1.4, 1.0}};
	for (int i = 0; i < 4; i++)
		assert_int_equal(ndf_init_params(&ndf, ndf_find("t-family"), bad_x[i]), STATUS_DOMAIN);
	assert_int_equal(ndf_init_params(&ndf, NULL, bad_x[0]), STATUS_DOMAIN);
	assert_int_equal(ndf_init(&ndf, NULL, 0.3, 0.3, 2.5), STATUS_DOMAIN);
	assert_memory_equal(&ndf, &before, sizeof(ndf));
}

static void every_class_is_found_by_its_name(void **state)
{
	(void)state;
	int count = 0, tabulated = 0;
	for (; ndf_at(count); count++) {
		const struct ndf_class *class = ndf_at(count);
		struct ndf ndf;
		if (ndf_is_tabulated(class)) {
			/* Made by ndf_from_pwl() only: tests/test_pwl.c. */
			assert_int_equal(ndf_init(&ndf, class, 0.3, 0.3, 2.5), STATUS_DOMAIN);
			assert_ptr_equal(ndf_find(ndf_name(class)), class);
			tabulated++;
			continue;
		}
		assert_ptr_equal(ndf_find(ndf_name(class)), class);
		assert_int_equal(ndf_has_gamma(class), class != ndf_find("ggx") && class != ndf_find("beckmann") &&
							       class != ndf_find("ellipsoid"));
		bool covered = false;
		for (int i = 0; i < SHAPES; i++)
			covered |= strcmp(shapes[i].name, ndf_name(class)) == 0;
		assert_true(covered);
	}
	assert_int_equal(count, SHAPES + tabulated);
	assert_int_equal(tabulated, 1);
	assert_null(ndf_at(-1));
	assert_null(ndf_at(count + 1));
	const char *const unknown[] = {"", "GGX", "std ", "trowbridge", NULL};
	for (int i = 0; i < 5; i++)
		assert_null(ndf_find(unknown[i]));
	assert_true(ndf_make("ggx", 0.1, 0.1, NAN).gamma == 2.0);
	assert_true(isinf(ndf_make("beckmann", 0.1, 0.1, 7.0).gamma));
	assert_true(ndf_make("std", 0.1, 0.1, 2.0).K == 0.0);
	check_rel(ndf_make("std", 0.1, 0.1, 3.0).K, 0.75, 1e-15, "K at gamma = 3");
}

/* Its own parameters make the same distribution again. */
static void check_params(const struct ndf *ndf)
{
	if (ndf->sigma_x != ndf->sigma_y)
		return;
	struct ndf again;
	assert_int_equal(ndf_init_params(&again, ndf->class, ndf->param), STATUS_OK);
	for (double theta = 5.0; theta < 90.0; theta += 20.0) {
		const struct vec3 w = vec3_from_spherical_deg(theta, 17.0);
		assert_true(ndf_D(ndf, w) == ndf_D(&again, w));
		check_rel(ndf_G1(&again, w), ndf_G1(ndf, w), 1e-13, "G1 from parameters");
	}
	for (int i = 0; ndf_param_at(ndf->class, i); i++) {
		const struct ndf_param *param = ndf_param_at(ndf->class, i);
		check_between(ndf->param[i], param->min, param->max, param->name);
		check_between(param->search_min, param->min, param->search_max, param->name);
		check_between(param->search_max, param->search_min, param->max, param->name);
		assert_true(again.param[i] == ndf->param[i]);
	}
}

static void own_parameters_make_the_same_distribution(void **state)
{
	(void)state;
	for_all(check_params);
	assert_null(ndf_param_at(ndf_find("ggx"), 1));
	assert_null(ndf_param_at(ndf_find("std"), -1));
	assert_string_equal(ndf_param_at(ndf_find("std"), 1)->name, "gamma");
	assert_string_equal(ndf_param_at(ndf_find("low"), 0)->name, "B");
	check_rel(ndf_make("low", 0.5, 0.5, 4.0).param[0], 2.0, 1e-15, "B = 2/(C sigma^2)");
	check_rel(ndf_make("t-family", 0.5, 0.5, 4.0).param[2], 2.0, 0.0, "x of t-family");
}

static int n_plain;

static void check_plain(const struct ndf *ndf)
{
	struct ndf plain = {.gamma = 0.0};
	if (ndf->sigma_x != ndf->sigma_y)
		return;
	if (!ndf_plain(ndf, &plain)) {
		assert_true(plain.gamma == 0);
		assert_true(!isinf(ndf->gamma));
		return;
	}
	n_plain++;
	assert_true(plain.class == ndf_find("ggx") || plain.class == ndf_find("beckmann"));
	for (double theta = 1.0; theta < 90.0; theta += 11.0) {
		const struct vec3 w = vec3_from_spherical_deg(theta, 17.0);
		if (ndf_D(ndf, w) > 1e-200)
			check_rel(ndf_D(&plain, w), ndf_D(ndf, w), 3e-13, "D of plain");
		check_rel(ndf_G1(&plain, w), ndf_G1(ndf, w), 1e-11, "G1 of plain");
	}
}

static void plain_is_the_same_distribution_by_another_name(void **state)
{
	(void)state;
	for_all(check_plain);
	/* std twice, ggx, beckmann, hyper-cauchy, t-family, gtr, ellipsoid; six roughnesses each. */
	assert_true(n_plain == 8 * 6);
	struct ndf low = ndf_make("low", 0.3, 0.3, 2.0), rational = ndf_make("std", 0.3, 0.3, 2.0), plain;
	assert_false(ndf_plain(&low, &plain));
	assert_true(ndf_plain(&rational, &plain));
	assert_int_equal(ndf_set_lambda_form(&rational, LAMBDA_RATIONAL), STATUS_OK);
	assert_false(ndf_plain(&rational, &plain));
}

static void classes_that_are_Student_t_take_the_other_forms(void **state)
{
	(void)state;
	for (int i = 0; ndf_at(i); i++) {
		const struct ndf_class *class = ndf_at(i);
		struct ndf ndf;
		if (ndf_is_tabulated(class)) {
			assert_false(ndf_is_student_t(class));
			continue;
		}
		assert_int_equal(ndf_init(&ndf, class, 0.3, 0.3, 3.0), STATUS_OK);
		assert_int_equal(ndf_set_lambda_form(&ndf, LAMBDA_RATIONAL),
				 ndf_is_student_t(class) ? STATUS_OK : STATUS_UNSUPPORTED);
		const struct ndf_param *second = ndf_param_at(class, 1);
		assert_true((second && second->min == 1.5) == ndf_is_student_t(class));
		for (int p = 0; ndf_param_at(class, p); p++) {
			const struct ndf_param *param = ndf_param_at(class, p);
			assert_true((param->role == NDF_ROLE_SIGMA) == !strcmp(param->name, "sigma"));
			assert_true((param->role == NDF_ROLE_GAMMA) == !strcmp(param->name, "gamma"));
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(std_D_matches_golden_rows),
		cmocka_unit_test(std_Lambda_matches_golden_rows),
		cmocka_unit_test(beckmann_matches_golden_rows),
		cmocka_unit_test(ggx_matches_golden_rows),
		cmocka_unit_test(anisotropic_std_matches_golden_rows),
		cmocka_unit_test(anisotropic_classes_match_golden_rows),
		cmocka_unit_test(values_match_golden_vectors),
		cmocka_unit_test(D_is_normalised),
		cmocka_unit_test(Lambda_is_the_integral_that_defines_it),
		cmocka_unit_test(masking_is_1_over_1_plus_Lambda),
		cmocka_unit_test(D_and_Lambda_are_symmetric),
		cmocka_unit_test(ggx_is_std_2),
		cmocka_unit_test(limits_are_reached),
		cmocka_unit_test(classes_that_are_others_renamed_have_their_values),
		cmocka_unit_test(G1_by_quadrature_matches_the_integral),
		cmocka_unit_test(no_step_where_formulas_meet),
		cmocka_unit_test(corners_of_the_domain_stay_finite),
		cmocka_unit_test(arguments_outside_the_domain_are_refused),
		cmocka_unit_test(every_class_is_found_by_its_name),
		cmocka_unit_test(own_parameters_make_the_same_distribution),
		cmocka_unit_test(plain_is_the_same_distribution_by_another_name),
		cmocka_unit_test(classes_that_are_Student_t_take_the_other_forms),
	};
	gsl_set_error_handler_off();
	return cmocka_run_group_tests_name("ndf", tests, NULL, NULL);
}
