/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/local.h"
#include <math.h>
#include <string.h>

/* Evaluations that a patient search waits for something better, and those of its first model, taken twice. */
#define PATIENCE(dims) (2 * (dims) + 2)
#define FIRST_EVALUATIONS(dims) (4 * (dims) + 2)
/* Share of a search's tolerance to which kd and ks are solved for: what they miss is noise to the search, which then ends
 * further off. */
#define INNER 0.03

/* An index of each channel asks for so many times the evaluations: up to eight parameters, not two to four. */
enum { PER_CHANNEL = 4 };

struct local {
	const struct space *space;
	struct objective *objective;
	const struct local_settings *settings;
	local_report *report;
	void *user;
	struct space_point best;
	double first; /* error of the point it began at */
	int evaluations;
	double least[PATIENCE(SPACE_DIMS)]; /* the least error as of each of the last evaluations, in turn */
	nlopt_opt opt;
};

/* Whether the last evaluations have brought nothing that matters. */
static bool is_done(struct local *l)
{
	const int dims = l->space->dims, evaluation = l->evaluations++;
	double *before = &l->least[evaluation % PATIENCE(dims)];
	const bool done =
		evaluation >= FIRST_EVALUATIONS(dims) && *before - l->best.error <= l->settings->tolerance * *before;

	*before = l->best.error;
	return done;
}

static double evaluate(unsigned dims, const double *x, double *gradient, void *data)
{
	struct local *l = data;
	const struct shape shape = space_shape(l->space, x);
	struct linear linear;

	(void)gradient;
	if (fit_cancelled(l->objective->options))
		nlopt_force_stop(l->opt);
	const double error = objective_eval(l->objective, &shape, INNER * l->settings->tolerance, false, &linear);

	if (l->report)
		l->report(l->user, &shape, &linear);
	if (isinf(l->best.error))
		l->first = error;
	if (error < l->best.error) {
		l->best.error = error;
		l->best.linear = linear;
		memcpy(l->best.x, x, dims * sizeof *x);
	}
	if (l->settings->patient && is_done(l))
		nlopt_force_stop(l->opt);
	return error;
}

double local_spacing(enum coordinate coordinate)
{
	static const double spacing[] = {
		[COORDINATE_SIGMA] = 0.35,       [COORDINATE_GAMMA] = 1.0,         [COORDINATE_IOR] = 0.1,
		[COORDINATE_K] = 0.15,           [COORDINATE_LENGTH] = 0.1,        [COORDINATE_PHASE] = 0.35,
		[COORDINATE_STRETCH_COS] = 0.35, [COORDINATE_STRETCH_SIN] = 0.35,  [COORDINATE_STRETCH] = 0.35,
		[COORDINATE_ANGLE] = 15,         [COORDINATE_TILT_X] = 0.35,       [COORDINATE_TILT_Y] = 0.35,
		[COORDINATE_GRAZING] = 0.4,      [COORDINATE_SECOND_SIGMA] = 0.35, [COORDINATE_SECOND_GAMMA] = 1.0};

	return spacing[coordinate];
}

enum status local_descend(const struct space *space, struct objective *o, const struct local_settings *settings,
			  local_report *report, void *user, struct space_point *point, bool *limited)
{
	const unsigned dims = (unsigned)space->dims;
	struct local local = {
		.space = space, .objective = o, .settings = settings, .report = report, .user = user, .best = *point};
	double x[SPACE_DIMS], first[SPACE_DIMS], error;

	objective_begin(o, &point->linear);
	local.best.error = INFINITY;
	memcpy(x, point->x, sizeof x);
	nlopt_opt opt = nlopt_create(settings->algorithm, dims);

	if (!opt)
		return STATUS_NO_MEMORY;
	for (unsigned d = 0; d < dims; d++) {
		first[d] = settings->step * local_spacing(space->coordinate[d]);
		if (x[d] + first[d] > space->hi[d])
			first[d] = -first[d];
	}
	local.opt = opt;
	nlopt_set_min_objective(opt, evaluate, &local);
	nlopt_set_lower_bounds(opt, space->lo);
	nlopt_set_upper_bounds(opt, space->hi);
	nlopt_set_ftol_rel(opt, settings->patient ? 0 : settings->tolerance);
	nlopt_set_xtol_rel(opt, 1e-5);
	nlopt_set_maxeval(opt, (space->per_channel ? PER_CHANNEL : 1) * settings->evaluations);
	if (settings->enough > 0)
		nlopt_set_stopval(opt, settings->enough);
	/* nlopt keeps the steps in memory that it asks for now; without them it would take others. */
	nlopt_result result = nlopt_set_initial_step(opt, first);
	if (result >= 0)
		result = nlopt_optimize(opt, x, &error);

	/* Stopped with the error still falling; 1e-5 is no matter for an E near 0. */
	if (limited)
		*limited = result == NLOPT_MAXEVAL_REACHED && local.best.error < (1 - 1e-4) * local.first - 1e-5;
	nlopt_destroy(opt);
	*point = local.best;
	return result == NLOPT_OUT_OF_MEMORY ? STATUS_NO_MEMORY : STATUS_OK;
}
