/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "chi_square.h"
#include "src/dielectric.h"
#include "src/pwl.h"
#include "src/vndf.h"
#include <gsl/gsl_integration.h>
#include <gsl/gsl_sf_gamma.h>

static struct dielectric interface(const struct ndf *ndf, enum gaf gaf, double n)
{
	struct dielectric dielectric;
	assert_int_equal(dielectric_init(&dielectric, ndf, gaf, n), STATUS_OK);
	return dielectric;
}

static struct ndf facets(const char *name, double sigma_x, double sigma_y, double gamma)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find(name), sigma_x, sigma_y, gamma), STATUS_OK);
	return ndf;
}

/* Every class of the table, index by index; of pl the table that *pwl takes up. */
static struct ndf facets_of_class(int index, struct pwl *pwl)
{
	const struct ndf_class *class = ndf_at(index);
	if (!ndf_is_tabulated(class))
		return facets(ndf_name(class), 0.4, 0.4, 2.7);
	double theta[10];
	struct ndf ndf = facets("std", 0.4, 0.4, 2.2);
	for (int i = 0; i < 10; i++)
		theta[i] = 0.5 * M_PI * i / 9.0;
	assert_int_equal(pwl_from_ndf(pwl, 10, theta, &ndf), STATUS_OK);
	ndf_from_pwl(&ndf, pwl);
	return ndf;
}

static struct vec3 random_direction(uint64_t *random)
{
	const double z = 2.0 * uniform(random) - 1.0, phi = 2.0 * M_PI * uniform(random);
	const double r = sqrt((1.0 - z) * (1.0 + z));
	return (struct vec3){r * cos(phi), r * sin(phi), z};
}

/* The transmitted term as the paper prints it, with both indices, the half vector -(n_i i + n_o o) and the sum of the two
 * dot products; G by its own formula. wi above. */
static double printed_f(const struct ndf *ndf, enum gaf gaf, double n_i, double n_o, struct vec3 i, struct vec3 o)
{
	struct vec3 h = vec3_unit(vec3_scale(vec3_add(vec3_scale(i, n_i), vec3_scale(o, n_o)), -1.0));
	if (h.z < 0.0)
		h = vec3_scale(h, -1.0);
	const double ih = vec3_dot(i, h), oh = vec3_dot(o, h);
	if (!(ih > 0.0 && oh < 0.0))
		return 0.0;
	const double a = ndf_lambda(ndf, i), b = ndf_lambda(ndf, vec3_scale(o, -1.0));
	const double G = gaf == GAF_CORRELATED ? tgamma(1.0 + a) * tgamma(1.0 + b) / tgamma(2.0 + a + b)
					       : 1.0 / ((1.0 + a) * (1.0 + b));
	const double sum = n_i * ih + n_o * oh;
	return fabs(ih) * fabs(oh) / (i.z * fabs(o.z)) * n_o * n_o * (1.0 - fresnel_dielectric(ih, n_o / n_i)) * G *
	       ndf_D(ndf, h) / (sum * sum);
}

static void values_are_those_of_the_printed_formula(void **state)
{
	(void)state;
	uint64_t random = 2007;
	int seen = 0;
	for (int c = 0; ndf_at(c); c++) {
		struct pwl pwl = {0};
		const struct ndf ndf = facets_of_class(c, &pwl);
		for (int j = 0; j < 200; j++) {
			const enum gaf gaf = j % 2 ? GAF_CORRELATED : GAF_UNCORRELATED;
			const double n_above = j % 3 ? 1.0 : 1.7, n_below = j % 3 ? 1.5 : 1.3;
			const struct dielectric d = interface(&ndf, gaf, n_below / n_above);
			struct vec3 wi = random_direction(&random), wo = random_direction(&random);
			const double f = dielectric_f(&d, wi, wo);
			const bool below = wi.z < 0.0;
			if (below) {
				wi = vec3_scale(wi, -1.0);
				wo = vec3_scale(wo, -1.0);
			}
			const double n_i = below ? n_below : n_above, n_o = below ? n_above : n_below;
			if (wo.z < 0.0) {
				check_rel(f, printed_f(&ndf, gaf, n_i, n_o, wi, wo),
					  1e-11 - (f > 0.0 ? 1e-12 * log(f) : 0.0), "transmission");
				seen += f > 0.0;
				continue;
			}
			const struct cook_torrance model = {
				.ndf = ndf, .gaf = gaf, .fresnel = FRESNEL_DIELECTRIC, .n = n_o / n_i};
			check_rel(f, cook_torrance_lobe(&model, wi, wo), 1e-13, "reflection");
		}
		pwl_free(&pwl);
	}
	assert_in_range(seen, 100, 2000);
}

