/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "chi_square.h"
#include "src/ndf.h"
#include <gsl/gsl_integration.h>

static void std_samples_match_golden_rows(void **state)
{
	(void)state;
	struct golden golden =
		golden_open("tests/golden/std_sampling.csv", "gamma,sigma_x,sigma_y,xi1,xi2,theta_m_deg,phi_m_deg,pdf");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		struct ndf ndf;
		assert_int_equal(ndf_init(&ndf, ndf_find("std"), v[1], v[2], v[0]), STATUS_OK);
		const struct vec3 m = ndf_sample(&ndf, v[3], v[4]);
		const double phi = atan2(m.y, m.x) * 180.0 / M_PI;
		check_rel(atan2(hypot(m.x, m.y), m.z) * 180.0 / M_PI, v[5], 2e-14, golden.label);
		check_abs(phi < 0.0 ? phi + 360.0 : phi, v[6], 3e-13, golden.label);
		/* The angle in the table is rounded, and at the horizon the pdf is steep. */
		check_rel(ndf_pdf(&ndf, m), v[7], 5e-15 * (1.0 + fabs(log(v[7]))) / fmin(1.0, 1e3 * m.z), golden.label);
	}
}

static const struct {
	const char *name;
	double sigma_x, sigma_y, gamma;
} rows[] = {
	{"std", 0.4, 0.4, 1.55},         {"std", 0.3, 1.2, 3.3},      {"ggx", 0.8, 0.2, 2.0},
	{"beckmann", 0.1, 0.5, 0.0},     {"std", 0.2, 0.6, INFINITY}, {"hyper-cauchy", 0.5, 0.7, 1.7},
	{"hyper-cauchy", 0.5, 0.5, 6.0}, {"t-family", 0.9, 0.3, 2.2}, {"gtr", 0.01, 0.01, 0.6},
	{"gtr", 0.2, 0.2, 1.0},          {"gtr", 0.3, 0.3, 5.0},      {"gtr", 1.0, 1.0, 3.0},
	{"gtr", 2.5, 2.5, 2.3},          {"low", 1e-3, 1e-3, 0.4},    {"low", 0.1, 0.1, 1.0},
	{"low", 0.3, 0.3, 2.0},          {"low", 0.4, 0.4, 50.0},     {"low", 30.0, 30.0, 0.7},
};

enum { ROWS = sizeof(rows) / sizeof(rows[0]), TILTS = 12, TURNS = 8, BINS = TURNS * TILTS, SAMPLES = 20000 };

static struct ndf row(int i)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find(rows[i].name), rows[i].sigma_x, rows[i].sigma_y, rows[i].gamma),
			 STATUS_OK);
	return ndf;
}

/* The normal of the slope s in units of sigma, at the turn t (in circles). */
static struct vec3 normal_at(const struct ndf *ndf, double s, double t)
{
	const double phi = 2.0 * M_PI * t;
	return vec3_unit((struct vec3){ndf->sigma_x * s * cos(phi), ndf->sigma_y * s * sin(phi), 1.0});
}

/* Probability of slopes between exp(v0) and exp(v1) and one of the turns: the pdf integrated. */
static double expected(const struct ndf *ndf, double v0, double v1, double turn,
		       const gsl_integration_glfixed_table *points)
{
	double sum = 0.0;
	for (size_t i = 0; i < 12; i++) {
		double v, v_weight;
		gsl_integration_glfixed_point(v0, v1, i, &v, &v_weight, points);
		for (size_t k = 0; k < 12; k++) {
			double t, t_weight;
			gsl_integration_glfixed_point(turn, turn + 1.0 / TURNS, k, &t, &t_weight, points);
			const double s = exp(v);
			const struct vec3 m = normal_at(ndf, s, t);
			/* dm = cos^3 d(slope area) */
			const double area = 2.0 * M_PI * ndf->sigma_x * s * ndf->sigma_y * s;
			sum += v_weight * t_weight * ndf_pdf(ndf, m) * m.z * m.z * m.z * area;
		}
	}
	return sum;
}

static int tilt_bin(const double edge[], double v)
{
	int bin = 0;
	while (bin < TILTS - 1 && v > edge[bin])
		bin++;
	return bin;
}

/* ln of the slopes that part the samples evenly. */
static void place_edges(const struct ndf *ndf, double edge[TILTS - 1])
{
	for (int i = 0; i < TILTS - 1; i++) {
		const struct vec3 m = ndf_sample(ndf, 0.0, (i + 1.0) / TILTS);
		edge[i] = log(m.x / m.z / ndf->sigma_x);
	}
}

/* Bins, in the slopes of ndf, of samples of `source`. */
static void count_samples(const struct ndf *source, const struct ndf *ndf, const double edge[TILTS - 1], uint64_t *seed,
			  int count[BINS])
{
	for (int i = 0; i < SAMPLES; i++) {
		const double u1 = uniform(seed), u2 = uniform(seed);
		const struct vec3 m = ndf_sample(source, u1, u2);
		const double x = m.x / m.z / ndf->sigma_x, y = m.y / m.z / ndf->sigma_y;
		const double turn = atan2(y, x) / (2.0 * M_PI);
		const int k = (int)floor((turn < 0.0 ? turn + 1.0 : turn) * TURNS);
		count[(k < TURNS ? k : TURNS - 1) * TILTS + tilt_bin(edge, log(hypot(x, y)))]++;
	}
}

