/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "chi_square.h"
#include "src/ellipsoid.h"
#include "src/ndf.h"
#include <gsl/gsl_integration.h>

#define DEG (M_PI / 180.0)

static struct ellipsoid from_row(const double *v)
{
	const double A[3][3] = {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]}};
	struct ellipsoid ellipsoid;
	assert_int_equal(ellipsoid_init(&ellipsoid, A), STATUS_OK);
	return ellipsoid;
}

static struct ellipsoid from_angles(double alpha_x, double alpha_y, double x_deg, double y_deg, double z_deg)
{
	struct ellipsoid ellipsoid;
	assert_int_equal(ellipsoid_init_angles(&ellipsoid, alpha_x, alpha_y, x_deg * DEG, y_deg * DEG, z_deg * DEG),
			 STATUS_OK);
	return ellipsoid;
}

static void values_match_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/ellipsoid.csv",
					   "A00,A01,A02,A10,A11,A12,A20,A21,A22,theta_m_deg,phi_m_deg,theta_u_deg,"
					   "phi_u_deg,D,G1raw,pdf_vis");
	int bound = 0, hidden = 0;
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ellipsoid e = from_row(v);
		const struct vec3 m = vec3_from_spherical_deg(v[9], v[10]), u = vec3_from_spherical_deg(v[11], v[12]);
		check_rel(ellipsoid_D(&e, m), v[13], 5e-14, golden.label);
		check_rel(ellipsoid_smith(&e, u), v[14], 5e-15, golden.label);
		check_rel(ellipsoid_G1(&e, u), fmin(1.0, v[14]), 5e-15, golden.label);
		check_rel(ellipsoid_pdf(&e, u, m), v[15], 5e-14, golden.label);
		bound += v[14] > 1.0;
		hidden += v[15] == 0.0;
	}
	assert_in_range(bound, 1, golden.rows);
	assert_in_range(hidden, 1, golden.rows);
}

static void samples_match_golden_rows(void **state)
{
	(void)state;
	struct golden golden =
		golden_open("tests/golden/ellipsoid_sample.csv",
			    "A00,A01,A02,A10,A11,A12,A20,A21,A22,theta_psi_deg,phi_psi_deg,xi1,xi2,mx,my,"
			    "mz");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ellipsoid e = from_row(v);
		const struct vec3 m = ellipsoid_sample(&e, vec3_from_spherical_deg(v[9], v[10]), v[11], v[12]);
		check_abs(m.x, v[13], 2e-14, golden.label);
		check_abs(m.y, v[14], 2e-14, golden.label);
		check_abs(m.z, v[15], 2e-14, golden.label);
	}
}

static void unrotated_is_anisotropic_ggx(void **state)
{
	(void)state;
	const double alphas[][2] = {{0.3, 0.3}, {0.07, 1.9}, {1e-4, 3e-4}, {25.0, 0.4}};
	uint64_t random = 3;
	for (int i = 0; i < 4; i++) {
		const struct ellipsoid e = from_angles(alphas[i][0], alphas[i][1], 0.0, 0.0, 0.0);
		struct ndf ggx;
		assert_int_equal(ndf_init(&ggx, ndf_find("ggx"), alphas[i][0], alphas[i][1], NAN), STATUS_OK);
		for (int j = 0; j < 200; j++) {
			const double theta = 90.0 * uniform(&random), phi = 360.0 * uniform(&random);
			const struct vec3 w = vec3_from_spherical_deg(theta, phi);
			check_rel(ellipsoid_D(&e, w), ndf_D(&ggx, w), 1e-13, "D");
			check_rel(ellipsoid_smith(&e, w), ndf_G1(&ggx, w), 1e-13, "Smith");
			check_rel(ellipsoid_G1(&e, w), ndf_G1(&ggx, w), 1e-13, "G1");
		}
	}
}

