/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit render - spheres of measured materials beside spheres of their models, and how much their pictures differ. */
#include "data_readers/measurement_read.h"
#include "data_readers/resample.h"
#include "data_readers/text_quote.h"
#include "fit/cli/files.h"
#include "fit/cli/lighting.h"
#include "fit/cli/messages.h"
#include "fit/cli/outputs.h"
#include "fit/cli/progress.h"
#include "fit/commands/commands.h"
#include "fit/render/glass.h"
#include "fit/render/pictures.h"
#include "fit/render/sheet.h"
#include "fit/results/store.h"
#include "fit/sources/shown_models.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum render_column {
	RENDER_MATERIAL,
	RENDER_NDF,
	RENDER_WEIGHT,
	RENDER_ERROR,
	RENDER_RMSE,
	RENDER_DELTA_E,
	RENDER_SSIM,
	RENDER_COLUMNS
};

static const struct csv_column columns[RENDER_COLUMNS] = {
	[RENDER_MATERIAL] = {"material", false}, [RENDER_NDF] = {"ndf", false},  [RENDER_WEIGHT] = {"weight", false},
	[RENDER_ERROR] = {"error", true},        [RENDER_RMSE] = {"rmse", true}, [RENDER_DELTA_E] = {"delta_e", true},
	[RENDER_SSIM] = {"ssim", true},
};

struct render {
	struct options *options;
	const char *picture; /* file; NULL: none */
	bool from_table;     /* the files are those of the rows of --from */
	struct environment environment;
	struct sphere_options sphere;
	struct shown_columns columns; /* of the sheet, behind that of the measured table */
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
	/* The error of given parameters is not known, and under no weight. */
	const char *weight = isnan(model->error) ? "" : weight_name(model->fit.criterion.weight);
	const char *cell[RENDER_COLUMNS] = {material, ndf_name(model->model.ndf.class), weight};
	for (int c = RENDER_ERROR; c < RENDER_COLUMNS; c++)
		cell[c] = csv_number(text[c], number[c]);
	return csv_table_add(&render->output, cell);
}

/* In the next row of the sheet. */
static void draw(struct render *render, const char *material, const struct shown_models *shown,
		 const struct pictures *pictures)
{
	struct sheet *sheet = &render->sheet;
	const int row = render->n_drawn++;
	int column[SHOWN_MAX];
	shown_columns_find(&render->columns, shown, column);
	sheet_sphere(sheet, 0, row, &pictures->measured, material);
	if (sheet->differences)
		sheet_legend(sheet, row);
	for (int i = 0; i < shown->n; i++) {
		char label[64];
		if (column[i] < 0)
			continue;
		sheet_error_label(sheet, &pictures->error[i], label, sizeof label);
		sheet_sphere(sheet, 1 + column[i], row, &pictures->sphere[i], label);
		if (sheet->differences)
			sheet_difference(sheet, 1 + column[i], row, &pictures->sphere[i], &pictures->measured);
	}
}

/* Renders the models of a table that has been read, draws and reports them. */
static enum status show_models(struct render *render, const char *path, const struct measurement *measurement,
			       const struct shown_models *shown)
{
	struct pictures pictures;
	struct pictures_model model[SHOWN_MAX];
	char *material = result_material(path);
	for (int i = 0; i < shown->n; i++)
		model[i] = (struct pictures_model){&shown->model[i]->model, shown->model[i]->error};
	enum status status =
		material ? pictures_render(measurement, shown->model[0]->fit.criterion.bins, model, shown->n,
					   render->options->sampling, &render->environment, &render->sphere, &pictures)
			 : STATUS_NO_MEMORY;
	for (int i = 0; i < shown->n && status == STATUS_OK; i++)
		status = add_row(render, material, shown->model[i], &pictures.error[i]);
	if (status == STATUS_OK && render->picture)
		draw(render, material, shown, &pictures);
	pictures_free(&pictures);
	free(material);
	return status;
}

