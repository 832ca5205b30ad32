/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "data_readers/text_quote.h"
#include "fit/plot/gnuplot.h"
#include "fit/plot/plot_common.h"
#include "fit/plot/plot_files.h"
#include "fit/sources/error_grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of several weights a material has a place under each: their errors are different measures. */
static void put_name(FILE *file, const struct error_grid *grid, const struct material *material)
{
	char name[TEXT_QUOTE_SIZE + 32];
	if (grid->weights) {
		char shown[TEXT_QUOTE_SIZE];
		text_quote(material->name, shown, sizeof shown);
		snprintf(name, sizeof name, "%s, %.20s", shown, material->row[0][RESULT_WEIGHT]);
	}
	plot_text(file, grid->weights ? name : material->name);
}

static enum status write_errors(const char *directory, const struct error_grid *grid, struct error *error)
{
	struct atomic_file file;
	const enum status status = plot_open(&file, directory, "errors.csv", error);
	if (status != STATUS_OK)
		return status;
	char label[ERROR_GRID_LABEL];
	fputs("material", file.stream);
	for (int n = 0; n < grid->n_ndf; n++) {
		fputc(',', file.stream);
		plot_text(file.stream, error_grid_label(grid, n, label));
	}
	fputc('\n', file.stream);
	for (size_t m = 0; m < grid->n_fitted; m++) {
		put_name(file.stream, grid, grid->line[m].material);
		for (int n = 0; n < grid->n_ndf; n++)
			plot_number(file.stream, grid->line[m].error[n]);
		fputc('\n', file.stream);
	}
	return atomic_file_commit(&file, error);
}

/* The shape of an NDF's points. They are not joined: between two materials there is nothing. */
static int plot_point(int n)
{
	static const int shape[] = {7, 4, 8, 1, 12, 2};
	return shape[n % (int)(sizeof shape / sizeof *shape)];
}

static enum status write_errors_script(const char *directory, const struct error_grid *grid, struct error *error)
{
	enum { LABELS_MOST = 130 };
	char label[ERROR_GRID_LABEL];
	struct atomic_file file;
	const int width = grid->n_fitted < 20            ? 800
			  : grid->n_fitted > LABELS_MOST ? 2000
							 : 400 + 14 * (int)grid->n_fitted;
	const enum status status = plot_open(&file, directory, "errors.gp", error);
	if (status != STATUS_OK)
		return status;
	gnuplot_begin(file.stream, "errors", width, 560);
	fprintf(file.stream,
		"set title \"error of the fits, %zu material%s in order of %s\"\nset ylabel \"error E\"\n"
		"set xrange [-0.5:%g]\nset yrange [0:*]\nset key outside top center horizontal\n",
		grid->n_distinct, grid->n_distinct == 1 ? "" : "s", grid->by_std ? "that of std" : "their lowest",
		(double)grid->n_fitted - 0.5);
	fprintf(file.stream, "set xtics rotate by 60 right noenhanced scale 0.5\n%s",
		grid->n_fitted > LABELS_MOST ? "unset xtics\nset xlabel \"materials\"\n" : "");
	for (int n = 0; n < grid->n_ndf; n++) {
		fprintf(file.stream,
			"%s\"errors.csv\" skip 1 using 0:%d%s with points pt %d ps 0.9 lw 1.5 lc rgb \"%s\" title ",
			n ? ", " : "plot ", n + 2, grid->n_fitted > LABELS_MOST ? "" : ":xtic(1)", plot_point(n),
			plot_colour(grid->ndf[n], n));
		gnuplot_string(file.stream, error_grid_label(grid, n, label));
	}
	fputc('\n', file.stream);
	gnuplot_end(file.stream);
	return atomic_file_commit(&file, error);
}

enum status plot_errors(const char *directory, const struct materials *materials, struct error *error)
{
	struct error_grid grid;
	if (error_grid_make(materials, &grid) != STATUS_OK)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	error_grid_sort(&grid);
	enum status status = grid.n_fitted ? STATUS_OK : error_set(error, STATUS_NO_DATA, "no fit has an error");
	if (status == STATUS_OK)
		status = write_errors(directory, &grid, error);
	if (status == STATUS_OK)
		status = write_errors_script(directory, &grid, error);
	error_grid_free(&grid);
	return status;
}
