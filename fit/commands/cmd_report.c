/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit report - fits as one HTML page that holds all it needs, or of many materials as one page each and one that leads to
 * them: written to DIR/index.html and DIR/materials/, pictures by way of a scratch directory beside them. */
#include "data_readers/atomic_file.h"
#include "fit/cli/lighting.h"
#include "fit/cli/messages.h"
#include "fit/cli/output_directory.h"
#include "fit/cli/progress.h"
#include "fit/commands/commands.h"
#include "fit/page/material_pictures.h"
#include "fit/page/report_spheres.h"
#include "fit/plot/gnuplot.h"
#include "fit/plot/plot_files.h"

#include <stdlib.h>
#include <string.h>

struct report {
	const struct options *options;
	struct progress progress;
	struct scratch scratch; /* where pictures are made */
	int code;
	struct environment environment;
	bool no_gnuplot, no_png; /* reported already; why, below */
	struct error missing, missing_png;
};

static void report_failure(struct report *r, const struct error *error)
{
	progress_erase(&r->progress);
	report_error("%s", error->text);
	r->code = EXIT_FAILED;
}

/* Draws what plot_*() has written to the scratch directory. Without gnuplot the page does without, which is reported once. */
static bool draw(struct report *r, const char *const *name, int n, struct error *error)
{
	if (r->no_gnuplot) {
		*error = r->missing;
		return false;
	}
	const enum status status = gnuplot_draw(r->scratch.path, name, n, r->options->cancel, error);
	if (status == STATUS_UNSUPPORTED) {
		progress_erase(&r->progress);
		report_error("%s: the page has no plots", error->text);
		r->no_gnuplot = true;
		r->missing = *error;
	} else if (status != STATUS_OK && status != STATUS_INTERRUPTED) {
		report_failure(r, error);
	}
	return status == STATUS_OK;
}

/* NAME in the scratch directory; NULL, which the page takes for no picture, when out of memory, as `why` then says. */
static char *scratch_path(const struct report *r, const char *name, struct error *why)
{
	char *path;
	if (asprintf(&path, "%s/%s", r->scratch.path, name) >= 0)
		return path;
	error_set(why, STATUS_NO_MEMORY, "out of memory");
	return NULL;
}

static enum status begin(struct report *r, struct page *page, FILE *file, const struct materials *materials,
			 struct error *error)
{
	static const char *const name[] = {"errors"};
	struct page_picture errors = {
		.type = "image/svg+xml",
		.plot = true,
		.alt = "Error of each fit, a point a material and NDF, materials sorted; the numbers are in the table "
		       "below.",
		.caption = "Errors of all materials, sorted.",
	};
	struct error why;
	const enum status status = plot_errors(r->scratch.path, materials, &why);
	const bool wanted = status != STATUS_NO_DATA && materials->n_distinct > 1;
	if (status != STATUS_OK && status != STATUS_NO_DATA)
		report_failure(r, &why);
	if (status == STATUS_OK && wanted && draw(r, name, 1, &why)) {
		errors.path = scratch_path(r, "errors.svg", &why);
		if (!errors.path)
			report_failure(r, &why);
	}
	const char *missing = wanted && !errors.path ? why.text : NULL;
	const enum status begun = page_begin(page, file, materials, &errors, missing, error);
	free(errors.path);
	return begun;
}

/* Without libpng the page does without spheres, which is reported once. */
static bool draw_spheres(struct report *r, const struct material_data *data, struct page_picture *picture,
			 char **caption, struct error *why)
{
	struct picture_error difference[FIT_NDFS_MAX] = {{.rmse = 0}};
	char *path = r->no_png ? NULL : scratch_path(r, "spheres", why);
	enum status status = r->no_png ? STATUS_UNSUPPORTED : STATUS_NO_MEMORY;
	if (r->no_png)
		*why = r->missing_png;
	else if (path)
		status = report_spheres(path, data, &r->environment, r->options, difference, why);
	if (status == STATUS_OK) {
		*caption = material_spheres_caption(r->options, data, difference);
		if (!*caption)
			status = error_set(why, STATUS_NO_MEMORY, "out of memory");
	}
	if (status == STATUS_OK) {
		picture->path = path;
		picture->caption = *caption;
		picture->parts = 1 + data->n;
		picture->part[0] = "as measured.";
		for (int f = 0; f < data->n; f++)
			picture->part[1 + f] = data->fit[f].ndf;
		return true;
	}
	free(path);
	if (status == STATUS_UNSUPPORTED && !r->no_png) {
		progress_erase(&r->progress);
		report_error("%s: the page has no spheres", why->text);
		r->no_png = true;
		r->missing_png = *why;
	} else if (status != STATUS_UNSUPPORTED && status != STATUS_INTERRUPTED) {
		report_failure(r, why);
	}
	return false;
}

static bool draw_plots(struct report *r, const struct material_data *data, struct page_picture picture[PICTURES],
		       struct error *why)
{
	static const char *const name[PICTURES] = {[PICTURE_SLICES] = "slices.png",
						   [PICTURE_SLICES_0] = "slices_0.png",
						   [PICTURE_MAP] = "map.png",
						   [PICTURE_NDF] = "ndf.svg"};
	if (plot_material(r->scratch.path, data, why) != STATUS_OK) {
		report_failure(r, why);
		return false;
	}
	if (!draw(r, plot_material_names, PLOT_MATERIAL_PICTURES, why))
		return false;
	bool all = true;
	for (int p = PICTURE_SLICES; p < PICTURES; p++) {
		picture[p].path = scratch_path(r, name[p], why);
		all &= picture[p].path != NULL;
	}
	if (!all)
		report_failure(r, why);
	return all;
}

