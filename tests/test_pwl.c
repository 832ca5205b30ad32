/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "chi_square.h"
#include "src/pwl.h"
#include <gsl/gsl_integration.h>

#define DEG (M_PI / 180.0)

enum { TABLES = 8, NODES = 128 };

struct tables {
	struct pwl pwl[TABLES];
};

/* The distributions P0, P1, ... of the reference values. */
static int setup(void **state)
{
	struct tables *tables = calloc(1, sizeof(*tables));
	assert_non_null(tables);
	struct golden golden = golden_open("tests/golden/piecewise_linear_dists.csv",
					   "dist,kind,node,theta_deg,Dx_raw,Dy_raw,c_iso_x,c_iso_y");
	double theta[TABLES][NODES], Dx[TABLES][NODES], Dy[TABLES][NODES];
	int n[TABLES] = {0};
	while (golden_next(&golden)) {
		const int i = golden.text[0][1] - '0', k = n[i]++;
		assert_in_range(i, 0, TABLES - 1);
		assert_in_range(k, 0, NODES - 1);
		theta[i][k] = golden.value[3] * DEG;
		Dx[i][k] = golden.value[4];
		Dy[i][k] = golden.value[5];
	}
	for (int i = 0; i < TABLES; i++)
		assert_int_equal(pwl_init(&tables->pwl[i], n[i], theta[i], Dx[i], Dy[i]), STATUS_OK);
	*state = tables;
	return 0;
}

static int teardown(void **state)
{
	struct tables *tables = *state;
	for (int i = 0; i < TABLES; i++)
		pwl_free(&tables->pwl[i]);
	free(tables);
	return 0;
}

static const struct pwl *table_named(void **state, const char *name)
{
	const struct tables *tables = *state;
	const int i = name[1] - '0';
	assert_in_range(i, 0, TABLES - 1);
	return &tables->pwl[i];
}

static void D_matches_golden_rows(void **state)
{
	struct golden golden = golden_open("tests/golden/piecewise_linear_D.csv",
					   "dist,theta_m_deg,phi_m_deg,D,cdf_phi,cdf_theta_given_phi");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct pwl *pwl = table_named(state, golden.text[0]);
		check_rel(pwl_D(pwl, vec3_from_spherical_deg(v[1], v[2])), v[3], 1e-13, golden.label);
		check_abs(pwl_cdf_phi(pwl, v[2] * DEG), v[4], 1e-15, golden.label);
		check_abs(pwl_cdf_theta(pwl, v[1] * DEG, v[2] * DEG), v[5], 2e-15, golden.label);
	}
}

/* The reference Lambda is 1/G1 - 1 with the 25 digits of its quadrature: below 1e-12 it has none left of its own. */
static void G1_matches_golden_rows(void **state)
{
	struct golden golden =
		golden_open("tests/golden/piecewise_linear_g1.csv", "dist,theta_o_deg,phi_o_deg,G1,Lambda");
	int lambdas = 0;
	double worst_trapezoid = 0.0;
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct pwl *pwl = table_named(state, golden.text[0]);
		const struct vec3 o = vec3_from_spherical_deg(v[1], v[2]);
		check_rel(pwl_G1(pwl, o), v[3], 2e-13, golden.label);
		if (v[4] > 1e-12) {
			check_rel(pwl_lambda(pwl, o), v[4], 2e-13, golden.label);
			lambdas++;
		}
		const double trapezoid = pwl_G1_trapezoid(pwl, o);
		check_rel(trapezoid, v[3], 7e-3, golden.label);
		worst_trapezoid = fmax(worst_trapezoid, fabs(trapezoid / v[3] - 1.0));
	}
	assert_in_range(lambdas, 50, golden.rows);
	check_between(worst_trapezoid, 1e-3, 7e-3, "the trapezoid is an approximation");
}

