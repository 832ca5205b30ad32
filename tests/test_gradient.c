/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The gradient of the error by the shape against differences of solved errors. */
#include "check.h"
#include "fit/error/gradient.h"
#include "make_table.h"

enum { PARAMETERS = 3 };

static double *parameter(struct shape *shape, int i)
{
	return i == 0 ? &shape->sigma : i == 1 ? &shape->gamma : &shape->ior;
}

static void check_gradient(const struct measurement *measurement, const struct fit_options *o)
{
	const struct shape shape = {.sigma = 0.17, .gamma = 2.2, .ior = 1.8};
	struct geometry geometry;
	struct sample_set table;
	struct objective objective;
	struct gradient gradient;
	struct linear linear, side;
	struct shape near[PARAMETERS];
	double change[PARAMETERS], at_one[PARAMETERS];

	assert_int_equal(geometry_init(&geometry, 180, o), STATUS_OK);
	assert_int_equal(sample_set_init(&table, &geometry, measurement, 2), STATUS_OK);
	assert_int_equal(objective_init(&objective, &table, o, ndf_find("std"), 1, MASKING_FINE), STATUS_OK);
	assert_int_equal(gradient_init(&gradient, &objective, PARAMETERS, MASKING_FINE), STATUS_OK);
	for (int i = 0; i < PARAMETERS; i++) {
		near[i] = shape;
		*parameter(&near[i], i) *= 1 + 1e-4;
	}
	objective_eval(&objective, &shape, 1e-9, true, &linear);
	assert_int_equal(gradient_changes(&gradient, &linear, near, change), STATUS_OK);
	/* The same bits from two threads. */
	objective.threads++;
#pragma omp parallel num_threads(2)
#pragma omp single
	assert_int_equal(gradient_changes(&gradient, &linear, near, at_one), STATUS_OK);
	assert_memory_equal(change, at_one, sizeof change);
	objective.threads--;
	for (int i = 0; i < PARAMETERS; i++) {
		struct shape below = shape, above = shape;
		const double h = 0.01 * *parameter(&below, i);

		*parameter(&below, i) -= h;
		*parameter(&above, i) += h;
		const double difference = objective_eval(&objective, &above, 1e-9, true, &side) -
					  objective_eval(&objective, &below, 1e-9, true, &side);

		check_abs(change[i], difference / 200, 0.01 * fabs(difference / 200) + 1e-9, "change by a parameter");
	}
	gradient_free(&gradient);
	objective_free(&objective);
	sample_set_free(&table);
	geometry_free(&geometry);
}

static void gradient_is_that_of_solved_errors(void **state)
{
	(void)state;
	const struct cook_torrance truth = make_model("std", 0.2, 1.7, 1.5);
	struct measurement measurement = make_table(&truth, 180, BINS_NODE, 0.3);
	struct fit_options o = fit_options_default();

	check_gradient(&measurement, &o);
	o.gray = true;
	o.criterion.gaf = GAF_CORRELATED;
	o.criterion.weight = WEIGHT_COSINE;
	check_gradient(&measurement, &o);
	measurement_free(&measurement);
}

int main(void)
{
	const struct CMUnitTest tests[] = {cmocka_unit_test(gradient_is_that_of_solved_errors)};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
