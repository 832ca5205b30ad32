/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "chi_square.h"
#include "src/vndf.h"
#include "src/vndf_student.h"
#include <gsl/gsl_integration.h>

static struct ndf ndf_make(const char *name, double sigma_x, double sigma_y, double gamma)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find(name), sigma_x, sigma_y, gamma), STATUS_OK);
	return ndf;
}

static void pdf_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden =
		golden_open("tests/golden/vndf_pdf.csv",
			    "model,gamma,sigma_x,sigma_y,theta_i_deg,phi_i_deg,theta_m_deg,phi_m_deg,D,G1_i,D_wi");
	int seen = 0;
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct ndf ndf = ndf_make(golden.text[0], v[2], v[3], v[1]);
		const struct vec3 wi = vec3_from_spherical_deg(v[4], v[5]), m = vec3_from_spherical_deg(v[6], v[7]);
		if (v[10] == 0.0) {
			check_between(vndf_pdf(&ndf, wi, m), 0.0, 1e-300, golden.label);
			continue;
		}
		check_rel(vndf_pdf(&ndf, wi, m), v[10], 3e-13 + 1e-15 / vec3_dot(wi, m), golden.label);
		seen++;
	}
	assert_in_range(seen, 100, 10000);
}

static void slopes_match_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/vndf_sample11.csv",
					   "theta_i_deg,U1,U2,ggx_x,ggx_y_fit,ggx_y_exact,beck_x,beck_y");
	int exact = 0;
	while (golden_next(&golden)) {
		const double *v = golden.value;
		const struct vec3 wi = vec3_from_spherical_deg(v[0], 0.0);
		const struct vndf_slopes ggx = vndf_ggx_slopes(wi.z, wi.x, v[1], v[2], VNDF_GGX_EXACT);
		const struct vndf_slopes fit = vndf_ggx_slopes(wi.z, wi.x, v[1], v[2], VNDF_GGX_FIT);
		const struct vndf_slopes beckmann = vndf_beckmann_slopes(wi.z, wi.x, v[1], v[2]);
		check_rel(ggx.x, v[3], 1e-13, golden.label);
		check_rel(fit.x, v[3], 1e-13, golden.label);
		check_rel(fit.y, v[4], 1e-12, golden.label);
		if (!isnan(v[5])) {
			check_rel(ggx.y, v[5], 1e-11, golden.label);
			exact++;
		}
		check_rel(beckmann.x, v[6], 1e-12, golden.label);
		check_rel(beckmann.y, v[7], 1e-12, golden.label);
	}
	assert_in_range(exact, 50, 10000);
}

/* Bins of slopes at unit roughness, (sqrt(q), angle), uniform in v and angle: 1 - v^power is the CDF of q. The power
 * makes the seen area over all bins about even also where slopes have no mean. */
enum { BINS_V = 8, BINS_PHI = 8, BINS = BINS_V * BINS_PHI };

static double bin_power(double gamma)
{
	return isinf(gamma) ? 1.0 : 2.0 * (gamma - 1.0) / (2.0 * gamma - 3.0);
}

/* The normal at (v, angle). */
static struct vec3 normal_at(const struct ndf *ndf, double v, double angle)
{
	const double a = ndf->gamma - 1.0, ln = bin_power(ndf->gamma) * log(v);
	const double r = sqrt(isinf(a) ? -ln : a * expm1(-ln / a)) / ndf->stretch;
	return vec3_unit((struct vec3){-ndf->sigma_x * r * cos(angle), -ndf->sigma_y * r * sin(angle), 1.0});
}

