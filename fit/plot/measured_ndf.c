/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/plot/measured_ndf.h"
#include "fit/error/entries.h"
#include "fit/error/masking.h"
#include "fit/error/weighted_median.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bounds of what counts, see measured_ndf.h. */
enum { THETA_D_MAX = 30, TAIL_NODES = 40 };
static const double steepest = 80 * M_PI / 180;

struct reading {
	const struct measurement *measurement;
	const struct cook_torrance *model;
	struct cook_torrance without; /* the same without the lobe whose D is read */
	struct entries entries;
	struct masking masking;
	struct weighted_value *value; /* room for one theta_h */
	double min_cos;
};

/* What a unit of D and of ks adds to the model. */
static double lobe_per_D(const struct reading *r, struct vec3 wi, struct vec3 wo, double F)
{
	const struct cook_torrance *model = r->model;
	const double cosines = wi.z * wo.z;

	if (model->gaf == GAF_V_GROOVE)
		return cook_torrance_from_G(F, gaf_G(GAF_V_GROOVE, &model->ndf, wi, wo), cosines);
	return cook_torrance_from_G1(model->gaf, F, masking_at(&r->masking, masking_q(wi)),
				     masking_at(&r->masking, masking_q(wo)), cosines);
}

/* What the model has beside the lobe. */
static void other_terms(const struct reading *r, struct vec3 wi, struct vec3 wo, double rest[MERL_CHANNELS])
{
	if (cook_torrance_has_second(&r->without) || cook_torrance_has_grazing(&r->without)) {
		cook_torrance_f(&r->without, wi, wo, rest);
		return;
	}
	for (int c = 0; c < MERL_CHANNELS; c++)
		rest[c] = r->without.kd[c] / M_PI;
}

/* The values of D that entry (i, j, k) gives, one per channel; returns how many. */
static size_t entry_values(const struct reading *r, int i, int j, int k, const double F[MERL_CHANNELS],
			   struct weighted_value *asked)
{
	const struct measurement *measurement = r->measurement;
	const size_t at = measurement_at(measurement->n_phi_d, i, j, k);
	double rest[MERL_CHANNELS];
	struct vec3 wi, wo;
	size_t n = 0;

	entries_dirs(&r->entries, i, j, k, &wi, &wo);
	if (wi.z < r->min_cos || wo.z < r->min_cos || isnan(measurement->value[0][at]))
		return 0;
	other_terms(r, wi, wo, rest);
	double lobe = 0;
	for (int c = 0; c < MERL_CHANNELS; c++) {
		if (c == 0 || F[c] != F[0])
			lobe = lobe_per_D(r, wi, wo, F[c]);
		const double per_D = r->model->ks[c] * lobe;
		const double wanted = (double)measurement->value[c][at] - rest[c];

		if (per_D > 0)
			asked[n++] = (struct weighted_value){(float)(wanted / per_D), (float)per_D};
	}
	return n;
}

static double read_row(const struct reading *r, int i)
{
	size_t n = 0;

	for (int j = 0; j <= THETA_D_MAX; j++) {
		double F[MERL_CHANNELS];

		for (int c = 0; c < MERL_CHANNELS; c++)
			F[c] = cook_torrance_F(r->model, c, r->entries.theta[j].cos_d);
		for (int k = 0; k < r->measurement->n_phi_d; k++)
			n += entry_values(r, i, j, k, F, r->value + n);
	}
	return weighted_median(r->value, n, NAN);
}

static enum status read_rows(const struct measurement *measurement, const struct cook_torrance *model, enum bins bins,
			     double D[])
{
	struct reading r = {.measurement = measurement,
			    .model = model,
			    .without = *model,
			    .entries = entries_make(bins, measurement->n_phi_d),
			    .min_cos = cos(steepest)};
	const size_t n_max = (size_t)(THETA_D_MAX + 1) * (size_t)measurement->n_phi_d * MERL_CHANNELS;
	const int32_t q_min = masking_q((struct vec3){sin(steepest), 0, cos(steepest)}) - 1;

	memset(r.without.ks, 0, sizeof r.without.ks);
	r.value = malloc(n_max * sizeof *r.value);
	const enum status status = r.value ? masking_init(&r.masking, q_min, MASKING_FINE) : STATUS_NO_MEMORY;
	if (status == STATUS_OK && model->gaf != GAF_V_GROOVE)
		masking_fill(&r.masking, &model->ndf);
	for (int i = 0; i < MERL_THETA_H && status == STATUS_OK; i++)
		D[i] = read_row(&r, i);
	if (status == STATUS_OK)
		masking_free(&r.masking);
	free(r.value);
	return status;
}

/* D of the fit, at its last finite value where there is none at the horizon. */
static double fitted_D(const struct cook_torrance *model, double theta)
{
	return ndf_D(&model->ndf, (struct vec3){sin(theta), 0, cos(theta)});
}

/* Nodes: the rows that are known, then the tail, ever closer to the horizon. */
static int make_nodes(const double D[], const struct cook_torrance *model, enum bins bins, double theta[],
		      double value[])
{
	int n = 0;
	double known = NAN;

	for (int i = 0; i < MERL_THETA_H; i++) {
		const double at = bins_angles(bins, i, 0, 0).theta_h;

		if (isnan(D[i]))
			continue;
		if (n == 0 && at > 0) {
			theta[n] = 0;
			value[n++] = D[i];
		}
		theta[n] = at;
		value[n++] = D[i];
		known = at;
	}
	if (n == 0)
		return 0;
	/* A free form has no law that could be scaled: its tail means as much as it says. */
	const double fitted = fitted_D(model, known);
	const double ratio = model->ndf.pwl ? 1 : fitted > 0 ? value[n - 1] / fitted : 0;
	const double rest = M_PI / 2 - known;
	for (int t = 1; t <= TAIL_NODES; t++) {
		const double left = rest * pow(1e-6 / rest, (double)t / TAIL_NODES);

		theta[n] = M_PI / 2 - left;
		value[n] = ratio * fitted_D(model, theta[n]);
		n++;
	}
	theta[n] = M_PI / 2;
	value[n] = value[n - 1];
	return n + 1;
}

enum status measured_ndf_make(const struct measurement *measurement, const struct cook_torrance *model, enum bins bins,
			      struct measured_ndf *ndf)
{
	double theta[MERL_THETA_H + TAIL_NODES + 2], value[MERL_THETA_H + TAIL_NODES + 2];

	*ndf = (struct measured_ndf){.scale = NAN};
	enum status status = read_rows(measurement, model, bins, ndf->D);
	if (status != STATUS_OK)
		return status;
	const int n = make_nodes(ndf->D, model, bins, theta, value);
	if (n == 0)
		return STATUS_NO_DATA;
	status = pwl_init(&ndf->pwl, n, theta, value, NULL);
	if (status == STATUS_DOMAIN)
		return STATUS_NO_DATA; /* zeros only */
	for (int a = 0; a < n && status == STATUS_OK && isnan(ndf->scale); a++)
		if (value[a] > 0)
			ndf->scale = ndf->pwl.nodes[a].Fx / value[a];
	return status;
}

void measured_ndf_free(struct measured_ndf *ndf)
{
	pwl_free(&ndf->pwl);
}
