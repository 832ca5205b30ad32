/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chi_square - what the tests of samplers share: uniform numbers, and counts held against expected ones. */
#ifndef CHI_SQUARE_H
#define CHI_SQUARE_H

#include "check.h"
#include "src/splitmix.h"
#include <gsl/gsl_cdf.h>

static inline double uniform(uint64_t *state)
{
	return splitmix_uniform(state);
}

/* The pairs of numbers with which a sampler has to cope. */
static const double extreme_numbers[] = {0.0, 0x1p-53, 1e-12, 1e-3,       0.25,         0.5 - 0x1p-54,
					 0.5, 0.75,    0.999, 1.0 - 1e-9, 1.0 - 0x1p-53};
enum { EXTREME_NUMBERS = sizeof(extreme_numbers) / sizeof(extreme_numbers[0]) };

/* check_counts - fails where counts so far from the expected ones have a probability below 1 % over all `tests` such
 * comparisons (Sidak). Bins in which fewer than 5 are expected are taken together. */
static inline void check_counts(int bins, const int *count, const double *expected, int tests, const char *label)
{
	double chi2 = 0.0, rest_count = 0.0, rest_expected = 0.0;
	int used = 0;
	for (int i = 0; i < bins; i++) {
		if (expected[i] < 5.0) {
			rest_count += count[i];
			rest_expected += expected[i];
			continue;
		}
		chi2 += (count[i] - expected[i]) * (count[i] - expected[i]) / expected[i];
		used++;
	}
	if (rest_expected >= 5.0) {
		chi2 += (rest_count - rest_expected) * (rest_count - rest_expected) / rest_expected;
		used++;
	} else {
		check_between(rest_count, 0.0, 25.0, label);
	}
	if (used < 5)
		fail_msg("%s: only %d bins", label, used);
	const double p = gsl_cdf_chisq_Q(chi2, used - 1.0);
	const double limit = 1.0 - pow(0.99, 1.0 / tests);
	if (!(p > limit))
		fail_msg("%s: chi^2 %g over %d bins, p = %.3g < %.3g", label, chi2, used, p, limit);
}

/* check_unit - fails unless m is a unit vector above the horizon. */
static inline void check_unit(double x, double y, double z, const char *label)
{
	if (!(fabs(x * x + y * y + z * z - 1.0) < 4e-15 && z > 0.0))
		fail_msg("%s: not a unit vector above the horizon: %g %g %g", label, x, y, z);
}

/* check_mean - fails unless a mean with its standard error is within 4 of them of what it should be. */
static inline void check_mean(double mean, double standard_error, double want, const char *label)
{
	if (!(fabs(mean - want) <= 4.0 * standard_error))
		fail_msg("%s: mean %.6g +- %.2g, expected %.6g", label, mean, standard_error, want);
}

#endif