static int bin_of(const struct ndf *ndf, struct vec3 m)
{
	const double x = -m.x / ndf->sigma_x * ndf->stretch, y = -m.y / ndf->sigma_y * ndf->stretch,
		     q = (x * x + y * y) / (m.z * m.z);
	const double a = ndf->gamma - 1.0;
	const double ln = isinf(a) ? -q : -a * log1p(q / a);
	const double v = exp(ln / bin_power(ndf->gamma));
	const double angle = (atan2(y, x) + M_PI) / (2.0 * M_PI);
	const int i = (int)(v * BINS_V), j = (int)(angle * BINS_PHI);
	return (i < BINS_V ? i : BINS_V - 1) * BINS_PHI + (j < BINS_PHI ? j : BINS_PHI - 1);
}

/* Integral of vndf_pdf(), below the horizon of vndf_pdf_inside(), over one bin, n x n points. Since D cos dm = d(v^power) d(angle)/(2 pi), it is divided by
 * D cos, so that nothing here knows the distribution but through them. */
static double bin_integral(const struct ndf *ndf, struct vec3 wi, int bin, const gsl_integration_glfixed_table *table)
{
	const int i = bin / BINS_PHI, j = bin % BINS_PHI;
	double (*pdf)(const struct ndf *ndf, struct vec3 wi, struct vec3 m) = wi.z < 0.0 ? vndf_pdf_inside : vndf_pdf;
	const double power = bin_power(ndf->gamma);
	double sum = 0.0;
	for (size_t k = 0; k < table->n; k++) {
		double v, w;
		gsl_integration_glfixed_point((double)i / BINS_V, (double)(i + 1) / BINS_V, k, &v, &w, table);
		for (size_t l = 0; l < table->n; l++) {
			double angle, w_angle;
			gsl_integration_glfixed_point(2.0 * M_PI * j / BINS_PHI - M_PI,
						      2.0 * M_PI * (j + 1) / BINS_PHI - M_PI, l, &angle, &w_angle,
						      table);
			const struct vec3 m = normal_at(ndf, v, angle);
			sum += w * w_angle * pdf(ndf, wi, m) / (ndf_D(ndf, m) * m.z) * power * pow(v, power - 1.0) /
			       (2.0 * M_PI);
		}
	}
	return sum;
}

/* Where the distribution is known by name and parameters. */
struct subject {
	const char *name;
	double gamma;
};

static const struct subject subjects[] = {{"ggx", 2.0},          {"beckmann", INFINITY}, {"std", 1.62}, {"std", 1.9},
					  {"std", 2.0},          {"std", 2.83},          {"std", 7.1},  {"std", 41.0},
					  {"hyper-cauchy", 3.4}, {"t-family", 2.6},      {"std", 1e5}};
enum { SUBJECTS = sizeof(subjects) / sizeof(subjects[0]), ANGLES = 5 };
static const double angles[ANGLES] = {0.0, 21.7, 58.3, 84.9, 89.9};

/* Calls check(ndf, wi, context, label) over distributions, roughnesses and angles. */
static void for_grid(void (*check)(const struct ndf *ndf, struct vec3 wi, void *context, const char *label),
		     void *context)
{
	for (int i = 0; i < SUBJECTS; i++) {
		for (int j = 0; j < 2; j++) {
			const struct ndf ndf =
				ndf_make(subjects[i].name, j ? 1.23 : 0.31, j ? 0.27 : 0.31, subjects[i].gamma);
			for (int k = 0; k < ANGLES; k++) {
				char label[128];
				snprintf(label, sizeof(label), "%s gamma %g sigma_x %g theta_i %g", subjects[i].name,
					 subjects[i].gamma, ndf.sigma_x, angles[k]);
				check(&ndf, vec3_from_spherical_deg(angles[k], 38.0), context, label);
			}
		}
	}
}