/* theta_z turns the distribution about the normal; scale, an orthogonal factor and the sign of A do not matter. */
static void scale_and_rotation_of_A_change_nothing(void **state)
{
	(void)state;
	const struct ellipsoid plain = from_angles(0.2, 0.7, 0.0, 0.0, 0.0),
			       turned = from_angles(0.2, 0.7, 0.0, 0.0, 30.0);
	const struct ellipsoid a = from_angles(0.2, 0.7, 12.0, -33.0, 50.0);
	/* Rows of a exchanged, times 3e7: an orthogonal matrix of determinant -1, and a scale. */
	const double permuted[3][3] = {{3e7 * a.A[1].x, 3e7 * a.A[1].y, 3e7 * a.A[1].z},
				       {3e7 * a.A[0].x, 3e7 * a.A[0].y, 3e7 * a.A[0].z},
				       {3e7 * a.A[2].x, 3e7 * a.A[2].y, 3e7 * a.A[2].z}};
	struct ellipsoid b;
	assert_int_equal(ellipsoid_init(&b, permuted), STATUS_OK);
	assert_true(a.sign == 1.0 && b.sign == -1.0);
	uint64_t random = 8;
	for (int i = 0; i < 100; i++) {
		const double theta = 89.0 * uniform(&random), phi = 360.0 * uniform(&random);
		const struct vec3 w = vec3_from_spherical_deg(theta, phi);
		const struct vec3 back = vec3_from_spherical_deg(theta, phi + 30.0);
		check_rel(ellipsoid_D(&turned, w), ellipsoid_D(&plain, back), 1e-13, "turned");
		check_rel(ellipsoid_D(&b, w), ellipsoid_D(&a, w), 1e-13, "D");
		check_rel(ellipsoid_smith(&b, w), ellipsoid_smith(&a, w), 1e-13, "Smith");
		const double u1 = uniform(&random), u2 = uniform(&random);
		/* The mirror image turns the second number round. */
		const struct vec3 m = ellipsoid_sample(&b, w, u1, 1.0 - u2), n = ellipsoid_sample(&a, w, u1, u2);
		check_abs(vec3_length(vec3_sub(m, n)), 0.0, 1e-12, "sample");
	}
}

/* A needle tilted away from u: |A u| |A n| and (A u).(A n) all but cancel. */
static void a_tilted_needle_loses_no_digits(void **state)
{
	(void)state;
	const struct ellipsoid e = from_angles(1e-5, 3e-5, 0.0, 60.0, 0.0);
	for (double theta = 40.0; theta < 90.0; theta += 7.0) {
		const struct vec3 u = vec3_from_spherical_deg(theta, 0.0);
		long double Au2 = 0.0L, An2 = 0.0L, dot = 0.0L;
		for (int i = 0; i < 3; i++) {
			const long double Au =
				(long double)e.A[i].x * u.x + (long double)e.A[i].y * u.y + (long double)e.A[i].z * u.z;
			Au2 += Au * Au;
			An2 += (long double)e.A[i].z * e.A[i].z;
			dot += Au * e.A[i].z;
		}
		assert_true(dot < 0.0L);
		const long double want = 2.0L * An2 * u.z / (sqrtl(Au2) * sqrtl(An2) + dot);
		check_rel(ellipsoid_smith(&e, u), (double)want, long_double_is_wide() ? 1e-8 : 1e-4, "Smith");
	}
}

static const double shapes[][5] = {{0.3, 0.3, 0.0, 0.0, 0.0},
				   {0.25, 0.9, 0.0, 0.0, 40.0},
				   {0.4, 0.4, 25.0, 0.0, 0.0},
				   {0.5, 0.3, -15.0, 35.0, 70.0},
				   {1.7, 0.6, 40.0, -20.0, 10.0}};
enum { SHAPES = sizeof(shapes) / sizeof(shapes[0]), BINS_THETA = 9, BINS_PHI = 12, BINS = BINS_THETA * BINS_PHI };

