/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The extremes of every function, condensed from `make stability`, and what once went wrong there. */
#include "check.h"
#include "extremes.h"
#include "fit/error/objective.h"
#include "make_table.h"
#include "src/cook_torrance.h"
#include "src/ellipsoid.h"
#include "src/ndf_cdf.h"
#include "src/ndf_slopes.h"
#include "src/pwl.h"
#include "src/vndf.h"
#include <fenv.h>
#include <float.h>

#define TRAPS (FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW)

static struct ndf make_ndf(const char *name, double sigma, double gamma)
{
	struct ndf ndf;
	assert_int_equal(ndf_init(&ndf, ndf_find(name), sigma, sigma, gamma), STATUS_OK);
	return ndf;
}

static void no_exception(const char *label)
{
	const int raised = fetestexcept(TRAPS);
	feclearexcept(FE_ALL_EXCEPT);
	if (raised)
		fail_msg("%s raised%s%s%s", label, raised & FE_INVALID ? " invalid" : "",
			 raised & FE_DIVBYZERO ? " division by zero" : "", raised & FE_OVERFLOW ? " overflow" : "");
}

/* Finite, within bounds, falling or rising as it should, without an exception: D, Lambda, G1, P2, samples. */
static void check_ndf(const struct ndf *ndf, const char *label)
{
	struct vec3 w[EXTREME_DIRECTIONS];
	double lambda_before = 0.0, G1_before = 1.0;
	extreme_directions(ndf->sigma_x, w);
	feclearexcept(FE_ALL_EXCEPT);
	for (int i = 0; i < EXTREME_DIRECTIONS; i++) {
		check_between(ndf_D(ndf, w[i]), 0.0, DBL_MAX, label);
		check_between(ndf_P2(ndf, 0.3, w[i].x / fmax(w[i].z, 1e-150)), 0.0, DBL_MAX, label);
		no_exception(label);
		const double lambda = ndf_lambda(ndf, w[i]), G1 = ndf_G1(ndf, w[i]);
		check_between(lambda, lambda_before * (1.0 - 1e-11) - 1e-11, INFINITY, label);
		check_between(G1, 0.0, fmin(1.0, G1_before + 2e-12), label);
		if (w[i].z > 1e-250)
			no_exception(label);
		feclearexcept(FE_ALL_EXCEPT); /* Lambda itself overflows */
		lambda_before = lambda;
		G1_before = G1;
		const struct vec3 m = ndf_sample(ndf, 0.3, (double)i / EXTREME_DIRECTIONS);
		check_between(m.z, 0.0, 1.0, label);
		no_exception(label);
		if (!vndf_supports(ndf))
			continue;
		const struct vec3 visible =
			vndf_sample(ndf, w[i], i % 3 * 0.5 * (1.0 - 0x1p-53), i % 4 / 3.0 * (1.0 - 0x1p-53));
		check_between(visible.z, DBL_MIN, 1.0, label);
		check_between(vec3_dot(w[i], visible), -0x1p-52, 1.0 + 1e-15, label);
		no_exception(label);
	}
}

static void extreme_distributions_stay_finite(void **state)
{
	(void)state;
	for (int d = 0; ndf_at(d); d++) {
		if (ndf_is_tabulated(ndf_at(d)))
			continue;
		int made = 0;
		for (int i = 0; i < COUNT(extreme_sigma); i++)
			for (int j = 0; j < COUNT(extreme_gamma); j++) {
				struct ndf ndf;
				char label[128];
				if (ndf_init(&ndf, ndf_at(d), extreme_sigma[i], extreme_sigma[i], extreme_gamma[j]) !=
				    STATUS_OK)
					continue;
				snprintf(label, sizeof(label), "%s sigma %g gamma %.17g", ndf_name(ndf_at(d)),
					 extreme_sigma[i], extreme_gamma[j]);
				made++;
				check_ndf(&ndf, label);
			}
		assert_true(made >= COUNT(extreme_sigma));
	}
}

/* Shares of normals, and of visible slopes, from the normal to the horizon: within [0, 1], without an exception. */
static void extreme_shares_stay_in_range(void **state)
{
	(void)state;
	for (int d = 0; ndf_at(d); d++)
		for (int i = 0; i < COUNT(extreme_sigma) * COUNT(extreme_gamma) && !ndf_is_tabulated(ndf_at(d)); i++) {
			const double sigma = extreme_sigma[i % COUNT(extreme_sigma)];
			struct vec3 w[EXTREME_DIRECTIONS];
			struct ndf ndf;
			if (ndf_init(&ndf, ndf_at(d), sigma, sigma, extreme_gamma[i / COUNT(extreme_sigma)]) !=
			    STATUS_OK)
				continue;
			extreme_directions(sigma, w);
			feclearexcept(FE_ALL_EXCEPT);
			for (int k = 0; k < EXTREME_DIRECTIONS; k++) {
				check_between(ndf_cdf_theta(&ndf, atan2(w[k].x, w[k].z), 0.3), 0.0, 1.0,
					      ndf_name(ndf.class));
				double along = 0.5, across = 0.5;
				if (vndf_supports(&ndf))
					vndf_cdf(&ndf, w[k], w[(k + i) % EXTREME_DIRECTIONS], &along, &across);
				check_between(along, 0.0, 1.0, "visible slope along");
				check_between(across, 0.0, 1.0, "visible slope across");
				no_exception(ndf_name(ndf.class));
			}
		}
}