static void check_one_chi_square(const struct ndf *ndf, struct vec3 wi, void *context, const char *label)
{
	enum { SAMPLES = 6000 };
	gsl_integration_glfixed_table *table = context;
	int count[BINS] = {0};
	double expected[BINS], total = 0.0;
	uint64_t random = 17;
	for (int i = 0; i < SAMPLES; i++) {
		const double u1 = uniform(&random), u2 = uniform(&random);
		count[bin_of(ndf, (wi.z < 0.0 ? vndf_sample_inside : vndf_sample)(ndf, wi, u1, u2))]++;
	}
	for (int i = 0; i < BINS; i++) {
		expected[i] = SAMPLES * bin_integral(ndf, wi, i, table);
		total += expected[i];
	}
	check_abs(total / SAMPLES, 1.0, 2e-3, label);
	check_counts(BINS, count, expected, SUBJECTS * 2 * ANGLES, label);
}

static void samples_follow_pdf(void **state)
{
	(void)state;
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(8);
	assert_non_null(table);
	for_grid(check_one_chi_square, table);
	gsl_integration_glfixed_table_free(table);
}

/* From below the horizon, where each facet has to lean over wi. */
static void samples_from_below_follow_pdf(void **state)
{
	(void)state;
	const double below[] = {90.1, 104.0, 118.0};
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(14);
	assert_non_null(table);
	for (int i = 0; i < SUBJECTS; i++) {
		const struct ndf ndf = ndf_make(subjects[i].name, i % 2 ? 0.7 : 0.31, 0.5, subjects[i].gamma);
		const double theta = below[i % 3];
		char label[64];
		snprintf(label, sizeof(label), "%s gamma %g theta_i %g", subjects[i].name, subjects[i].gamma, theta);
		check_one_chi_square(&ndf, vec3_from_spherical_deg(theta, 70.0), table, label);
	}
	gsl_integration_glfixed_table_free(table);
}

/* Integrals with more points, where they are smooth: wi near the normal, no facet turned away but the steepest. */
static void pdf_integrates_to_one(void **state)
{
	(void)state;
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(24);
	assert_non_null(table);
	for (int i = 0; i < SUBJECTS; i++) {
		const struct ndf ndf = ndf_make(subjects[i].name, 0.21, 0.31, subjects[i].gamma);
		const struct vec3 wi = vec3_from_spherical_deg(11.0, 200.0);
		double sum = 0.0;
		for (int j = 0; j < BINS; j++)
			sum += bin_integral(&ndf, wi, j, table);
		check_abs(sum, 1.0, 1e-4, subjects[i].name);
	}
	gsl_integration_glfixed_table_free(table);
}

/* The density of w, from its definition: weight times k (1 + X^2)^-p dX/dw, X = sign(w) sqrt(exp(w^2) - 1). */
static double seen_density(double w, void *context)
{
	const struct student *s = context;
	const double X = copysign(sqrt(expm1(w * w)), w);
	const double dX = fabs(w) < 1e-8 ? 1.0 : w * exp(w * w) / X;
	return s->k * exp(-s->p * w * w) * (s->c - s->s * X) * dX;
}

static double seen_mass(struct student *student, double low, double high, gsl_integration_workspace *workspace)
{
	double mass, error;
	gsl_function f = {seen_density, student};
	assert_int_equal(
		gsl_integration_qag(&f, low, high, 0.0, 1e-11, 1000, GSL_INTEG_GAUSS31, workspace, &mass, &error), 0);
	return mass;
}

