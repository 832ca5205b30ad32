/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The course of an algorithm: evaluations of several searches added up, the best points kept, the error by a time. */
#include "check.h"
#include "fit/results/course.h"

static void add_point(struct course *course, double seconds, double error)
{
	const struct fit_trace point = {.ndf = ndf_find("ggx"), .stage = "full", .seconds = seconds, .error = error};
	trace_note(&course->trace, &point);
}

static void evaluations_are_those_of_all_searches(void **state)
{
	(void)state;
	struct course course = course_begin();
	const struct ndf_class *ggx = ndf_find("ggx"), *beckmann = ndf_find("beckmann");
	course_note(&course, &(struct fit_trace){.ndf = ggx, .evaluations = 10, .seconds = -1});
	course_note(&course, &(struct fit_trace){.ndf = beckmann, .evaluations = 5, .seconds = -1});
	course_note(&course, &(struct fit_trace){.ndf = ggx, .evaluations = 30, .seconds = -1});
	assert_int_equal(course.trace.n, 3);
	assert_int_equal(course.trace.point[0].evaluations, 10);
	assert_int_equal(course.trace.point[1].evaluations, 15);
	assert_int_equal(course.trace.point[2].evaluations, 35);
	assert_true(course.trace.point[0].seconds >= 0);
	assert_true(course.trace.point[2].seconds >= course.trace.point[0].seconds);
	trace_free(&course.trace);
}

static void only_better_points_in_time_and_the_end_are_kept(void **state)
{
	(void)state;
	struct course course = {.begin_s = 0};
	const struct ndf_class *std = ndf_find("std");
	add_point(&course, 0.5, 4);
	add_point(&course, 1, 5);
	add_point(&course, 1.5, 2);
	add_point(&course, 3, 1);
	add_point(&course, 4, 3);
	course_keep_best(&course, 2, std);
	assert_int_equal(course.trace.n, 3);
	const struct fit_trace *point = course.trace.point;
	check_rel(point[0].error, 4, 0, "first");
	check_rel(point[1].error, 2, 0, "second");
	check_rel(point[2].error, 2, 0, "the best within the time");
	check_rel(point[2].seconds, 2, 0, "end");
	assert_ptr_equal(point[0].ndf, std);
	trace_free(&course.trace);
}

static void without_a_point_in_time_there_is_no_error(void **state)
{
	(void)state;
	struct course course = {.begin_s = 0};
	add_point(&course, 3, 1);
	course_keep_best(&course, 2, ndf_find("ggx"));
	assert_int_equal(course.trace.n, 1);
	assert_true(isnan(course.trace.point[0].error));
	trace_free(&course.trace);
}

static void error_after_is_that_of_the_last_point_by_then(void **state)
{
	(void)state;
	struct course course = {.begin_s = 0};
	add_point(&course, 0.5, 4);
	add_point(&course, 1.5, 2);
	assert_true(isnan(course_error_after(&course, 0.25)));
	check_rel(course_error_after(&course, 0.5), 4, 0, "at the point");
	check_rel(course_error_after(&course, 1), 4, 0, "between");
	check_rel(course_error_after(&course, 10), 2, 0, "behind the last");
	trace_free(&course.trace);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(evaluations_are_those_of_all_searches),
		cmocka_unit_test(only_better_points_in_time_and_the_end_are_kept),
		cmocka_unit_test(without_a_point_in_time_there_is_no_error),
		cmocka_unit_test(error_after_is_that_of_the_last_point_by_then),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
