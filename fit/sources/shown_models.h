/* SPDX-License-Identifier: GPL-3.0-or-later */
/* shown_models - which models of a material are shown beside its measurement, and in which column of a sheet. */
#ifndef SHOWN_MODELS_H
#define SHOWN_MODELS_H

#include "fit/cli/files.h"
#include "fit/sources/model_source.h"

enum { SHOWN_MAX = FIT_NDFS_MAX }; /* models of one material; columns of models */

/* struct shown_models - borrowed from a source. */
struct shown_models {
	int n;
	const struct source_model *model[SHOWN_MAX];
};

/* shown_models_choose - the models of the file `path`. Files in several directories can have one name: where the source
 * has models of this path, or with by_path, only they are meant; else all. Errors: STATUS_UNSUPPORTED: more than
 * SHOWN_MAX, or of different bins; STATUS_NO_DATA: there is none. */
MUST_CHECK enum status shown_models_choose(const struct model_source *source, const char *path, bool by_path,
					   struct shown_models *shown, struct error *error);

/* struct shown_columns - the NDF and the weight of each column of models. They have as many columns as a material has
 * models of them. */
struct shown_columns {
	int n;
	bool weights; /* of several weights */
	const char *ndf[SHOWN_MAX];
	enum weight weight[SHOWN_MAX];
};

/* shown_columns_find - the column of each model: the first of its NDF and weight that no model before it has; -1: there
 * is none. */
void shown_columns_find(const struct shown_columns *columns, const struct shown_models *shown, int column[SHOWN_MAX]);

/* shown_columns_plan - the columns for all models of the files: those of the options' NDFs, or what the rows of --from
 * need. Rows are read beforehand for that. What is wrong with one of them is left to be reported later, unless memory
 * ran out, which may pass: STATUS_NO_MEMORY. Errors of the table as a whole: see model_source_check_rows(). by_path:
 * see shown_models_choose(). */
MUST_CHECK enum status shown_columns_plan(struct shown_columns *columns, const struct options *options,
					  const struct files *files, bool by_path, struct error *error);

/* shown_files - the files that the rows of a result table are of; failed fits have none. Free with files_free() in any
 * case, *files being zeroed before. Errors: those of csv_table_read(), STATUS_NO_DATA: no such row. */
MUST_CHECK enum status shown_files(const char *table, struct files *files, const atomic_bool *cancel,
				   struct error *error);

#endif