/* CDF(quantile(u)) = u, with the CDF by quadrature. */
static void quantiles_invert_the_cdf(void **state)
{
	(void)state;
	const double gammas[] = {1.61, 1.7, 1.8, 2.1, 2.5, 4.0, 11.3, 60.0, 900.0};
	const double cots[] = {1e-6, 0.07, 0.4, 1.1, 3.0, 30.0, INFINITY};
	const double numbers[] = {1e-9, 1e-4, 0.03, 0.31, 0.5, 0.77, 0.98, 1.0 - 1e-6};
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(1000);
	assert_non_null(workspace);
	for (int g = 0; g < 9; g++) {
		const struct ndf ndf = ndf_make("std", 1.0, 1.0, gammas[g]);
		const double a = gammas[g] - 1.0;
		for (int c = 0; c < 7; c++) {
			const double sin_i = isinf(cots[c]) ? 0.0 : 1.0 / hypot(1.0, cots[c]);
			const double cos_i = isinf(cots[c]) ? 1.0 : cots[c] * sin_i;
			struct student seen = {gammas[g] - 0.5, ndf.K, cos_i, sin_i * sqrt(a)};
			const double steep = -sqrt(60.0 / (seen.p - 1.0)); /* exp(-60) of the mass is below */
			const double end = fmin(sqrt(log1p(pow(seen.c / seen.s, 2.0))), -steep);
			const double total = cos_i / ndf_G1(&ndf, (struct vec3){sin_i, 0.0, cos_i});
			for (int u = 0; u < 8; u++) {
				const double w = student_quantile(&seen, numbers[u]);
				char label[96];
				snprintf(label, sizeof(label), "gamma %g cot %g u %g", gammas[g], cots[c], numbers[u]);
				if (numbers[u] <= 0.5)
					check_rel(seen_mass(&seen, steep, w, workspace) / total, numbers[u], 1e-11,
						  label);
				else
					check_abs(seen_mass(&seen, w, end, workspace) / total, 1.0 - numbers[u], 1e-13,
						  label);
			}
		}
	}
	gsl_integration_workspace_free(workspace);
}

/* The same with c < 0: only slopes below c/s are seen, and of the steepest directions hardly any. */
static void quantiles_from_below_invert_the_cdf(void **state)
{
	(void)state;
	const double gammas[] = {1.61, 1.8, 2.5, 11.3, 900.0}, cots[] = {1e-9, 0.07, 0.4, 1.1, 2.0};
	const double numbers[] = {1e-6, 0.03, 0.31, 0.77, 0.98, 1.0 - 1e-6};
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(1000);
	assert_non_null(workspace);
	for (int i = 0; i < 25; i++) {
		const double gamma = gammas[i % 5], cot = cots[i / 5];
		const struct ndf ndf = ndf_make("std", 1.0, 1.0, gamma);
		const double sin_i = 1.0 / hypot(1.0, cot),
			     lambda = ndf_lambda(&ndf, (struct vec3){sin_i, 0.0, cot * sin_i});
		struct student seen = {gamma - 0.5, ndf.K, -cot * sin_i, sin_i * sqrt(gamma - 1.0)};
		const double steep = -sqrt(60.0 / (seen.p - 1.0));
		for (int u = 0; u < 6; u++) {
			const double w = student_quantile(&seen, numbers[u]);
			char label[96];
			snprintf(label, sizeof(label), "gamma %g cot %g u %g", gamma, cot, numbers[u]);
			check_abs(seen_mass(&seen, steep, w, workspace) / (cot * sin_i * lambda), numbers[u],
				  1e-13 * (1.0 + 1.0 / lambda) + 1e-11 * numbers[u], label);
			/* Its closed form */
			const struct vndf_slopes ggx = vndf_ggx_slopes(seen.c, sin_i, numbers[u], 0.5, VNDF_GGX_EXACT);
			const struct student as_ggx = {1.5, 0.5, seen.c, sin_i};
			check_rel(ggx.x, -sqrt(expm1(pow(student_quantile(&as_ggx, numbers[u]), 2.0))), 1e-9, label);
		}
	}
	gsl_integration_workspace_free(workspace);
}

