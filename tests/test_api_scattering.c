/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The public functions of rough dielectrics and of light that meets several facets: what they give is what the internals
 * give, and what is wrong is refused. */
#include "check.h"
#include "chi_square.h"
#include "fit/stdfit.h"
#include "src/dielectric.h"
#include "src/random_walk.h"

static struct stdfit_error error;

static void expect(enum stdfit_status got, enum stdfit_status want, const char *part)
{
	if (got != want || !strstr(error.text, part))
		fail_msg("status %d, text '%s': expected %d, '%s'", (int)got, error.text, (int)want, part);
	error.text[0] = '\0';
}

static stdfit_ndf *new_ndf(const char *name, double gamma)
{
	stdfit_ndf *ndf = NULL;

	expect(stdfit_ndf_new(&ndf, name, 0.4, 0.4, gamma, NULL, &error), STDFIT_OK, "");
	return ndf;
}

static struct vec3 vec(const double *d)
{
	return (struct vec3){d[0], d[1], d[2]};
}

static const double wi[3] = {0.6, 0, 0.8}, under[3] = {0.28, 0, -0.96}, up[3] = {0, 0, 1}, level[3] = {1, 0, 0};

static void dielectrics_are_those_of_the_internals(void **state)
{
	const double u[6] = {0.3, 0.7, 0.9, 0.2, 0.4, 0.01}, two_wi[6] = {0.6, 0, 0.8, 0.28, 0, -0.96},
		     two_wo[6] = {-0.28, 0, -0.96, -0.28, 0, -0.96};
	stdfit_ndf *ndf = new_ndf("std", 1.8), *low = new_ndf("low", 1.8);
	double f[2], wo[6], weight[2], pdf[2];
	struct dielectric inner;
	struct ndf facets;

	(void)state;
	assert_int_equal(ndf_init(&facets, ndf_find("std"), 0.4, 0.4, 1.8), STATUS_OK);
	assert_int_equal(dielectric_init(&inner, &facets, GAF_CORRELATED, 1.5), STATUS_OK);
	expect(stdfit_dielectric_evaluate(ndf, "correlated", 1.5, 2, two_wi, two_wo, f, &error), STDFIT_OK, "");
	for (int i = 0; i < 2; i++) {
		check_rel(f[i], dielectric_f(&inner, vec(two_wi + 3 * i), vec(two_wo + 3 * i)), 0, "f");
		assert_true(f[i] > 0);
	}
	expect(stdfit_dielectric_sample(ndf, "correlated", 1.5, NULL, under, 2, u, wo, weight, &error), STDFIT_OK, "");
	expect(stdfit_dielectric_pdf(ndf, 1.5, NULL, under, 2, wo, pdf, &error), STDFIT_OK, "");
	for (int i = 0; i < 2; i++) {
		const double value = dielectric_f(&inner, vec(under), vec(wo + 3 * i)) * fabs(wo[3 * i + 2]);

		check_rel(weight[i] * pdf[i], value, 1e-9, "weight and density");
	}
	assert_true(wo[2] > 0 && wo[5] < 0);
	/* low has no visible normals, but its own */
	expect(stdfit_dielectric_sample(low, NULL, 1.5, "ndf", under, 2, u, wo, weight, &error), STDFIT_OK, "");
	expect(stdfit_dielectric_pdf(low, 1.5, "ndf", under, 2, wo, pdf, &error), STDFIT_OK, "");
	expect(stdfit_dielectric_evaluate(low, NULL, 1.5, 1, under, wo, f, &error), STDFIT_OK, "");
	check_rel(weight[0] * pdf[0], f[0] * wo[2], 1e-9, "weight and density");
	stdfit_ndf_free(low);
	stdfit_ndf_free(ndf);
}

static double next_number(void *state)
{
	return uniform(state);
}

static void walks_are_those_of_the_internals(void **state)
{
	struct stdfit_facets facets = stdfit_facets_default();
	stdfit_ndf *ndf = new_ndf("std", 1.8);
	uint64_t random = 5, same = 5;
	const struct random_numbers numbers = {next_number, &same};
	double f[6], wo[6], weight[6];
	int events[2];
	struct random_walk walk;
	struct ndf inner;

	(void)state;
	facets.fresnel = "conductor";
	facets.k[0] = 2;
	facets.k[2] = 3;
	assert_int_equal(ndf_init(&inner, ndf_find("std"), 0.4, 0.4, 1.8), STATUS_OK);
	assert_int_equal(random_walk_init_mirror(&walk, &inner, FRESNEL_CONDUCTOR, facets.n, facets.k), STATUS_OK);
	expect(stdfit_scatter_sample(&facets, ndf, wi, 2, &random, wo, weight, events, &error), STDFIT_OK, "");
	for (int i = 0; i < 2; i++) {
		const struct random_walk_exit out = random_walk_sample(&walk, vec(wi), &numbers);

		assert_true(wo[3 * i] == out.wo.x && weight[3 * i + 2] == out.weight[2] && events[i] == out.events);
	}
	expect(stdfit_scatter_evaluate(&facets, ndf, 0, 1, wi, up, &random, f, &error), STDFIT_OK, "");
	random_walk_f(&walk, vec(wi), vec(up), 0, &numbers, f + 3);
	assert_true(random == same);
	for (int c = 0; c < 3; c++)
		check_rel(f[c], f[3 + c], 0, "f");
	/* one event of glass is the dielectric's */
	facets = stdfit_facets_default();
	facets.transmits = 1;
	facets.fresnel = NULL;
	const double through[3] = {-0.28, 0, -0.96};

	expect(stdfit_scatter_evaluate(&facets, ndf, 1, 1, wi, through, &random, f, &error), STDFIT_OK, "");
	expect(stdfit_dielectric_evaluate(ndf, "correlated", 1.5, 1, wi, through, f + 3, &error), STDFIT_OK, "");
	check_rel(f[1], f[3], 1e-12, "one event");
	expect(stdfit_scatter_sample(&facets, ndf, under, 2, &random, wo, weight, NULL, &error), STDFIT_OK, "");
	assert_true(weight[0] == 1 && weight[5] == 1);
	stdfit_ndf_free(ndf);
}

