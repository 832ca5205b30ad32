/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The piecewise-linear NDF fitted to a table: a floor for the parametric ones. */
#include "check.h"
#include "fit/search/fit.h"
#include "fit/search/free_form.h"
#include "make_table.h"
#include "run_fit.h"

/* A lobe of its own shape, neither STD nor GGX nor Beckmann: a narrow one on a wide one. */
static struct measurement made(enum bins bins)
{
	struct cook_torrance wide = make_model("beckmann", 0.4, INFINITY, 1.6),
			     narrow = make_model("ggx", 0.05, 2, 1.6);
	struct measurement a, b;

	narrow.kd[0] = narrow.kd[1] = narrow.kd[2] = 0;
	a = make_table(&wide, 180, bins, 0.05);
	b = make_table(&narrow, 180, bins, 0.05);
	for (int c = 0; c < 3; c++)
		for (size_t e = 0; e < measurement_count(&a); e++)
			a.value[c][e] += 0.2F * b.value[c][e];
	measurement_free(&b);
	return a;
}

static void check_floor(enum bins bins)
{
	struct fit_options o = fit_options_default();
	struct fit_result r[4];
	struct fit_metrics metrics;
	struct measurement measurement = made(bins);

	o.criterion.bins = bins;
	o.criterion.max_theta = 70;
	o.threads = 2;
	o.ndf[o.n_ndf++] = ndf_find("pl");
	run_fit(&measurement, &o, r);
	assert_non_null(r[3].pwl);
	assert_ptr_equal(r[3].model.ndf.pwl, r[3].pwl);
	for (int n = 0; n < 3; n++) {
		assert_null(r[n].pwl);
		/* Its nodes leave something to chance between them, but no more than a thousandth. */
		assert_true(r[3].error <= 1.001 * r[n].error);
	}
	/* Here it is really better: no parametric NDF has two widths. */
	assert_true(r[3].error < 0.9 * r[0].error);
	check_between(r[3].error - r[3].lower_bound, -1e-6, 1e-6, "certified gap");
	assert_int_equal(fit_eval(&measurement, &r[3].model, &o, &metrics, NULL), STATUS_OK);
	check_abs(metrics.error[WEIGHT_NONE], r[3].error, 0, "eval repeats the error");
	for (int n = 0; n < 4; n++)
		fit_result_free(&r[n]);
	assert_null(r[3].pwl);
	measurement_free(&measurement);
}

static void lies_below_the_parametric_ndfs(void **state)
{
	(void)state;
	check_floor(BINS_NODE);
}

static void centres_have_a_node_at_the_normal(void **state)
{
	double D[FREE_FORM_VALUES];
	struct pwl pwl;

	(void)state;
	for (int i = 0; i < FREE_FORM_VALUES; i++)
		D[i] = 1 + i % 3;
	assert_int_equal(free_form_pwl(BINS_CENTRE, D, &pwl), STATUS_OK);
	const double at_row = bins_angles(BINS_CENTRE, 1, 0, 0).theta_h;

	check_rel(pwl_D(&pwl, (struct vec3){sin(at_row), 0, cos(at_row)}) / pwl_D(&pwl, (struct vec3){0, 0, 1}), 2,
		  1e-12, "second row against the normal");
	pwl_free(&pwl);
	memset(D, 0, sizeof D);
	assert_int_equal(free_form_pwl(BINS_NODE, D, &pwl), STATUS_DOMAIN);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(lies_below_the_parametric_ndfs),
		cmocka_unit_test(centres_have_a_node_at_the_normal),
	};

	return cmocka_run_group_tests_name("free form", tests, NULL, NULL);
}