/* Inside the surface the horizon is nothing special, above it all is as from outside, and straight down nothing is seen. */
static void inside_joins_outside(void **state)
{
	(void)state;
	uint64_t random = 4;
	for (int i = 0; i < SUBJECTS; i++) {
		const struct ndf ndf = ndf_make(subjects[i].name, 0.6, 0.3, subjects[i].gamma);
		const struct vec3 over = vec3_from_spherical_deg(90.0 - 1e-9, 40.0), down = {0.0, 0.0, -1.0};
		const struct vec3 under = {over.x, over.y, -over.z};
		check_rel(vndf_area(&ndf, under), vndf_area(&ndf, over), 1e-9, "area");
		for (int j = 0; j < 50; j++) {
			const double u1 = uniform(&random), u2 = uniform(&random);
			const struct vec3 wi = vec3_from_spherical_deg(90.0 * uniform(&random), 300.0);
			const struct vec3 a = vndf_sample(&ndf, wi, u1, u2), b = vndf_sample_inside(&ndf, wi, u1, u2);
			assert_true(a.x == b.x && a.y == b.y && a.z == b.z);
			check_rel(vndf_pdf_inside(&ndf, wi, a), vndf_pdf(&ndf, wi, a), 1e-14, "pdf");
			check_rel(vndf_area(&ndf, wi), wi.z / ndf_G1(&ndf, wi), 1e-14, "area");
		}
		assert_true(vndf_area(&ndf, down) == 0.0 && isnan(vndf_sample_inside(&ndf, down, 0.5, 0.5).z));
		for (double theta = 91.0; theta < 178.0; theta += 5.0) {
			const struct vec3 wi = vec3_from_spherical_deg(theta, 40.0);
			for (int j = 0; j < EXTREME_NUMBERS * EXTREME_NUMBERS && vndf_area(&ndf, wi) > 0.0; j++) {
				const struct vec3 m = vndf_sample_inside(&ndf, wi, extreme_numbers[j / EXTREME_NUMBERS],
									 extreme_numbers[j % EXTREME_NUMBERS]);
				check_unit(m.x, m.y, m.z, "from below");
				check_between(vec3_dot(wi, m), -0x1p-52, 1.0, "a facet that faces wi");
			}
		}
	}
}

/* The slope across wi, over sqrt(gamma-1+x^2), has the density Gamma(gamma)/(sqrt(pi) Gamma(gamma-1/2)) (1 +
 * z^2)^-gamma and the CDF u2, whatever x is. */
static void slopes_across_invert_their_cdf(void **state)
{
	(void)state;
	const double gammas[] = {1.61, 2.0, 2.4, 6.0, 30.0};
	gsl_integration_workspace *workspace = gsl_integration_workspace_alloc(1000);
	assert_non_null(workspace);
	uint64_t random = 12;
	for (int i = 0; i < 100; i++) {
		const double gamma = gammas[i % 5];
		const struct ndf ndf = ndf_make("std", 0.4, 1.3, gamma);
		const double u2 = 0.5 * uniform(&random);
		const struct vec3 m = vndf_sample(&ndf, vec3_from_spherical_deg(60.0, 180.0), uniform(&random), u2);
		const double x = m.x / (ndf.sigma_x * m.z), y = m.y / (ndf.sigma_y * m.z);
		struct student across = {gamma, exp(lgamma(gamma) - lgamma(gamma - 0.5)) / sqrt(M_PI), 1.0, 0.0};
		const double w = -sqrt(log1p(y * y / (gamma - 1.0 + x * x)));
		check_between(y, -INFINITY, 0.0, "y below its median");
		check_rel(seen_mass(&across, -sqrt(60.0 / (gamma - 1.0)), w, workspace), u2, 1e-9, "CDF across");
	}
	gsl_integration_workspace_free(workspace);
}

/* Towards the end of the weight the mass left is that of a linear weight. */
static void quantiles_near_the_end_have_a_linear_weight(void **state)
{
	(void)state;
	const double gammas[] = {1.6, 3.0, 20.0};
	for (int g = 0; g < 3; g++) {
		const struct ndf ndf = ndf_make("std", 1.0, 1.0, gammas[g]);
		const struct vec3 wi = vec3_from_spherical_deg(70.0, 0.0);
		const struct student seen = {gammas[g] - 0.5, ndf.K, wi.z, wi.x * sqrt(gammas[g] - 1.0)};
		const double end = seen.c / seen.s, density = seen.k * pow(1.0 + end * end, -seen.p);
		for (double left = 1e-8; left > 1e-16; left *= 0.3) {
			const double u = 1.0 - left;
			const double w = student_quantile(&seen, u);
			const double distance = end - sqrt(expm1(w * w));
			const double mass = 0.5 * seen.s * density * distance * distance * ndf_G1(&ndf, wi) / wi.z;
			check_rel(mass, 1.0 - u, 1e-2, "mass left");
		}
	}
}

