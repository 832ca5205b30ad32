/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit plot - fits, and the course of searches, as pictures by gnuplot. */
#include "data_readers/regular_file.h"
#include "fit/cli/messages.h"
#include "fit/cli/output_directory.h"
#include "fit/cli/progress.h"
#include "fit/commands/commands.h"
#include "fit/plot/gnuplot.h"
#include "fit/plot/plot_files.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct plotting {
	const struct options *options;
	struct progress progress;
	int code;
	bool no_gnuplot; /* reported already, */
	bool no_data;    /* as is why there is no fit */
};

/* Tells what went wrong; once is enough for a gnuplot that is missing. */
static void fail(struct plotting *p, enum status status, const struct error *error)
{
	progress_erase(&p->progress);
	const bool reported = status == STATUS_INTERRUPTED || (status == STATUS_NO_DATA && p->no_data);
	if (status != STATUS_UNSUPPORTED && !reported)
		report_error("%s", error->text);
	else if (status == STATUS_UNSUPPORTED && !p->no_gnuplot)
		report_error("%s: data and scripts are written, no picture is drawn", error->text);
	p->no_gnuplot |= status == STATUS_UNSUPPORTED;
	p->code = EXIT_FAILED;
}

static enum status draw(struct plotting *p, const char *directory, const char *const *name, int n, struct error *error)
{
	return p->no_gnuplot ? STATUS_OK : gnuplot_draw(directory, name, n, p->options->cancel, error);
}

static void plot_one(struct plotting *p, const struct material *material)
{
	struct material_data data;
	struct error error;
	char *directory = NULL;
	enum status status = material_read(material, p->options->fit.threads, &data, &error);
	if (status == STATUS_OK)
		status = output_directory_make(p->options->output, material->file_name, &directory, &error);
	for (int i = 0; i < PLOT_MATERIAL_TABLES && status == STATUS_OK; i++)
		status = output_directory_spares(directory, plot_material_tables[i], p->options->path,
						 p->options->n_paths, &error);
	for (int i = 0; i < PLOT_MATERIAL_TABLES && status == STATUS_OK; i++)
		status = output_directory_spares(directory, plot_material_tables[i], &material->row[0][RESULT_PATH], 1,
						 &error);
	if (status == STATUS_OK)
		status = plot_material(directory, &data, &error);
	if (status == STATUS_OK)
		status = draw(p, directory, plot_material_names, PLOT_MATERIAL_PICTURES, &error);
	if (status != STATUS_OK)
		fail(p, status, &error);
	free(directory);
	material_data_free(&data);
}

static void plot_all(struct plotting *p, const struct materials *materials)
{
	static const char *const name[] = {"errors"};
	struct error error;
	enum status status = plot_errors(p->options->output, materials, &error);
	if (status == STATUS_OK)
		status = draw(p, p->options->output, name, 1, &error);
	if (status != STATUS_OK)
		fail(p, status, &error);
	p->progress = progress_start(materials->n, "materials", p->options->quiet);
	for (size_t i = 0; i < materials->n && !*p->options->cancel; i++) {
		progress_draw(&p->progress);
		plot_one(p, &materials->material[i]);
		p->progress.done = i + 1;
	}
	progress_erase(&p->progress);
}

/* Whether the file begins as a trace does. What a pipe begins with is gone once it is read. */
static bool is_trace(const char *path)
{
	char line[256];
	struct stat st;
	int fd;
	ssize_t n = 0;
	if (regular_file_open(path, "a trace", &fd, &st, NULL) == STATUS_OK)
		n = read(fd, line, sizeof line - 1);
	if (fd >= 0)
		close(fd);
	line[n > 0 ? n : 0] = '\0';
	line[strcspn(line, "\n")] = '\0';
	return strstr(line, "algorithm,stage,");
}

static void plot_the_trace(struct plotting *p)
{
	static const char *const name[] = {"trace"};
	struct csv_table trace = csv_table_make(trace_columns, TRACE_COLUMNS);
	struct error error;
	enum status status = csv_table_read(&trace, p->options->path[0], TRACE_COLUMNS, NULL, &error);
	if (status == STATUS_OK)
		status = plot_trace(p->options->output, &trace, &error);
	if (status == STATUS_OK)
		status = draw(p, p->options->output, name, 1, &error);
	if (status != STATUS_OK)
		fail(p, status, &error);
	csv_table_free(&trace);
}

static void plot_the_fits(struct plotting *p)
{
	struct materials materials;
	const int code = materials_collect(&materials, p->options);
	p->no_data = materials.reported;
	if (materials.n && code != EXIT_INTERRUPTED)
		plot_all(p, &materials);
	materials_free(&materials);
	p->code = code != EXIT_DONE ? code : p->code;
}

int cmd_plot(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error;
	int code = options_parse(&options, COMMAND_PLOT, argc, argv, cancel);
	if (code < 0)
		code = options_check_fit(&options);
	if (code < 0 && !options.output)
		code = options_usage(COMMAND_PLOT, "expected -o DIR, a directory for the plots");
	if (code >= 0)
		return code;
	static const char *const written[] = {"trace.csv", "errors.csv"};
	enum status status = output_directory_make(options.output, NULL, NULL, &error);
	for (size_t i = 0; i < sizeof written / sizeof *written && status == STATUS_OK; i++)
		status = output_directory_spares(options.output, written[i], options.path, options.n_paths, &error);
	if (status == STATUS_DOMAIN)
		return options_usage(COMMAND_PLOT, "%s", error.text);
	if (status != STATUS_OK) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	struct plotting plotting = {.options = &options, .code = EXIT_DONE};
	if (options.n_paths == 1 && is_trace(options.path[0]))
		plot_the_trace(&plotting);
	else
		plot_the_fits(&plotting);
	return *cancel ? EXIT_INTERRUPTED : plotting.code;
}