/* Draws the pictures of a material; the paths of those that are there go to picture[]. Returns whether all are. */
static bool draw_material(struct report *r, const struct materials *materials, size_t m,
			  struct page_picture picture[PICTURES], char **caption, struct error *why)
{
	struct material_data data;
	const enum status status = material_read(&materials->material[m], r->options->fit.threads, &data, why);
	if (status == STATUS_NO_DATA && materials->reported)
		r->code = EXIT_FAILED;
	else if (status != STATUS_OK)
		report_failure(r, why);
	if (status != STATUS_OK)
		return false;
	struct error no_spheres;
	const bool spheres = draw_spheres(r, &data, &picture[PICTURE_SPHERES], caption, &no_spheres);
	const bool plots = draw_plots(r, &data, picture, why);
	if (plots && !spheres)
		*why = no_spheres;
	material_data_free(&data);
	return spheres && plots;
}

/* The file of a material, where each has one of its own. */
static enum status material_file(struct report *r, const struct page *page, size_t m, struct atomic_file *file,
				 struct page *own, struct error *error)
{
	char *directory = NULL, *name = NULL, *path = NULL;
	enum status status = output_directory_make(r->options->output, PAGE_DIRECTORY, &directory, error);
	if (status == STATUS_OK && asprintf(&name, "%s.html", page->materials->material[m].file_name) < 0) {
		name = NULL;
		status = error_set(error, STATUS_NO_MEMORY, "out of memory");
	}
	if (status == STATUS_OK)
		status = output_directory_path(directory, name, &path, error);
	if (status == STATUS_OK)
		status = atomic_file_open(file, path, error);
	if (status == STATUS_OK)
		page_of_material(page, m, file->stream, own);
	free(directory);
	free(name);
	free(path);
	return status;
}

static enum status put_material(struct report *r, const struct page *page, size_t m, const struct page_picture *picture,
				const char *missing, struct error *error)
{
	struct atomic_file file;
	struct page own;
	if (!page->divided)
		return page_material(page, m, picture, PICTURES, missing, error);
	enum status status = material_file(r, page, m, &file, &own, error);
	if (status != STATUS_OK)
		return status;
	status = page_material(&own, m, picture, PICTURES, missing, error);
	if (status == STATUS_OK) {
		page_end(&own);
		return atomic_file_commit(&file, error);
	}
	atomic_file_abort(&file);
	return status;
}

static enum status add_material(struct report *r, const struct page *page, size_t m, struct error *error)
{
	struct page_picture picture[PICTURES];
	struct error why;
	char *caption = NULL;
	memcpy(picture, material_pictures, sizeof picture);
	const bool drawn = draw_material(r, page->materials, m, picture, &caption, &why);
	enum status status = STATUS_INTERRUPTED;
	if (!*r->options->cancel)
		status = put_material(r, page, m, picture, drawn ? NULL : why.text, error);
	for (int p = 0; p < PICTURES; p++)
		free(picture[p].path);
	free(caption);
	return status;
}

static enum status write_page(struct report *r, FILE *file, const struct materials *materials, struct error *error)
{
	struct page page;
	enum status status = begin(r, &page, file, materials, error);
	r->progress = progress_start(materials->n, "materials", r->options->quiet);
	for (size_t m = 0; m < materials->n && status == STATUS_OK; m++) {
		progress_draw(&r->progress);
		status = add_material(r, &page, m, error);
		r->progress.done = m + 1;
	}
	progress_erase(&r->progress);
	if (status == STATUS_OK)
		page_end(&page);
	page_free(&page);
	return *r->options->cancel ? STATUS_INTERRUPTED : status;
}

static enum status make_page(struct report *r, const struct materials *materials, struct error *error)
{
	struct atomic_file file;
	char *path;
	if (asprintf(&path, "%s/index.html", r->options->output) < 0)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	enum status status = atomic_file_open(&file, path, error);
	free(path);
	if (status != STATUS_OK)
		return status;
	status = scratch_make(r->options->output, &r->scratch, error);
	if (status == STATUS_OK)
		status = write_page(r, file.stream, materials, error);
	scratch_remove(&r->scratch);
	if (status == STATUS_OK)
		return atomic_file_commit(&file, error);
	atomic_file_abort(&file);
	return status;
}

int cmd_report(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error;
	int code = options_parse(&options, COMMAND_REPORT, argc, argv, cancel);
	if (code < 0)
		code = options_check_fit(&options);
	if (code < 0 && !options.output)
		code = options_usage(COMMAND_REPORT, "expected -o DIR, a directory for the page");
	if (code >= 0)
		return code;
	enum status status = output_directory_make(options.output, NULL, NULL, &error);
	if (status == STATUS_OK)
		status = output_directory_spares(options.output, "index.html", options.path, options.n_paths, &error);
	if (status == STATUS_DOMAIN)
		return options_usage(COMMAND_REPORT, "%s", error.text);
	if (status == STATUS_OK)
		status = output_directory_accepts(options.output, "index.html", &error);
	if (status != STATUS_OK) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	struct report report = {.options = &options};
	struct materials materials;
	status = lighting_make(&options, &report.environment, &error);
	if (status == STATUS_DOMAIN)
		return options_usage(COMMAND_REPORT, "%s", error.text);
	if (status != STATUS_OK) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	code = materials_collect(&materials, &options);
	if (materials.n && code != EXIT_INTERRUPTED)
		status = make_page(&report, &materials, &error);
	if (status != STATUS_OK && status != STATUS_INTERRUPTED) {
		report_error("%s", error.text);
		report.code = EXIT_FAILED;
	}
	materials_free(&materials);
	environment_free(&report.environment);
	if (*cancel)
		return EXIT_INTERRUPTED;
	return code != EXIT_DONE ? code : report.code;
}
