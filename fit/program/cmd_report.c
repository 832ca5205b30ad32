/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit report - fits as one HTML page that holds all it needs: written to DIR/index.html, pictures by way of a scratch
 * directory beside it. */
#include "atomic_file.h"
#include "gnuplot.h"
#include "output_directory.h"
#include "page.h"
#include "plot_files.h"

#include <stdlib.h>
#include <string.h>

/* The pictures of a material, in the order of the page. */
enum picture { PICTURE_SLICES, PICTURE_MAP, PICTURE_NDF, PICTURES };

struct report {
	const struct options *options;
	struct progress progress;
	char *scratch; /* where pictures are made */
	int code;
	bool no_gnuplot; /* told already */
	struct error missing;
};

static void tell(struct report *r, const struct error *error)
{
	progress_erase(&r->progress);
	report_error("%s", error->text);
	r->code = EXIT_FAILED;
}

/* Draws what plot_*() has written to the scratch directory. Without gnuplot the page does without, which is told once. */
static bool draw(struct report *r, const char *const *name, int n, struct error *error)
{
	if (r->no_gnuplot) {
		*error = r->missing;
		return false;
	}
	const enum status status = gnuplot_draw(r->scratch, name, n, r->options->cancel, error);
	if (status == STATUS_UNSUPPORTED) {
		progress_erase(&r->progress);
		report_error("%s: the page has no plots", error->text);
		r->no_gnuplot = true;
		r->missing = *error;
	} else if (status && status != STATUS_INTERRUPTED) {
		tell(r, error);
	}
	return status == STATUS_OK;
}

/* NAME in the scratch directory; NULL, which the page takes for no picture, when out of memory. */
static char *scratch_path(const struct report *r, const char *name)
{
	char *path;
	return asprintf(&path, "%s/%s", r->scratch, name) < 0 ? NULL : path;
}

static enum status begin(struct report *r, struct page *page, FILE *file, const struct materials *materials,
			 struct error *error)
{
	static const char *const name[] = {"errors"};
	struct page_picture errors = {
		.type = "image/svg+xml",
		.plot = true,
		.alt = "Error of each fit, one curve an NDF, materials sorted; the numbers are in the table below.",
		.caption = "Errors of all materials, sorted.",
	};
	struct error why;
	const enum status status = plot_errors(r->scratch, materials, &why);
	if (status && status != STATUS_NO_DATA)
		tell(r, &why);
	if (!status && materials->n > 1 && draw(r, name, 1, &why))
		errors.path = scratch_path(r, "errors.svg");
	const enum status begun = page_begin(page, file, materials, &errors, error);
	free(errors.path);
	return begun;
}

/* Draws the plots of a material; the paths of those that are there go to picture[]. Returns whether all are. */
static bool draw_material(struct report *r, const struct material *material, struct page_picture picture[PICTURES],
			  struct error *error)
{
	static const char *const name[PICTURES] = {
		[PICTURE_SLICES] = "slices.svg", [PICTURE_MAP] = "map.png", [PICTURE_NDF] = "ndf.svg"};
	struct material_data data;
	enum status status = material_read(material, r->options->fit.threads, &data, error);
	if (!status)
		status = plot_material(r->scratch, &data, error);
	material_data_free(&data);
	if (status) {
		tell(r, error);
		return false;
	}
	if (!draw(r, plot_material_names, PLOT_MATERIAL_PICTURES, error))
		return false;
	for (int p = 0; p < PICTURES; p++)
		picture[p].path = scratch_path(r, name[p]);
	return true;
}

static enum status add_material(struct report *r, const struct page *page, size_t m, struct error *error)
{
	struct page_picture picture[PICTURES] = {
		[PICTURE_SLICES] =
			{.type = "image/svg+xml",
			 .plot = true,
			 .alt = "measured and fitted BRDF over theta_h, on a logarithmic scale, for theta_d of 0, 15, "
				"30, 45, 60 and 75 degrees at phi_d = 90 degrees.",
			 .caption = "Slices, measured and fitted: \xcf\x86_d = 90\xc2\xb0, six \xce\xb8_d, mean of the "
				    "channels."},
		[PICTURE_MAP] =
			{.type = "image/png",
			 .plot = true,
			 .alt = "heat maps of the error over theta_h and theta_d, one a fit; the errors in all are in "
				"the table of parameters.",
			 .caption =
				 "Where each fit errs: E of each row (\xce\xb8_h, \xce\xb8_d) of the table by itself; "
				 "gray: nothing measured."},
		[PICTURE_NDF] =
			{.type = "image/svg+xml",
			 .plot = true,
			 .alt = "D of each fit over theta_h against the D that the fit reads off the data, and G1 over "
				"theta.",
			 .caption =
				 "D of each fit against the D that it reads off the data at small \xce\xb8_d, and G\xe2"
				 "\x82\x81."},
	};
	struct error why;
	const bool drawn = draw_material(r, &page->materials->material[m], picture, &why);
	enum status status = STATUS_INTERRUPTED;
	if (!*r->options->cancel)
		status = page_material(page, m, picture, PICTURES, drawn ? NULL : why.text, error);
	for (int p = 0; p < PICTURES; p++)
		free(picture[p].path);
	return status;
}

static enum status write_page(struct report *r, FILE *file, const struct materials *materials, struct error *error)
{
	struct page page;
	enum status status = begin(r, &page, file, materials, error);
	r->progress = progress_start(materials->n, "materials", r->options->quiet);
	for (size_t m = 0; m < materials->n && !status; m++) {
		progress_draw(&r->progress);
		status = add_material(r, &page, m, error);
		r->progress.done = m + 1;
	}
	progress_erase(&r->progress);
	if (!status)
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
	if (status)
		return status;
	status = scratch_make(r->options->output, &r->scratch, error);
	if (!status)
		status = write_page(r, file.stream, materials, error);
	scratch_remove(r->scratch);
	if (!status)
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
	if (output_directory_make(options.output, NULL, NULL, &error)) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	struct report report = {.options = &options};
	struct materials materials;
	code = materials_collect(&materials, &options);
	enum status status = STATUS_OK;
	if (materials.n && code != EXIT_INTERRUPTED)
		status = make_page(&report, &materials, &error);
	if (status && status != STATUS_INTERRUPTED) {
		report_error("%s", error.text);
		report.code = EXIT_FAILED;
	}
	materials_free(&materials);
	if (*cancel)
		return EXIT_INTERRUPTED;
	return code != EXIT_DONE ? code : report.code;
}
