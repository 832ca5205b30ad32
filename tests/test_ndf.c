/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "ndf.h"
#include <gsl/gsl_errno.h>
#include <gsl/gsl_integration.h>

static struct ndf ndf_make(const char *name, double sigma_x, double sigma_y, double gamma)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find(name), sigma_x, sigma_y, gamma), STATUS_OK);
	return ndf;
}

/* Calls check(&ndf) for every class over a grid of roughness and shape, isotropic and anisotropic. */
static void for_all(void (*check)(const struct ndf *ndf))
{
	const double sigmas[] = {1e-4, 0.0123, 0.31, 1.07, 4.0, 37.0};
	const double gammas[] = {1.5001, 1.503, 1.72, 1.999, 2.0, 2.5, 3.0,
				 7.31,   32.9,  33.1, 170.0, 1e3, 1e6, INFINITY};
	for (int c = 0; ndf_at(c); c++) {
		const int n_gammas = ndf_has_gamma(ndf_at(c)) ? (int)(sizeof(gammas) / sizeof(gammas[0])) : 1;
		for (int g = 0; g < n_gammas; g++) {
			for (int s = 0; s < 6; s++) {
				const char *name = ndf_name(ndf_at(c));
				const struct ndf round = ndf_make(name, sigmas[s], sigmas[s], gammas[g]);
				const struct ndf oval = ndf_make(name, sigmas[s], 0.3 * sigmas[s], gammas[g]);
				check(&round);
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

static void golden_std_D(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/std_D.csv", "gamma,sigma,theta_deg,D");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make("std", v[1], v[1], v[0]);
		check_golden_D(&golden, &ndf, vec3_from_spherical_deg(v[2], 0.0), v[3]);
	}
}

static void golden_std_lambda(void **state)
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

static void golden_beckmann(void **state)
{
	(void)state;
	golden_closed("tests/golden/beckmann_lambda.csv", "beckmann");
}

static void golden_ggx(void **state)
{
	(void)state;
	golden_closed("tests/golden/ggx_lambda.csv", "ggx");
}

static void golden_anisotropic(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/aniso_std.csv",
					   "gamma,sigma_x,sigma_y,theta_deg,phi_deg,D,Lambda,G1");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make("std", v[1], v[2], v[0]);
		const struct vec3 w = vec3_from_spherical_deg(v[3], v[4]);
		check_golden_D(&golden, &ndf, w, v[5]);
		check_golden_smith(&golden, &ndf, w, v[6], v[7]);
	}
}

static void golden_anisotropic_classes(void **state)
{
	(void)state;
	struct golden golden = golden_open(
		"tests/golden/vndf_pdf.csv",
		"model,gamma,sigma_x,sigma_y,theta_i_deg,phi_i_deg,theta_m_deg,phi_m_deg,D,G1_i,D_wi");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make(golden.text[0], v[2], v[3], v[1]);
		check_golden_D(&golden, &ndf, vec3_from_spherical_deg(v[6], v[7]), v[8]);
		check_rel(ndf_G1(&ndf, vec3_from_spherical_deg(v[4], v[5])), v[9], 2e-15, golden.label);
	}
}

/* D of vectors taken as exact, far into the tails: there is no rounding of an angle in these. */
static void golden_vectors(void **state)
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
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(200);
	for (double phi = 0.1; phi < 6.2; phi += 1.7) {
		struct ray ray = {ndf, phi};
		gsl_function f = {normalisation_integrand, &ray};
		double sum = NAN, error;
		const double end = 5.0 + 16.0 / (ndf->gamma - 1.0);
		const int failed = gsl_integration_qag(&f, -18.0, end, 0.0, 1e-12, 200, GSL_INTEG_GAUSS61, workspace,
						       &sum, &error);
		assert_int_equal(failed, GSL_SUCCESS);
		check_rel(sum, 1.0, 1e-11, ndf_name(ndf->class));
	}
	gsl_integration_workspace_free(workspace);
}

static void normalised(void **state)
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

