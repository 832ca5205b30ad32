/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit render - spheres of measured materials beside spheres of their models, and how different they look. */
#include "data_readers/measurement_read.h"
#include "data_readers/text_quote.h"
#include "fit/cli/files.h"
#include "fit/cli/lighting.h"
#include "fit/cli/messages.h"
#include "fit/cli/progress.h"
#include "fit/commands/commands.h"
#include "fit/render/pictures.h"
#include "fit/render/sheet.h"
#include "fit/results/store.h"
#include "fit/sources/model_source.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

enum render_column {
	RENDER_MATERIAL,
	RENDER_NDF,
	RENDER_ERROR,
	RENDER_RMSE,
	RENDER_DELTA_E,
	RENDER_SSIM,
	RENDER_COLUMNS
};

static const struct csv_column columns[RENDER_COLUMNS] = {
	[RENDER_MATERIAL] = {"material", false}, [RENDER_NDF] = {"ndf", false},        [RENDER_ERROR] = {"error", true},
	[RENDER_RMSE] = {"rmse", true},          [RENDER_DELTA_E] = {"delta_e", true}, [RENDER_SSIM] = {"ssim", true},
};

enum { COLUMNS_MAX = FIT_NDFS_MAX }; /* models of one material */

struct render {
	struct options *options;
	const char *picture; /* file; NULL: none */
	bool from_table;     /* the files are those of the rows of --from */
	struct environment environment;
	struct sphere_options sphere;
	const char *column[COLUMNS_MAX]; /* NDFs of the sheet's columns, behind that of the measured table */
	int n_columns;
	struct sheet sheet;
	int n_drawn; /* rows of it: a material that fails has none */
	struct csv_table output;
	struct progress progress;
};

static void row_done(void *user)
{
	struct render *render = user;
	render->progress.done++;
	progress_draw(&render->progress);
}

/* The models of one material that are to be shown. */
struct chosen {
	int n;
	const struct source_model *model[COLUMNS_MAX];
};

static bool is_of(const struct source_model *model, const char *path)
{
	return model->path && !strcmp(model->path, path);
}

/* Files in several directories can have one name: where there are models of this path, only they are meant. */
static enum status choose(const struct render *render, const struct model_source *source, const char *path,
			  struct chosen *chosen, struct error *error)
{
	bool by_path = render->from_table;
	chosen->n = 0;
	for (size_t i = 0; i < source->n; i++)
		by_path |= is_of(&source->model[i], path);
	for (size_t i = 0; i < source->n; i++) {
		const struct source_model *model = &source->model[i];
		if (by_path && !is_of(model, path))
			continue;
		if (chosen->n == COLUMNS_MAX)
			return error_set(error, STATUS_UNSUPPORTED, "'%.150s' has more than %d models", model->material,
					 COLUMNS_MAX);
		if (chosen->n && model->fit.criterion.bins != chosen->model[0]->fit.criterion.bins)
			return error_set(error, STATUS_UNSUPPORTED,
					 "the models of '%.150s' were fitted with different bins", model->material);
		chosen->model[chosen->n++] = model;
	}
	return chosen->n ? STATUS_OK : error_set(error, STATUS_NO_DATA, "there is no model to show");
}

/* Columns */

/* The column of each model: the first of its NDF that none before it has; new ones are added if `grow`. */
static void find_columns(struct render *render, const struct chosen *chosen, int column[COLUMNS_MAX], bool grow)
{
	bool used[COLUMNS_MAX] = {false};
	for (int i = 0; i < chosen->n; i++) {
		const char *ndf = ndf_name(chosen->model[i]->model.ndf.class);
		int c = 0;
		while (c < render->n_columns && (used[c] || strcmp(render->column[c], ndf) != 0))
			c++;
		column[i] = c;
		if (c == render->n_columns && (!grow || c == COLUMNS_MAX)) {
			column[i] = -1;
			continue;
		}
		if (c == render->n_columns)
			render->column[render->n_columns++] = ndf;
		used[c] = true;
	}
}