static void f_over_the_squared_index_is_reciprocal(void **state)
{
	(void)state;
	uint64_t random = 5;
	struct ndf ndf = facets("std", 0.3, 0.7, 1.8);
	assert_int_equal(ndf_turn(&ndf, 25.0), STATUS_OK);
	int seen = 0;
	for (int i = 0; i < 2000; i++) {
		const double n = i % 2 ? 1.33 : 0.6;
		const struct dielectric d = interface(&ndf, i % 4 < 2 ? GAF_CORRELATED : GAF_UNCORRELATED, n);
		const struct vec3 wi = random_direction(&random), wo = random_direction(&random);
		const double n_i = wi.z > 0.0 ? 1.0 : n, n_o = wo.z > 0.0 ? 1.0 : n;
		const double f = dielectric_f(&d, wi, wo), back = dielectric_f(&d, wo, wi);
		check_rel(f / (n_o * n_o), back / (n_i * n_i), 1e-10, "reciprocity");
		seen += f > 0.0 && wi.z * wo.z < 0.0;
	}
	assert_in_range(seen, 200, 2000);
}

/* Integrals over the sphere in cos(theta) and phi by the midpoint rule, `rings` of them in either hemisphere. */
static double over_sphere(double (*f)(const void *context, struct vec3 w), const void *context, int rings)
{
	double sum = 0.0;
	for (int i = 0; i < 2 * rings; i++) {
		const double z = (i + 0.5) / rings - 1.0, r = sqrt((1.0 - z) * (1.0 + z));
		for (int j = 0; j < rings; j++) {
			const double phi = 2.0 * M_PI * (j + 0.5) / rings;
			sum += f(context, (struct vec3){r * cos(phi), r * sin(phi), z});
		}
	}
	return sum * 2.0 * M_PI / rings / rings;
}

/* struct light - what comes from wi. */
struct light {
	struct dielectric dielectric;
	enum sampling sampling;
	struct vec3 wi;
};

static double f_cos(const void *context, struct vec3 wo)
{
	const struct light *light = context;
	return dielectric_f(&light->dielectric, light->wi, wo) * fabs(wo.z);
}

static double pdf_of(const void *context, struct vec3 wo)
{
	const struct light *light = context;
	return dielectric_pdf(&light->dielectric, light->sampling, light->wi, wo);
}

/* What one event sends on, as an integral over the facets: no half vector, no Jacobian. wi is above. */
static double facet_term(const struct light *light, struct vec3 m)
{
	const struct cook_torrance *model = &light->dielectric.side[0];
	const struct vec3 wi = light->wi;
	const double c = vec3_dot(wi, m), n = model->n, s2 = 1.0 - c * c, a = ndf_lambda(&model->ndf, wi);
	if (!(m.z > 0.0 && c > 0.0))
		return 0.0;
	const bool correlated = model->gaf == GAF_CORRELATED;
	const double F = fresnel_dielectric(c, n);
	const struct vec3 r = {2.0 * c * m.x - wi.x, 2.0 * c * m.y - wi.y, 2.0 * c * m.z - wi.z};
	double sum = 0.0;
	if (r.z > 0.0) {
		const double b = ndf_lambda(&model->ndf, r);
		sum += F / (correlated ? 1.0 + a + b : (1.0 + a) * (1.0 + b));
	}
	if (s2 < n * n) {
		const double k = c / n - sqrt(1.0 - s2 / (n * n));
		const struct vec3 t = {wi.x / n - k * m.x, wi.y / n - k * m.y, wi.z / n - k * m.z}; /* -wo */
		const double b = ndf_lambda(&model->ndf, t);
		if (t.z > 0.0)
			sum += (1.0 - F) * (correlated ? gsl_sf_beta(1.0 + a, 1.0 + b) : 1.0 / ((1.0 + a) * (1.0 + b)));
	}
	return sum * c * ndf_D(&model->ndf, m) / wi.z;
}

