/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The searches beside the default one: each ends with the best it saw, traces its way there, and stops when told to. */
#include "check.h"
#include "fit/results/trace.h"
#include "fit/search/algorithms.h"
#include "make_table.h"

#include <unistd.h>

/* Measurements that no model meets exactly, and the few of them that are looked at. */
static struct measurement material;
static struct geometry geometry;
static struct sample_set table;

static struct fit_options options_for(const struct algorithm *algorithm, struct trace *trace)
{
	struct fit_options o = fit_options_default();

	o.ndf[0] = ndf_find("std");
	o.n_ndf = 1;
	o.threads = 2;
	o.criterion.max_theta = 25;
	o.time_s = 0.01;
	o.algorithm = algorithm;
	o.trace = trace_note;
	o.trace_data = trace;
	return o;
}

static int set_up(void **state)
{
	const struct cook_torrance model = make_model("std", 0.12, 1.9, 1.6);
	const struct fit_options options = options_for(NULL, NULL);

	(void)state;
	/* Against a search that does not end. */
	alarm(300);
	material = make_table(&model, 180, BINS_NODE, 0.2);
	return geometry_init(&geometry, 180, &options) || sample_set_init(&table, &geometry, &material, 1);
}

static int tear_down(void **state)
{
	(void)state;
	sample_set_free(&table);
	geometry_free(&geometry);
	measurement_free(&material);
	return 0;
}

static enum status run(const struct fit_options *options, struct found *found)
{
	return algorithm_run(&table, options, options->ndf[0], found);
}

static void names_and_algorithms_are_inverse(void **state)
{
	const struct algorithm *found = algorithm_at(1);

	(void)state;
	assert_string_equal(algorithm_name(NULL), "default");
	for (int i = 0; i < ALGORITHM_COUNT; i++) {
		assert_int_equal(algorithm_find(algorithm_name(algorithm_at(i)), &found), STATUS_OK);
		assert_ptr_equal(found, algorithm_at(i));
	}
	assert_int_equal(algorithm_find("crs2-joint", &found), STATUS_OK);
	assert_int_equal(algorithm_find("crs", &found), STATUS_DOMAIN);
	assert_string_equal(algorithm_name(found), "crs2-joint");
}

/* Every point is better than the one before, and later. */
static void check_trace(const struct trace *trace, const char *label)
{
	assert_false(trace->incomplete);
	if (trace->n == 0)
		fail_msg("%s: no point in the trace", label);
	for (size_t i = 0; i < trace->n; i++) {
		const struct fit_trace *p = &trace->point[i];

		assert_string_equal(p->stage, "full");
		check_between(p->error, 0, i ? nextafter(p[-1].error, 0) : 1e3, label);
		check_between(p->seconds, i ? p[-1].seconds : 0, 1e9, label);
		check_between((double)p->evaluations, i ? (double)p[-1].evaluations + 1 : 1, 1e9, label);
		check_between(p->sigma, FIT_SIGMA_MIN, FIT_SIGMA_MAX, label);
	}
}

static void check_found(const struct found *f, const struct trace *trace, double largest_factor, const char *label)
{
	/* The last evaluation is one with a finer masking. */
	check_rel(f->linear.error, trace->point[trace->n - 1].error, 1e-4, label);
	check_between(f->linear.error, 0, trace->point[0].error * (1 + 1e-4), label);
	check_between(f->linear.lower_bound, 0, f->linear.error + 1e-7, label);
	check_between(f->shape.sigma, FIT_SIGMA_MIN, FIT_SIGMA_MAX, label);
	check_between(f->shape.ior, FIT_CONDUCTOR_IOR_MIN, FIT_IOR_MAX, label);
	for (int c = 0; c < 3; c++) {
		check_between(f->linear.kd[c], 0, largest_factor, label);
		check_between(f->linear.coefficient[c][1], 0, largest_factor, label);
	}
	check_between(f->starts_agreeing, 1, f->starts, label);
	check_between((double)f->evaluations, (double)trace->point[trace->n - 1].evaluations, 1e9, label);
}

static void each_ends_with_the_best_it_saw(void **state)
{
	(void)state;
	for (int i = 1; i < ALGORITHM_COUNT; i++) {
		const char *name = algorithm_name(algorithm_at(i));
		struct trace trace = {.n = 0};
		const struct fit_options o = options_for(algorithm_at(i), &trace);
		struct found found;

		assert_int_equal(run(&o, &found), STATUS_OK);
		check_trace(&trace, name);
		check_found(&found, &trace, 1, name);
		assert_true(found.limited);
		if (!strstr(name, "-joint"))
			check_between(found.linear.error - found.linear.lower_bound, -1e-8, 1.2e-7, name);
		trace_free(&trace);
	}
}

