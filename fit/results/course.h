/* SPDX-License-Identifier: GPL-3.0-or-later */
/* course - error against time of one algorithm: the searches of several NDFs taken as one, in one trace. */
#ifndef COURSE_H
#define COURSE_H

#include "fit/error/sample_set.h"
#include "fit/results/trace.h"

struct course {
	struct trace trace;
	double begin_s;                            /* of search_clock() */
	const struct ndf_class *ndf[FIT_NDFS_MAX]; /* of the searches so far, */
	long evaluations[FIT_NDFS_MAX];            /* and how far each has come */
};

/* course_begin - an empty course that begins now. Release with trace_free(&course.trace). */
struct course course_begin(void);

/* course_note - what fit_options.trace calls, `data` being a struct course: appends the point with the seconds since
 * the beginning and the evaluations of all searches so far. */
void course_note(void *data, const struct fit_trace *point);

/* course_judge - gives the points that were found on thinned tables the error that their shapes have on the full one.
 * Stages "full" and "end" have it already. STATUS_NO_MEMORY, STATUS_INTERRUPTED. */
MUST_CHECK enum status course_judge(struct course *course, const struct sample_set *full,
				    const struct fit_options *options);

/* course_keep_best - keeps the points within time_s seconds that are better than all before them, and the last, which
 * gets the best error (NaN: there is none) and time_s at most. All are then of `ndf`, the one that was asked for: GGX
 * and Beckmann are members of STD. */
void course_keep_best(struct course *course, double time_s, const struct ndf_class *ndf);

/* course_error_after - the error of the last point within so many seconds; NaN: there is none yet. */
double course_error_after(const struct course *course, double seconds);

#endif
