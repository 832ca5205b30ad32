/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "chi_square.h"
#include "energy.h"

static struct cook_torrance mirror(const char *name, double sigma, double gamma, enum gaf gaf)
{
	struct cook_torrance model = {.gaf = gaf, .fresnel = FRESNEL_NONE};
	assert_int_equal(ndf_init(&model.ndf, ndf_find(name), sigma, sigma, gamma), STATUS_OK);
	return model;
}

static double lobe(const struct cook_torrance *model, double cos_i)
{
	double albedo = NAN;
	assert_int_equal(energy_lobe(model, cos_i, &albedo), STATUS_OK);
	return albedo;
}

static void golden_balance(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/energy_balance.csv",
					   "gamma,sigma,theta_i_deg,E_uncorrelated,E_correlated,rel_err");
	while (golden_next(&golden)) {
		if (golden.rows % 14 != 1) /* each takes 10 ms */
			continue;
		const double *v = golden.value;
		const double cos_i = vec3_from_spherical_deg(v[2], 0.0).z;
		for (int gaf = GAF_UNCORRELATED; gaf <= GAF_CORRELATED; gaf++) {
			const struct cook_torrance model = mirror("std", v[1], v[0], (enum gaf)gaf);
			check_abs(lobe(&model, cos_i), v[3 + gaf], 2e-8, golden.label);
		}
	}
}

/* The same from sampled normals: the weight F G (wi.m) / (cos_i cos_m) averages to the albedo. */
static void check_sampled(const struct cook_torrance *model, double theta_i, uint64_t *seed)
{
	const struct vec3 wi = vec3_from_spherical_deg(theta_i, 0.0);
	const int n = ndf_has_anisotropy(model->ndf.class) ? 20000 : 5000; /* quadrature is slow */
	double sum = 0.0, squares = 0.0;
	for (int i = 0; i < n; i++) {
		const double u1 = uniform(seed), u2 = uniform(seed);
		const struct vec3 m = ndf_sample(&model->ndf, u1, u2);
		const double cos_d = vec3_dot(wi, m);
		const struct vec3 wo = vec3_sub(vec3_scale(m, 2.0 * cos_d), wi);
		double weight = 0.0;
		if (cos_d > 0.0 && wo.z > 0.0)
			weight = fresnel_F(model->fresnel, cos_d, model->n, model->k) *
				 gaf_G(model->gaf, &model->ndf, wi, wo) * cos_d / (wi.z * m.z);
		sum += weight;
		squares += weight * weight;
	}
	const double mean = sum / n, deviation = sqrt((squares / n - mean * mean) / n);
	check_mean(mean, deviation, lobe(model, wi.z), ndf_name(model->ndf.class));
}

static void sampled(void **state)
{
	(void)state;
	uint64_t seed = 2017;
	for (int d = 0; ndf_at(d); d++) {
		if (ndf_is_tabulated(ndf_at(d)))
			continue;
		const char *name = ndf_name(ndf_at(d));
		const double gamma = strcmp(name, "low") == 0 ? 1.3 : 2.9;
		struct cook_torrance model = mirror(name, 0.45, gamma, (enum gaf)(d % 2));
		check_sampled(&model, 52.0, &seed);
		if (d > 0)
			continue;
		model.gaf = GAF_V_GROOVE;
		model.fresnel = FRESNEL_DIELECTRIC;
		model.n = 1.7;
		check_sampled(&model, 71.0, &seed);
	}
}

/* A nearly flat mirror returns all; nothing returns more than it gets; normal incidence works. */
static void limits(void **state)
{
	(void)state;
	for (int gaf = GAF_UNCORRELATED; gaf < GAF_COUNT; gaf++) {
		const struct cook_torrance flat = mirror("beckmann", 1e-4, 0.0, (enum gaf)gaf);
		check_abs(lobe(&flat, 0.8), 1.0, 1e-7, "flat mirror");
		check_abs(lobe(&flat, 1.0), 1.0, 1e-7, "flat mirror, along the normal");
	}
	for (double sigma = 0.05; sigma < 3.0; sigma *= 4.0) {
		for (double cos_i = 1e-3; cos_i <= 1.0; cos_i *= 4.0) {
			const struct cook_torrance a = mirror("std", sigma, 1.8, GAF_UNCORRELATED);
			const struct cook_torrance b = mirror("std", sigma, 1.8, GAF_CORRELATED);
			check_between(lobe(&a, cos_i), 0.0, lobe(&b, cos_i) + 1e-8, "correlated G is the larger");
			check_between(lobe(&b, cos_i), 0.0, 1.0 + 1e-8, "no gain");
		}
	}
}

static void whole_model(void **state)
{
	(void)state;
	struct cook_torrance model = mirror("std", 0.3, 3.0, GAF_UNCORRELATED);
	model.fresnel = FRESNEL_DIELECTRIC;
	model.n = 1.5;
	for (int c = 0; c < 3; c++) {
		model.kd[c] = 0.1 * c;
		model.ks[c] = 1.0 - 0.2 * c;
	}
	double albedo[3];
	assert_int_equal(energy_albedo(&model, 0.6, albedo), STATUS_OK);
	for (int c = 0; c < 3; c++)
		check_rel(albedo[c], 0.1 * c + (1.0 - 0.2 * c) * lobe(&model, 0.6), 1e-15, "kd + ks lobe");
	check_between(lobe(&model, 0.6), 0.04, 0.1, "a dielectric reflects little");
}

static void refusals(void **state)
{
	(void)state;
	struct cook_torrance model = mirror("std", 0.3, 3.0, GAF_UNCORRELATED);
	const double bad[] = {0.0, -0.5, 1.0000000000000002, NAN, INFINITY};
	double albedo = 7.0, channels[3] = {7.0, 7.0, 7.0};
	for (int i = 0; i < 5; i++) {
		assert_int_equal(energy_lobe(&model, bad[i], &albedo), STATUS_DOMAIN);
		assert_int_equal(energy_albedo(&model, bad[i], channels), STATUS_DOMAIN);
	}
	assert_int_equal(ndf_init(&model.ndf, ndf_find("ggx"), 0.3, 0.2, 2.0), STATUS_OK);
	assert_int_equal(energy_lobe(&model, 0.5, &albedo), STATUS_UNSUPPORTED);
	check_abs(albedo, 7.0, 0.0, "untouched");
	check_abs(channels[1], 7.0, 0.0, "untouched");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(golden_balance), cmocka_unit_test(sampled),  cmocka_unit_test(limits),
		cmocka_unit_test(whole_model),    cmocka_unit_test(refusals),
	};
	return cmocka_run_group_tests_name("energy", tests, NULL, NULL);
}