/* Over slopes, which reach far out as s goes to 1. */
static double over_facets(const struct light *light, int rings)
{
	const double sigma = light->dielectric.side[0].ndf.sigma_x;
	double sum = 0.0;
	for (int i = 0; i < rings; i++) {
		const double s = (i + 0.5) / rings, left = 1.0 - s;
		const double slope = sigma * s / (left * left * left), z = 1.0 / hypot(1.0, slope);
		const double solid_angle = z * z * z * slope * sigma * (1.0 + 2.0 * s) / (left * left * left * left);
		for (int j = 0; j < rings; j++) {
			const double phi = 2.0 * M_PI * (j + 0.5) / rings;
			const struct vec3 m = {slope * z * cos(phi), slope * z * sin(phi), z};
			sum += solid_angle * facet_term(light, m);
		}
	}
	return sum * 2.0 * M_PI / rings / rings;
}

/* van der Corput's numbers */
static double radical_inverse(int i, int base)
{
	double sum = 0.0, place = 1.0 / base;
	for (; i > 0; i /= base, place /= base)
		sum += place * (i % base);
	return sum;
}

/* The mean of the weights at the points of a Halton sequence, whose error is less than that of random ones. */
static double mean_weight(const struct light *light, int n)
{
	double sum = 0.0;
	for (int i = 1; i <= n; i++) {
		const double u[3] = {radical_inverse(i, 2), radical_inverse(i, 3), radical_inverse(i, 5)};
		sum += dielectric_sample(&light->dielectric, light->sampling, light->wi, u).weight;
	}
	return sum / n;
}

/* The same energy from the formula over directions, from the facets, and from samples. */
static void one_event_sends_on_what_the_facets_do(void **state)
{
	(void)state;
	const struct {
		const char *name;
		double sigma, gamma, n, theta;
	} cases[] = {{"beckmann", 0.3, INFINITY, 1.5, 40.0}, {"ggx", 0.5, 2.0, 1.5, 70.0}, {"std", 0.4, 1.7, 1.5, 20.0},
		     {"std", 0.25, 4.0, 1.0 / 1.5, 30.0},    {"std", 0.6, 3.0, 2.4, 60.0}, {"gtr", 0.5, 2.5, 1.3, 45.0},
		     {"std", 0.3, 50.0, 1.0 / 1.33, 65.0},   {"low", 0.5, 2.5, 1.5, 35.0}};
	for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
		const struct ndf ndf = facets(cases[i].name, cases[i].sigma, cases[i].sigma, cases[i].gamma);
		const int rings = vndf_supports(&ndf) ? 150 : 70; /* Lambda of the others is slow */
		for (size_t gaf = i % case_step(2); gaf <= GAF_CORRELATED; gaf += case_step(2)) {
			struct light light = {interface(&ndf, (enum gaf)gaf, cases[i].n), SAMPLING_NDF,
					      vec3_from_spherical_deg(cases[i].theta, 0.0)};
			char label[64];
			snprintf(label, sizeof label, "%s gamma %g n %g %s", cases[i].name, cases[i].gamma, cases[i].n,
				 gaf_name((enum gaf)gaf));
			const double want = over_facets(&light, rings);
			check_between(want, 0.05, 1.0, label);
			if (cases[i].gamma >= 2.0) /* else D is infinite along a curve of directions */
				check_abs(over_sphere(f_cos, &light, rings), want, 1e-3, label);
			if (!vndf_supports(&ndf)) {
				check_abs(mean_weight(&light, 20000), want, 4e-3, label);
				continue;
			}
			light.sampling = SAMPLING_VISIBLE;
			check_abs(mean_weight(&light, 12000), want, 1e-3, label);
			/* Seen from below it is the surface with the indices exchanged. */
			const double mean = mean_weight(&light, 100);
			light.dielectric = interface(&ndf, (enum gaf)gaf, 1.0 / cases[i].n);
			light.wi = vec3_scale(light.wi, -1.0);
			check_abs(mean_weight(&light, 100), mean, 1e-9, label);
		}
	}
}

/* Where G1 is nearly 1 nothing is lost. */
static void smooth_interfaces_lose_nothing(void **state)
{
	(void)state;
	const double indices[] = {1.5, 1.0 / 1.5, 2.4, 1.01};
	for (int i = 0; i < 4; i++) {
		for (int d = 0; d < 3; d++) {
			const struct ndf ndf = facets("std", 0.02, 0.02, d == 0 ? 2.2 : d == 1 ? 6.0 : INFINITY);
			for (double theta = 0.0; theta < 70.0; theta += 20.0) {
				const struct light light = {interface(&ndf, GAF_CORRELATED, indices[i]),
							    SAMPLING_VISIBLE, vec3_from_spherical_deg(theta, 10.0)};
				check_abs(mean_weight(&light, 2000), 1.0, 1e-3, "reflection and transmission");
			}
		}
	}
}

