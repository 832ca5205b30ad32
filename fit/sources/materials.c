/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/materials.h"
#include "data_readers/measurement_read.h"
#include "data_readers/resample.h"
#include "data_readers/text_quote.h"
#include "fit/cli/files.h"
#include "fit/cli/messages.h"
#include "fit/cli/output_directory.h"
#include "fit/results/contradiction.h"
#include "fit/results/store.h"
#include "fit/sources/batch.h"

#include <ctype.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Materials from rows */

static int text_order(char *const *a, char *const *b, enum result_column column)
{
	return strcmp(a[column], b[column]);
}

static int file_order(char *const *a, char *const *b)
{
	const int order = text_order(a, b, RESULT_MATERIAL);
	return order ? order : text_order(a, b, RESULT_PATH);
}

static int material_order(char *const *a, char *const *b)
{
	const int order = file_order(a, b);
	return order ? order : text_order(a, b, RESULT_OPTIONS);
}

bool material_is_same(const struct material *a, const struct material *b)
{
	return file_order(a->row[0], b->row[0]) == 0;
}

/* A row and its index, so that the NDFs of a material keep their order. */
struct indexed_row {
	char **row;
	size_t index;
};

static int indexed_row_order(const void *a, const void *b)
{
	const struct indexed_row *x = a, *y = b;
	const int order = material_order(x->row, y->row);
	return order ? order : (x->index > y->index) - (x->index < y->index);
}

static enum status sort_rows(struct csv_table *rows)
{
	struct indexed_row *indexed = calloc(rows->n_rows + 1, sizeof(*indexed));
	if (!indexed)
		return STATUS_NO_MEMORY;
	for (size_t i = 0; i < rows->n_rows; i++)
		indexed[i] = (struct indexed_row){rows->row[i], i};
	qsort(indexed, rows->n_rows, sizeof(*indexed), indexed_row_order);
	for (size_t i = 0; i < rows->n_rows; i++)
		rows->row[i] = indexed[i].row;
	free(indexed);
	return STATUS_OK;
}

