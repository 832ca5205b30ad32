/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/row_pictures.h"
#include "data_readers/measurement_read.h"
#include "data_readers/resample.h"
#include "data_readers/text_quote.h"

#include <math.h>
#include <stdlib.h>

enum { SIZE = 64, SAMPLES = 64 };

/* The models of the rows that have one. */
struct models {
	int n;
	enum bins bins;
	struct cook_torrance *model;
	struct pwl **pwl;
	struct pictures_model *shown;
	size_t *row;
};

static enum status cannot(char *const *row, enum status status, const char *why, struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	text_quote(row[RESULT_MATERIAL], name, sizeof name);
	return error_set(error, status, "cannot render '%s': %.200s", name, why);
}

static enum status models_read(struct models *m, char **const *rows, size_t n, const struct fit_options *options,
			       struct error *error)
{
	*m = (struct models){.bins = options->criterion.bins,
			     .model = calloc(n, sizeof *m->model),
			     .pwl = calloc(n, sizeof *m->pwl),
			     .shown = calloc(n, sizeof *m->shown),
			     .row = calloc(n, sizeof *m->row)};
	if (!m->model || !m->pwl || !m->shown || !m->row)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	for (size_t i = 0; i < n; i++) {
		struct fit_options fit = *options;
		const int at = m->n;
		if (result_failed(rows[i]))
			continue;
		struct error why;
		const enum status status = result_model(rows[i], &m->model[at], &fit, &m->pwl[at], &why);
		if (status != STATUS_OK)
			return cannot(rows[i], status, why.text, error);
		m->bins = fit.criterion.bins;
		m->shown[at] = (struct pictures_model){&m->model[at], result_number(rows[i], RESULT_ERROR)};
		m->row[m->n++] = i;
	}
	return STATUS_OK;
}

static void models_free(struct models *m)
{
	for (int i = 0; i < m->n; i++)
		result_model_free(&m->model[i], m->pwl[i]);
	free(m->model);
	free(m->pwl);
	free(m->shown);
	free(m->row);
}

/* Every row must have been made from the bytes of the file as it is now. */
static enum status read_samples(const struct models *m, char **const *rows, const struct fit_options *options,
				struct measurement *measurement, struct error *error)
{
	const char *path = rows[0][RESULT_PATH];
	if (!*path)
		return cannot(rows[0], STATUS_NO_DATA, "the table has no path of its file", error);
	const struct read_options reading = result_reading(rows[0], options->threads);
	enum status status = measurement_read(path, &reading, measurement, error);
	if (status != STATUS_OK)
		return status;
	for (int i = 0; i < m->n && status == STATUS_OK; i++)
		status = result_check_input(rows[m->row[i]][RESULT_INPUT], measurement, path, error);
	if (status != STATUS_OK)
		measurement_free(measurement);
	return status;
}

static enum status render(const struct models *m, char **const *rows, const struct fit_options *options,
			  const struct environment *light, struct pictures *pictures, struct error *error)
{
	const struct sphere_options sphere = {
		.size = SIZE, .samples = SAMPLES, .threads = options->threads, .cancel = options->cancel};
	struct measurement measurement;
	enum status status = read_samples(m, rows, options, &measurement, error);
	if (status != STATUS_OK)
		return status;
	status = measurement_fill_isotropic(&measurement, m->bins, options->threads);
	if (status == STATUS_OK)
		status = pictures_render(&measurement, m->bins, m->shown, m->n, SAMPLING_VISIBLE, light, &sphere,
					 pictures);
	measurement_free(&measurement);
	return status != STATUS_OK ? cannot(rows[0], status, status_str(status), error) : STATUS_OK;
}

enum status row_pictures_errors(char **const *rows, size_t n, const struct fit_options *options,
				const struct environment *light, struct picture_error *errors, struct error *error)
{
	struct models models;
	struct pictures pictures = {0};
	for (size_t i = 0; i < n; i++)
		errors[i] = (struct picture_error){NAN, NAN, NAN};
	enum status status = models_read(&models, rows, n, options, error);
	if (status == STATUS_OK && models.n)
		status = render(&models, rows, options, light, &pictures, error);
	for (int i = 0; i < pictures.n; i++)
		errors[models.row[i]] = pictures.error[i];
	pictures_free(&pictures);
	models_free(&models);
	return status;
}
