/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/shown_models.h"
#include "data_readers/text_quote.h"

#include <stdlib.h>
#include <string.h>

static bool is_of(const struct source_model *model, const char *path)
{
	return model->path && !strcmp(model->path, path);
}

enum status shown_models_choose(const struct model_source *source, const char *path, bool by_path,
				struct shown_models *shown, struct error *error)
{
	shown->n = 0;
	for (size_t i = 0; i < source->n; i++)
		by_path |= is_of(&source->model[i], path);
	for (size_t i = 0; i < source->n; i++) {
		const struct source_model *model = &source->model[i];
		if (by_path && !is_of(model, path))
			continue;
		if (shown->n == SHOWN_MAX)
			return error_set(error, STATUS_UNSUPPORTED, "'%.150s' has more than %d models", model->material,
					 SHOWN_MAX);
		if (shown->n && model->fit.criterion.bins != shown->model[0]->fit.criterion.bins)
			return error_set(error, STATUS_UNSUPPORTED,
					 "the models of '%.150s' were fitted with different bins", model->material);
		shown->model[shown->n++] = model;
	}
	return shown->n ? STATUS_OK : error_set(error, STATUS_NO_DATA, "there is no model to show");
}

/* As shown_columns_find(). What has no column gets one, as long as there is room, with `grow`. */
static void find(struct shown_columns *columns, const struct shown_models *shown, int column[SHOWN_MAX], bool grow)
{
	bool used[SHOWN_MAX] = {false};
	for (int i = 0; i < shown->n; i++) {
		const char *ndf = ndf_name(shown->model[i]->model.ndf.class);
		const enum weight weight = shown->model[i]->fit.criterion.weight;
		int c = 0;
		while (c < columns->n && (used[c] || columns->weight[c] != weight || strcmp(columns->ndf[c], ndf) != 0))
			c++;
		column[i] = c;
		if (c == columns->n && (!grow || c == SHOWN_MAX)) {
			column[i] = -1;
			continue;
		}
		if (c == columns->n) {
			columns->weight[c] = weight;
			columns->weights |= weight != columns->weight[0];
			columns->ndf[columns->n++] = ndf;
		}
		used[c] = true;
	}
}

void shown_columns_find(const struct shown_columns *columns, const struct shown_models *shown, int column[SHOWN_MAX])
{
	struct shown_columns same = *columns;
	find(&same, shown, column, false);
}

enum status shown_columns_plan(struct shown_columns *columns, const struct options *options, const struct files *files,
			       bool by_path, struct error *error)
{
	*columns = (struct shown_columns){.n = 0};
	if (model_source_kind(options) != SOURCE_ROWS) {
		for (int i = 0; i < options->fit.n_ndf; i++) {
			/* Given parameters have no weight: model_source_read(). */
			columns->weight[i] =
				model_source_kind(options) == SOURCE_FIT ? options->fit.criterion.weight : WEIGHT_NONE;
			columns->ndf[columns->n++] = ndf_name(options->fit.ndf[i]);
		}
		return STATUS_OK;
	}
	/* What is wrong with the table as a whole is told once. */
	const enum status whole = model_source_check_rows(options, error);
	if (whole != STATUS_OK)
		return whole;
	for (size_t i = 0; i < files->n; i++) {
		struct model_source source;
		struct shown_models shown;
		const enum status status = model_source_read(options, files->path[i], &source, error);
		if (status == STATUS_NO_MEMORY)
			return status;
		if (status != STATUS_OK)
			continue;
		if (shown_models_choose(&source, files->path[i], by_path, &shown, error) == STATUS_OK) {
			int column[SHOWN_MAX];
			find(columns, &shown, column, true);
		}
		model_source_free(&source);
	}
	return STATUS_OK;
}

enum status shown_files(const char *table, struct files *files, const atomic_bool *cancel, struct error *error)
{
	struct csv_table rows = csv_table_make(result_columns, RESULT_COLUMNS);
	enum status status = csv_table_read(&rows, table, RESULT_SAMPLES, NULL, error);
	char **path = status != STATUS_OK ? NULL : calloc(rows.n_rows + 1, sizeof *path);
	int n = 0;
	for (size_t i = 0; i < rows.n_rows && path; i++)
		if (*rows.row[i][RESULT_PATH] && !result_failed(rows.row[i]))
			path[n++] = rows.row[i][RESULT_PATH];
	if (status == STATUS_OK && (!path || files_collect(files, path, n, false, cancel) < 0))
		status = error_set(error, STATUS_NO_MEMORY, "out of memory");
	if (status == STATUS_OK && !files->n) {
		char name[TEXT_QUOTE_SIZE];
		text_quote(table, name, sizeof name);
		status = error_set(error, STATUS_NO_DATA, "'%s' has no row of a fit with the path of its file", name);
	}
	free(path);
	csv_table_free(&rows);
	return status;
}
