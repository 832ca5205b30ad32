/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/entry_list.h"
#include "data_readers/measurement_read.h"
#include "data_readers/merl.h"
#include "fit/api/api.h"
#include "fit/error/model_table.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>

/* A measurement to be filled in by the caller. */
static enum stdfit_status allocate(stdfit_measurement **measurement, struct stdfit_error *error)
{
	if (!measurement)
		return api_fail(error, STATUS_DOMAIN, "measurement is NULL");
	*measurement = calloc(1, sizeof **measurement);
	return *measurement ? STDFIT_OK : api_fail(error, STATUS_NO_MEMORY, "%s", status_str(STATUS_NO_MEMORY));
}

static enum stdfit_status give_up(stdfit_measurement **measurement, enum stdfit_status status)
{
	if (status != STDFIT_OK) {
		free(*measurement);
		*measurement = NULL;
	}
	return status;
}

static enum stdfit_status check_n_phi_d(int n_phi_d, struct stdfit_error *error)
{
	return n_phi_d == 180 || n_phi_d == 360
		       ? STDFIT_OK
		       : api_fail(error, STATUS_DOMAIN, "expected n_phi_d 180 or 360, found %d", n_phi_d);
}

enum stdfit_status stdfit_measurement_read(stdfit_measurement **measurement, const char *path,
					   struct stdfit_error *error)
{
	struct error why = {""};
	enum stdfit_status status = allocate(measurement, error);

	if (status != STDFIT_OK)
		return status;
	if (!path)
		status = api_fail(error, STATUS_DOMAIN, "path is NULL");
	else
		status = api_end(error, measurement_read(path, NULL, &(*measurement)->grid, &why), &why);
	return give_up(measurement, status);
}

enum stdfit_status stdfit_measurement_write(const stdfit_measurement *measurement, const char *path,
					    struct stdfit_error *error)
{
	struct error why = {""};

	if (!measurement || !path)
		return api_fail(error, STATUS_DOMAIN, "measurement or path is NULL");
	return api_end(error, merl_write(path, &measurement->grid, &why), &why);
}

/* One entry of three channels; what a float cannot hold counts as not finite, as in files. */
static void set_entry(struct measurement *grid, size_t at, const double *value, size_t plane)
{
	bool finite = true, negative = false;

	for (int c = 0; c < MERL_CHANNELS; c++) {
		finite = finite && fabs(value[(size_t)c * plane + at]) <= FLT_MAX;
		negative = negative || value[(size_t)c * plane + at] < 0;
	}
	grid->n_nonfinite += !finite;
	grid->n_negative += finite && negative;
	for (int c = 0; c < MERL_CHANNELS; c++)
		grid->value[c][at] = finite && !negative ? (float)value[(size_t)c * plane + at] : NAN;
}

enum stdfit_status stdfit_measurement_from_values(stdfit_measurement **measurement, int n_phi_d, const double *values,
						  struct stdfit_error *error)
{
	enum stdfit_status status = allocate(measurement, error);

	if (status != STDFIT_OK)
		return status;
	struct measurement *grid = &(*measurement)->grid;

	status = check_n_phi_d(n_phi_d, error);
	if (status == STDFIT_OK && !values)
		status = api_fail(error, STATUS_DOMAIN, "values is NULL");
	if (status == STDFIT_OK)
		status = api_end(error, measurement_reserve(grid, n_phi_d), NULL);
	const size_t plane = status == STDFIT_OK ? measurement_count(grid) : 0;

	for (size_t at = 0; at < plane; at++)
		set_entry(grid, at, values, plane);
	return give_up(measurement, status);
}

static enum status add_samples(struct entry_list *list, size_t n, const double *wi, const double *wo,
			       const double *values, const double *solid_angles)
{
	enum status status = STATUS_OK;

	for (size_t i = 0; i < n && status == STATUS_OK; i++) {
		const double *v = values + 3 * i;
		const struct entry entry = {.wi = vec3_unit(api_vec(wi + 3 * i)),
					    .wo = vec3_unit(api_vec(wo + 3 * i)),
					    .value = {v[0], v[1], v[2]},
					    .solid_angle = solid_angles ? solid_angles[i] : 0};

		status = entry_list_add(list, &entry, false);
	}
	return status;
}

enum stdfit_status stdfit_measurement_from_samples(stdfit_measurement **measurement, size_t n, const double *wi,
						   const double *wo, const double *values, const double *solid_angles,
						   struct stdfit_error *error)
{
	struct entry_list list = {.from_grid = solid_angles, .n_channels = MERL_CHANNELS};
	struct error why = {""};
	enum stdfit_status status = allocate(measurement, error);

	if (status != STDFIT_OK)
		return status;
	if (n < 1)
		status = api_fail(error, STATUS_DOMAIN, "expected n of at least 1");
	if (status == STDFIT_OK)
		status = api_directions("wi", n, wi, error);
	if (status == STDFIT_OK)
		status = api_directions("wo", n, wo, error);
	if (status == STDFIT_OK && !values)
		status = api_fail(error, STATUS_DOMAIN, "values is NULL");
	for (size_t i = 0; i < n && status == STDFIT_OK && solid_angles; i++)
		if (!(solid_angles[i] >= 0 && solid_angles[i] <= FLT_MAX))
			status = api_fail(error, STATUS_DOMAIN, "solid angle number %zu is %g: expected 0 or more", i,
					  solid_angles[i]);
	if (status == STDFIT_OK) {
		enum status end = add_samples(&list, n, wi, wo, values, solid_angles);

		if (end == STATUS_OK)
			end = entry_list_finish(&list, &(*measurement)->grid, &why);
		status = api_end(error, end, &why);
	}
	entry_list_free(&list);
	return give_up(measurement, status);
}

enum stdfit_status stdfit_measurement_from_model(stdfit_measurement **measurement, const struct stdfit_model *model,
						 const stdfit_ndf *ndf, const char *bins, int n_phi_d,
						 struct stdfit_error *error)
{
	struct cook_torrance inner;
	enum bins where;
	enum stdfit_status status = allocate(measurement, error);

	if (status != STDFIT_OK)
		return status;
	status = api_model(model, ndf, &inner, error);
	if (status == STDFIT_OK)
		status = api_isotropic(&inner.ndf, error);
	if (status == STDFIT_OK)
		status = api_bins(bins, &where, error);
	if (status == STDFIT_OK)
		status = check_n_phi_d(n_phi_d, error);
	if (status == STDFIT_OK)
		status = api_end(error, model_table(&inner, where, n_phi_d, 90, 1, &(*measurement)->grid), NULL);
	return give_up(measurement, status);
}

enum stdfit_status stdfit_measurement_values(const stdfit_measurement *measurement, double *values,
					     struct stdfit_error *error)
{
	if (!measurement || !values)
		return api_fail(error, STATUS_DOMAIN, "measurement or values is NULL");
	struct error why = {""};

	if (measurement_require_table(&measurement->grid, "this call", &why) != STATUS_OK)
		return api_end(error, STATUS_UNSUPPORTED, &why);
	const size_t plane = measurement_count(&measurement->grid);

	for (int c = 0; c < MERL_CHANNELS; c++)
		for (size_t at = 0; at < plane; at++)
			values[(size_t)c * plane + at] = (double)measurement->grid.value[c][at];
	return STDFIT_OK;
}

int stdfit_measurement_n_phi_d(const stdfit_measurement *measurement)
{
	return measurement ? measurement->grid.n_phi_d : 0;
}

void stdfit_measurement_free(stdfit_measurement *measurement)
{
	if (measurement)
		measurement_free(&measurement->grid);
	free(measurement);
}
