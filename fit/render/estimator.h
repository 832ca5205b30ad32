/* SPDX-License-Identifier: GPL-3.0-or-later */
/* estimator - how the light of a map is integrated. */
#ifndef ESTIMATOR_H
#define ESTIMATOR_H

enum estimator {
	ESTIMATE_BOTH,    /* light and surface sampled alike, weighted by the power heuristic [Veach and Guibas 1995] */
	ESTIMATE_LIGHT,   /* one of them alone: the same in the mean, */
	ESTIMATE_SURFACE, /* noisier */
};

/* estimator_weight - 1/p times the weight of a sample that was drawn with density p, and could have been with density q. */
static inline double estimator_weight(enum estimator estimator, double p, double q)
{
	if (estimator != ESTIMATE_BOTH)
		return 1 / p;
	const double ratio = q / p;
	return 1 / (p * (1 + ratio * ratio));
}

#endif
