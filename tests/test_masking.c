/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tabulated G1 against the exact one, over the domain of the fit. */
#include "check.h"
#include "fit/error/masking.h"

static const double sigmas[] = {1e-4, 3.7e-3, 0.05, 0.31, 1.3, 4};
static const double gammas[] = {1.5001, 1.513, 1.7, 2, 2.6, 7.3, 55, 1000, INFINITY};

/* The largest relative error between the smallest cosine of a table, about 1e-7, and cot theta = 2^13.9. */
static double worst_error(enum masking_density density)
{
	const int32_t q_min = -(23 << MASKING_Q_BITS), q_max = (int32_t)(13.9 * (1 << MASKING_Q_BITS));
	double worst = 0;
	struct masking masking;

	assert_int_equal(masking_init(&masking, q_min, density), STATUS_OK);
	for (size_t s = 0; s < sizeof sigmas / sizeof *sigmas; s++)
		for (size_t g = 0; g < sizeof gammas / sizeof *gammas; g++) {
			struct ndf ndf;

			assert_int_equal(ndf_init(&ndf, ndf_find("std"), sigmas[s], sigmas[s], gammas[g]), STATUS_OK);
			masking_fill(&masking, &ndf);
			for (int32_t q = q_min + 12345; q < q_max; q += 777777) {
				const double cot = exp2((double)q / (1 << MASKING_Q_BITS)),
					     sine = 1 / sqrt(1 + cot * cot);
				const double exact = ndf_G1(&ndf, (struct vec3){sine, 0, cot * sine});

				worst = fmax(worst, fabs(masking_at(&masking, q) - exact) / exact);
			}
		}
	masking_free(&masking);
	return worst;
}

static void interpolates_within_its_bound(void **state)
{
	(void)state;
	const double coarse = worst_error(MASKING_COARSE), fine = worst_error(MASKING_FINE);

	print_message("largest relative error of G1: coarse %.2g, fine %.2g\n", coarse, fine);
	check_between(coarse, 0, 1e-5, "coarse");
	check_between(fine, 0, 1.2e-7, "fine");
}

static void q_is_the_logarithm_of_the_cotangent(void **state)
{
	(void)state;
	assert_int_equal(masking_q((struct vec3){0, 0, 1}), MASKING_Q_MAX << MASKING_Q_BITS);
	assert_int_equal(masking_q((struct vec3){M_SQRT1_2, 0, M_SQRT1_2}), 0);
	assert_int_equal(masking_q((struct vec3){0, 2 / sqrt(5), 1 / sqrt(5)}), -(1 << MASKING_Q_BITS));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(interpolates_within_its_bound),
		cmocka_unit_test(q_is_the_logarithm_of_the_cotangent),
	};

	return cmocka_run_group_tests_name("masking", tests, NULL, NULL);
}
