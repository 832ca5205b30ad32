/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "check.h"
#include "src/fresnel.h"

static void dielectric_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/fresnel_dielectric.csv", "eta,cos_i,F");
	while (golden_next(&golden)) {
		const double n = golden.value[0], cos_d = golden.value[1], want = golden.value[2];
		check_rel(fresnel_dielectric(cos_d, n), want, 2e-15, golden.label);
		check_rel(fresnel_conductor(cos_d, n, 0.0), want, 2e-15, golden.label);
	}
}

static void conductor_matches_golden_rows(void **state)
{
	(void)state;
	struct golden golden = golden_open("tests/golden/fresnel_conductor.csv", "eta,k,cos_i,F");
	while (golden_next(&golden)) {
		const double *v = golden.value;
		check_rel(fresnel_conductor(v[2], v[0], v[1]), v[3], 2e-15, golden.label);
	}
}

static void edges_give_their_limits(void **state)
{
	(void)state;
	for (int i = 0; i <= 1000; i++) {
		const double c = i / 1000.0;
		if (i > 0)
			check_abs(fresnel_dielectric(c, 1.0), 0.0, 0.0, "no interface");
		check_abs(fresnel_F(FRESNEL_NONE, c, 1.5, 0.0), 1.0, 0.0, "none");
	}
	const double indices[] = {0.2, 1.0001, 1.385, 4.2, 100.0, 1e70};
	for (int i = 0; i < 6; i++) {
		check_abs(fresnel_dielectric(0.0, indices[i]), 1.0, 0.0, "grazing dielectric");
		check_abs(fresnel_conductor(0.0, indices[i], 2.3), 1.0, 0.0, "grazing conductor");
		check_abs(fresnel_schlick(0.0, indices[i]), 1.0, 1e-15, "grazing Schlick");
		const double root = (indices[i] - 1.0) / (indices[i] + 1.0);
		check_rel(fresnel_dielectric(1.0, indices[i]), root * root, 1e-15, "normal incidence dielectric");
		check_rel(fresnel_schlick(1.0, indices[i]), root * root, 1e-15, "normal incidence Schlick");
		check_between(fresnel_conductor(0.3, indices[i], 1e70), 1.0 - 1e-15, 1.0, "huge k");
	}
	/* The critical angle of n = 0.8 is at sin = 0.8, cos = 0.6. */
	check_abs(fresnel_dielectric(0.599, 0.8), 1.0, 0.0, "total internal reflection");
	check_between(fresnel_dielectric(0.601, 0.8), 0.3, 0.99, "just outside total internal reflection");
	check_abs(fresnel_conductor(0.599, 0.8, 0.0), 1.0, 1e-15, "total internal reflection, complex form");
	check_rel(fresnel_dielectric(7.0, 1.5), fresnel_dielectric(1.0, 1.5), 0.0, "cosine above 1");
	check_abs(fresnel_dielectric(-1e-9, 1.5), 1.0, 0.0, "cosine below 0");
	check_abs(fresnel_dielectric(NAN, 1.5), NAN, 0.0, "NaN cosine");
	check_abs(fresnel_schlick(NAN, 1.5), NAN, 0.0, "NaN cosine");
	check_abs(fresnel_conductor(0.5, 1.5, NAN), NAN, 0.0, "NaN k");
}

/* A weak interface reflects (n - 1)^2/4 (1/c^4)(1 - 2 s^2 + 2 s^4): the first order of both amplitudes in n - 1. */
static void a_weak_interface_reflects_to_first_order(void **state)
{
	(void)state;
	const double n_minus_1 = 0x1p-30;
	for (double c = 0.2; c <= 1.0; c += 0.05) {
		const double s2 = 1.0 - c * c;
		const double r_s = n_minus_1 / (2.0 * c * c);
		const double want = 0.5 * r_s * r_s * (1.0 + (c * c - s2) * (c * c - s2));
		check_rel(fresnel_dielectric(c, 1.0 + n_minus_1), want, 1e-6, "weak interface");
	}
}

/* At Brewster's angle, tan = n, only s-polarised light is reflected: F = r_s^2/2, r_s = (1 - n^2)/(1 + n^2). */
static void F_at_the_Brewster_angle_is_half_of_r_s_squared(void **state)
{
	(void)state;
	for (double n = 1.1; n < 5.0; n += 0.37) {
		const double r_s = (1.0 - n * n) / (1.0 + n * n);
		check_rel(fresnel_dielectric(1.0 / sqrt(1.0 + n * n), n), 0.5 * r_s * r_s, 1e-14, "Brewster");
	}
}

