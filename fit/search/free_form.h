/* SPDX-License-Identifier: GPL-3.0-or-later */
/* free_form - a piecewise-linear NDF fitted to the measurement itself: what any isotropic NDF could reach with this G and F.
 *
 * Nodes stand at the theta_h of a table; each scattered entry counts for the node next to it. One more value stands for the facets that are all but vertical, of which the table
 * shows nothing but their shadow: they add a tan(theta) to Lambda, a free factor. Heavy tails need it: most of the
 * Lambda of STD near gamma = 1.5 comes from slopes beyond any table. Convex steps take turns, from the optimum of a parametric NDF: (kd, ks); the node
 * values, each the weighted median of its row; the index of refraction; and the normalisation and G that follow from
 * the new D. A step stays only if E on the full table falls, so the end is a bound from above of the floor. */
#ifndef FREE_FORM_H
#define FREE_FORM_H

#include "fit/search/search.h"
#include "src/pwl.h"

enum { FREE_FORM_VALUES = MERL_THETA_H + 1, FREE_FORM_NODES = MERL_THETA_H + 4 };

/* free_form_pwl - the distribution with D[i] at the table's rows and D[MERL_THETA_H] within 1e-6 radians of the
 * horizon. Status as pwl_init(). */
MUST_CHECK enum status free_form_pwl(enum bins bins, const double D[FREE_FORM_VALUES], struct pwl *pwl);

/* free_form_run - from each of the n_starts models, of which the best is followed to its end.
 * Returns: *found (shape.ior, shape.k and linear are the model's) and *pwl, which the caller frees.
 * Errors:  STATUS_NO_MEMORY, STATUS_INTERRUPTED */
MUST_CHECK enum status free_form_run(const struct multiresolution *multiresolution, const struct fit_options *options,
				     const struct cook_torrance starts[], int n_starts, struct found *found,
				     struct pwl *pwl);

#endif
