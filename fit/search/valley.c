/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/search/valley.h"
#include <math.h>

struct walk {
	const struct space *space;
	struct objective *objective;
	local_report *report;
	void *user;
	int d; /* the dimension that moves */
};

/* The best of the other parameters with that of dimension d at `value`, sought from a point near by. */
static enum status refit(const struct walk *w, const struct space_point *from, double value, struct space_point *to)
{
	static const struct local_settings settings = {NLOPT_LN_SBPLX, 0.02, 1e-4, 100, false, 0};
	const struct shape near = space_shape(w->space, from->x);
	struct space others = *w->space;
	struct space_point point = *from;

	space_fix(&others, w->d, value);
	space_from_shape(&others, &near, point.x);
	const enum status status = local_descend(&others, w->objective, &settings, w->report, w->user, &point, NULL);
	const struct shape shape = space_shape(&others, point.x);

	*to = point;
	space_from_shape(w->space, &shape, to->x);
	return status;
}

/* Steps are in ln(value - least): longer ones after a gain, shorter ones back after none. */
static enum status follow(const struct walk *w, double least, struct space_point *point)
{
	const struct space *s = w->space;
	enum status status = STATUS_OK;
	int steps = 0;

	for (double step = 0.1; fabs(step) > 1e-5 && steps < 60 && status == STATUS_OK; steps++) {
		const double value = least + (space_value(s, w->d, point->x[w->d]) - least) * exp(step);
		struct space_point next;

		if (fit_cancelled(w->objective->options))
			break;
		status = refit(w, point, fmin(fmax(value, s->lowest[w->d]), s->highest[w->d]), &next);
		if (status == STATUS_OK && next.error < point->error) {
			*point = next;
			step *= 2;
		} else {
			step *= -0.4;
		}
	}
	return status;
}

enum status valley_follow(const struct space *space, struct objective *o, local_report *report, void *user,
			  struct space_point *point)
{
	const struct shape shape = space_shape(space, point->x);
	enum status status = STATUS_OK;

	point->error = objective_eval(o, &shape, 1e-5, false, &point->linear);
	report(user, &shape, &point->linear);
	for (int d = 0; d < space->dims && space->dims > 1 && status == STATUS_OK; d++) {
		const struct walk walk = {space, o, report, user, d};

		if (space->coordinate[d] == COORDINATE_GAMMA)
			status = follow(&walk, space->least_gamma, point);
		/* Of length, steps in ln(1 - length); n and k of three channels would take too long. */
		else if (space->coordinate[d] == COORDINATE_IOR ||
			 (space->coordinate[d] == COORDINATE_LENGTH && !space->per_channel))
			status = follow(&walk, 1, point);
		else if (space->per_channel)
			continue;
		else if (space->coordinate[d] == COORDINATE_PHASE)
			status = follow(&walk, 0, point);
	}
	return status;
}