/* A fit has the NDFs of the options. Rows are looked at beforehand; what is wrong with them will be told later, unless
 * memory ran out, which may pass. */
static enum status plan_columns(struct render *render, const struct files *files, struct error *error)
{
	const struct options *options = render->options;
	if (model_source_kind(options) != SOURCE_ROWS) {
		for (int i = 0; i < options->fit.n_ndf; i++)
			render->column[render->n_columns++] = ndf_name(options->fit.ndf[i]);
		return STATUS_OK;
	}
	for (size_t i = 0; i < files->n; i++) {
		struct model_source source;
		struct chosen chosen;
		const enum status status = model_source_read(options, files->path[i], &source, error);
		if (status == STATUS_NO_MEMORY)
			return status;
		if (status != STATUS_OK)
			continue;
		if (!choose(render, &source, files->path[i], &chosen, error)) {
			int column[COLUMNS_MAX];
			find_columns(render, &chosen, column, true);
		}
		model_source_free(&source);
	}
	return STATUS_OK;
}

/* One material */

static enum status add_row(struct render *render, const char *material, const struct source_model *model,
			   const struct picture_error *picture)
{
	const double number[RENDER_COLUMNS] = {
		[RENDER_ERROR] = model->error,
		[RENDER_RMSE] = picture->rmse,
		[RENDER_DELTA_E] = picture->delta_e,
		[RENDER_SSIM] = picture->ssim,
	};
	char text[RENDER_COLUMNS][CSV_NUMBER_SIZE];
	const char *cell[RENDER_COLUMNS] = {material, ndf_name(model->model.ndf.class)};
	for (int c = RENDER_ERROR; c < RENDER_COLUMNS; c++)
		cell[c] = csv_number(text[c], number[c]);
	return csv_table_add(&render->output, cell);
}

/* What stands above a sphere, as far as there is room for it. */
static void write_label(const struct sheet *sheet, const struct picture_error *error, char *label, size_t size)
{
	const int length = snprintf(label, size, "dE %.2f SSIM %.3f", error->delta_e, error->ssim);
	if (length > sheet_label_length(sheet))
		snprintf(label, size, "dE %.2f", error->delta_e);
}

/* In the next row of the sheet. */
static void draw(struct render *render, const char *material, const struct chosen *chosen,
		 const struct pictures *pictures)
{
	struct sheet *sheet = &render->sheet;
	const int row = render->n_drawn++;
	int column[COLUMNS_MAX];
	find_columns(render, chosen, column, false);
	sheet_sphere(sheet, 0, row, &pictures->measured, material);
	if (sheet->differences)
		sheet_legend(sheet, row);
	for (int i = 0; i < chosen->n; i++) {
		char label[64];
		if (column[i] < 0)
			continue;
		write_label(sheet, &pictures->error[i], label, sizeof label);
		sheet_sphere(sheet, 1 + column[i], row, &pictures->sphere[i], label);
		if (sheet->differences)
			sheet_difference(sheet, 1 + column[i], row, &pictures->sphere[i], &pictures->measured);
	}
}

/* Renders the models of a table that has been read, draws and reports them. */
static enum status show_models(struct render *render, const char *path, const struct measurement *measurement,
			       const struct chosen *chosen)
{
	struct pictures pictures;
	struct pictures_model model[COLUMNS_MAX];
	char *material = result_material(path);
	for (int i = 0; i < chosen->n; i++)
		model[i] = (struct pictures_model){&chosen->model[i]->model, chosen->model[i]->error};
	enum status status =
		material ? pictures_render(measurement, chosen->model[0]->fit.criterion.bins, model, chosen->n,
					   render->options->sampling, &render->environment, &render->sphere, &pictures)
			 : STATUS_NO_MEMORY;
	for (int i = 0; i < chosen->n && status == STATUS_OK; i++)
		status = add_row(render, material, chosen->model[i], &pictures.error[i]);
	if (status == STATUS_OK && render->picture)
		draw(render, material, chosen, &pictures);
	pictures_free(&pictures);
	free(material);
	return status;
}