/* Integral of f(m) over one bin of cos(theta) and phi. */
static double bin_integral(const struct ellipsoid *e, struct vec3 wi, int bin,
			   double (*f)(const struct ellipsoid *e, struct vec3 wi, struct vec3 m),
			   const gsl_integration_glfixed_table *table)
{
	double sum = 0.0;
	for (size_t k = 0; k < table->n; k++) {
		double z, w;
		const int i = bin / BINS_PHI, j = bin % BINS_PHI;
		gsl_integration_glfixed_point((double)i / BINS_THETA, (i + 1.0) / BINS_THETA, k, &z, &w, table);
		for (size_t l = 0; l < table->n; l++) {
			double phi, w_phi;
			gsl_integration_glfixed_point(2.0 * M_PI * j / BINS_PHI, 2.0 * M_PI * (j + 1) / BINS_PHI, l,
						      &phi, &w_phi, table);
			const double r = sqrt(1.0 - z * z);
			sum += w * w_phi * f(e, wi, (struct vec3){r * cos(phi), r * sin(phi), z});
		}
	}
	return sum;
}

static double integral(const struct ellipsoid *e, struct vec3 wi,
		       double (*f)(const struct ellipsoid *e, struct vec3 wi, struct vec3 m), size_t points)
{
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(points);
	assert_non_null(table);
	double sum = 0.0;
	for (int i = 0; i < BINS; i++)
		sum += bin_integral(e, wi, i, f, table);
	gsl_integration_glfixed_table_free(table);
	return sum;
}

static double D_cos(const struct ellipsoid *e, struct vec3 wi, struct vec3 m)
{
	(void)wi;
	return ellipsoid_D(e, m) * m.z;
}

static double D_seen(const struct ellipsoid *e, struct vec3 wi, struct vec3 m)
{
	return ellipsoid_D(e, m) * fmax(0.0, vec3_dot(wi, m));
}

/* Smooth but for the kink at wi.m = 0, hence the tolerances. */
static void D_and_visible_normals_integrate_to_their_areas(void **state)
{
	(void)state;
	for (int i = 0; i < SHAPES; i++) {
		const double *s = shapes[i];
		const struct ellipsoid e = from_angles(s[0], s[1], s[2], s[3], s[4]);
		const struct vec3 up = {0.0, 0.0, 1.0}, wi = vec3_from_spherical_deg(63.0, 100.0);
		check_abs(integral(&e, up, D_cos, 14), 1.0, 1e-7, "D cos");
		check_rel(ellipsoid_smith(&e, wi), wi.z / integral(&e, wi, D_seen, 14), 1e-4, "Smith");
		check_abs(integral(&e, wi, ellipsoid_pdf, 14), 1.0, 1e-4, "pdf");
	}
}

static void samples_follow_pdf(void **state)
{
	(void)state;
	enum { SAMPLES = 15000, ANGLES = 4 };
	const double angles[ANGLES] = {0.0, 33.0, 71.0, 89.0};
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(8);
	assert_non_null(table);
	uint64_t random = 2;
	for (int i = 0; i < SHAPES * ANGLES; i++) {
		const double *s = shapes[i / ANGLES];
		const struct ellipsoid e = from_angles(s[0], s[1], s[2], s[3], s[4]);
		const struct vec3 wi = vec3_from_spherical_deg(angles[i % ANGLES], 250.0);
		int count[BINS] = {0};
		double expected[BINS];
		for (int j = 0; j < SAMPLES; j++) {
			const double u1 = uniform(&random), u2 = uniform(&random);
			const struct vec3 m = ellipsoid_sample(&e, wi, u1, u2);
			const double turn = atan2(m.y, m.x) / (2.0 * M_PI);
			const int k = (int)fmin(m.z * BINS_THETA, BINS_THETA - 1);
			count[k * BINS_PHI + (int)fmin((turn < 0.0 ? turn + 1.0 : turn) * BINS_PHI, BINS_PHI - 1)]++;
		}
		for (int j = 0; j < BINS; j++)
			expected[j] = SAMPLES * bin_integral(&e, wi, j, ellipsoid_pdf, table);
		char label[64];
		snprintf(label, sizeof(label), "shape %d, theta_i %g", i / ANGLES, angles[i % ANGLES]);
		check_counts(BINS, count, expected, SHAPES * ANGLES, label);
	}
	gsl_integration_glfixed_table_free(table);
}

