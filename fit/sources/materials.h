/* SPDX-License-Identifier: GPL-3.0-or-later */
/* materials - the rows of a result table by material, and what their pictures need: the measured table and the models.
 */
#ifndef MATERIALS_H
#define MATERIALS_H

#include "fit/cli/options.h"
#include "fit/results/result.h"

enum { MATERIAL_FILE_NAME_SIZE = 80 };

/* struct material - the rows of one material, path and options; they belong to the table. */
struct material {
	const char *name;
	char file_name[MATERIAL_FILE_NAME_SIZE]; /* the name, fit for files and links: letters, digits, . _ + - */
	char **const *row;
	size_t n_rows;
};

/* material_is_same - whether both are of one name and file: fits under other options. */
bool material_is_same(const struct material *a, const struct material *b);

struct materials {
	struct csv_table rows; /* in order of material, path, options, ndf as given */
	struct material *material;
	size_t n, n_distinct; /* the latter without those that differ from another by options only */
	bool reported;        /* why a material has no fit: they were fitted just now */
};

/* materials_collect - rows of the one result table among the command's paths, or of a fit of its files.
 * A fit's rows are kept in DIR/fits.csv, DIR being the command's output.
 * Returns an exit code, what went wrong reported on standard error: EXIT_FAILED with some materials when only a part
 * of the files could be fitted. */
int materials_collect(struct materials *materials, const struct options *options);
void materials_free(struct materials *materials);

/* struct fitted - one row, as a model. */
struct fitted {
	char *const *row;
	const char *ndf;
	double error;
	struct cook_torrance model;
	struct pwl *pwl;            /* the table of model.ndf, if that is pl */
	struct fit_options options; /* under which it was fitted */
};

/* struct material_data - a material in memory. */
struct material_data {
	const char *name;
	struct measurement measurement; /* a table; of scattered entries one with filled gaps */
	struct measurement turned; /* the entries themselves of a sample that turns (measurement_turns()); else empty */
	int n;
	struct fitted fit[FIT_NDFS_MAX];
};

/* material_read - the table that the rows were made from, and the model of each row that did not fail.
 * Errors: STATUS_NO_DATA: no row to show; STATUS_FORMAT: an invalid row, more rows than FIT_NDFS_MAX, or a file that is
 * not the one of the rows; STATUS_IO, STATUS_NO_MEMORY. *data holds nothing then. */
MUST_CHECK enum status material_read(const struct material *material, int threads, struct material_data *data,
				     struct error *error);
void material_data_free(struct material_data *data);

/* material_best - number of the fit with the lowest error. */
int material_best(const struct material_data *data);

#endif