static enum status show_source(struct render *render, const char *path, struct model_source *source,
			       struct error *error)
{
	struct chosen chosen;
	enum status status = choose(render, source, path, &chosen, error);
	if (status == STATUS_OK && !source->measurement.value[0])
		status = measurement_read(path, &chosen.model[0]->reading, &source->measurement, error);
	for (int i = 0; i < chosen.n && status == STATUS_OK && render->from_table; i++)
		status = result_check_input(chosen.model[i]->input, &source->measurement, path, error);
	if (status != STATUS_OK)
		return status;
	status = show_models(render, path, &source->measurement, &chosen);
	if (status == STATUS_OK)
		return STATUS_OK;
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	return error_set(error, status, "cannot render '%s': %s", name, status_str(status));
}

static enum status show_file(struct render *render, const char *path)
{
	struct model_source source;
	struct error error;
	enum status status = model_source_read(render->options, path, &source, &error);
	if (status == STATUS_OK) {
		status = show_source(render, path, &source, &error);
		model_source_free(&source);
	}
	if (status != STATUS_OK && status != STATUS_INTERRUPTED) {
		progress_erase(&render->progress);
		report_error("%s", error.text);
	}
	return status;
}

/* All */

static enum status prepare_sheet(struct render *render, size_t n, struct error *error)
{
	const struct options *options = render->options;
	enum status status = store_probe(render->picture, error);
	if (status != STATUS_OK)
		return status;
	status = n < IMAGE_SIZE_MAX ? sheet_init(&render->sheet, options->size, 1 + render->n_columns, (int)n,
						 n == 1 || options->difference)
				    : STATUS_DOMAIN;
	if (status != STATUS_OK)
		return error_set(
			error, status, "%s",
			status == STATUS_DOMAIN
				? "the picture would be too large: expected fewer materials or a smaller --size"
				: status_str(status));
	sheet_title(&render->sheet, 0, "measured");
	for (int c = 0; c < render->n_columns; c++)
		sheet_title(&render->sheet, 1 + c, render->column[c]);
	return STATUS_OK;
}

static bool ends_with(const char *path, const char *ending)
{
	const size_t length = strlen(path), n = strlen(ending);
	return length > n && !strcasecmp(path + length - n, ending);
}

static enum status write_picture(const struct render *render, struct error *error)
{
	return ends_with(render->picture, ".png") ? image_write_png(render->picture, &render->sheet.image, error)
						  : image_write_pfm(render->picture, &render->sheet.image, error);
}

/* Shows the files, reports them, and writes the picture unless nothing or not everything could be tried. */
static int show_files(struct render *render, const struct files *files)
{
	const struct options *options = render->options;
	struct error error;
	size_t failed = 0;
	enum status status = plan_columns(render, files, &error);
	if (status == STATUS_OK && render->picture)
		status = prepare_sheet(render, files->n, &error);
	if (status != STATUS_OK) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	render->progress =
		progress_start(files->n * (size_t)((1 + render->n_columns) * options->size), "rows", options->quiet);
	for (size_t i = 0; i < files->n && !*options->cancel; i++)
		failed += show_file(render, files->path[i]) != STATUS_OK;
	progress_erase(&render->progress);
	report_output(&render->output, options_show(options), report_table);
	if (*options->cancel)
		return EXIT_INTERRUPTED;
	sheet_end(&render->sheet, render->n_drawn);
	if (render->picture && failed < files->n && write_picture(render, &error)) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	return failed ? EXIT_FAILED : EXIT_DONE;
}