/* The whole lobe over pairs of extreme directions: finite, not negative, the same both ways. */
static void extreme_lobes_stay_finite_and_reciprocal(void **state)
{
	(void)state;
	static const double azimuth[] = {0.0, M_PI, 1.1};
	for (int gaf = 0; gaf < GAF_COUNT; gaf++)
		for (int i = 0; i < COUNT(extreme_sigma); i += 2)
			for (int j = 1; j < COUNT(extreme_gamma); j += 4) {
				const double sigma = extreme_sigma[i];
				struct vec3 w[EXTREME_DIRECTIONS];
				const struct cook_torrance model = {.ndf = make_ndf("std", sigma, extreme_gamma[j]),
								    .gaf = (enum gaf)gaf,
								    .fresnel = FRESNEL_DIELECTRIC,
								    .n = 1.5};
				extreme_directions(sigma, w);
				for (int p = 0; p < EXTREME_DIRECTIONS * EXTREME_DIRECTIONS; p += 2) {
					const struct vec3 wi = w[p % EXTREME_DIRECTIONS];
					const struct vec3 wo = turned(w[p / EXTREME_DIRECTIONS], azimuth[p % 3]);
					if (fmin(wi.z, wo.z) < 1e-250 && fmin(wi.z, wo.z) > 0.0)
						continue; /* 1/cos overflows */
					feclearexcept(FE_ALL_EXCEPT);
					const double f = cook_torrance_lobe(&model, wi, wo);
					check_between(f, 0.0, DBL_MAX, "lobe");
					no_exception("lobe");
					check_rel(cook_torrance_lobe(&model, wo, wi), f, 1e-11, "lobe, the other way");
				}
			}
}

/* G1 and G underflow long before G/(cos_i cos_o) D does. */
static void a_lobe_outlives_the_underflow_of_G(void **state)
{
	(void)state;
	const struct cook_torrance model = {.ndf = make_ndf("std", 1e4, 5.3), .fresnel = FRESNEL_NONE};
	const struct vec3 wi = {1.0, 0.0, 1e-160}, wo = {0.5, sqrt(0.75), 1e-30};
	check_rel(cook_torrance_lobe(&model, wi, wo), 1.2609754279223692633e-170, 1e-13, "grazing lobe");
}

/* References by tests/high_precision.h. */
static void large_gamma_matches_references(void **state)
{
	(void)state;
	const struct ndf ndf = make_ndf("std", 1e-4, 9.99e17), rough = make_ndf("std", 4.0, 9.99e17);
	check_rel(ndf_lambda(&ndf, (struct vec3){1.0, 0.0, 0.0026}), 2.0912890971884977608e-299, 1e-12, "Lambda");
	check_rel(ndf_G1(&rough, (struct vec3){1.0, 0.0, 1e-300}), 1.0 / 1.1283791670955125466e300, 1e-15, "G1");
	static const double gamma[] = {1e15, 9.99e17, 1e20};
	static const double D[] = {2.4888978952486184534e-211, 2.4888978949466701701e-211, 2.4888978949463693948e-211};
	for (int i = 0; i < 3; i++) {
		const struct ndf at = make_ndf("std", 0.3, gamma[i]);
		check_rel(ndf_D(&at, (struct vec3){0.988936, 0.0, 0.14834}), D[i], 2e-15, "D");
	}
}

static void the_far_tail_of_low_keeps_its_digits(void **state)
{
	(void)state;
	static const double value[] = {1e14, 2.0};
	struct ndf ndf;
	assert_int_equal(ndf_init_params(&ndf, ndf_find("low"), value), STATUS_OK);
	check_rel(ndf_D(&ndf, (struct vec3){1.0, 0.0, 1e-10}), 1.591549431237744465e-15, 4e-15, "low");
}

/* (1 - 1/gamma)/(2 - 3/gamma) once lost all digits at gamma 1.5. */
static void rational_form_keeps_its_digits_near_its_pole(void **state)
{
	(void)state;
	struct ndf ndf = make_ndf("std", 1e-7, 0x1.8000000000001p0);
	const struct vec3 w = {1.0, 0.0, 1e-10};
	assert_int_equal(ndf_set_lambda_form(&ndf, LAMBDA_RATIONAL), STATUS_OK);
	check_rel(ndf_G1(&ndf, w), 1.0 / (1.0 + 506833028245090296.91), 0.0072, "rational G1");
}