/* Against adaptive quadrature of the integral in pwl.h with 30 digits, at angles of every branch. */
static void Lambda_is_the_integral_at_all_angles(void **state)
{
	const struct {
		const char *name;
		double theta_deg, lambda; /* at phi = 33 deg */
	} cases[] = {
		{"P1", 0.001, 3.7807452148676741154e-11}, {"P1", 0.5, 9.7848786768486788219e-6},
		{"P1", 20.0, 0.027427708748032326816},    {"P1", 44.9, 0.18711175318208760243},
		{"P1", 45.1, 0.18947283805924742493},     {"P1", 62.0, 0.53551305154947813689},
		{"P1", 89.0, 27.393549342801941876},      {"P1", 89.99, 2788.7195116016965392},
		{"P3", 0.001, 7.7387767176823579919e-12}, {"P3", 0.5, 1.9350549060088100025e-6},
		{"P3", 20.0, 0.0033555371763886100513},   {"P3", 44.9, 0.024634253231125214061},
		{"P3", 45.1, 0.024972430326672422755},    {"P3", 62.0, 0.083036609483207891158},
		{"P3", 89.0, 8.6540697195626969987},      {"P3", 89.99, 913.63562561253641812},
		{"P7", 0.001, 1.0746751866983425972e-10}, {"P7", 0.5, 0.000026405763321635926899},
		{"P7", 20.0, 0.037497827949511855891},    {"P7", 44.9, 0.21486728402014520288},
		{"P7", 45.1, 0.21728662761951463209},     {"P7", 62.0, 0.56920913437819467991},
		{"P7", 89.0, 28.622490115649711855},      {"P7", 89.99, 2911.785072250041524},
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		const struct pwl *pwl = table_named(state, cases[i].name);
		const struct vec3 o = vec3_from_spherical_deg(cases[i].theta_deg, 33.0);
		char label[64];
		snprintf(label, sizeof(label), "%s theta_o %g", cases[i].name, cases[i].theta_deg);
		/* The nodes of the reference are exact degrees, here radians rounded: near the normal that shows. */
		check_rel(pwl_lambda(pwl, o), cases[i].lambda, 2e-13 + 1e-15 / (cases[i].theta_deg * DEG), label);
	}
}

static void even_nodes(int n, double *theta)
{
	for (int i = 0; i < n; i++)
		theta[i] = M_PI_2 * i / (n - 1);
}

/* Refined, it turns into its source, the error falling with the square of the step. */
static void refined_becomes_its_source(void **state)
{
	(void)state;
	enum { COARSE = 201, FINE = 801 };
	static double theta[FINE];
	const struct {
		const char *name;
		double sigma, gamma;
	} sources[] = {{"ggx", 0.4, 2.0}, {"beckmann", 0.5, INFINITY}, {"std", 0.6, 3.3}};
	for (int s = 0; s < 3; s++) {
		struct ndf ndf;
		assert_int_equal(
			ndf_init(&ndf, ndf_find(sources[s].name), sources[s].sigma, sources[s].sigma, sources[s].gamma),
			STATUS_OK);
		double error[2] = {0.0, 0.0};
		for (int fine = 0; fine < 2; fine++) {
			const int n = fine ? FINE : COARSE;
			even_nodes(n, theta);
			struct pwl pwl;
			assert_int_equal(pwl_from_ndf(&pwl, n, theta, &ndf), STATUS_OK);
			for (double deg = 3.3; deg < 60.0; deg += 5.1) {
				const struct vec3 w = vec3_from_spherical_deg(deg, 70.0);
				error[fine] = fmax(error[fine], fabs(pwl_G1(&pwl, w) / ndf_G1(&ndf, w) - 1.0));
				error[fine] = fmax(error[fine], 0.1 * fabs(pwl_D(&pwl, w) / ndf_D(&ndf, w) - 1.0));
			}
			pwl_free(&pwl);
		}
		check_between(error[0], 0.0, 0.03, "coarse");
		check_between(error[0] / error[1], 10.0, 24.0, "coarse error to fine error, a sixteenth expected");
	}
}

/* Anisotropic: the two axes are those of the source. */
static double two_lobes(struct vec3 m, const void *context)
{
	const double *power = context;
	return pow(m.z, power[m.y != 0.0]);
}

static void nodes_of_a_function_blend_as_eq_1(void **state)
{
	(void)state;
	double theta[31];
	even_nodes(31, theta);
	const double power[2] = {3.0, 12.0};
	struct pwl pwl;
	assert_int_equal(pwl_from_function(&pwl, 31, theta, two_lobes, power), STATUS_OK);
	/* Dx is cos^3 normalised, (3 + 2)/(2 pi) cos^3, Dy likewise; at a node the blend of Eq. 1 is that of the
	 * values. */
	const struct vec3 m = {sin(theta[7]) * cos(0.7), sin(theta[7]) * sin(0.7), cos(theta[7])};
	const double Dx = 5.0 / (2.0 * M_PI) * pow(m.z, 3.0), Dy = 14.0 / (2.0 * M_PI) * pow(m.z, 12.0);
	const double c = 0.5 * (5.0 + 14.0);
	const double want = (pow(cos(0.7), 2.0) * Dx * 14.0 + pow(sin(0.7), 2.0) * Dy * 5.0) / c;
	check_rel(pwl_D(&pwl, m), want, 1e-2, "blend");
	const struct vec3 o = vec3_from_spherical_deg(70.0, 12.0), turned = vec3_from_spherical_deg(70.0, 102.0);
	assert_true(fabs(pwl_G1(&pwl, o) - pwl_G1(&pwl, turned)) > 0.01);
	pwl_free(&pwl);
}