/* STD at gamma = 2 samples what GGX does, to the bit; its general solver agrees. */
static void std_at_2_is_ggx(void **state)
{
	(void)state;
	const struct ndf std = ndf_make("std", 0.4, 0.7, 2.0), ggx = ndf_make("ggx", 0.4, 0.7, NAN);
	uint64_t random = 5;
	for (int i = 0; i < 300; i++) {
		const struct vec3 wi = vec3_from_spherical_deg(90.0 * uniform(&random), 77.0);
		const double u1 = uniform(&random), u2 = uniform(&random);
		const struct vec3 a = vndf_sample(&std, wi, u1, u2), b = vndf_sample(&ggx, wi, u1, u2);
		assert_true(a.x == b.x && a.y == b.y && a.z == b.z);

		const struct student along = {1.5, 0.5, wi.z, hypot(wi.x, wi.y)};
		const struct student across = {2.0, M_2_PI, 1.0, 0.0};
		const struct vndf_slopes slopes = vndf_ggx_slopes(along.c, along.s, u1, u2, VNDF_GGX_EXACT);
		const double w = student_quantile(&along, u1), v = student_quantile(&across, u2);
		check_rel(copysign(sqrt(expm1(w * w)), w), slopes.x, 1e-11 / (1e-3 + fabs(slopes.x)), "x");
		check_rel(copysign(sqrt(expm1(v * v)), v), slopes.y / hypot(1.0, slopes.x),
			  1e-11 / (1e-3 + fabs(slopes.y)), "y");
	}
}

/* Every map but Beckmann's increases with u1 along wi. */
static void maps_increase(void **state)
{
	(void)state;
	const double gammas[] = {1.6, 2.0, 3.3, 25.0};
	for (int g = 0; g < 4; g++) {
		const struct ndf ndf = ndf_make("std", 0.5, 0.5, gammas[g]);
		const struct vec3 wi = vec3_from_spherical_deg(50.0, 0.0);
		double before = -INFINITY;
		for (int i = 0; i <= 2000; i++) {
			const struct vec3 m = vndf_sample(&ndf, wi, i / 2001.0, 0.5);
			const double slope = -m.x / m.z;
			if (!(slope > before))
				fail_msg("gamma %g, u1 = %d/2001: slope %g after %g", gammas[g], i, slope, before);
			before = slope;
		}
	}
}

static void extreme_shapes_give_unit_vectors(void **state)
{
	(void)state;
	const double gammas[] = {1.5 + 1e-12, 1.5001, 1.7, 2.0, 3.0, 50.0, 1e9, 1e16, INFINITY};
	const double sigmas[] = {1e-50, 1e-4, 0.5, 30.0, 1e50};
	const double thetas[] = {0.0, 1e-200, 1e-9, 0.7, 45.0, 89.0, 89.999999999, 90.0, 110.0};
	for (int g = 0; g < 9; g++) {
		for (int s = 0; s < 5; s++) {
			const struct ndf ndf = ndf_make("std", sigmas[s], 0.3 * sigmas[s] + 1e-50, gammas[g]);
			for (int t = 0; t < 9; t++) {
				struct vec3 wi = vec3_from_spherical_deg(thetas[t], 130.0);
				for (int i = 0; i < EXTREME_NUMBERS * EXTREME_NUMBERS; i++) {
					const double u1 = extreme_numbers[i / EXTREME_NUMBERS];
					const double u2 = extreme_numbers[i % EXTREME_NUMBERS];
					char label[128];
					snprintf(label, sizeof(label), "gamma %.13g sigma %g theta %g u %g %g",
						 gammas[g], sigmas[s], thetas[t], u1, u2);
					const struct vec3 m = vndf_sample(&ndf, wi, u1, u2);
					check_unit(m.x, m.y, m.z, label);
					if (thetas[t] <= 90.0)
						check_between(vec3_dot(wi, m), -0x1p-52, 1.0 + 1e-15, label);
					const double pdf = vndf_pdf(&ndf, wi, m);
					if (!(pdf >= 0.0))
						fail_msg("%s: pdf %g", label, pdf);
				}
			}
		}
	}
}

