/* SPDX-License-Identifier: GPL-3.0-or-later */
/* newton - one local search of a space by the error's gradient: a quadratic model whose second derivatives are those of a level
 * before, or else differences of gradients, and are corrected by every gradient since, is minimised within a box that grows and
 * shrinks with its success (a trust region; the corrections are symmetric and of rank one). Where the error is smooth, it takes a
 * fifth of the evaluations that a search without derivatives does. */
#ifndef NEWTON_H
#define NEWTON_H

#include "fit/search/local.h"

/* newton_descend - as local_descend(), of whose settings it takes step, tolerance and evaluations. *point has its curvature after
 * that. *converged: whether the quadratic model promises less than the tolerance at the end. */
MUST_CHECK enum status newton_descend(const struct space *space, struct objective *objective,
				      const struct local_settings *settings, local_report *report, void *user,
				      struct space_point *point, bool *converged);

#endif
