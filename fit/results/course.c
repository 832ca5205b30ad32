/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/course.h"
#include "fit/error/objective.h"
#include "fit/search/search.h"

#include <math.h>
#include <string.h>

struct course course_begin(void)
{
	return (struct course){.begin_s = search_clock()};
}

/* Shapes evaluated by all searches so far, of which this one has come to `point`. */
static long add_evaluations(struct course *course, const struct fit_trace *point)
{
	long sum = 0;
	int i = 0;
	while (course->ndf[i] && course->ndf[i] != point->ndf)
		i++;
	course->ndf[i] = point->ndf;
	course->evaluations[i] = point->evaluations;
	for (i = 0; i < FIT_NDFS_MAX; i++)
		sum += course->evaluations[i];
	return sum;
}

void course_note(void *data, const struct fit_trace *point)
{
	struct course *course = data;
	struct fit_trace own = *point;
	own.seconds = search_clock() - course->begin_s;
	own.evaluations = add_evaluations(course, point);
	trace_note(&course->trace, &own);
}

static bool is_thinned(const struct fit_trace *point)
{
	return strcmp(point->stage, "full") != 0 && strcmp(point->stage, "end") != 0;
}

enum status course_judge(struct course *course, const struct sample_set *full, const struct fit_options *options)
{
	struct objective objective;
	struct linear linear;
	enum status status = STATUS_OK;
	for (int i = 0; i < FIT_NDFS_MAX && course->ndf[i] && status == STATUS_OK; i++) {
		const struct ndf_class *ready = course->ndf[i];
		status = objective_init(&objective, full, options, ready, 1, MASKING_COARSE);
		for (size_t n = 0; n < course->trace.n && status == STATUS_OK; n++) {
			struct fit_trace *p = &course->trace.point[n];
			const struct shape shape = {.sigma = p->sigma, .gamma = p->gamma, .ior = p->ior, .k = p->k};
			if (fit_cancelled(options))
				status = STATUS_INTERRUPTED;
			else if (p->ndf == ready && is_thinned(p))
				p->error = objective_eval(&objective, &shape, 1e-6, false, &linear);
		}
		objective_free(&objective);
	}
	return status;
}

void course_keep_best(struct course *course, double time_s, const struct ndf_class *ndf)
{
	struct trace *trace = &course->trace;
	double best = INFINITY;
	size_t kept = 0;
	for (size_t i = 0; i < trace->n; i++) {
		struct fit_trace p = trace->point[i];
		const bool end = i + 1 == trace->n, better = p.seconds <= time_s && p.error < best;
		if (!better && !end)
			continue;
		if (better)
			best = p.error;
		p.error = isinf(best) ? NAN : best;
		p.seconds = fmin(p.seconds, time_s);
		p.ndf = ndf;
		trace->point[kept++] = p;
	}
	trace->n = kept;
}

double course_error_after(const struct course *course, double seconds)
{
	const struct trace *trace = &course->trace;
	double error = NAN;
	for (size_t i = 0; i < trace->n && trace->point[i].seconds <= seconds; i++)
		error = trace->point[i].error;
	return error;
}