/* The last bin reaches to the horizon, the first from the normal: in pieces that the rule can do. */
static void expect(const struct ndf *ndf, const double edge[TILTS - 1], double want[BINS])
{
	gsl_integration_glfixed_table *points = gsl_integration_glfixed_table_alloc(12);
	for (int k = 0; k < TURNS; k++) {
		const double turn = (double)k / TURNS;
		double rest = 1.0 / TURNS;
		for (int i = 0; i < TILTS - 1; i++) {
			double share = i > 0 ? expected(ndf, edge[i - 1], edge[i], turn, points) : 0.0;
			for (int piece = 0; i == 0 && piece < 16; piece++)
				share += expected(ndf, edge[0] - piece - 1.0, edge[0] - piece, turn, points);
			rest -= share;
			want[k * TILTS + i] = share * SAMPLES;
		}
		want[k * TILTS + TILTS - 1] = rest * SAMPLES;
	}
	gsl_integration_glfixed_table_free(points);
}

static void samples_follow_D_cos(void **state)
{
	(void)state;
	uint64_t seed = 20170402;
	for (int i = 0; i < ROWS; i++) {
		const struct ndf ndf = row(i);
		double edge[TILTS - 1], want[BINS];
		int count[BINS] = {0};
		place_edges(&ndf, edge);
		count_samples(&ndf, &ndf, edge, &seed, count);
		expect(&ndf, edge, want);
		check_counts(BINS, count, want, ROWS, rows[i].name);
	}
}

/* The comparison can tell: a roughness along one axis 10 % off, a shape 0.5 off. */
static void chi_square_rejects_wrong_distributions(void **state)
{
	(void)state;
	const double wrong[2][2] = {{0.33, 3.3}, {0.3, 2.8}};
	const struct ndf right = row(1);
	double edge[TILTS - 1], want[BINS];
	place_edges(&right, edge);
	expect(&right, edge, want);
	for (int i = 0; i < 2; i++) {
		struct ndf other;
		double chi2 = 0.0;
		uint64_t seed = 1;
		int count[BINS] = {0};
		assert_int_equal(ndf_init(&other, right.class, wrong[i][0], right.sigma_y, wrong[i][1]), STATUS_OK);
		count_samples(&other, &right, edge, &seed, count);
		for (int bin = 0; bin < BINS; bin++)
			chi2 += pow(count[bin] - want[bin], 2.0) / want[bin];
		check_between(gsl_cdf_chisq_Q(chi2, BINS - 1.0), 0.0, 1e-6, "p of wrong samples");
	}
}

/* The share u2 of the normals lies below the tilt of u2: from the pdf alone, to many digits. */
static void tilts_invert_the_integral_of_the_pdf(void **state)
{
	(void)state;
	gsl_integration_glfixed_table *points = gsl_integration_glfixed_table_alloc(12);
	for (int i = 0; i < ROWS; i++) {
		const struct ndf ndf = row(i);
		for (double u = 1e-6; u < 1.0; u += 0.083) {
			const struct vec3 m = ndf_sample(&ndf, 0.0, u);
			const double end = log(m.x / m.z / ndf.sigma_x);
			double sum = 0.0;
			for (int k = 0; k < 100; k++)
				sum += TURNS * expected(&ndf, end - 0.2 * (k + 1), end - 0.2 * k, 0.1, points);
			check_rel(sum, u, 1e-9, rows[i].name);
		}
	}
	gsl_integration_glfixed_table_free(points);
}

/* All four quadrants, and the azimuth that u1 asks for in stretched slopes. */
static void azimuths_fill_all_quadrants_evenly(void **state)
{
	(void)state;
	for (int i = 0; i < ROWS; i++) {
		const struct ndf ndf = row(i);
		for (double u1 = 0.01; u1 < 1.0; u1 += 0.07) {
			const struct vec3 m = ndf_sample(&ndf, u1, 0.6);
			const double turn = atan2(m.y / ndf.sigma_y, m.x / ndf.sigma_x) / (2.0 * M_PI);
			check_abs(turn < 0.0 ? turn + 1.0 : turn, u1, 1e-15, rows[i].name);
		}
		check_abs(ndf_sample(&ndf, 0.3, 0.0).z, 1.0, 0.0, "u2 = 0 is the normal");
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(std_samples_match_golden_rows),
		cmocka_unit_test(samples_follow_D_cos),
		cmocka_unit_test(chi_square_rejects_wrong_distributions),
		cmocka_unit_test(tilts_invert_the_integral_of_the_pdf),
		cmocka_unit_test(azimuths_fill_all_quadrants_evenly),
	};
	return cmocka_run_group_tests_name("ndf_sample", tests, NULL, NULL);
}