static void edges_give_their_limits(void **state)
{
	(void)state;
	const struct ndf ndf = ndf_make("std", 0.5, 0.5, 3.0);
	const struct vec3 up = {0.0, 0.0, 1.0}, level = {1.0, 0.0, 0.0}, wi = vec3_from_spherical_deg(60.0, 0.0);
	assert_true(vndf_pdf(&ndf, level, up) == 0.0);
	assert_true(vndf_pdf(&ndf, up, level) == 0.0);
	assert_true(vndf_pdf(&ndf, wi, vec3_from_spherical_deg(31.0, 180.0)) == 0.0);
	assert_true(vndf_pdf(&ndf, wi, vec3_from_spherical_deg(29.0, 180.0)) > 0.0);
	assert_true(vndf_pdf(&ndf, up, up) == ndf_D(&ndf, up));
	const struct ndf low = ndf_make("low", 0.5, 0.5, 3.0);
	struct vndf_pseudo pseudo;
	assert_true(!vndf_supports(&low) && isnan(vndf_sample(&low, wi, 0.3, 0.4).z));
	assert_int_equal(vndf_pseudo_init(&pseudo, &low), STATUS_DOMAIN);
	assert_true(vndf_pdf(&low, wi, up) > 0.0);
	assert_true(isnan(vndf_sample(&ndf, (struct vec3){NAN, 0.0, 0.5}, 0.3, 0.4).z));
}

/* Mean of the weights of one way of sampling, and its standard error. */
struct estimate {
	double mean, error;
};

/* pseudo: NULL = visible normals. */
static struct estimate albedo(const struct ndf *ndf, const struct vndf_pseudo *pseudo, enum gaf gaf, struct vec3 wi)
{
	enum { SAMPLES = 6000 };
	double sum = 0.0, squares = 0.0;
	uint64_t random = 99;
	for (int i = 0; i < SAMPLES; i++) {
		const double u1 = uniform(&random), u2 = uniform(&random);
		const struct vec3 m = pseudo ? vndf_pseudo_sample(pseudo, wi, u1, u2) : vndf_sample(ndf, wi, u1, u2);
		const double pdf = pseudo ? vndf_pseudo_pdf(pseudo, wi, m) : vndf_pdf(ndf, wi, m);
		const double weight = vndf_weight(ndf, gaf, wi, m, pdf);
		if (!pseudo && !(weight <= 1.0 + 1e-9))
			fail_msg("gamma %g: weight %g of a visible normal", ndf->gamma, weight);
		sum += weight;
		squares += weight * weight;
	}
	const double mean = sum / SAMPLES;
	/* What happens to one sample in so many is not in their variance. */
	return (struct estimate){mean, sqrt(fmax(squares / SAMPLES - mean * mean, 0.0) / SAMPLES) + 0.5 / SAMPLES};
}

