/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gnuplot.h"
#include "plot_common.h"
#include "plot_files.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

struct error_line {
	const char *name;
	double lowest, key;
	double error[FIT_NDFS_MAX];
};

struct errors {
	const char *ndf[FIT_NDFS_MAX];
	int n_ndf;
	bool by_std; /* every material has an STD fit, whose error sets the order */
	struct error_line *line;
	size_t n;
};

static int line_order(const void *a, const void *b)
{
	const double x = ((const struct error_line *)a)->key, y = ((const struct error_line *)b)->key;
	return (x > y) - (x < y);
}

/* The column of an NDF, which it gets if it has none; -1 when there is no room. */
static int errors_column(struct errors *errors, const char *ndf)
{
	for (int n = 0; n < errors->n_ndf; n++)
		if (!strcmp(errors->ndf[n], ndf))
			return n;
	if (errors->n_ndf == FIT_NDFS_MAX)
		return -1;
	errors->ndf[errors->n_ndf] = ndf;
	return errors->n_ndf++;
}

/* Takes the errors of one material. */
static void add_material(struct errors *errors, const struct material *material)
{
	struct error_line *line = &errors->line[errors->n];
	*line = (struct error_line){.name = material->name, .lowest = INFINITY};
	for (int n = 0; n < FIT_NDFS_MAX; n++)
		line->error[n] = NAN;
	for (size_t r = 0; r < material->n_rows; r++) {
		const double e = result_number(material->row[r], RESULT_ERROR);
		const int column = isnan(e) ? -1 : errors_column(errors, material->row[r][RESULT_NDF]);
		if (column < 0)
			continue;
		line->error[column] = e;
		line->lowest = fmin(line->lowest, e);
	}
	errors->n += isfinite(line->lowest);
}

/* Errors by material and NDF, in order of STD's or, where one is missing, of the lowest. */
static enum status collect_errors(const struct materials *materials, struct errors *errors)
{
	errors->line = calloc(materials->n + 1, sizeof(*errors->line));
	if (!errors->line)
		return STATUS_NO_MEMORY;
	for (size_t m = 0; m < materials->n; m++)
		add_material(errors, &materials->material[m]);
	int std = 0;
	while (std < errors->n_ndf && strcmp(errors->ndf[std], "std"))
		std++;
	errors->by_std = std < errors->n_ndf;
	for (size_t m = 0; m < errors->n; m++)
		errors->by_std = errors->by_std && !isnan(errors->line[m].error[std]);
	for (size_t m = 0; m < errors->n; m++)
		errors->line[m].key = errors->by_std ? errors->line[m].error[std] : errors->line[m].lowest;
	qsort(errors->line, errors->n, sizeof(*errors->line), line_order);
	return errors->n ? STATUS_OK : STATUS_NO_DATA;
}

static enum status write_errors(const char *directory, const struct errors *errors, struct error *error)
{
	struct atomic_file file;
	const enum status status = plot_open(&file, directory, "errors.csv", error);
	if (status)
		return status;
	fputs("material", file.stream);
	for (int n = 0; n < errors->n_ndf; n++)
		fprintf(file.stream, ",%s", errors->ndf[n]);
	fputc('\n', file.stream);
	for (size_t m = 0; m < errors->n; m++) {
		plot_text(file.stream, errors->line[m].name);
		for (int n = 0; n < errors->n_ndf; n++)
			plot_number(file.stream, errors->line[m].error[n]);
		fputc('\n', file.stream);
	}
	return atomic_file_commit(&file, error);
}

static enum status write_errors_script(const char *directory, const struct errors *errors, struct error *error)
{
	enum { LABELS_MOST = 130 };
	struct atomic_file file;
	const int width = errors->n < 20 ? 800 : errors->n > LABELS_MOST ? 2000 : 400 + 14 * (int)errors->n;
	const enum status status = plot_open(&file, directory, "errors.gp", error);
	if (status)
		return status;
	gnuplot_begin(file.stream, "errors", width, 560);
	fprintf(file.stream,
		"set title \"error of the fits, %zu materials in order of %s\"\nset ylabel \"error E\"\n"
		"set xrange [-0.5:%g]\nset yrange [0:*]\nset key left top\n",
		errors->n, errors->by_std ? "that of std" : "their lowest", (double)errors->n - 0.5);
	fprintf(file.stream, "set xtics rotate by 60 right noenhanced scale 0.5\n%s",
		errors->n > LABELS_MOST ? "unset xtics\nset xlabel \"materials\"\n" : "");
	for (int n = 0; n < errors->n_ndf; n++) {
		fprintf(file.stream,
			"%s\"errors.csv\" skip 1 using 0:%d%s with linespoints pt 7 ps 0.6 lw 1.5 lc rgb \"%s\" title ",
			n ? ", " : "plot ", n + 2, errors->n > LABELS_MOST ? "" : ":xtic(1)",
			plot_colour(errors->ndf[n], n));
		gnuplot_string(file.stream, errors->ndf[n]);
	}
	fputc('\n', file.stream);
	gnuplot_end(file.stream);
	return atomic_file_commit(&file, error);
}

enum status plot_errors(const char *directory, const struct materials *materials, struct error *error)
{
	struct errors errors = {.n = 0};
	enum status status = collect_errors(materials, &errors);
	if (status)
		error_set(error, status, "%s", status == STATUS_NO_DATA ? "no fit has an error" : "out of memory");
	if (!status)
		status = write_errors(directory, &errors, error);
	if (!status)
		status = write_errors_script(directory, &errors, error);
	free(errors.line);
	return status;
}