enum { BINS_THETA = 12, BINS_PHI = 8, BINS = BINS_THETA * BINS_PHI };

typedef double density(const struct pwl *pwl, struct vec3 o, struct vec3 m);

static double phi_integral(const struct pwl *pwl, struct vec3 o, int bin, double theta, density *f,
			   const gsl_integration_glfixed_table *table)
{
	const double from = 2.0 * M_PI * (bin % BINS_PHI) / BINS_PHI;
	double sum = 0.0;
	for (size_t l = 0; l < table->n; l++) {
		double phi, w;
		gsl_integration_glfixed_point(from, from + 2.0 * M_PI / BINS_PHI, l, &phi, &w, table);
		sum += w * f(pwl, o, (struct vec3){sin(theta) * cos(phi), sin(theta) * sin(phi), cos(theta)});
	}
	return sum;
}

/* Integral of f(pwl, o, m) over one bin in theta and phi, each theta bin cut in parts. */
static double bin_integral(const struct pwl *pwl, struct vec3 o, int bin, int parts, density *f,
			   const gsl_integration_glfixed_table *table)
{
	const double step = M_PI_2 / BINS_THETA / parts;
	const int first = bin / BINS_PHI * parts;
	double sum = 0.0;
	for (int part = first; part < first + parts; part++) {
		for (size_t k = 0; k < table->n; k++) {
			double theta, w;
			gsl_integration_glfixed_point(step * part, step * (part + 1), k, &theta, &w, table);
			sum += w * sin(theta) * phi_integral(pwl, o, bin, theta, f, table);
		}
	}
	return sum;
}

static double D_cos(const struct pwl *pwl, struct vec3 o, struct vec3 m)
{
	(void)o;
	return pwl_D(pwl, m) * m.z;
}

static double D_seen(const struct pwl *pwl, struct vec3 o, struct vec3 m)
{
	return pwl_D(pwl, m) * fmax(0.0, vec3_dot(o, m));
}

static void D_and_visible_area_integrate_to_theirs(void **state)
{
	const struct tables *tables = *state;
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(4);
	assert_non_null(table);
	for (int i = 0; i < TABLES; i++) {
		const struct vec3 o = vec3_from_spherical_deg(64.0, 21.0);
		double all = 0.0, seen = 0.0;
		for (int j = 0; j < BINS; j++) {
			all += bin_integral(&tables->pwl[i], o, j, 15, D_cos, table);
			seen += bin_integral(&tables->pwl[i], o, j, 15, D_seen, table);
		}
		check_abs(all, 1.0, 1e-4, "D cos");
		check_rel(pwl_G1(&tables->pwl[i], o), o.z / seen, 3e-4, "G1 from its definition");
	}
	gsl_integration_glfixed_table_free(table);
}

static void samples_follow_D_cos(void **state)
{
	enum { SAMPLES = 30000 };
	const struct tables *tables = *state;
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(4);
	assert_non_null(table);
	uint64_t random = 4;
	for (int i = 0; i < TABLES; i++) {
		const struct pwl *pwl = &tables->pwl[i];
		int count[BINS] = {0};
		double expected[BINS];
		for (int j = 0; j < SAMPLES; j++) {
			const double u1 = uniform(&random), u2 = uniform(&random);
			const struct vec3 m = pwl_sample(pwl, u1, u2);
			const double turn = atan2(m.y, m.x) / (2.0 * M_PI);
			const int k = (int)fmin(acos(m.z) / M_PI_2 * BINS_THETA, BINS_THETA - 1);
			count[k * BINS_PHI + (int)fmin((turn < 0.0 ? turn + 1.0 : turn) * BINS_PHI, BINS_PHI - 1)]++;
		}
		for (int j = 0; j < BINS; j++)
			expected[j] = SAMPLES * bin_integral(pwl, (struct vec3){0}, j, 15, D_cos, table);
		char label[32];
		snprintf(label, sizeof(label), "P%d", i);
		check_counts(BINS, count, expected, TABLES, label);
	}
	gsl_integration_glfixed_table_free(table);
}