static void fresnel_raises_no_exception_at_its_edges(void **state)
{
	(void)state;
	static const double cosine[] = {DBL_TRUE_MIN, 1e-300, 0.3, 1.0};
	for (int i = 0; i < COUNT(cosine); i++) {
		feclearexcept(FE_ALL_EXCEPT);
		assert_true(fresnel_dielectric(cosine[i], 1.0) == 0.0);
		assert_true(fresnel_conductor(cosine[i], 1.0, 0.0) == 0.0);
		for (double k = 0.0; k < 1e9; k = 10.0 * k + 1e-3)
			check_between(fresnel_conductor(cosine[i], 1.5, k), 0.0, 1.0, "conductor");
		no_exception("fresnel");
	}
}

static void ellipsoid_takes_a_denormal_tilt(void **state)
{
	(void)state;
	struct ellipsoid e;
	assert_int_equal(ellipsoid_init_angles(&e, 1.0, 0.3, 0.4, -0.7, 1.0), STATUS_OK);
	const struct vec3 wi = {-DBL_TRUE_MIN, -DBL_TRUE_MIN, 1.0};
	check_between(ellipsoid_sample(&e, wi, 0.3, 0.6).z, DBL_MIN, 1.0, "a denormal tilt");
}

/* All the mass in the first segment: whatever the numbers, samples stay there. */
static void samples_of_a_spike_stay_in_it(void **state)
{
	(void)state;
	enum { NODES = 91 };
	double theta[NODES], D[NODES] = {DBL_MAX};
	struct pwl pwl;
	for (int i = 0; i < NODES; i++)
		theta[i] = 0.5 * M_PI * i * i / ((NODES - 1.0) * (NODES - 1.0));
	assert_int_equal(pwl_init(&pwl, NODES, theta, D, NULL), STATUS_OK);
	feclearexcept(FE_ALL_EXCEPT);
	for (double u = 0.0; u < 1.0; u = 0.5 * (1.0 + u) + 0x1p-54) {
		const struct vec3 m = pwl_sample(&pwl, 0.25, u);
		check_between(atan2(hypot(m.x, m.y), m.z), 0.0, theta[1] * (1.0 + 1e-15), "in the first segment");
		if (u > 1.0 - 0x1p-52)
			break;
	}
	no_exception("pwl_sample");
	pwl_free(&pwl);
}

/* The error of a table of the largest floats is what it is for moderate ones: no kd or ks can do anything. */
static void E_is_right_over_the_range_of_floats(void **state)
{
	(void)state;
	static const float scale[] = {1e-45f, 1e-41f, 1e25f, 1e38f, FLT_MAX};
	struct fit_options options = fit_options_default();
	struct geometry geometry;
	struct measurement measurement;
	options.threads = 1;
	assert_int_equal(measurement_alloc(&measurement, 180), STATUS_OK);
	assert_int_equal(geometry_init(&geometry, 180, &options), STATUS_OK);
	for (int i = 0; i < COUNT(scale); i++) {
		struct sample_set table;
		struct objective o;
		struct linear linear;
		for (size_t e = 0; e < measurement_count(&measurement); e++)
			for (int c = 0; c < MERL_CHANNELS; c++)
				measurement.value[c][e] = scale[i];
		assert_int_equal(sample_set_init(&table, &geometry, &measurement, 1), STATUS_OK);
		assert_int_equal(objective_init(&o, &table, &options, ndf_find("std"), 1, MASKING_COARSE), STATUS_OK);
		const double E = objective_eval(&o, &(struct shape){.sigma = 0.1, .gamma = 3.0, .ior = 1.5}, 1e-6, true,
						&linear);
		check_between(E, scale[i] > 1.0f ? 1.0 - 1e-5 : 0.0, 1.0 + 1e-6, "E");
		/* A lobe sharper than a float can hold stays one. */
		assert_int_equal(objective_lobe(&o, &(struct shape){.sigma = 1e-40, .gamma = 3.0, .ior = 1.5}),
				 STATUS_OK);
		for (int n = 0; n < table.n_blocks * KERNEL_BLOCK; n++)
			if (!(o.term[1][n] >= 0.0f && o.term[1][n] <= FLT_MAX))
				fail_msg("lobe of slot %d is %g", n, (double)o.term[1][n]);
		objective_free(&o);
		sample_set_free(&table);
	}
	geometry_free(&geometry);
	measurement_free(&measurement);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(extreme_distributions_stay_finite),
		cmocka_unit_test(extreme_shares_stay_in_range),
		cmocka_unit_test(extreme_lobes_stay_finite_and_reciprocal),
		cmocka_unit_test(a_lobe_outlives_the_underflow_of_G),
		cmocka_unit_test(large_gamma_matches_references),
		cmocka_unit_test(the_far_tail_of_low_keeps_its_digits),
		cmocka_unit_test(rational_form_keeps_its_digits_near_its_pole),
		cmocka_unit_test(fresnel_raises_no_exception_at_its_edges),
		cmocka_unit_test(ellipsoid_takes_a_denormal_tilt),
		cmocka_unit_test(samples_of_a_spike_stay_in_it),
		cmocka_unit_test(E_is_right_over_the_range_of_floats),
	};
	return cmocka_run_group_tests_name("stability", tests, NULL, NULL);
}