enum { BINS_Z = 12, BINS_PHI = 8, BINS = BINS_Z * BINS_PHI, INNER = 16 };

static int bin_of(struct vec3 w)
{
	const int i = (int)((w.z + 1.0) * 0.5 * BINS_Z), j = (int)((atan2(w.y, w.x) / (2.0 * M_PI) + 0.5) * BINS_PHI);
	return (i < BINS_Z ? i : BINS_Z - 1) * BINS_PHI + (j < BINS_PHI ? j : BINS_PHI - 1);
}

/* The integral of the density over one bin of cos(theta) and phi. */
static double bin_pdf(const struct light *light, int bin)
{
	double sum = 0.0;
	for (int k = 0; k < INNER * INNER; k++) {
		const double z = 2.0 * (bin / BINS_PHI + (k / INNER + 0.5) / INNER) / BINS_Z - 1.0;
		const double phi = 2.0 * M_PI * (bin % BINS_PHI + (k % INNER + 0.5) / INNER) / BINS_PHI - M_PI;
		const double r = sqrt((1.0 - z) * (1.0 + z));
		sum += pdf_of(light, (struct vec3){r * cos(phi), r * sin(phi), z});
	}
	return sum * (2.0 / BINS_Z) * (2.0 * M_PI / BINS_PHI) / (INNER * INNER);
}

static void check_samples(const struct light *light, int tests, const char *label)
{
	enum { SAMPLES = 6000 };
	int count[BINS + 1] = {0};
	double expected[BINS + 1], total = 0.0;
	uint64_t random = 41;
	for (int i = 0; i < SAMPLES; i++) {
		const double u[3] = {uniform(&random), uniform(&random), uniform(&random)};
		const struct dielectric_sample s = dielectric_sample(&light->dielectric, light->sampling, light->wi, u);
		check_abs(vec3_length(s.wo), 1.0, 1e-14, label);
		count[s.weight > 0.0 ? bin_of(s.wo) : BINS]++;
		if (i % 16 || s.weight == 0.0)
			continue;
		check_rel(s.weight * pdf_of(light, s.wo), f_cos(light, s.wo), 1e-9, label);
	}
	for (int i = 0; i < BINS; i++) {
		expected[i] = SAMPLES * bin_pdf(light, i);
		total += expected[i];
	}
	expected[BINS] = SAMPLES - total;
	check_between(expected[BINS], -1e-2 * SAMPLES, 0.9 * SAMPLES, label);
	check_counts(BINS + 1, count, expected, tests, label);
}

static void samples_follow_the_density(void **state)
{
	(void)state;
	const double indices[] = {1.5, 1.0 / 1.5}, thetas[] = {25.0, 75.0, 130.0};
	for (int c = 0; ndf_at(c); c++) {
		struct pwl pwl = {0};
		struct ndf ndf = facets_of_class(c, &pwl);
		if (ndf_has_anisotropy(ndf.class) && !ndf.pwl) {
			ndf = facets(ndf_name(ndf.class), 0.35, 0.6, 2.7);
			assert_int_equal(ndf_turn(&ndf, 33.0), STATUS_OK);
		}
		for (size_t i = (size_t)c % case_step(3); i < 6; i += case_step(3)) {
			const struct light light = {interface(&ndf, GAF_UNCORRELATED, indices[i % 2]),
						    vndf_supports(&ndf) && i % 3 ? SAMPLING_VISIBLE : SAMPLING_NDF,
						    vec3_from_spherical_deg(thetas[i / 2], 200.0)};
			char label[64];
			snprintf(label, sizeof label, "%s n %g theta %g", ndf_name(ndf.class), indices[i % 2],
				 thetas[i / 2]);
			check_samples(&light, 48, label);
		}
		pwl_free(&pwl);
	}
}

