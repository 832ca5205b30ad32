/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fit of a table without noise, whose error falls along a narrow, curved way in sigma, gamma and n, gets to its end. */
#include "check.h"
#include "make_table.h"
#include "run_fit.h"

static void the_end_of_a_flat_valley_is_reached(void **state)
{
	const struct cook_torrance m = make_model("std", 0.19, 2.2, 1.006);
	const struct fit_options options = options_for("std");
	struct measurement measurement = make_sparse_table(&m, 180, BINS_NODE, 0, 12);
	struct fit_result r;

	(void)state;
	run_fit(&measurement, &options, &r);
	check_between(r.error, 0, 1e-5, "E");
	check_rel(r.model.ndf.sigma_x, 0.19, 1e-3, "sigma");
	check_rel(r.model.ndf.gamma, 2.2, 1e-3, "gamma");
	check_rel(r.model.n - 1, 0.006, 1e-3, "n - 1");
	measurement_free(&measurement);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_end_of_a_flat_valley_is_reached),
	};

	return cmocka_run_group_tests_name("valley", tests, NULL, NULL);
}
