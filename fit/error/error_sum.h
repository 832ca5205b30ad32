/* SPDX-License-Identifier: GPL-3.0-or-later */
/* error_sum - the error that a fit minimises: E = sum w |m - f| / sum w m over entries and channels, 1/sr each, for
 * measured values m, model values f and the weight w of an entry. The kernel adds the same terms in float, with slopes;
 * kernel_and_metrics_match_the_reference in tests/test_objective.c holds it against these. */
#ifndef ERROR_SUM_H
#define ERROR_SUM_H

#include <math.h>

/* error_term - what one value adds to the numerator. */
static inline double error_term(double w, double m, double f)
{
	return w * fabs(m - f);
}

/* error_ratio - E from both sums; NaN where nothing was measured and nothing differs. */
static inline double error_ratio(double difference, double measured)
{
	return difference / measured;
}

#endif