/* Those of GGX in place of std's, and the rational fit. */
static void substitutes_of_visible_normals_follow_their_density(void **state)
{
	(void)state;
	const struct ndf std = facets("std", 0.5, 0.5, 3.0), ggx = facets("ggx", 0.4, 0.7, 2.0);
	const struct light pseudo = {interface(&std, GAF_CORRELATED, 1.5), SAMPLING_PSEUDO,
				     vec3_from_spherical_deg(55.0, 200.0)};
	const struct light rational = {interface(&ggx, GAF_UNCORRELATED, 1.0 / 1.5), SAMPLING_RATIONAL,
				       vec3_from_spherical_deg(130.0, 20.0)};
	const struct ndf substitute = facets("ggx", 0.5, 0.5, 2.0);
	const struct dielectric in_its_place = interface(&substitute, GAF_CORRELATED, 1.5);
	const struct vec3 wo = vec3_from_spherical_deg(160.0, 30.0);
	check_rel(pdf_of(&pseudo, wo), dielectric_pdf(&in_its_place, SAMPLING_VISIBLE, pseudo.wi, wo), 1e-14, "pseudo");
	check_samples(&pseudo, 2, "pseudo");
	check_samples(&rational, 2, "rational");
	const struct dielectric_sample none =
		dielectric_sample(&pseudo.dielectric, SAMPLING_RATIONAL, pseudo.wi, (double[]){0.1, 0.2, 0.3});
	assert_true(isnan(none.wo.x));
}

/* All but smooth: Snell's and Fresnel's laws. */
static void the_smooth_limit_is_that_of_snell_and_fresnel(void **state)
{
	(void)state;
	const struct ndf ndf = facets("std", 1e-7, 1e-7, 3.0);
	uint64_t random = 1;
	for (int i = 0; i < 200; i++) {
		const double n = i % 2 ? 1.6 : 1.0 / 1.6;
		const struct dielectric d = interface(&ndf, GAF_CORRELATED, n);
		const struct vec3 wi = random_direction(&random);
		const double relative = wi.z > 0.0 ? n : 1.0 / n, sine = hypot(wi.x, wi.y) / relative;
		const double F = fresnel_dielectric(fabs(wi.z), relative);
		if (fabs(wi.z) < 0.05 || fabs(sine - 1.0) < 0.01)
			continue;
		for (int j = 0; j < 2; j++) {
			const double u[3] = {0.3, 0.4, j ? F - 1e-3 : F + 1e-3};
			const struct dielectric_sample s = dielectric_sample(&d, SAMPLING_VISIBLE, wi, u);
			const double z = j || sine > 1.0 ? wi.z : -copysign(sqrt(1.0 - sine * sine), wi.z);
			const double scale = j || sine > 1.0 ? 1.0 : 1.0 / relative;
			check_abs(s.weight, 1.0, 1e-5, "weight");
			check_abs(s.wo.x, -wi.x * scale, 1e-5, "x");
			check_abs(s.wo.y, -wi.y * scale, 1e-5, "y");
			check_abs(s.wo.z, z, 1e-5, "z");
		}
	}
}

/* B(1 + a, 1 + b) against its integral, closed values, and limits. */
static void G_of_a_transmission_is_the_mean_over_heights(void **state)
{
	(void)state;
	const double lambdas[] = {0.0, 1e-9, 0.03, 0.4, 1.0, 2.5, 7.0};
	gsl_integration_glfixed_table *table = gsl_integration_glfixed_table_alloc(64);
	for (int i = 0; i < 7; i++) {
		for (int j = 0; j < 7; j++) {
			const double a = lambdas[i], b = lambdas[j];
			double mean = 0.0;
			for (size_t k = 0; k < 64; k++) {
				double t, weight;
				/* u = sin^2 takes the roots at the ends away */
				gsl_integration_glfixed_point(0.0, 0.5 * M_PI, k, &t, &weight, table);
				mean += weight * pow(sin(t), 2.0 * a) * pow(cos(t), 2.0 * b) * sin(2.0 * t);
			}
			check_rel(gaf_smith_through(GAF_CORRELATED, a, b), mean, 2e-7, "quadrature");
			check_rel(gaf_smith_through(GAF_CORRELATED, a, b), gaf_smith_through(GAF_CORRELATED, b, a),
				  1e-14, "symmetry");
			check_rel(gaf_smith_through(GAF_UNCORRELATED, a, b), 1.0 / (1.0 + a) / (1.0 + b), 1e-15,
				  "uncorrelated");
		}
	}
	gsl_integration_glfixed_table_free(table);
	for (double b = 1e-12; b < 1e90; b *= 1e3)
		check_rel(gaf_smith_through(GAF_CORRELATED, 0.0, b), 1.0 / (1.0 + b), 5e-14, "one side flat");
	check_rel(gaf_smith_through(GAF_CORRELATED, 2.0, 3.0), 1.0 / 60.0, 1e-14, "2! 3!/6!");
	assert_true(gaf_smith_through(GAF_CORRELATED, INFINITY, 1.0) == 0.0);
	assert_true(gaf_smith_through(GAF_CORRELATED, 1.0, 1e300) == 0.0);
	assert_true(isnan(gaf_smith_through(GAF_CORRELATED, NAN, 1.0)));
	assert_true(isnan(gaf_smith_through(GAF_V_GROOVE, 1.0, 1.0)));
}

