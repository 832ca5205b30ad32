/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "src/cook_torrance.h"
#include "src/halfdiff.h"

static struct cook_torrance model_make(const char *name, double sigma, double gamma)
{
	struct cook_torrance model = {
		.gaf = GAF_UNCORRELATED,
		.fresnel = FRESNEL_DIELECTRIC,
		.n = 1.55,
		.k = 2.1,
		.kd = {0.11, 0.23, 0.37},
		.ks = {0.83, 0.41, 0.29},
		.reflectance = {{0.9, 0.8, 1.0}, {0.5, 0.55, 0.9}, {0.04, 0.3, 1.0}},
	};
	assert_int_equal(ndf_init(&model.ndf, ndf_find(name), sigma, sigma, gamma), STATUS_OK);
	return model;
}

/* Calls check(&model, wi, wo) for every form of D, G and F and pairs of directions, grazing ones among them. */
static void for_all(void (*check)(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo))
{
	const double thetas[] = {0.0, 0.01, 13.7, 45.0, 71.3, 89.0, 89.9999};
	const double phis[] = {0.0, 3.3, 97.0, 180.0};
	for (int d = 0; ndf_at(d); d++) {
		if (ndf_is_tabulated(ndf_at(d)))
			continue;
		for (double sigma = 0.003; sigma < 4.0; sigma *= 5.7) {
			struct cook_torrance model = model_make(ndf_name(ndf_at(d)), sigma, 2.7);
			for (int i = 0; i < 7 * 7 * 4; i++) {
				model.gaf = (enum gaf)(i % GAF_COUNT);
				model.fresnel = (enum fresnel)(i % (FRESNEL_F82 + 1));
				check(&model, vec3_from_spherical_deg(thetas[i % 7], 11.0),
				      vec3_from_spherical_deg(thetas[i / 7 % 7], 11.0 + phis[i / 49]));
			}
		}
	}
}

/* The lobe from its parts, with the half vector by way of half and difference angles. */
static void check_product(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo)
{
	const struct halfdiff a = halfdiff_from_dirs(wi, wo);
	const struct vec3 sum = vec3_add(wi, wo);
	const double azimuth = atan2(sum.y, sum.x);
	const struct vec3 h = {sin(a.theta_h) * cos(azimuth), sin(a.theta_h) * sin(azimuth), cos(a.theta_h)};
	const double F = fresnel_F(model->fresnel, cos(a.theta_d), model->n, model->k);
	const double D = ndf_D(&model->ndf, h);
	const double G = gaf_G(model->gaf, &model->ndf, wi, wo);
	const double want = F * D * G / (4.0 * wi.z * wo.z);
	/* theta_h carries a rounding error of 1e-16/cos(theta_d), which a sharp D multiplies, or the horizon. */
	const double sigma = model->ndf.sigma_x;
	const double log_slope = 2.0 * sin(a.theta_h) / (sigma * sigma * h.z * h.z * h.z) + 10.0 / h.z;
	const double tolerance = 1e-13 + 4e-16 / cos(a.theta_d) * log_slope;
	if (want > 1e-250)
		check_rel(cook_torrance_lobe(model, wi, wo), want, tolerance, ndf_name(model->ndf.class));

	double f[3];
	cook_torrance_f(model, wi, wo, f);
	for (int c = 0; c < 3; c++) {
		const bool f82 = model->fresnel == FRESNEL_F82;
		const double F_c = f82 ? fresnel_f82(cos(a.theta_d), model->reflectance[c]) : 1.0;
		const double sum_c = model->kd[c] / M_PI + model->ks[c] * F_c * cook_torrance_lobe(model, wi, wo);
		check_rel(f[c], sum_c, f82 ? 1e-13 : 1e-15, "sum of Lambert and lobe");
	}
}

/* The terms of richer models add up. */
static void a_second_lobe_and_a_grazing_term_add(void **state)
{
	(void)state;
	const struct vec3 wi = vec3_from_spherical_deg(70.0, 20.0), wo = vec3_from_spherical_deg(50.0, 190.0);
	const struct cook_torrance model = model_make("std", 0.2, 2.7);
	struct cook_torrance second = model_make("std", 0.05, 4.0), rich = model;
	double f_model[3], f_second[3], f_rich[3];
	rich.second = second.ndf;
	rich.grazing = 3.0;
	for (int c = 0; c < 3; c++) {
		second.kd[c] = 0.0;
		rich.ks_second[c] = second.ks[c] = 0.1 * (c + 1);
		rich.kg[c] = 0.3 * (c + 1);
	}
	second.gaf = model.gaf;
	second.fresnel = model.fresnel;
	second.n = model.n;
	second.k = model.k;
	cook_torrance_f(&model, wi, wo, f_model);
	cook_torrance_f(&second, wi, wo, f_second);
	cook_torrance_f(&rich, wi, wo, f_rich);
	/* cos theta_d by the angle between the two. */
	const double cos_d = cos(0.5 * acos(vec3_dot(wi, wo)));
	const double grazing = cos_d * cos_d / M_PI * (pow(1.0 - wi.z, 3.0) + pow(1.0 - wo.z, 3.0));
	for (int c = 0; c < 3; c++) {
		assert_true(f_second[c] > 0.0);
		check_rel(f_rich[c], f_model[c] + f_second[c] + rich.kg[c] * grazing, 1e-14, "sum of four terms");
	}
}