static void null_and_nonsense_are_refused(void **state)
{
	const double u[3] = {0.1, 0.2, 1};
	struct stdfit_facets facets = stdfit_facets_default();
	stdfit_ndf *ndf = new_ndf("std", 1.8), *low = new_ndf("low", 1.8);
	double value[3], weight[3];
	uint64_t random = 1;

	(void)state;
	expect(stdfit_dielectric_evaluate(NULL, NULL, 1.5, 1, wi, up, value, &error), STDFIT_DOMAIN, "ndf is NULL");
	expect(stdfit_dielectric_evaluate(ndf, NULL, 1, 1, wi, up, value, &error), STDFIT_DOMAIN, "other than 1");
	expect(stdfit_dielectric_evaluate(ndf, NULL, NAN, 1, wi, up, value, &error), STDFIT_DOMAIN, "found nan");
	expect(stdfit_dielectric_evaluate(ndf, "v-groove", 2, 1, wi, up, value, &error), STDFIT_UNSUPPORTED,
	       "v-groove");
	expect(stdfit_dielectric_evaluate(ndf, NULL, 2, 1, wi, u, value, &error), STDFIT_DOMAIN, "wo number 0");
	expect(stdfit_dielectric_evaluate(ndf, NULL, 2, 1, wi, up, NULL, &error), STDFIT_DOMAIN, "f is NULL");
	expect(stdfit_dielectric_sample(ndf, NULL, 2, NULL, level, 1, u, value, weight, &error), STDFIT_DOMAIN,
	       "in the horizon");
	expect(stdfit_dielectric_sample(ndf, NULL, 2, NULL, wi, 1, u, value, weight, &error), STDFIT_DOMAIN, "found 1");
	expect(stdfit_dielectric_sample(ndf, NULL, 2, NULL, wi, 1, u, NULL, weight, &error), STDFIT_DOMAIN, "NULL");
	expect(stdfit_dielectric_sample(low, NULL, 2, NULL, wi, 1, u, value, weight, &error), STDFIT_UNSUPPORTED,
	       "low");
	expect(stdfit_dielectric_pdf(ndf, 2, "all", wi, 1, up, value, &error), STDFIT_DOMAIN, "'all'");
	expect(stdfit_dielectric_pdf(ndf, 2, NULL, wi, 1, up, NULL, &error), STDFIT_DOMAIN, "pdf is NULL");
	expect(stdfit_scatter_sample(NULL, ndf, wi, 1, &random, value, weight, NULL, &error), STDFIT_DOMAIN, "facets");
	expect(stdfit_scatter_sample(&facets, low, wi, 1, &random, value, weight, NULL, &error), STDFIT_UNSUPPORTED,
	       "low");
	expect(stdfit_scatter_sample(&facets, ndf, under, 1, &random, value, weight, NULL, &error), STDFIT_DOMAIN,
	       "below the horizon");
	expect(stdfit_scatter_sample(&facets, ndf, wi, 1, NULL, value, weight, NULL, &error), STDFIT_DOMAIN, "random");
	expect(stdfit_scatter_evaluate(&facets, ndf, -1, 1, wi, up, &random, value, &error), STDFIT_DOMAIN, "found -1");
	expect(stdfit_scatter_evaluate(&facets, ndf, 0, 1, wi, up, &random, NULL, &error), STDFIT_DOMAIN, "f is NULL");
	facets.transmits = 1;
	expect(stdfit_scatter_evaluate(&facets, ndf, 0, 1, wi, up, &random, value, &error), STDFIT_DOMAIN, "not none");
	facets.fresnel = "dielectric";
	facets.n[0] = 1;
	expect(stdfit_scatter_evaluate(&facets, ndf, 0, 1, wi, up, &random, value, &error), STDFIT_DOMAIN,
	       "other than 1");
	facets.transmits = 0;
	facets.n[1] = -1;
	expect(stdfit_scatter_evaluate(&facets, ndf, 0, 1, wi, up, &random, value, &error), STDFIT_DOMAIN, "found -1");
	assert_true(random == 1);
	stdfit_ndf_free(low);
	stdfit_ndf_free(ndf);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(dielectrics_are_those_of_the_internals),
		cmocka_unit_test(walks_are_those_of_the_internals),
		cmocka_unit_test(null_and_nonsense_are_refused),
	};
	return cmocka_run_group_tests_name("scattering in the public interface", tests, NULL, NULL);
}