static void edges_and_refusals(void **state)
{
	(void)state;
	const struct ndf ndf = facets("ggx", 0.3, 0.3, 2.0);
	struct dielectric d = interface(&ndf, GAF_CORRELATED, 1.5);
	const double bad[] = {1.0, 0.0, -1.5, 1e51, 1e-51, NAN, INFINITY};
	for (int i = 0; i < 7; i++)
		assert_int_equal(dielectric_init(&d, &ndf, GAF_CORRELATED, bad[i]), STATUS_DOMAIN);
	assert_int_equal(dielectric_init(&d, &ndf, GAF_V_GROOVE, 1.5), STATUS_UNSUPPORTED);
	check_rel(d.side[0].n * d.side[1].n, 1.0, 1e-15, "untouched");

	const struct vec3 up = {0.0, 0.0, 1.0}, level = {1.0, 0.0, 0.0}, down = {0.0, 0.0, -1.0};
	assert_true(dielectric_f(&d, level, up) == 0.0 && dielectric_f(&d, up, level) == 0.0);
	assert_true(dielectric_pdf(&d, SAMPLING_VISIBLE, level, down) == 0.0);
	assert_true(dielectric_pdf(&d, SAMPLING_NDF, down, level) == 0.0);
	check_rel(dielectric_f(&d, up, down), 0.96 / (M_PI * 0.09) * 2.25 / 0.25, 1e-14, "straight through");
	/* From the dense side beyond the critical angle no facet near the normal lets through. */
	const struct vec3 inside = vec3_from_spherical_deg(120.0, 0.0);
	const struct ndf smooth = facets("beckmann", 1e-3, 1e-3, INFINITY);
	const struct light light = {interface(&smooth, GAF_CORRELATED, 1.5), SAMPLING_VISIBLE, inside};
	for (int i = 0; i < 100; i++) {
		const double u[3] = {0.01 * i, 0.37, 0.9999};
		assert_true(dielectric_sample(&light.dielectric, SAMPLING_VISIBLE, inside, u).wo.z < 0.0);
	}

	struct vec3 wo = up;
	assert_true(!dielectric_refract(vec3_from_spherical_deg(60.0, 0.0), up, 0.5, &wo) && wo.z == 1.0);
	assert_true(dielectric_half(up, up, 1.5).length == 0.0);
	assert_true(dielectric_half(up, down, 1.0).length == 0.0);
	for (double theta = 0.0; theta < 90.0; theta += 7.3) {
		const struct vec3 wi = vec3_from_spherical_deg(theta, 30.0);
		assert_true(dielectric_refract(wi, up, 1.7, &wo));
		check_abs(hypot(wo.x, wo.y) * 1.7, hypot(wi.x, wi.y), 1e-15, "Snell's law");
		check_abs(vec3_length(wo), 1.0, 1e-15, "unit");
		check_abs(wo.x * wi.y, wo.y * wi.x, 1e-15, "in the plane");
		const struct dielectric_half half = dielectric_half(wi, wo, 1.7);
		assert_true(half.length > 0.0);
		check_abs(half.m.z, 1.0, 1e-14, "the half vector leads back");
	}
	assert_true(isnan(dielectric_sample(&d, SAMPLING_VISIBLE, (struct vec3){NAN, 0.0, 0.5}, (double[3]){0}).wo.z));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(values_are_those_of_the_printed_formula),
		cmocka_unit_test(f_over_the_squared_index_is_reciprocal),
		cmocka_unit_test(one_event_sends_on_what_the_facets_do),
		cmocka_unit_test(smooth_interfaces_lose_nothing),
		cmocka_unit_test(samples_follow_the_density),
		cmocka_unit_test(substitutes_of_visible_normals_follow_their_density),
		cmocka_unit_test(the_smooth_limit_is_that_of_snell_and_fresnel),
		cmocka_unit_test(G_of_a_transmission_is_the_mean_over_heights),
		cmocka_unit_test(edges_and_refusals),
	};
	return cmocka_run_group_tests_name("dielectric", tests, NULL, NULL);
}