static void lobe_is_the_product_of_its_parts(void **state)
{
	(void)state;
	for_all(check_product);
}

static void check_reciprocity(const struct cook_torrance *model, struct vec3 wi, struct vec3 wo)
{
	const double lobe = cook_torrance_lobe(model, wi, wo);
	check_rel(cook_torrance_lobe(model, wo, wi), lobe, 2e-15, "reciprocity");
	check_between(lobe, 0.0, 1e300, "lobe is finite");
}

static void lobe_is_reciprocal(void **state)
{
	(void)state;
	for_all(check_reciprocity);
}

/* By hand: a GGX mirror configuration at 60 degrees, h the normal. Lambda = (sqrt(1 + 3 sigma^2) - 1)/2. */
static void lobe_matches_values_by_hand(void **state)
{
	(void)state;
	struct cook_torrance model = model_make("ggx", 0.5, 0.0);
	const struct vec3 wi = vec3_from_spherical_deg(60.0, 0.0);
	const struct vec3 wo = vec3_from_spherical_deg(60.0, 180.0);
	const double G1 = 2.0 / (1.0 + sqrt(1.75));
	const double D = 1.0 / (M_PI * 0.25);
	const double g = sqrt(1.55 * 1.55 - 0.75);
	const double r_s = (0.5 - g) / (0.5 + g);
	const double r_p = (1.55 * 1.55 * 0.5 - g) / (1.55 * 1.55 * 0.5 + g);
	const double F = 0.5 * (r_s * r_s + r_p * r_p);
	check_rel(cook_torrance_lobe(&model, wi, wo), F * D * G1 * G1, 1e-14, "dielectric, uncorrelated");
	model.gaf = GAF_CORRELATED;
	model.fresnel = FRESNEL_NONE;
	check_rel(cook_torrance_lobe(&model, wi, wo), D / sqrt(1.75), 1e-14, "no Fresnel, correlated");
	model.gaf = GAF_V_GROOVE; /* min(1, 2 * 1 * 0.5 / 0.5) = 1 */
	check_rel(cook_torrance_lobe(&model, wi, wo), D, 1e-14, "v-groove, open");
}

/* Below the horizon nothing is reflected, Lambert's part included. */
static void lobe_is_zero_below_the_horizon(void **state)
{
	(void)state;
	const struct cook_torrance model = model_make("std", 0.3, 1.7);
	const struct vec3 up = vec3_from_spherical_deg(40.0, 0.0);
	const struct vec3 others[] = {
		vec3_from_spherical_deg(90.0, 30.0), vec3_from_spherical_deg(90.01, 30.0), {0.0, 0.0, -1.0}};
	for (int i = 0; i < 3; i++) {
		double f[2][3];
		check_abs(cook_torrance_lobe(&model, up, others[i]), 0.0, 0.0, "view below the horizon");
		check_abs(cook_torrance_lobe(&model, others[i], up), 0.0, 0.0, "light below the horizon");
		for (enum gaf gaf = GAF_UNCORRELATED; gaf < GAF_COUNT; gaf++) {
			check_abs(gaf_G(gaf, &model.ndf, up, others[i]), 0.0, 0.0, "G, view below the horizon");
			check_abs(gaf_G(gaf, &model.ndf, others[i], up), 0.0, 0.0, "G, light below the horizon");
		}
		cook_torrance_f(&model, up, others[i], f[0]);
		cook_torrance_f(&model, others[i], up, f[1]);
		for (int c = 0; c < 3; c++) {
			check_abs(f[0][c], 0.0, 0.0, "view below the horizon");
			check_abs(f[1][c], 0.0, 0.0, "light below the horizon");
		}
	}
	/* As close to it as a double comes, in mirror configuration: no NaN, no infinity. */
	for (double z = 1e-3; z > 0.0; z *= 1e-4) {
		const struct vec3 wi = {1.0, 0.0, z}, wo = {-1.0, 0.0, z};
		check_between(cook_torrance_lobe(&model, wi, wo), 0.0, 1e10, "mirror reflection at the horizon");
	}
}

