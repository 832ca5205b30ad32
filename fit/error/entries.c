/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/error/entries.h"

_Static_assert((int)MERL_THETA_H == (int)MERL_THETA_D, "one array serves both angles");

struct entries entries_make(enum bins bins, int n_phi_d)
{
	struct entries entries = {0};
	for (int i = 0; i < MERL_THETA_H; i++)
		entries.theta[i] = bins_trig(bins, i, i, 0);
	for (int k = 0; k < n_phi_d; k++)
		entries.phi[k] = bins_trig(bins, 0, 0, k);
	return entries;
}

void entries_dirs(const struct entries *entries, int i, int j, int k, struct vec3 *wi, struct vec3 *wo)
{
	struct halfdiff_trig trig = entries->theta[i];
	trig.sin_d = entries->theta[j].sin_d;
	trig.cos_d = entries->theta[j].cos_d;
	trig.sin_phi = entries->phi[k].sin_phi;
	trig.cos_phi = entries->phi[k].cos_phi;
	halfdiff_trig_dirs(trig, wi, wo);
}