/* A whole fit by another algorithm: of the one NDF alone, and it says that a limit ended it. */
static void a_fit_takes_the_algorithm(void **state)
{
	struct trace trace = {.n = 0};
	const struct fit_options o = options_for(algorithm_at(3), &trace);
	struct fit_context *context;
	struct fit_result r;

	(void)state;
	assert_int_equal(fit_context_new(&context, 180, &o), STATUS_OK);
	assert_int_equal(fit_run(context, &material, &o, &r, NULL), STATUS_OK);
	fit_context_free(context);
	assert_int_equal(r.end, FIT_LIMIT);
	check_trace(&trace, "fit");
	for (size_t n = 0; n < trace.n; n++)
		assert_ptr_equal(trace.point[n].ndf, o.ndf[0]);
	check_rel(r.error, trace.point[trace.n - 1].error, 1e-4, "fit");
	trace_free(&trace);
}

/* The time decides where a search ends, nothing but the seed how it gets there. */
static void the_path_depends_on_the_seed_alone(void **state)
{
	(void)state;
	for (int i = 1; i < ALGORITHM_COUNT; i++) {
		const char *name = algorithm_name(algorithm_at(i));
		struct trace a = {.n = 0}, b = {.n = 0};
		struct fit_options o = options_for(algorithm_at(i), &a), again = options_for(algorithm_at(i), &b);
		struct found found;

		o.seed = again.seed = 7;
		again.threads = 1;
		assert_int_equal(run(&o, &found), STATUS_OK);
		assert_int_equal(run(&again, &found), STATUS_OK);
		for (size_t n = 0; n < a.n && n < b.n; n++) {
			check_abs(a.point[n].error, b.point[n].error, 0, name);
			assert_int_equal(a.point[n].evaluations, b.point[n].evaluations);
		}
		trace_free(&a);
		trace_free(&b);
	}
}

/* Fewer and more parameters: one to search, none, all of them without a bound; kd and ks in bounds of their own. */
static void each_takes_any_number_of_parameters(void **state)
{
	(void)state;
	for (int i = 1; i < ALGORITHM_COUNT; i++) {
		const char *name = algorithm_name(algorithm_at(i));
		for (int variant = 0; variant < 5; variant++) {
			struct trace trace = {.n = 0};
			struct fit_options o = options_for(algorithm_at(i), &trace);
			struct found found;

			o.time_s = 0.002;
			if (variant < 2) {
				o.gray = true;
				o.ior = 1.5;
				o.gamma = 2.2;
				o.diffuse = false;
			}
			if (variant == 1)
				o.sigma = 0.15;
			if (variant == 2) {
				o.unbounded = true;
				o.fresnel = FRESNEL_CONDUCTOR;
			}
			if (variant == 3)
				o.specular = false;
			if (variant == 4)
				o.blend = 0.125;
			assert_int_equal(run(&o, &found), STATUS_OK);
			check_trace(&trace, name);
			check_found(&found, &trace, o.unbounded ? 1e6 : 1, name);
			if (variant == 1)
				check_abs(found.shape.sigma, 0.15, 0, name);
			if (variant < 2) {
				check_abs(found.linear.kd[0] + found.linear.kd[1] + found.linear.kd[2], 0, 0, name);
				check_abs(found.linear.coefficient[2][1], found.linear.coefficient[0][1], 0, name);
			}
			if (variant == 3)
				check_abs(found.linear.coefficient[0][1] + found.linear.coefficient[1][1] +
						  found.linear.coefficient[2][1],
					  0, 0, name);
			for (int c = 0; c < 3 && variant == 4; c++) {
				check_between(found.linear.kd[c], 0, 0.875, name);
				check_between(found.linear.coefficient[c][1], 0, 0.125, name);
			}
			trace_free(&trace);
		}
	}
}

struct canceller {
	atomic_bool cancel;
	struct trace trace;
};

static void cancel_at_once(void *data, const struct fit_trace *point)
{
	struct canceller *c = data;

	trace_note(&c->trace, point);
	c->cancel = true;
}

/* With all the time of the world, each stops at the next shape after it is told to. */
static void each_stops_when_cancelled(void **state)
{
	(void)state;
	for (int i = 1; i < ALGORITHM_COUNT; i++) {
		struct canceller c = {.cancel = false};
		struct fit_options o = options_for(algorithm_at(i), NULL);
		struct found found;

		o.time_s = 1e6;
		o.trace = cancel_at_once;
		o.trace_data = &c;
		o.cancel = &c.cancel;
		assert_int_equal(run(&o, &found), STATUS_INTERRUPTED);
		assert_int_equal(c.trace.n, 1);
		trace_free(&c.trace);
	}
}