/* Exact and pseudo-visible normals against the albedo by quadrature; each proposal of the latter is used. */
static void weights_give_the_albedo(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/energy_balance.csv",
					   "gamma,sigma,theta_i_deg,E_uncorrelated,E_correlated,rel_err");
	int used[3] = {0};
	while (golden_next(&golden)) {
		const double *v = golden.value;
		if (golden.rows % 5 != 0)
			continue;
		const struct ndf ndf = ndf_make("std", v[1], v[1], v[0]);
		const struct vec3 wi = vec3_from_spherical_deg(v[2], 10.0);
		const enum gaf gaf = golden.rows % 2 ? GAF_CORRELATED : GAF_UNCORRELATED;
		const double want = gaf == GAF_CORRELATED ? v[4] : v[3];
		struct estimate exact = albedo(&ndf, NULL, gaf, wi);
		check_mean(exact.mean, exact.error, want, golden.label);
		struct vndf_pseudo pseudo;
		assert_int_equal(vndf_pseudo_init(&pseudo, &ndf), STATUS_OK);
		used[!pseudo.visible ? 0 : pseudo.proposal.gamma == 2.0 ? 1 : 2]++;
		/* Weights of infinite variance tell nothing within so few samples; nor do all normals at grazing
		 * angles. */
		if (v[0] < 1.8 || (v[0] < 100.0 && pseudo.proposal.gamma > v[0]) || v[2] > 75.0)
			continue;
		exact = albedo(&ndf, &pseudo, gaf, wi);
		check_mean(exact.mean, exact.error, want, golden.label);
		const struct vndf_pseudo all_normals = {ndf, false};
		exact = albedo(&ndf, &all_normals, gaf, wi);
		check_mean(exact.mean, exact.error, want, golden.label);
	}
	for (int i = 0; i < 3; i++)
		assert_in_range(used[i], 1, 100);
}

static void pseudo_sampling_switches_at_its_thresholds(void **state)
{
	(void)state;
	const struct {
		double sigma, gamma;
		const char *proposal; /* "std" = all normals */
	} cases[] = {{0.01, 3.0, "std"},      {0.011, 10.1, "beckmann"}, {0.3, 5.0, "ggx"},        {0.2, 4.0, "ggx"},
		     {0.2, 4.01, "std"},      {0.2, 9.9, "std"},         {0.25, 7.51, "beckmann"}, {0.25, 7.4, "std"},
		     {0.5, 5.01, "beckmann"}, {0.1, 10.0, "beckmann"}};
	for (int i = 0; i < 10; i++) {
		const struct ndf ndf = ndf_make("std", cases[i].sigma, cases[i].sigma, cases[i].gamma);
		struct vndf_pseudo pseudo;
		assert_int_equal(vndf_pseudo_init(&pseudo, &ndf), STATUS_OK);
		assert_string_equal(ndf_name(pseudo.proposal.class), cases[i].proposal);
		assert_int_equal(pseudo.visible, strcmp(cases[i].proposal, "std") != 0);
		assert_true(pseudo.proposal.sigma_x == ndf.sigma_x);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pdf_matches_golden_rows),
		cmocka_unit_test(slopes_match_golden_rows),
		cmocka_unit_test(samples_follow_pdf),
		cmocka_unit_test(samples_from_below_follow_pdf),
		cmocka_unit_test(pdf_integrates_to_one),
		cmocka_unit_test(quantiles_invert_the_cdf),
		cmocka_unit_test(quantiles_from_below_invert_the_cdf),
		cmocka_unit_test(inside_joins_outside),
		cmocka_unit_test(slopes_across_invert_their_cdf),
		cmocka_unit_test(quantiles_near_the_end_have_a_linear_weight),
		cmocka_unit_test(std_at_2_is_ggx),
		cmocka_unit_test(maps_increase),
		cmocka_unit_test(extreme_shapes_give_unit_vectors),
		cmocka_unit_test(edges_give_their_limits),
		cmocka_unit_test(weights_give_the_albedo),
		cmocka_unit_test(pseudo_sampling_switches_at_its_thresholds),
	};
	return cmocka_run_group_tests_name("vndf", tests, NULL, NULL);
}