/* Torrance-Sparrow's three cases, in the plane of incidence. */
static void v_groove_is_the_minimum_of_its_three_terms(void **state)
{
	(void)state;
	const struct cook_torrance model = model_make("ggx", 0.5, 0.0);
	const double pairs[][2] = {{10.0, -20.0}, {80.0, -10.0}, {30.0, 75.0}, {85.0, 85.0}};
	for (int i = 0; i < 4; i++) {
		const double t_i = pairs[i][0] * M_PI / 180.0, t_o = pairs[i][1] * M_PI / 180.0;
		const double cos_h = cos(0.5 * (t_i + t_o)), cos_d = cos(0.5 * (t_i - t_o));
		const double want = fmin(1.0, fmin(2.0 * cos_h * cos(t_i) / cos_d, 2.0 * cos_h * cos(t_o) / cos_d));
		const struct vec3 wi = {sin(t_i), 0.0, cos(t_i)}, wo = {sin(t_o), 0.0, cos(t_o)};
		check_rel(gaf_G(GAF_V_GROOVE, &model.ndf, wi, wo), want, 1e-14, "v-groove");
		check_rel(gaf_G(GAF_V_GROOVE, &model.ndf, wo, wi), want, 1e-14, "v-groove, swapped");
	}
}

static void names_and_values_are_inverse(void **state)
{
	(void)state;
	const char *const want[GAF_COUNT] = {"uncorrelated", "correlated", "v-groove"};
	for (int i = 0; i < GAF_COUNT; i++) {
		enum gaf found = GAF_COUNT;
		assert_string_equal(gaf_name((enum gaf)i), want[i]);
		assert_int_equal(gaf_find(want[i], &found), STATUS_OK);
		assert_int_equal(found, i);
	}
	enum gaf untouched = GAF_V_GROOVE;
	const char *const bad[] = {"", "Correlated", "smith", NULL};
	for (int i = 0; i < 4; i++)
		assert_int_equal(gaf_find(bad[i], &untouched), STATUS_DOMAIN);
	assert_int_equal(untouched, GAF_V_GROOVE);
	assert_string_equal(gaf_name(GAF_COUNT), "unknown");
}

/* The texts of failures: truncated to fit, ignored when nobody wants them, status handed through. */
static void error_texts_are_truncated_and_distinct(void **state)
{
	(void)state;
	struct error error;
	assert_int_equal(error_set(&error, STATUS_IO, "%s: %d", "file", 17), STATUS_IO);
	assert_string_equal(error.text, "file: 17");
	assert_int_equal(error_set(NULL, STATUS_FORMAT, "%d", 1), STATUS_FORMAT);
	assert_int_equal(error_set(&error, STATUS_FORMAT, "%1000d", 7), STATUS_FORMAT);
	assert_int_equal(strlen(error.text), sizeof(error.text) - 1);
	for (int a = STATUS_OK; a <= STATUS_INTERRUPTED; a++) {
		assert_string_not_equal(status_str((enum status)a), status_str((enum status)(STATUS_INTERRUPTED + 1)));
		for (int b = STATUS_OK; b < a; b++)
			assert_string_not_equal(status_str((enum status)a), status_str((enum status)b));
	}
}

static void lobe_from_tabulated_factors_is_the_lobe(void **state)
{
	(void)state;
	for (enum gaf gaf = 0; gaf < GAF_COUNT; gaf++)
		for (int n = 0; n < 60; n++) {
			struct cook_torrance model = {.gaf = gaf, .fresnel = FRESNEL_DIELECTRIC, .n = 1.5};
			assert_int_equal(ndf_init(&model.ndf, ndf_find("std"), 0.3, 0.3, 1.8), STATUS_OK);
			const struct vec3 wi = vec3_from_spherical_deg(1.5 * n, 10.0);
			const struct vec3 wo = vec3_from_spherical_deg(89.5 - n, 3.0 * n);
			const struct vec3 sum = vec3_add(wi, wo);
			const double F = fresnel_F(model.fresnel, 0.5 * vec3_length(sum), model.n, 0.0);
			const double DF = F * ndf_D(&model.ndf, vec3_unit(sum)), cosines = wi.z * wo.z;
			const double want = cook_torrance_lobe(&model, wi, wo);
			check_rel(cook_torrance_from_G(DF, gaf_G(gaf, &model.ndf, wi, wo), cosines), want, 1e-13, "G");
			if (gaf == GAF_V_GROOVE)
				continue;
			check_rel(
				cook_torrance_from_G1(gaf, DF, ndf_G1(&model.ndf, wi), ndf_G1(&model.ndf, wo), cosines),
				want, 1e-13, "G1");
		}
	assert_true(cook_torrance_from_G1(GAF_CORRELATED, 1.0, 0.0, 0.5, 0.25) == 0.0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lobe_is_the_product_of_its_parts),
		cmocka_unit_test(a_second_lobe_and_a_grazing_term_add),
		cmocka_unit_test(lobe_is_reciprocal),
		cmocka_unit_test(lobe_matches_values_by_hand),
		cmocka_unit_test(lobe_is_zero_below_the_horizon),
		cmocka_unit_test(v_groove_is_the_minimum_of_its_three_terms),
		cmocka_unit_test(names_and_values_are_inverse),
		cmocka_unit_test(error_texts_are_truncated_and_distinct),
		cmocka_unit_test(lobe_from_tabulated_factors_is_the_lobe),
	};
	return cmocka_run_group_tests_name("cook_torrance", tests, NULL, NULL);
}
