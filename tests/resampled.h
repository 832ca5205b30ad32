/* SPDX-License-Identifier: GPL-3.0-or-later */
/* resampled - tables of samples, for the tests of resampling and of convert. */
#ifndef RESAMPLED_H
#define RESAMPLED_H

#include "check.h"
#include "data_readers/resample.h"
#include "make_samples.h"

/* A material that changes slowly, and the program's options for it. */
#define MODEL "--ndf ggx --sigma 0.4 --ior 1.5 --kd 0.31,0.12,0.047 --ks 0.42,0.63,0.77"

static inline struct cook_torrance smooth_model(void)
{
	return make_model("ggx", 0.4, 2, 1.5);
}

static inline struct measurement resampled(const struct measurement *from, int n_phi_d, enum gaps gaps, int threads,
					   struct resampled *result)
{
	struct measurement table;
	assert_int_equal(measurement_resample(from, BINS_NODE, n_phi_d, gaps, threads, &table, result), STATUS_OK);
	assert_null(table.scattered);
	assert_int_equal(table.n_phi_d, n_phi_d);
	return table;
}

static inline void check_same(const struct measurement *a, const struct measurement *b)
{
	assert_int_equal(measurement_count(a), measurement_count(b));
	for (int c = 0; c < MERL_CHANNELS; c++)
		assert_memory_equal(a->value[c], b->value[c], measurement_count(a) * sizeof(float));
}

#endif