/* The files that the rows of a result table are of. */
static enum status table_files(const char *table, struct files *files, const atomic_bool *cancel, struct error *error)
{
	struct csv_table rows = csv_table_make(result_columns, RESULT_COLUMNS);
	enum status status = csv_table_read(&rows, table, RESULT_SAMPLES, NULL, error);
	char **path = status ? NULL : calloc(rows.n_rows + 1, sizeof *path);
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

/* A picture in the place of what it is made from would be the last one. */
static int check_output(const struct render *render, const struct files *files)
{
	const char *const read[] = {render->options->from, render->options->environment};
	bool replaces = render->picture && files_has(files, render->picture);
	for (size_t i = 0; i < sizeof read / sizeof *read && render->picture; i++)
		replaces |= read[i] && files_same(read[i], render->picture) && !access(read[i], F_OK);
	return replaces ? options_usage(COMMAND_RENDER, "--output names a file that is to be read") : -1;
}

static int collect_and_show(struct render *render)
{
	const struct options *options = render->options;
	struct files files = {0};
	struct error error;
	int bad = 0;
	enum status status = lighting_make(options, &render->environment, &error);
	if (status == STATUS_DOMAIN)
		return options_usage(COMMAND_RENDER, "%s", error.text);
	if (status == STATUS_OK && render->from_table)
		status = table_files(options->from, &files, options->cancel, &error);
	else if (status == STATUS_OK)
		bad = files_collect(&files, options->path, options->n_paths, options->recursive, options->cancel);
	if (status != STATUS_OK)
		report_error("%s", error.text);
	int code = status || bad < 0 || !files.n ? EXIT_FAILED : -1;
	if (code < 0)
		code = check_output(render, &files);
	if (code < 0)
		code = show_files(render, &files);
	files_free(&files);
	return code == EXIT_DONE && bad ? EXIT_FAILED : code;
}

/* Options */

static int check_paths(struct render *render)
{
	struct options *options = render->options;
	bool table = false;
	for (int i = 0; i < options->n_paths; i++)
		table |= csv_is_name(options->path[i]);
	if (!table)
		return -1;
	if (options->n_paths > 1)
		return options_usage(COMMAND_RENDER, "expected one table and nothing beside it, found %d paths",
				     options->n_paths);
	if (options->from)
		return options_usage(COMMAND_RENDER, "--from and a table exclude each other");
	options->from = options->path[0];
	render->from_table = true;
	return -1;
}

static int check_picture(struct render *render, char **renamed)
{
	render->picture = render->options->picture;
	if (!render->picture)
		return -1;
	if (ends_with(render->picture, ".pfm"))
		return -1;
	if (!ends_with(render->picture, ".png"))
		return options_usage(COMMAND_RENDER, "expected -o FILE.png or -o FILE.pfm");
	if (image_has_png())
		return -1;
	if (asprintf(renamed, "%.*s.pfm", (int)(strlen(render->picture) - 4), render->picture) < 0)
		*renamed = NULL;
	char name[TEXT_QUOTE_SIZE];
	text_quote(*renamed ? *renamed : "", name, sizeof name);
	report_error("this build cannot write PNG, as it was made without libpng: the picture goes to '%s'", name);
	render->picture = *renamed;
	return *renamed ? -1 : EXIT_FAILED;
}

int cmd_render(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	char *renamed = NULL;
	int code = options_parse(&options, COMMAND_RENDER, argc, argv, cancel);
	if (code >= 0)
		return code;
	struct render render = {.options = &options, .output = csv_table_make(columns, RENDER_COLUMNS)};
	code = check_paths(&render);
	if (code < 0 && model_source_kind(&options) == SOURCE_GIVEN && !options_given(&options, "ndf"))
		options.fit.n_ndf = 1;
	if (code < 0)
		code = model_source_check(&options, true);
	if (code < 0)
		code = check_picture(&render, &renamed);
	if (code < 0) {
		render.sphere = (struct sphere_options){.size = options.size,
							.samples = options.pixel_samples,
							.seed = options.fit.seed,
							.threads = options.fit.threads,
							.cancel = cancel,
							.row_done = row_done,
							.user = &render};
		code = collect_and_show(&render);
	}
	environment_free(&render.environment);
	sheet_free(&render.sheet);
	csv_table_free(&render.output);
	free(renamed);
	return code;
}