static void stays_in_range(void **state)
{
	(void)state;
	for (double n = 0.05; n < 200.0; n *= 1.21) {
		for (double k = 1e-3; k < 200.0; k *= 2.1) {
			for (int i = 0; i <= 200; i++) {
				const double c = i / 200.0;
				for (enum fresnel f = FRESNEL_DIELECTRIC; f < FRESNEL_COUNT; f++)
					check_between(fresnel_F(f, c, n, k), 0.0, 1.0, fresnel_name(f));
			}
		}
	}
}

static void F_is_the_form_it_is_asked_for(void **state)
{
	(void)state;
	assert_true(fresnel_F(FRESNEL_DIELECTRIC, 0.37, 1.7, 2.9) == fresnel_dielectric(0.37, 1.7));
	assert_true(fresnel_F(FRESNEL_SCHLICK, 0.37, 1.7, 2.9) == fresnel_schlick(0.37, 1.7));
	assert_true(fresnel_F(FRESNEL_CONDUCTOR, 0.37, 1.7, 2.9) == fresnel_conductor(0.37, 1.7, 2.9));
	check_rel(fresnel_schlick(0.5, 3.0), 0.25 + 0.75 / 32.0, 1e-15, "Schlick by hand");
}

/* The three reflectances are those at their angles; with Schlick's own at 1/7 it is Schlick's; what leads out of [0, 1] is cut. */
static void f82_has_its_three_reflectances(void **state)
{
	(void)state;
	const double gold[F82_PARTS] = {0.91, 0.8, 1.0}, excessive[F82_PARTS] = {0.0, 0.0, 1.0};
	check_rel(fresnel_f82(1.0, gold), 0.91, 1e-15, "F0");
	check_rel(fresnel_f82(1.0 / 7.0, gold), 0.8, 1e-14, "F82");
	check_rel(fresnel_f82(0.0, gold), 1.0, 1e-15, "F90");
	for (double n = 1.1; n < 100.0; n *= 1.7) {
		const double schlick[F82_PARTS] = {fresnel_schlick(1.0, n), fresnel_schlick(1.0 / 7.0, n), 1.0};
		for (double c = 0.0; c <= 1.0; c += 1.0 / 64.0)
			check_rel(fresnel_f82(c, schlick), fresnel_schlick(c, n), 1e-13, "Schlick's own");
	}
	for (double c = -0.1; c <= 1.1; c += 1.0 / 128.0)
		check_between(fresnel_f82(c, excessive), 0.0, 1.0, "in range");
	assert_true(isnan(fresnel_f82(NAN, gold)));
}

static void names_and_values_are_inverse(void **state)
{
	(void)state;
	const char *const want[FRESNEL_COUNT] = {"dielectric", "schlick", "conductor", "none", "f82"};
	for (int i = 0; i < FRESNEL_COUNT; i++) {
		enum fresnel found = FRESNEL_COUNT;
		assert_string_equal(fresnel_name((enum fresnel)i), want[i]);
		assert_int_equal(fresnel_find(want[i], &found), STATUS_OK);
		assert_int_equal(found, i);
	}
	enum fresnel untouched = FRESNEL_CONDUCTOR;
	const char *const bad[] = {"", "Dielectric", "dielectri", "dielectric ", NULL};
	for (int i = 0; i < 5; i++)
		assert_int_equal(fresnel_find(bad[i], &untouched), STATUS_DOMAIN);
	assert_int_equal(untouched, FRESNEL_CONDUCTOR);
	assert_string_equal(fresnel_name(FRESNEL_COUNT), "unknown");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(dielectric_matches_golden_rows),
		cmocka_unit_test(conductor_matches_golden_rows),
		cmocka_unit_test(edges_give_their_limits),
		cmocka_unit_test(a_weak_interface_reflects_to_first_order),
		cmocka_unit_test(F_at_the_Brewster_angle_is_half_of_r_s_squared),
		cmocka_unit_test(stays_in_range),
		cmocka_unit_test(F_is_the_form_it_is_asked_for),
		cmocka_unit_test(f82_has_its_three_reflectances),
		cmocka_unit_test(names_and_values_are_inverse),
	};
	return cmocka_run_group_tests_name("fresnel", tests, NULL, NULL);
}