/* The albedo by samples of visible normals and by samples of the reflected direction, evenly over the hemisphere. */
static void weights_give_the_albedo(void **state)
{
	(void)state;
	enum { SAMPLES = 30000 };
	uint64_t random = 21;
	for (int i = 0; i < SHAPES; i++) {
		const double *s = shapes[i];
		const struct ellipsoid e = from_angles(s[0], s[1], s[2], s[3], s[4]);
		const struct vec3 wi = vec3_from_spherical_deg(50.0, 20.0);
		const double seen = ellipsoid_G1(&e, wi) / ellipsoid_smith(&e, wi);
		double sum[2] = {0.0}, squares[2] = {0.0};
		for (int j = 0; j < SAMPLES; j++) {
			const double u1 = uniform(&random), u2 = uniform(&random);
			const struct vec3 m = ellipsoid_sample(&e, wi, u1, u2);
			const struct vec3 wo = vec3_sub(vec3_scale(m, 2.0 * vec3_dot(wi, m)), wi);
			const double weight = seen * ellipsoid_G1(&e, wo);
			assert_true(weight <= 1.0);

			const double r = sqrt(1.0 - u1 * u1);
			const struct vec3 even = {r * cos(2.0 * M_PI * u2), r * sin(2.0 * M_PI * u2), u1};
			const struct vec3 h = vec3_unit(vec3_add(wi, even));
			const double f_cos =
				ellipsoid_D(&e, h) * ellipsoid_G1(&e, wi) * ellipsoid_G1(&e, even) / (4.0 * wi.z);
			const double other = 2.0 * M_PI * f_cos;
			sum[0] += weight;
			squares[0] += weight * weight;
			sum[1] += other;
			squares[1] += other * other;
		}
		const double mean = sum[0] / SAMPLES, other = sum[1] / SAMPLES;
		const double variance = squares[0] / SAMPLES - mean * mean + squares[1] / SAMPLES - other * other;
		check_mean(mean, sqrt(variance / SAMPLES), other, "albedo");
	}
}

static void extreme_axes_stay_finite(void **state)
{
	(void)state;
	const double alphas[] = {1e-50, 1e-5, 0.4, 30.0, 1e50};
	const double thetas[] = {0.0, 1e-200, 1e-9, 45.0, 89.0, 89.9999999, 90.0};
	for (int a = 0; a < 25; a++) {
		const double tilt = a % 2 ? 20.0 : 0.0;
		const struct ellipsoid e = from_angles(alphas[a / 5], alphas[a % 5], tilt, -tilt, 33.0);
		for (int t = 0; t < 7; t++) {
			const struct vec3 wi = vec3_from_spherical_deg(thetas[t], 130.0);
			check_between(ellipsoid_G1(&e, wi), 0.0, 1.0, "G1");
			for (int i = 0; i < EXTREME_NUMBERS * EXTREME_NUMBERS; i++) {
				char label[96];
				snprintf(label, sizeof(label), "alphas %g %g theta %g numbers %d", alphas[a / 5],
					 alphas[a % 5], thetas[t], i);
				const struct vec3 m = ellipsoid_sample(&e, wi, extreme_numbers[i / EXTREME_NUMBERS],
								       extreme_numbers[i % EXTREME_NUMBERS]);
				check_unit(m.x, m.y, m.z, label);
				check_between(vec3_dot(wi, m), -0x1p-52, 1.0 + 1e-15, label);
				if (!(ellipsoid_pdf(&e, wi, m) >= 0.0))
					fail_msg("%s: pdf %g", label, ellipsoid_pdf(&e, wi, m));
			}
		}
	}
}

