/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Two fits at once in one process are the fits one after the other, to the bit. */
#include "make_table.h"
#include "run_fit.h"

#include <pthread.h>

enum { JOBS = 2, NDFS = 3 };

struct job {
	struct measurement table;
	struct fit_options options;
	struct fit_result result[NDFS];
	struct fit_context *context; /* shared by the jobs */
	enum status status;
};

static void *run_job(void *data)
{
	struct job *job = data;
	job->status = fit_run(job->context, &job->table, &job->options, job->result, NULL);
	return NULL;
}

static void check_same(const struct fit_result *got, const struct fit_result *want)
{
	const struct cook_torrance *g = &got->model, *w = &want->model;
	assert_memory_equal(&got->error, &want->error, sizeof got->error);
	assert_memory_equal(g->kd, w->kd, sizeof g->kd);
	assert_memory_equal(g->ks, w->ks, sizeof g->ks);
	assert_memory_equal(&g->n, &w->n, sizeof g->n);
	assert_memory_equal(&g->ndf.sigma_x, &w->ndf.sigma_x, sizeof g->ndf.sigma_x);
	assert_memory_equal(&g->ndf.gamma, &w->ndf.gamma, sizeof g->ndf.gamma);
	assert_int_equal(got->evaluations, want->evaluations);
}

/* With random starts, so that the random numbers of one must not depend on the other. */
static void two_fits_at_once_give_what_each_gives_alone(void **state)
{
	(void)state;
	const struct cook_torrance model[JOBS] = {make_model("std", 0.3, 2.2, 1.5), make_model("ggx", 0.15, 2, 1.9)};
	struct fit_context *context;
	struct job job[JOBS];
	struct fit_result alone[JOBS][NDFS];
	pthread_t thread[JOBS];

	for (int j = 0; j < JOBS; j++) {
		job[j] = (struct job){.table = make_table(&model[j], 180, BINS_NODE, 0.1),
				      .options = fit_options_default()};
		job[j].options.threads = 1 + j;
		job[j].options.criterion.max_theta = 15;
		job[j].options.starts = 1;
		assert_int_equal(job[j].options.n_ndf, NDFS);
	}
	assert_int_equal(fit_context_new(&context, 180, &job[0].options), STATUS_OK);
	for (int j = 0; j < JOBS; j++) {
		job[j].context = context;
		run_job(&job[j]);
		assert_int_equal(job[j].status, STATUS_OK);
		memcpy(alone[j], job[j].result, sizeof alone[j]);
	}
	for (int j = 0; j < JOBS; j++)
		assert_int_equal(pthread_create(&thread[j], NULL, run_job, &job[j]), 0);
	for (int j = 0; j < JOBS; j++)
		assert_int_equal(pthread_join(thread[j], NULL), 0);
	for (int j = 0; j < JOBS; j++) {
		assert_int_equal(job[j].status, STATUS_OK);
		for (int n = 0; n < NDFS; n++)
			check_same(&job[j].result[n], &alone[j][n]);
	}
	for (int j = 0; j < JOBS; j++)
		measurement_free(&job[j].table);
	fit_context_free(context);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(two_fits_at_once_give_what_each_gives_alone),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