static void smith_by_definition(void **state)
{
	(void)state;
	static const struct {
		const char *name;
		double gamma;
	} rows[] = {{"std", 1.72}, {"std", 2.5}, {"std", 7.3}, {"std", 1e3}, {"ggx", 2.0}, {"beckmann", INFINITY}};
	gsl_integration_workspace *inner = gsl_integration_workspace_alloc(200);
	gsl_integration_workspace *outer = gsl_integration_workspace_alloc(200);
	for (int i = 0; i < 6; i++) {
		for (double theta = 35.0; theta < 90.0; theta += 22.0) {
			const struct ndf ndf = ndf_make(rows[i].name, 0.6, 0.25, rows[i].gamma);
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
	for (double phi = 0.0; phi < 360.0; phi += 67.0) {
		double lambda = 0.0, G1 = 1.0;
		check_abs(ndf_lambda(ndf, vec3_from_spherical_deg(0.0, phi)), 0.0, 0.0, "Lambda at normal incidence");
		check_abs(ndf_G1(ndf, vec3_from_spherical_deg(0.0, phi)), 1.0, 0.0, "G1 at normal incidence");
		for (double theta = 0.25; theta < 90.0; theta += 0.25) {
			const struct vec3 w = vec3_from_spherical_deg(theta, phi);
			/* Grows with the angle, but for rounding where it is large and flat. */
			check_between(ndf_lambda(ndf, w), lambda * (1.0 - 1e-14), INFINITY, "Lambda grows");
			check_between(ndf_G1(ndf, w), 0.0, G1 * (1.0 + 1e-15), "G1 falls");
			lambda = ndf_lambda(ndf, w);
			G1 = ndf_G1(ndf, w);
		}
		check_abs(ndf_lambda(ndf, vec3_from_spherical_deg(90.0, phi)), INFINITY, 0.0, "Lambda at the horizon");
		check_abs(ndf_G1(ndf, vec3_from_spherical_deg(90.0, phi)), 0.0, 0.0, "G1 at the horizon");
	}
}

static void masking(void **state)
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

static void symmetry(void **state)
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
static void limits(void **state)
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

/* No step where one formula hands over to the next: z = 0.8, and gamma = 33 for the ratio of Gamma functions. */
static void seams(void **state)
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
static void corners(void **state)
{
	(void)state;
	const double sigmas[] = {NDF_SIGMA_MIN, 1e-20, 1.0, 1e20, NDF_SIGMA_MAX};
	const double gammas[] = {nextafter(1.5, 2.0), 1.75, 2.0, 2.5, 1e3, 1e17, 1e300, INFINITY};
	const double cosines[] = {4.9e-324, 1e-308, 1e-200, 1e-99, 1e-50, 1e-8, 0.5};
	const double sines[] = {0.0, 4.9e-324, 1e-200, 1e-20, 0.5};
	for (int c = 0; ndf_at(c); c++) {
		for (int i = 0; i < 5 * 5 * 8; i++) {
			struct ndf ndf;
			assert_int_equal(ndf_init(&ndf, ndf_at(c), sigmas[i % 5], sigmas[i / 5 % 5], gammas[i / 25]),
					 STATUS_OK);
			for (int k = 0; k < 7 + 5; k++) {
				struct vec3 w = {0.0, k < 7 ? 0.0 : sines[k - 7], 1.0};
				if (k < 7)
					w = (struct vec3){sqrt(1.0 - cosines[k] * cosines[k]), 0.0, cosines[k]};
				check_between(ndf_D(&ndf, w), 0.0, INFINITY, ndf_name(ndf.class));
				check_between(ndf_lambda(&ndf, w), 0.0, INFINITY, ndf_name(ndf.class));
				check_between(ndf_G1(&ndf, w), 0.0, 1.0, ndf_name(ndf.class));
			}
		}
	}
}

static void domain(void **state)
{
	(void)state;
	const double bad_sigmas[] = {0.0, -0.1, NAN, INFINITY, -INFINITY, 1e-51, 1e51};
	const double bad_gammas[] = {1.5, 1.0, 0.0, -3.0, NAN, -INFINITY};
	const struct ndf before = ndf_make("std", 0.25, 0.5, 3.0);
	struct ndf ndf = before;
	for (int c = 0; ndf_at(c); c++) {
		for (int i = 0; i < 7; i++) {
			assert_int_equal(ndf_init(&ndf, ndf_at(c), bad_sigmas[i], 0.3, 2.5), STATUS_DOMAIN);
			assert_int_equal(ndf_init(&ndf, ndf_at(c), 0.3, bad_sigmas[i], 2.5), STATUS_DOMAIN);
			assert_memory_equal(&ndf, &before, sizeof(ndf));
		}
		for (int i = 0; i < 6 && ndf_has_gamma(ndf_at(c)); i++) {
			assert_int_equal(ndf_init(&ndf, ndf_at(c), 0.3, 0.3, bad_gammas[i]), STATUS_DOMAIN);
			assert_memory_equal(&ndf, &before, sizeof(ndf));
		}
	}
	assert_int_equal(ndf_init(&ndf, NULL, 0.3, 0.3, 2.5), STATUS_DOMAIN);
	assert_memory_equal(&ndf, &before, sizeof(ndf));
}

static void table(void **state)
{
	(void)state;
	const char *const names[] = {"std", "ggx", "beckmann"};
	for (int i = 0; i < 3; i++) {
		assert_non_null(ndf_find(names[i]));
		assert_string_equal(ndf_name(ndf_find(names[i])), names[i]);
		assert_int_equal(ndf_has_gamma(ndf_find(names[i])), i == 0);
	}
	int count = 0;
	while (ndf_at(count)) {
		assert_ptr_equal(ndf_find(ndf_name(ndf_at(count))), ndf_at(count));
		count++;
	}
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

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(golden_std_D),
		cmocka_unit_test(golden_std_lambda),
		cmocka_unit_test(golden_beckmann),
		cmocka_unit_test(golden_ggx),
		cmocka_unit_test(golden_anisotropic),
		cmocka_unit_test(golden_anisotropic_classes),
		cmocka_unit_test(golden_vectors),
		cmocka_unit_test(normalised),
		cmocka_unit_test(smith_by_definition),
		cmocka_unit_test(masking),
		cmocka_unit_test(symmetry),
		cmocka_unit_test(ggx_is_std_2),
		cmocka_unit_test(limits),
		cmocka_unit_test(seams),
		cmocka_unit_test(corners),
		cmocka_unit_test(domain),
		cmocka_unit_test(table),
	};
	gsl_set_error_handler_off();
	return cmocka_run_group_tests_name("ndf", tests, NULL, NULL);
}