static void edges_give_their_limits(void **state)
{
	(void)state;
	const struct ellipsoid e = from_angles(0.4, 0.2, 30.0, 0.0, 0.0);
	const struct vec3 below = vec3_from_spherical_deg(100.0, 0.0), up = {0.0, 0.0, 1.0};
	assert_true(ellipsoid_D(&e, below) == 0.0);
	assert_true(ellipsoid_smith(&e, below) == 0.0 && ellipsoid_G1(&e, below) == 0.0);
	assert_true(ellipsoid_pdf(&e, below, up) == 0.0 && ellipsoid_pdf(&e, up, below) == 0.0);
	const struct vec3 nan = {NAN, 0.0, 0.5};
	assert_true(isnan(ellipsoid_D(&e, nan)) && isnan(ellipsoid_G1(&e, nan)));
	assert_true(isnan(ellipsoid_sample(&e, nan, 0.3, 0.4).x));
}

static void arguments_outside_the_domain_are_refused(void **state)
{
	(void)state;
	struct ellipsoid e;
	const double bad[][3][3] = {
		{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}},
		{{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}, {7.0, 8.0, 9.0}},
		{{1.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}},
		{{0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {0.0, 0.0, 1.0}},
		{{1.0, 0.0, 0.0}, {0.0, NAN, 0.0}, {0.0, 0.0, 1.0}},
		{{1.0, 0.0, INFINITY}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}},
	};
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		assert_int_equal(ellipsoid_init(&e, bad[i]), STATUS_DOMAIN);
	const double good[3][3] = {{1e-40, 0.0, 0.0}, {0.0, 1e-45, 0.0}, {0.0, 0.0, 1e200}};
	assert_int_equal(ellipsoid_init(&e, good), STATUS_OK);
	const double bad_alphas[] = {0.0, -0.1, NAN, INFINITY, 1e-51, 1e51};
	for (size_t i = 0; i < sizeof(bad_alphas) / sizeof(bad_alphas[0]); i++) {
		assert_int_equal(ellipsoid_init_angles(&e, bad_alphas[i], 0.3, 0.0, 0.0, 0.0), STATUS_DOMAIN);
		assert_int_equal(ellipsoid_init_angles(&e, 0.3, bad_alphas[i], 0.0, 0.0, 0.0), STATUS_DOMAIN);
	}
	assert_int_equal(ellipsoid_init_angles(&e, 0.3, 0.3, NAN, 0.0, 0.0), STATUS_DOMAIN);
	assert_int_equal(ellipsoid_init_angles(&e, 0.3, 0.3, 0.0, INFINITY, 0.0), STATUS_DOMAIN);
	assert_int_equal(ellipsoid_init_angles(&e, 0.3, 0.3, 0.0, 0.0, NAN), STATUS_DOMAIN);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(values_match_golden_rows),
		cmocka_unit_test(samples_match_golden_rows),
		cmocka_unit_test(unrotated_is_anisotropic_ggx),
		cmocka_unit_test(scale_and_rotation_of_A_change_nothing),
		cmocka_unit_test(a_tilted_needle_loses_no_digits),
		cmocka_unit_test(D_and_visible_normals_integrate_to_their_areas),
		cmocka_unit_test(samples_follow_pdf),
		cmocka_unit_test(weights_give_the_albedo),
		cmocka_unit_test(extreme_axes_stay_finite),
		cmocka_unit_test(edges_give_their_limits),
		cmocka_unit_test(arguments_outside_the_domain_are_refused),
	};
	return cmocka_run_group_tests_name("ellipsoid", tests, NULL, NULL);
}