/* The mean of o.m over samples that face o, over m.z, is o.z/G1: the same number from samples and from quadrature. */
static void sampled_weight_is_the_seen_area(void **state)
{
	enum { SAMPLES = 20000 };
	const struct tables *tables = *state;
	uint64_t random = 6;
	for (int i = 0; i < TABLES; i++) {
		const struct vec3 o = vec3_from_spherical_deg(40.0, 200.0);
		double sum = 0.0, squares = 0.0;
		for (int j = 0; j < SAMPLES; j++) {
			const double u1 = uniform(&random), u2 = uniform(&random);
			const struct vec3 m = pwl_sample(&tables->pwl[i], u1, u2);
			const double away = fmax(0.0, -vec3_dot(o, m)) / m.z;
			sum += away;
			squares += away * away;
		}
		const double mean = sum / SAMPLES;
		/* 1/m.z has no variance where D(pi/2) > 0: a generous margin instead of a standard error */
		const double want = o.z * pwl_lambda(&tables->pwl[i], o);
		check_abs(mean, want, 0.15 * want + 4.0 * sqrt((squares / SAMPLES - mean * mean) / SAMPLES),
			  "seen area");
	}
}

/* Both CDFs at the sample give back the numbers. */
static void samples_invert_the_cdfs(void **state)
{
	const struct tables *tables = *state;
	uint64_t random = 1;
	for (int i = 0; i < TABLES; i++) {
		const struct pwl *pwl = &tables->pwl[i];
		for (int j = 0; j < 1000 + EXTREME_NUMBERS * EXTREME_NUMBERS; j++) {
			const bool extreme = j < EXTREME_NUMBERS * EXTREME_NUMBERS;
			const double u1 = extreme ? extreme_numbers[j / EXTREME_NUMBERS] : uniform(&random);
			const double u2 = extreme ? extreme_numbers[j % EXTREME_NUMBERS] : uniform(&random);
			const struct vec3 m = pwl_sample(pwl, u1, u2);
			char label[64];
			snprintf(label, sizeof(label), "P%d u %.17g %.17g", i, u1, u2);
			check_unit(m.x, m.y, m.z, label);
			const double r = hypot(m.x, m.y);
			const double turn = atan2(m.y, m.x), phi = turn < 0.0 ? turn + 2.0 * M_PI : turn;
			if (r > 0.0 && u1 > 0.0 && u1 < 1.0 - 1e-15)
				check_abs(pwl_cdf_phi(pwl, phi), u1, 2e-15 + 1e-16 / r, label);
			/* Where phi has no density its own rounding decides about theta. */
			if (fabs(cos(2.0 * phi)) < 1.0 - 1e-6)
				check_abs(pwl_cdf_theta(pwl, atan2(r, m.z), phi), u2, 5e-15, label);
		}
	}
}

static void edges_give_their_limits(void **state)
{
	const struct tables *tables = *state;
	for (int i = 0; i < TABLES; i++) {
		const struct pwl *pwl = &tables->pwl[i];
		const struct vec3 up = {0.0, 0.0, 1.0}, level = {0.6, 0.8, 0.0}, below = {0.6, 0.0, -0.8},
				  nan = {NAN, 0.0, 0.5};
		assert_true(pwl_D(pwl, below) == 0.0);
		assert_true(pwl_lambda(pwl, up) == 0.0 && pwl_G1(pwl, up) == 1.0 && pwl_G1_trapezoid(pwl, up) == 1.0);
		assert_true(isinf(pwl_lambda(pwl, level)) && pwl_G1(pwl, level) == 0.0);
		assert_true(pwl_G1(pwl, below) == 0.0 && pwl_G1_trapezoid(pwl, below) == 0.0);
		assert_true(isnan(pwl_D(pwl, nan)) && isnan(pwl_lambda(pwl, nan)));
		for (double x = 1e-300; x < 1.0; x *= 1e20) {
			const struct vec3 steep = vec3_unit((struct vec3){x, 2.0 * x, 1.0});
			const struct vec3 grazing = vec3_unit((struct vec3){1.0, 2.0, x});
			check_between(pwl_G1(pwl, steep), 0.999999, 1.0, "towards the normal");
			check_between(pwl_lambda(pwl, steep), 0.0, 1e-6, "towards the normal");
			check_between(pwl_lambda(pwl, grazing) * grazing.z, 0.01, 1.0, "towards the horizon");
		}
	}
}