/* A character of a name, or its replacement in a file name. */
static char plain(char c, bool first)
{
	const bool letter = (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
	const bool mark = !first && (c == '.' || c == '+' || c == '-');
	if (letter || mark)
		return c;
	return '_';
}

/* A file name that is in use, whatever the case of its letters. */
struct used_name {
	const char *name; /* NULL: a free place of the table */
	size_t number;    /* the last that was put behind it to tell another name from it */
};

/* A hash table of the file names in use: at least half of its places, a power of two, are free. */
struct used_names {
	struct used_name *place;
	size_t n_places;
};

static struct used_name *used_name_find(const struct used_names *used, const char *name)
{
	uint64_t hash = 0xcbf29ce484222325u;
	for (const char *c = name; *c; c++)
		hash = (hash ^ (uint64_t)tolower((unsigned char)*c)) * 0x100000001b3u;
	for (size_t at = (size_t)(hash ^ hash >> 32);; at++) {
		struct used_name *place = &used->place[at & (used->n_places - 1)];
		if (!place->name || !strcasecmp(place->name, name))
			return place;
	}
}

enum { NUMBER_ROOM = 24 };

static void name_file(struct material *m, const struct used_names *used)
{
	size_t length = 0;
	for (const char *c = m->name; *c && length < MATERIAL_FILE_NAME_SIZE - NUMBER_ROOM; c++, length++)
		m->file_name[length] = plain(*c, length == 0);
	if (length == 0)
		m->file_name[length++] = '_';
	struct used_name *same = used_name_find(used, m->file_name), *place = same;
	while (place->name) {
		snprintf(m->file_name + length, NUMBER_ROOM, "-%zu", ++same->number);
		place = used_name_find(used, m->file_name); /* the new name may be in use as well */
	}
	*place = (struct used_name){m->file_name, 1};
}

/* Names that become the same file name, or differ only in case, are distinguished by a number. */
static enum status name_files(struct materials *materials)
{
	struct used_names used = {.n_places = 16};
	while (used.n_places < 2 * materials->n)
		used.n_places *= 2;
	used.place = calloc(used.n_places, sizeof *used.place);
	if (!used.place)
		return STATUS_NO_MEMORY;
	for (size_t i = 0; i < materials->n; i++)
		name_file(&materials->material[i], &used);
	free(used.place);
	return STATUS_OK;
}

static enum status group_rows(struct materials *materials)
{
	const struct csv_table *rows = &materials->rows;
	materials->n = materials->n_distinct = 0;
	materials->material = calloc(rows->n_rows + 1, sizeof(*materials->material));
	if (!materials->material)
		return STATUS_NO_MEMORY;
	for (size_t i = 0; i < rows->n_rows; i++) {
		if (i == 0 || file_order(rows->row[i - 1], rows->row[i]))
			materials->n_distinct++;
		if (i == 0 || material_order(rows->row[i - 1], rows->row[i])) {
			struct material *m = &materials->material[materials->n++];
			m->name = rows->row[i][RESULT_MATERIAL];
			m->row = &rows->row[i];
		}
		materials->material[materials->n - 1].n_rows++;
	}
	return name_files(materials);
}

/* Where rows come from */

/* Whether none of these files is one that is written into DIR itself. Returns -1, or the exit code to end with; what is
 * wrong is then reported. */
static int check_directory(const struct options *options, char *const *path, size_t n)
{
	static const char *const written[] = {"fits.csv", "errors.csv", "index.html"};
	struct error error;
	enum status status = STATUS_OK;
	for (size_t i = 0; i < sizeof written / sizeof *written && status == STATUS_OK; i++)
		status = output_directory_spares(options->output, written[i], path, (int)n, &error);
	if (status == STATUS_DOMAIN)
		return options_usage(options->command, "%s", error.text);
	if (status == STATUS_OK)
		return -1;
	report_error("%s", error.text);
	return EXIT_FAILED;
}

static int read_rows(struct csv_table *rows, const struct options *options)
{
	static const char *const useful[] = {"output",   "quiet", "threads", "environment", "light",
					     "exposure", "size",  "samples", NULL};
	const char *ignored = options_given_beside(options, useful);
	struct error error;
	if (ignored)
		return options_usage(options->command, "--%s means nothing for a table that is there already", ignored);
	if (options->n_paths > 1)
		return options_usage(options->command, "expected one table and nothing beside it, found %d paths",
				     options->n_paths);
	if (csv_table_read(rows, options->path[0], RESULT_STATUS + 1, NULL, &error) == STATUS_OK &&
	    contradiction_check(rows, options->path[0], &error) == STATUS_OK) {
		int wrong = -1;
		for (size_t i = 0; i < rows->n_rows && wrong < 0; i++)
			wrong = check_directory(options, &rows->row[i][RESULT_PATH], 1);
		if (wrong >= 0)
			csv_table_free(rows); /* nothing is shown */
		if (wrong >= 0 || rows->n_rows)
			return wrong < 0 ? EXIT_DONE : wrong;
		char name[TEXT_QUOTE_SIZE];
		text_quote(options->path[0], name, sizeof name);
		error_set(&error, STATUS_NO_DATA, "'%s' has no rows to show", name);
	}
	report_error("%s", error.text);
	csv_table_free(rows);
	return EXIT_FAILED;
}

static int fit_rows(struct csv_table *rows, const struct options *options)
{
	struct files files;
	struct batch batch;
	const int bad = files_collect(&files, options->path, options->n_paths, options->recursive, options->cancel);
	if (bad < 0)
		return EXIT_FAILED;
	int wrong = check_directory(options, files.path, files.n);
	struct error error;
	if (wrong < 0 && output_directory_accepts(options->output, "fits.csv", &error) != STATUS_OK) {
		report_error("%s", error.text);
		wrong = EXIT_FAILED;
	}
	if (wrong >= 0) {
		files_free(&files);
		return wrong;
	}
	if (batch_init(&batch, options, &files) != STATUS_OK) {
		files_free(&files);
		return EXIT_FAILED;
	}
	int code = files.n ? batch_run(&batch) : EXIT_FAILED;
	for (size_t i = 0; i < batch.n; i++)
		if (csv_table_move(rows, &batch.file[i].rows) != STATUS_OK) {
			report_error("out of memory");
			code = EXIT_FAILED;
		}
	bool fitted = false;
	for (size_t i = 0; i < rows->n_rows; i++)
		fitted |= !result_failed(rows->row[i]);
	if (fitted && code != EXIT_INTERRUPTED)
		options_say_weight(options);
	batch_free(&batch);
	files_free(&files);
	return code == EXIT_DONE && bad ? EXIT_FAILED : code;
}

/* Keeps what has been fitted, in DIR/fits.csv. */
static enum status keep_rows(const struct csv_table *rows, const char *directory, struct error *error)
{
	char *path;
	if (asprintf(&path, "%s/fits.csv", directory) < 0)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	const enum status status = store_write(path, rows, csv_write, error);
	free(path);
	return status;
}

int materials_collect(struct materials *materials, const struct options *options)
{
	bool table = false;
	*materials = (struct materials){.rows = csv_table_make(result_columns, RESULT_COLUMNS)};
	for (int i = 0; i < options->n_paths; i++)
		table |= csv_is_name(options->path[i]);
	materials->reported = !table;
	int code = (table ? read_rows : fit_rows)(&materials->rows, options);
	if (sort_rows(&materials->rows) != STATUS_OK || group_rows(materials) != STATUS_OK) {
		report_error("out of memory");
		materials_free(materials);
		return EXIT_FAILED;
	}
	struct error error;
	if (!table && materials->n && keep_rows(&materials->rows, options->output, &error) != STATUS_OK) {
		report_error("%s", error.text);
		code = code == EXIT_DONE ? EXIT_FAILED : code;
	}
	return code;
}

void materials_free(struct materials *materials)
{
	csv_table_free(&materials->rows);
	free(materials->material);
	materials->material = NULL;
	materials->n = 0;
}

/* One material */

static enum status read_models(const struct material *material, int threads, struct material_data *data,
			       struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	text_quote(material->name, name, sizeof name);
	for (size_t i = 0; i < material->n_rows; i++) {
		char *const *row = material->row[i];
		struct fitted *fit = &data->fit[data->n];
		struct error why;
		if (result_failed(row))
			continue;
		if (data->n == FIT_NDFS_MAX)
			return error_set(error, STATUS_FORMAT,
					 "cannot show '%s': expected at most %d rows of one material", name,
					 FIT_NDFS_MAX);
		*fit = (struct fitted){.row = row,
				       .ndf = row[RESULT_NDF],
				       .error = result_number(row, RESULT_ERROR),
				       .options = fit_options_default()};
		fit->options.threads = threads;
		data->n++;
		const enum status status = result_model(row, &fit->model, &fit->options, &fit->pwl, &why);
		if (status != STATUS_OK)
			return error_set(error, status, "cannot show '%s': %.200s", name, why.text);
	}
	if (data->n == 0)
		return error_set(error, STATUS_NO_DATA, "cannot show '%s': it has no fit", name);
	return STATUS_OK;
}

static enum status read_samples(const struct material *material, int threads, struct measurement *measurement,
				struct error *error)
{
	char *const *row = material->row[0];
	const struct read_options reading = result_reading(row, threads);
	enum status status = measurement_read(row[RESULT_PATH], &reading, measurement, error);
	if (status != STATUS_OK)
		return status;
	status = result_check_input(row[RESULT_INPUT], measurement, row[RESULT_PATH], error);
	if (status != STATUS_OK)
		measurement_free(measurement);
	return status;
}

/* Makes the table; entries that turn are kept beside it. */
static enum status fill(struct material_data *data, int threads)
{
	const enum bins bins = data->fit[0].options.criterion.bins;
	if (!measurement_turns(&data->measurement))
		return measurement_fill(&data->measurement, bins, threads);
	data->turned = data->measurement;
	return measurement_resample(&data->turned, bins, 180, GAPS_FILLED, threads, &data->measurement, NULL);
}

enum status material_read(const struct material *material, int threads, struct material_data *data, struct error *error)
{
	*data = (struct material_data){.name = material->name};
	enum status status = read_models(material, threads, data, error);
	if (status == STATUS_OK)
		status = read_samples(material, threads, &data->measurement, error);
	if (status == STATUS_OK && fill(data, threads) != STATUS_OK)
		status = error_set(error, STATUS_NO_MEMORY, "out of memory");
	if (status != STATUS_OK)
		material_data_free(data);
	return status;
}

void material_data_free(struct material_data *data)
{
	for (int i = 0; i < data->n; i++)
		result_model_free(&data->fit[i].model, data->fit[i].pwl);
	measurement_free(&data->measurement);
	measurement_free(&data->turned);
	*data = (struct material_data){.n = 0};
}

int material_best(const struct material_data *data)
{
	int best = 0;
	for (int i = 1; i < data->n; i++)
		if (data->fit[i].error < data->fit[best].error || isnan(data->fit[best].error))
			best = i;
	return best;
}