/* One pass at given kd and ks says what the inner solve said of them. */
static void the_error_of_a_point(void **state)
{
	const struct fit_options o = options_for(NULL, NULL);
	const struct shape shape = {.sigma = 0.2, .gamma = 1.8, .ior = 1.5},
			   nonsense = {.sigma = -1, .gamma = 1.8, .ior = 1.5};
	const struct linear none = {.error = 0};
	struct objective objective;
	struct linear linear;

	(void)state;
	assert_int_equal(objective_init(&objective, &table, &o, o.ndf[0], 1, MASKING_FINE), STATUS_OK);
	objective_eval(&objective, &shape, 1e-7, true, &linear);
	check_rel(objective_error(&objective, &shape, &linear), linear.error, 1e-7, "at the optimum");
	check_rel(objective_error(&objective, &shape, &none), 1, 1e-6, "black");
	check_abs(objective_error(&objective, &nonsense, &none), OBJECTIVE_NO_FIT, 0, "outside the domain");
	objective_free(&objective);
}

/* From lobes that are high to ones that are low and back: what is left of the solve before must not end the next one.
 * Where a lobe is so high that its ks is 1e-8, another one's ks is no place to begin either. */
static void a_jump_to_another_lobe_ends_at_its_minimum(void **state)
{
	static const struct shape shapes[] = {
		{.sigma = 2e-3, .gamma = 1.9, .ior = 90},       {.sigma = 0.3, .gamma = 2.5, .ior = 1.2},
		{.sigma = 0.087, .gamma = 9.5, .ior = 3.2},     {.sigma = 0.01, .gamma = 1.6, .ior = 30},
		{.sigma = 0.16, .gamma = 2.2, .ior = 3.1},      {.sigma = 1.5, .gamma = 1.55, .ior = 1.05},
		{.sigma = 4e-3, .gamma = 50, .ior = 60},        {.sigma = 0.52, .gamma = 1.6, .ior = 6.5},
		{.sigma = 0.12, .gamma = 1.9, .ior = 1.6},      {.sigma = 0.0849, .gamma = 41, .ior = 1.101},
		{.sigma = 1.74e-4, .gamma = 803, .ior = 100},   {.sigma = 0.0396, .gamma = 1.61, .ior = 1.002},
		{.sigma = 1.42e-4, .gamma = 141, .ior = 13},    {.sigma = 0.0258, .gamma = 154, .ior = 1.007},
		{.sigma = 1.15e-4, .gamma = 154, .ior = 43.7},  {.sigma = 0.526, .gamma = 17.6, .ior = 1.304},
		{.sigma = 1.05e-4, .gamma = 910, .ior = 71.24}, {.sigma = 0.0164, .gamma = 1.5001, .ior = 1.012},
		{.sigma = 1.19e-4, .gamma = 405, .ior = 12.67}, {.sigma = 0.42, .gamma = 1.5003, .ior = 1.002},
		{.sigma = 1.48e-4, .gamma = 5.87, .ior = 70.55}};
	const struct fit_options o = options_for(NULL, NULL);
	struct objective jumping, fresh;
	struct linear found, wanted;
	char label[32];

	(void)state;
	assert_int_equal(objective_init(&jumping, &table, &o, o.ndf[0], 1, MASKING_COARSE), STATUS_OK);
	assert_int_equal(objective_init(&fresh, &table, &o, o.ndf[0], 1, MASKING_COARSE), STATUS_OK);
	for (size_t n = 0; n < sizeof shapes / sizeof *shapes; n++) {
		objective_eval(&jumping, &shapes[n], 1e-6, false, &found);
		objective_forget(&fresh);
		objective_eval(&fresh, &shapes[n], 1e-7, true, &wanted);
		snprintf(label, sizeof label, "shape %zu", n);
		check_between(found.error - wanted.error, -1e-6, 1e-5, label);
	}
	objective_free(&jumping);
	objective_free(&fresh);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(names_and_algorithms_are_inverse),
		cmocka_unit_test(the_error_of_a_point),
		cmocka_unit_test(a_jump_to_another_lobe_ends_at_its_minimum),
		cmocka_unit_test(each_ends_with_the_best_it_saw),
		cmocka_unit_test(a_fit_takes_the_algorithm),
		cmocka_unit_test(the_path_depends_on_the_seed_alone),
		cmocka_unit_test(each_takes_any_number_of_parameters),
		cmocka_unit_test(each_stops_when_cancelled),
	};

	return cmocka_run_group_tests_name("algorithms", tests, set_up, tear_down);
}