/* One peak of 10^-4 rad, all the rest empty. */
static void samples_avoid_empty_segments(void **state)
{
	(void)state;
	const double theta[] = {0.0, 0.4, 0.5, 0.5001, 0.5002, 0.9, 1.5, M_PI_2};
	const double D[] = {0.0, 0.0, 0.0, 7e-200, 0.0, 0.0, 0.0, 0.0};
	struct pwl pwl;
	assert_int_equal(pwl_init(&pwl, 8, theta, D, NULL), STATUS_OK);
	for (int i = 0; i < EXTREME_NUMBERS; i++) {
		const struct vec3 m = pwl_sample(&pwl, 0.3, extreme_numbers[i]);
		check_between(acos(m.z), 0.5 - 1e-14, 0.5002 + 1e-14, "theta");
	}
	/* A triangle: the median is the peak but for the little that cos sin grows. */
	check_abs(acos(pwl_sample(&pwl, 0.3, 0.5).z), 0.5001, 1e-8, "median");
	check_rel(pwl_G1(&pwl, vec3_from_spherical_deg(40.0, 0.0)), 1.0, 1e-15, "no facet turned away");
	pwl_free(&pwl);
}

static void refuse_table(int n, const double *theta, const double *Dx, const double *Dy)
{
	struct pwl pwl;
	assert_int_equal(pwl_init(&pwl, n, theta, Dx, Dy), STATUS_DOMAIN);
	assert_true(pwl.nodes == NULL && pwl.n_nodes == 0);
	pwl_free(&pwl);
}

static void wrong_nodes_are_refused(void **state)
{
	(void)state;
	const double theta[] = {0.0, 0.7, M_PI_2}, D[] = {1.0, 0.5, 0.2};
	struct pwl pwl;
	assert_int_equal(pwl_init(&pwl, 3, theta, D, NULL), STATUS_OK);
	pwl_free(&pwl);
	pwl_free(&pwl); /* twice does no harm */
	const double end[] = {0.0, M_PI_2};
	assert_int_equal(pwl_init(&pwl, 2, end, D, NULL), STATUS_OK);
	pwl_free(&pwl);

	refuse_table(1, theta, D, NULL);
	refuse_table(0, theta, D, NULL);
	refuse_table(-3, theta, D, NULL);
	refuse_table(2, theta, D, NULL); /* does not reach pi/2 */
	refuse_table(3, NULL, D, NULL);
	refuse_table(3, theta, NULL, D);
	const double bad_theta[][3] = {
		{0.1, 0.7, M_PI_2},  {0.0, 0.0, M_PI_2}, {0.0, 1.6, M_PI_2},
		{0.0, -0.7, M_PI_2}, {0.0, NAN, M_PI_2}, {0.0, 0.7, 1.57},
		{0.0, 0.7, 90.0},    {NAN, 0.7, M_PI_2}, {0.0, M_PI_2, M_PI_2 + 1e-13},
	};
	for (size_t i = 0; i < sizeof(bad_theta) / sizeof(bad_theta[0]); i++)
		refuse_table(3, bad_theta[i], D, NULL);
	const double bad_D[][3] = {{1.0, -1e-9, 0.2}, {0.0, 0.0, 0.0}, {1.0, NAN, 0.2}, {INFINITY, 0.5, 0.2}};
	for (size_t i = 0; i < sizeof(bad_D) / sizeof(bad_D[0]); i++) {
		refuse_table(3, theta, bad_D[i], NULL);
		refuse_table(3, theta, D, bad_D[i]);
		refuse_table(3, theta, bad_D[i], D);
	}
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find("std"), 0.3, 0.3, 1.6), STATUS_OK);
	assert_int_equal(pwl_from_ndf(&pwl, 1, theta, &ndf), STATUS_DOMAIN);
	/* without a limit at the horizon */
	assert_int_equal(pwl_from_ndf(&pwl, 3, theta, &ndf), STATUS_OK);
	check_rel(pwl_D(&pwl, (struct vec3){1.0, 0.0, 0.0}), pwl.nodes[1].Fx, 1e-15, "last node");
	pwl_free(&pwl);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(D_matches_golden_rows),
		cmocka_unit_test(G1_matches_golden_rows),
		cmocka_unit_test(Lambda_is_the_integral_at_all_angles),
		cmocka_unit_test(refined_becomes_its_source),
		cmocka_unit_test(nodes_of_a_function_blend_as_eq_1),
		cmocka_unit_test(D_and_visible_area_integrate_to_theirs),
		cmocka_unit_test(samples_follow_D_cos),
		cmocka_unit_test(sampled_weight_is_the_seen_area),
		cmocka_unit_test(samples_invert_the_cdfs),
		cmocka_unit_test(edges_give_their_limits),
		cmocka_unit_test(samples_avoid_empty_segments),
		cmocka_unit_test(wrong_nodes_are_refused),
	};
	return cmocka_run_group_tests_name("pwl", tests, setup, teardown);
}
