/* SPDX-License-Identifier: GPL-3.0-or-later */
/* entries - the directions that the entries of a MERL table stand for. */
#ifndef ENTRIES_H
#define ENTRIES_H

#include "data_readers/measurement.h"

/* struct entries - sines and cosines by index: bins_trig() for each entry anew would cost more than a BRDF does. */
struct entries {
	struct halfdiff_trig theta[MERL_THETA_H]; /* theta_h and theta_d */
	struct halfdiff_trig phi[360];            /* phi_d */
};

struct entries entries_make(enum bins bins, int n_phi_d);
/* entries_dirs - light and view direction of entry (i, j, k). */
void entries_dirs(const struct entries *entries, int i, int j, int k, struct vec3 *wi, struct vec3 *wo);

#endif