static enum status show_source(struct render *render, const char *path, struct model_source *source,
			       struct error *error)
{
	struct shown_models shown;
	enum status status = shown_models_choose(source, path, render->from_table, &shown, error);
	if (status == STATUS_OK && !source->measurement.value[0])
		status = measurement_read(path, &shown.model[0]->reading, &source->measurement, error);
	for (int i = 0; i < shown.n && status == STATUS_OK && render->from_table; i++)
		status = result_check_input(shown.model[i]->input, &source->measurement, path, error);
	if (status != STATUS_OK)
		return status;
	status = measurement_fill_isotropic(&source->measurement, shown.model[0]->fit.criterion.bins,
					    render->options->fit.threads);
	if (status == STATUS_OK)
		status = show_models(render, path, &source->measurement, &shown);
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

static enum status write_picture(const struct render *render, struct error *error)
{
	const bool png =
		outputs_end_with(render->picture, ".png") || (render->options->to_standard_output && image_has_png());
	return png ? image_write_png(render->picture, &render->sheet.image, error)
		   : image_write_pfm(render->picture, &render->sheet.image, error);
}

/* A model alone: the picture is all there is to show. */
static enum status draw_model(struct render *render, const struct source_model *model, const struct sphere *sphere,
			      struct error *error)
{
	enum status status = store_probe(render->picture, error);
	if (status == STATUS_OK && sheet_init(&render->sheet, render->options->size, 1, 1, false) != STATUS_OK)
		status = error_set(error, STATUS_NO_MEMORY, "out of memory");
	if (status != STATUS_OK)
		return status;
	sheet_title(&render->sheet, 0, ndf_name(model->model.ndf.class));
	sheet_sphere(&render->sheet, 0, 0, sphere, model->material ? model->material : "");
	return write_picture(render, error);
}

static int show_model(struct render *render)
{
	const struct options *options = render->options;
	struct model_source source;
	struct sphere sphere = {.coverage = NULL};
	struct error error;
	enum status status = lighting_make(options, &render->environment, &error);
	if (status == STATUS_DOMAIN)
		return options_usage(COMMAND_RENDER, "%s", error.text);
	if (status == STATUS_OK)
		status = model_source_read(options, NULL, &source, &error);
	if (status == STATUS_OK) {
		render->progress = progress_start((size_t)options->size, "rows", options->quiet);
		status = pictures_render_model(&source.model[0].model, options->sampling, &render->environment,
					       &render->sphere, &sphere);
		progress_erase(&render->progress);
		status = status != STATUS_OK ? error_set(&error, status, "%s", status_str(status))
					     : draw_model(render, &source.model[0], &sphere, &error);
		sphere_free(&sphere);
		model_source_free(&source);
	}
	if (*options->cancel)
		return EXIT_INTERRUPTED;
	if (status != STATUS_OK)
		report_error("%s", error.text);
	return status != STATUS_OK ? EXIT_FAILED : EXIT_DONE;
}

/* All */

static enum status prepare_sheet(struct render *render, size_t n, struct error *error)
{
	const struct options *options = render->options;
	enum status status = store_probe(render->picture, error);
	if (status != STATUS_OK)
		return status;
	status = n < IMAGE_SIZE_MAX ? sheet_init(&render->sheet, options->size, 1 + render->columns.n, (int)n,
						 n == 1 || options->difference)
				    : STATUS_DOMAIN;
	if (status != STATUS_OK)
		return error_set(
			error, status, "%s",
			status == STATUS_DOMAIN
				? "the picture would be too large: expected fewer materials or a smaller --size"
				: status_str(status));
	sheet_title(&render->sheet, 0, "measured");
	for (int c = 0; c < render->columns.n; c++) {
		const struct shown_columns *shown = &render->columns;
		char title[64];
		snprintf(title, sizeof title, "%s%s%s", shown->ndf[c], shown->weights ? " " : "",
			 shown->weights ? weight_name(shown->weight[c]) : "");
		sheet_title(&render->sheet, 1 + c, title);
	}
	return STATUS_OK;
}

/* Shows the files, reports them, and writes the picture unless nothing or not everything could be tried. */
static int show_files(struct render *render, const struct files *files)
{
	const struct options *options = render->options;
	struct error error;
	size_t failed = 0;
	enum status status = shown_columns_plan(&render->columns, options, files, render->from_table, &error);
	if (status == STATUS_OK && render->picture)
		status = prepare_sheet(render, files->n, &error);
	if (status != STATUS_OK) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	render->progress =
		progress_start(files->n * (size_t)((1 + render->columns.n) * options->size), "rows", options->quiet);
	for (size_t i = 0; i < files->n && !*options->cancel; i++)
		failed += show_file(render, files->path[i]) != STATUS_OK;
	progress_erase(&render->progress);
	if (model_source_kind(options) == SOURCE_FIT && failed < files->n && !*options->cancel)
		options_say_weight(options);
	report_output(&render->output, options->to_standard_output ? SHOW_NOTHING : options_show(options),
		      report_table);
	if (*options->cancel)
		return EXIT_INTERRUPTED;
	sheet_end(&render->sheet, render->n_drawn);
	if (render->picture && failed < files->n && write_picture(render, &error) != STATUS_OK) {
		report_error("%s", error.text);
		return EXIT_FAILED;
	}
	return failed ? EXIT_FAILED : EXIT_DONE;
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
		status = shown_files(options->from, &files, options->cancel, &error);
	else if (status == STATUS_OK)
		bad = files_collect(&files, options->path, options->n_paths, options->recursive, options->cancel);
	if (status != STATUS_OK)
		report_error("%s", error.text);
	int code = status != STATUS_OK || bad < 0 || !files.n ? EXIT_FAILED : -1;
	if (code < 0)
		code = outputs_check(options, files.path, files.n);
	if (code < 0)
		code = show_files(render, &files);
	files_free(&files);
	return code == EXIT_DONE && bad ? EXIT_FAILED : code;
}

/* Glass */

static enum status glass_of(const struct options *options, const struct ndf_class *class, struct glass *glass,
			    struct error *error)
{
	const struct fit_options *fit = &options->fit;
	struct ndf ndf;
	enum status status = ndf_init(&ndf, class, fit->sigma, fit->sigma, isnan(fit->gamma) ? 2 : fit->gamma);
	if (status != STATUS_OK)
		return error_set(error, status, "--ndf %s does not allow these parameters", ndf_name(class));
	status = glass_init(glass, &ndf, fit->criterion.gaf, isnan(fit->ior) ? 1.5 : fit->ior, options->multiple,
			    options->sampling);
	if (status != STATUS_OK)
		error_set(error, status, "there is no glass of --ndf %s with these options", ndf_name(class));
	return status;
}

static enum status draw_glass(struct render *render, struct error *error)
{
	const struct options *options = render->options;
	enum status status = sheet_init(&render->sheet, options->size, options->fit.n_ndf, 1, false);
	if (status != STATUS_OK)
		return error_set(error, status, "the picture would be too large: expected a smaller --size");
	for (int i = 0; i < options->fit.n_ndf && status == STATUS_OK; i++) {
		struct glass glass;
		struct sphere sphere;
		status = glass_of(options, options->fit.ndf[i], &glass, error);
		if (status != STATUS_OK)
			return status;
		status = sphere_render_glass(&glass, &render->environment, &render->sphere, &sphere);
		if (status != STATUS_OK)
			return error_set(error, status, "%s", status_str(status));
		sheet_title(&render->sheet, i, ndf_name(options->fit.ndf[i]));
		sheet_sphere(&render->sheet, i, 0, &sphere, options->multiple ? "multiple" : "single");
		sphere_free(&sphere);
	}
	return status;
}

static int show_glass(struct render *render)
{
	const struct options *options = render->options;
	struct error error;
	enum status status = lighting_make(options, &render->environment, &error);
	if (status == STATUS_DOMAIN)
		return options_usage(COMMAND_RENDER, "%s", error.text);
	if (status == STATUS_OK)
		status = store_probe(render->picture, &error);
	render->progress = progress_start((size_t)options->fit.n_ndf * (size_t)options->size, "rows", options->quiet);
	if (status == STATUS_OK)
		status = draw_glass(render, &error);
	progress_erase(&render->progress);
	if (status == STATUS_OK)
		status = write_picture(render, &error);
	if (*options->cancel)
		return EXIT_INTERRUPTED;
	if (status != STATUS_OK)
		report_error("%s", error.text);
	return status == STATUS_OK ? EXIT_DONE : EXIT_FAILED;
}

/* Options */

static int check_glass_shape(const struct options *options)
{
	const struct fit_options *fit = &options->fit;
	bool shaped = false;
	for (int i = 0; i < fit->n_ndf; i++)
		shaped |= ndf_has_gamma(fit->ndf[i]);
	if (!options_given(options, "sigma") || !isnan(fit->sigma_y))
		return options_usage(COMMAND_RENDER, "--transmission needs --sigma with one number");
	if (shaped != options_given(options, "gamma"))
		return options_usage(COMMAND_RENDER, shaped ? "--ndf %s needs --gamma" : "--ndf %s has no --gamma",
				     ndf_name(fit->ndf[0]));
	return -1;
}

static int check_glass(const struct options *options)
{
	static const char *const useful[] = {"transmission", "multiple", "ndf",         "sigma",   "gamma",    "ior",
					     "gaf",          "output",   "environment", "light",   "exposure", "size",
					     "samples",      "sampling", "seed",        "threads", "quiet",    NULL};
	const char *ignored = options_given_beside(options, useful);
	if (options->multiple && !options->transmission)
		return options_usage(COMMAND_RENDER, "--multiple means nothing without --transmission");
	if (!options->transmission)
		return -1;
	if (options->n_paths)
		return options_usage(COMMAND_RENDER, "--transmission shows no files, found %d", options->n_paths);
	if (options->multiple && options_given(options, "gaf"))
		ignored = "gaf";
	if (options->multiple && options_given(options, "sampling"))
		ignored = "sampling";
	if (ignored)
		return options_usage(COMMAND_RENDER, "--%s means nothing with --%s", ignored,
				     options->multiple ? "multiple" : "transmission");
	if (!options->picture)
		return options_usage(COMMAND_RENDER, "--transmission needs -o");
	if (options->fit.criterion.gaf == GAF_V_GROOVE)
		return options_usage(COMMAND_RENDER, "--gaf v-groove is of reflection alone");
	if (options->fit.ior < FIT_IOR_MIN || options_index_per_channel(options))
		return options_usage(COMMAND_RENDER, "--ior of glass is one number, %g at least", FIT_IOR_MIN);
	return check_glass_shape(options);
}

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

/* Without a measurement there is nothing to fit, to compare, or to say in a table. */
static int check_alone(const struct options *options)
{
	static const char *const of_tables[] = {"json", "table", "recursive", "difference",      "quantity", "gamut",
						"bins", "row",   "max-theta", "zero-is-missing", NULL};
	const bool json = options->from && outputs_end_with(options->from, ".json");
	if (model_source_kind(options) != SOURCE_GIVEN && !json)
		return options_usage(COMMAND_RENDER,
				     "expected PATH..., found nothing; or a model: --kd and --ks, or --from FILE.json");
	for (int i = 0; of_tables[i]; i++)
		if (options_given(options, of_tables[i]))
			return options_usage(COMMAND_RENDER, "--%s means nothing without a measurement", of_tables[i]);
	if (!options->picture)
		return options_usage(COMMAND_RENDER, "a model without a measurement needs -o FILE.png");
	return -1;
}

static int check_picture(struct render *render, char **renamed)
{
	render->picture = render->options->picture;
	if (!render->picture && render->options->difference)
		return options_usage(COMMAND_RENDER, "--difference needs -o FILE, the picture to show it in");
	if (!render->picture)
		return -1;
	if (outputs_standard(render->picture)) {
		if (render->options->json || render->options->readable)
			return options_usage(COMMAND_RENDER, "--json and --table need standard output, as does -o -");
		render->options->to_standard_output = true;
		return -1;
	}
	if (outputs_end_with(render->picture, ".pfm"))
		return -1;
	if (!outputs_end_with(render->picture, ".png"))
		return options_usage(COMMAND_RENDER, "expected -o FILE.png, -o FILE.pfm or -o -");
	if (image_has_png())
		return -1;
	if (asprintf(renamed, "%.*s.pfm", (int)(strlen(render->picture) - 4), render->picture) < 0)
		*renamed = NULL;
	char name[TEXT_QUOTE_SIZE];
	text_quote(*renamed ? *renamed : "", name, sizeof name);
	report_error("this build cannot write PNG, as it was made without libpng: the picture goes to '%s'", name);
	render->picture = render->options->picture = *renamed;
	return *renamed ? -1 : EXIT_FAILED;
}

static int show(struct render *render)
{
	if (render->options->transmission)
		return show_glass(render);
	return render->options->n_paths ? collect_and_show(render) : show_model(render);
}

int cmd_render(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	char *renamed = NULL;
	int code = options_parse(&options, COMMAND_RENDER, argc, argv, cancel);
	if (code >= 0)
		return code;
	struct render render = {.options = &options, .output = csv_table_make(columns, RENDER_COLUMNS)};
	code = check_glass(&options);
	if (code < 0)
		code = check_paths(&render);
	if (code < 0 && (options.transmission || model_source_kind(&options) == SOURCE_GIVEN) &&
	    !options_given(&options, "ndf"))
		options.fit.n_ndf = 1;
	if (code < 0 && !options.transmission)
		code = model_source_check(&options, true);
	if (code < 0 && !options.n_paths && !options.transmission)
		code = check_alone(&options);
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
		code = show(&render);
	}
	environment_free(&render.environment);
	sheet_free(&render.sheet);
	csv_table_free(&render.output);
	free(renamed);
	return code;
}
