/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/page/page.h"
#include "fit/page/html.h"
#include "fit/page/page_style.h"
#include "fit/results/interval_text.h"
#include "fit/sources/row_options.h"

#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells */

/* A number of five digits or so, whole ones whole. */
static void put_shown(FILE *page, double x)
{
	if (isinf(x))
		fputs(x > 0 ? "\xe2\x88\x9e" : "\xe2\x88\x92\xe2\x88\x9e", page);
	else if (!isnan(x))
		fprintf(page, fabs(x) < 1e15 && x == rint(x) ? "%.0f" : "%.5g", x);
}

/* A table cell that sorts by its exact value, not yet ended. */
static void begin_number(FILE *page, double x, bool best)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(page, "<td class=\"n%s\" data-v=\"%s\">", best ? " best" : "",
		isinf(x) ? "Infinity" : csv_number(text, x));
	put_shown(page, x);
}

static void put_number(FILE *page, double x, bool best)
{
	begin_number(page, x, best);
	fputs("</td>", page);
}

static void put_text_cell(FILE *page, const char *text, bool is_long)
{
	fputs(is_long ? "<td class=\"long\">" : "<td>", page);
	html_text(page, text);
	fputs("</td>", page);
}

/* A table that scrolls by itself where it is wider than the page. of: NULL, or whose it is, which tells it from others. */
static void begin_table(FILE *page, const char *class, const char *label, const char *of)
{
	fputs("<section class=\"wide\" tabindex=\"0\" aria-label=\"", page);
	html_text(page, label);
	if (of) {
		fputs(", ", page);
		html_text(page, of);
	}
	fprintf(page, "\"><table class=\"%s\">\n<thead><tr>", class);
}

static void put_head(FILE *page, const char *text, const char *class, bool sorted)
{
	fprintf(page, "<th scope=\"col\"%s%s%s%s>", *class ? " class=\"" : "", class, *class ? "\"" : "",
		sorted ? " aria-sort=\"ascending\"" : "");
	html_text(page, text);
	fputs("</th>", page);
}

static void end_table(FILE *page)
{
	fputs("</tbody></table></section>\n", page);
}

char *page_part_path(const char *path, int part)
{
	char *file;
	return asprintf(&file, "%s-%d.png", path, part) < 0 ? NULL : file;
}

/* part: NULL, or what this part of the picture shows. */
static enum status put_image(FILE *page, const char *material, const struct page_picture *picture, const char *part,
			     const char *path, struct error *error)
{
	if (!path)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	fprintf(page, "<img loading=\"lazy\"%s alt=\"", picture->plot ? " class=\"plot\"" : "");
	if (material) {
		html_text(page, material);
		fputs(": ", page);
	}
	html_text(page, picture->alt);
	if (part)
		html_text(page, part);
	fputs("\" src=\"", page);
	const enum status status = html_file(page, path, picture->type, error);
	fputs("\">\n", page);
	return status;
}

static enum status put_picture(FILE *page, const char *material, const struct page_picture *picture,
			       struct error *error)
{
	enum status status = STATUS_OK;
	if (!picture->path)
		return status;
	fputs(picture->parts ? "<figure><div class=\"spheres\">\n" : "<figure>", page);
	if (!picture->parts)
		status = put_image(page, material, picture, NULL, picture->path, error);
	for (int p = 0; p < picture->parts && status == STATUS_OK; p++) {
		char *path = page_part_path(picture->path, p);
		status = put_image(page, material, picture, picture->part[p], path, error);
		free(path);
	}
	fputs(picture->parts ? "</div><figcaption>" : "<figcaption>", page);
	html_typeset(page, picture->caption);
	fputs("</figcaption></figure>\n", page);
	return status;
}

/* why: NULL if none is missing. */
static void put_missing(FILE *page, const char *why)
{
	if (!why)
		return;
	fputs("<p>Pictures are missing: ", page);
	html_text(page, why);
	fputs("</p>\n", page);
}

/* The beginning */

/* name: NULL where there are several. */
static void put_title(FILE *page, const char *name, size_t n)
{
	if (name)
		html_text(page, name);
	else
		fprintf(page, "%zu materials", n);
}

static void put_top(FILE *page, const char *name, size_t n)
{
	/* The page contains all it needs and fetches nothing. */
	fputs("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
	      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
	      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none';img-src data:;"
	      "style-src 'unsafe-inline';script-src 'unsafe-inline'\">\n"
	      "<meta name=\"color-scheme\" content=\"light dark\">\n"
	      "<link rel=\"icon\" href=\"data:,\">\n<title>stdfit: fits of ",
	      page);
	put_title(page, name, n);
	fprintf(page, "</title>\n<style>\n%s</style>\n</head>\n<body>\n<main>\n<h1>Fits of ", page_style);
	put_title(page, name, n);
	fputs("</h1>\n<p>Cook-Torrance models, diffuse terms and microfacet lobes, fitted to measured BRDFs. The "
	      "error "
	      "E is the sum of |measured \xe2\x88\x92 model| over that of measured, 0 for a perfect model and 1 for a "
	      "black "
	      "one.</p>\n",
	      page);
}

/* Mean, median, worst, wins of one NDF. value: room for one number a material. */
static void put_summary_row(FILE *page, const struct error_grid *grid, int ndf, double *value)
{
	size_t n = 0, wins = 0;
	for (size_t m = 0; m < grid->n; m++) {
		if (!isnan(grid->line[m].error[ndf]))
			value[n++] = grid->line[m].error[ndf];
		wins += grid->line[m].best == ndf;
	}
	char label[ERROR_GRID_LABEL];
	fputs("<tr><th scope=\"row\">", page);
	html_text(page, error_grid_label(grid, ndf, label));
	fputs("</th>", page);
	put_number(page, (double)n, false);
	put_number(page, n ? gsl_stats_mean(value, 1, n) : NAN, false);
	put_number(page, n ? gsl_stats_median(value, 1, n) : NAN, false);
	put_number(page, n ? gsl_stats_max(value, 1, n) : NAN, false);
	put_number(page, (double)wins, false);
	fputs("</tr>\n", page);
}

static enum status put_summary(FILE *page, const struct error_grid *grid)
{
	static const char *const head[] = {"NDF", "materials", "mean E", "median E", "worst E", "lowest E for"};
	double *value = calloc(grid->n + 1, sizeof(*value));
	if (!value)
		return STATUS_NO_MEMORY;
	fputs("<h2 id=\"summary\">Summary</h2>\n", page);
	begin_table(page, "summary", "Summary by NDF", NULL);
	for (size_t h = 0; h < sizeof head / sizeof *head; h++)
		put_head(page, head[h], h ? "n" : "", false);
	fputs("</tr></thead><tbody>\n", page);
	for (int n = 0; n < grid->n_ndf; n++)
		put_summary_row(page, grid, n, value);
	end_table(page);
	free(value);
	return STATUS_OK;
}

static char *const *best_row(const struct error_grid *grid, const struct error_line *line)
{
	for (size_t r = 0; r < line->material->n_rows && line->best >= 0; r++)
		if (!strcmp(line->material->row[r][RESULT_NDF], grid->ndf[line->best]))
			return line->material->row[r];
	return NULL;
}

static void put_material_row(FILE *page, const struct error_grid *grid, const struct error_line *line, bool divided)
{
	static const enum result_column shape[] = {RESULT_SIGMA, RESULT_GAMMA, RESULT_IOR};
	char *const *best = best_row(grid, line);
	fprintf(page,
		divided ? "<tr><th scope=\"row\"><a href=\"" PAGE_DIRECTORY "/%s.html\">"
			: "<tr><th scope=\"row\"><a href=\"#m-%s\">",
		line->material->file_name);
	html_text(page, line->material->name);
	fputs("</a></th>", page);
	if (grid->weights)
		put_text_cell(page, line->material->row[0][RESULT_WEIGHT], false);
	put_text_cell(page, best ? grid->ndf[line->best] : "", false);
	for (int n = 0; n < grid->n_ndf; n++)
		put_number(page, line->error[n], n == line->best);
	for (size_t s = 0; s < sizeof shape / sizeof *shape; s++)
		put_number(page, best ? result_number(best, shape[s]) : NAN, false);
	put_text_cell(page, best ? best[RESULT_STATUS] : line->material->row[0][RESULT_STATUS], true);
	fputs("</tr>\n", page);
}

static void put_materials(FILE *page, const struct error_grid *grid, bool divided)
{
	static const char *const shape[] = {"\xcf\x83", "\xce\xb3", "n"};
	fputs("<h2 id=\"materials\">Materials</h2>\n<p class=\"soft\">Lowest errors are bold; \xcf\x83, \xce\xb3 "
	      "and n are those of the best fit.</p>\n",
	      page);
	begin_table(page, "sortable", "Materials", NULL);
	put_head(page, "material", "", true);
	if (grid->weights)
		put_head(page, "weight", "", false);
	put_head(page, "best", "", false);
	for (int n = 0; n < grid->n_ndf; n++) {
		char head[ERROR_GRID_LABEL + 8], label[ERROR_GRID_LABEL];
		snprintf(head, sizeof head, "E, %s", error_grid_label(grid, n, label));
		put_head(page, head, "n", false);
	}
	for (size_t s = 0; s < sizeof shape / sizeof *shape; s++)
		put_head(page, shape[s], "n", false);
	put_head(page, "status", "", false);
	fputs("</tr></thead><tbody>\n", page);
	for (size_t m = 0; m < grid->n; m++)
		put_material_row(page, grid, &grid->line[m], divided);
	end_table(page);
}

enum status page_begin(struct page *page, FILE *file, const struct materials *materials,
		       const struct page_picture *errors, const char *missing, struct error *error)
{
	*page = (struct page){.file = file, .materials = materials, .divided = materials->n > PAGE_MATERIALS_MAX};
	if (error_grid_make(materials, &page->grid) != STATUS_OK)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	put_top(file, materials->n_distinct == 1 ? materials->material[0].name : NULL, materials->n_distinct);
	if (put_summary(file, &page->grid) != STATUS_OK)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	const enum status status = put_picture(file, NULL, errors, error);
	put_missing(file, missing);
	put_materials(file, &page->grid, page->divided);
	if (!page->divided)
		fputs("<h2 id=\"details\">Each material</h2>\n", file);
	return status;
}

void page_of_material(const struct page *page, size_t m, FILE *file, struct page *own)
{
	*own = *page;
	own->file = file;
	put_top(file, page->materials->material[m].name, 1);
	fprintf(file, "<p><a href=\"../index.html\">All %zu materials</a></p>\n", page->materials->n_distinct);
}

/* One material */

static const struct {
	enum result_column column;
	const char *name;
	enum interval_parameter interval; /* INTERVAL_PARAMETERS: it has none */
	bool always;                      /* else only where a fit of the material has it */
} parameters[] = {
	{RESULT_ERROR, "E", INTERVAL_PARAMETERS, true},
	{RESULT_SIGMA, "\xcf\x83", INTERVAL_SIGMA, true},
	{RESULT_SIGMA_X, "\xcf\x83 x", INTERVAL_PARAMETERS, false},
	{RESULT_SIGMA_Y, "\xcf\x83 y", INTERVAL_PARAMETERS, false},
	{RESULT_ANGLE, "angle", INTERVAL_ANGLE, false},
	{RESULT_GAMMA, "\xce\xb3", INTERVAL_GAMMA, true},
	{RESULT_IOR, "n", INTERVAL_IOR, true},
	{RESULT_F0_R, "F0 r", INTERVAL_PARAMETERS, false},
	{RESULT_F0_G, "g", INTERVAL_PARAMETERS, false},
	{RESULT_F0_B, "b", INTERVAL_PARAMETERS, false},
	{RESULT_F82_R, "F82 r", INTERVAL_PARAMETERS, false},
	{RESULT_F82_G, "g", INTERVAL_PARAMETERS, false},
	{RESULT_F82_B, "b", INTERVAL_PARAMETERS, false},
	{RESULT_F90_R, "F90 r", INTERVAL_PARAMETERS, false},
	{RESULT_F90_G, "g", INTERVAL_PARAMETERS, false},
	{RESULT_F90_B, "b", INTERVAL_PARAMETERS, false},
	{RESULT_KD_R, "kd r", INTERVAL_PARAMETERS, true},
	{RESULT_KD_G, "g", INTERVAL_PARAMETERS, true},
	{RESULT_KD_B, "b", INTERVAL_PARAMETERS, true},
	{RESULT_KG_R, "kg r", INTERVAL_PARAMETERS, false},
	{RESULT_KG_G, "g", INTERVAL_PARAMETERS, false},
	{RESULT_KG_B, "b", INTERVAL_PARAMETERS, false},
	{RESULT_EXPONENT, "exponent", INTERVAL_EXPONENT, false},
	{RESULT_KS_R, "ks r", INTERVAL_PARAMETERS, true},
	{RESULT_KS_G, "g", INTERVAL_PARAMETERS, true},
	{RESULT_KS_B, "b", INTERVAL_PARAMETERS, true},
	{RESULT_KS2_R, "ks2 r", INTERVAL_PARAMETERS, false},
	{RESULT_KS2_G, "g", INTERVAL_PARAMETERS, false},
	{RESULT_KS2_B, "b", INTERVAL_PARAMETERS, false},
	{RESULT_SIGMA2, "\xcf\x83 2", INTERVAL_SIGMA2, false},
	{RESULT_GAMMA2, "\xce\xb3 2", INTERVAL_GAMMA2, false},
};
enum { PARAMETERS = sizeof parameters / sizeof *parameters };

static bool is_interval(enum result_column column)
{
	return column >= RESULT_SIGMA_LO && column <= RESULT_OTHER_BINS;
}

/* What is shown elsewhere, or is the same for all rows of a material. */
static bool is_certainty(enum result_column column)
{
	static const enum result_column elsewhere[] = {RESULT_MATERIAL,  RESULT_NDF,     RESULT_PARAMS,  RESULT_GAF,
						       RESULT_FRESNEL,   RESULT_LAMBDA,  RESULT_WEIGHT,  RESULT_BINS,
						       RESULT_MAX_THETA, RESULT_PATH,    RESULT_INPUT,   RESULT_OPTIONS,
						       RESULT_VERSION,   RESULT_SECONDS, RESULT_SUSPECTS};
	if (is_interval(column))
		return false;
	for (int p = 0; p < PARAMETERS; p++)
		if (parameters[p].column == column)
			return false;
	for (size_t e = 0; e < sizeof elsewhere / sizeof *elsewhere; e++)
		if (elsewhere[e] == column)
			return false;
	return true;
}

static void put_row_head(FILE *page, char *const *row)
{
	fputs("<tr><th scope=\"row\">", page);
	html_text(page, row[RESULT_NDF]);
	fputs("</th>", page);
}

/* A row that knows its model as options of eval, export, render and synth: the script gives it a button that copies them. */
static void begin_parameters_row(FILE *page, char *const *row)
{
	char *options = row_options(row);
	fputs("<tr", page);
	if (options) {
		fputs(" data-options=\"", page);
		html_text(page, options);
		fputc('"', page);
	}
	free(options);
	fputs("><th scope=\"row\">", page);
	html_text(page, row[RESULT_NDF]);
	fputs("</th>", page);
}

static bool has_cell(const struct material *material, enum result_column column)
{
	for (size_t r = 0; r < material->n_rows; r++)
		if (*material->row[r][column])
			return true;
	return false;
}

static bool is_shown(const struct material *material, int p)
{
	return parameters[p].always || has_cell(material, parameters[p].column);
}

/* A parameter's value, below it where else it may lie. */
static void put_parameter(FILE *page, char *const *row, int p)
{
	char text[INTERVAL_TEXT_SIZE] = "";
	if (parameters[p].interval < INTERVAL_PARAMETERS)
		interval_text(text, row, parameters[p].interval);
	begin_number(page, result_number(row, parameters[p].column), false);
	if (*text) {
		fputs("<span class=\"range\">", page);
		html_text(page, text);
		fputs("</span>", page);
	}
	fputs("</td>", page);
}

/* What has no column of its own. */
static void put_further(FILE *page, char *const *row)
{
	static const struct {
		enum interval_parameter interval;
		const char *name;
	} own[] = {{INTERVAL_K, "k"}, {INTERVAL_RATIO, "sigma_x/sigma_y"}};
	enum { SHORT_PARAMS = 120 };
	char text[INTERVAL_TEXT_SIZE];
	fputs("<td class=\"long\">", page);
	html_text(page, strlen(row[RESULT_PARAMS]) <= SHORT_PARAMS ? row[RESULT_PARAMS]
								   : "the values of D: see the result table");
	for (size_t i = 0; i < sizeof own / sizeof *own; i++) {
		if (!*interval_text(text, row, own[i].interval))
			continue;
		fprintf(page, "<span class=\"range\">%s ", own[i].name);
		html_text(page, text);
		fputs("</span>", page);
	}
	fputs("</td>", page);
}

static void put_other_bins(FILE *page, char *const *row)
{
	char moves[OTHER_BINS_SIZE];
	if (!*other_bins_text(moves, row))
		return;
	fputs("<p>", page);
	html_text(page, row[RESULT_NDF]);
	fputs(" with entries at the centres of the bins: ", page);
	html_text(page, moves);
	fputs(".</p>\n", page);
}

static void put_parameters(FILE *page, const struct material *material)
{
	fputs("<h4>Parameters</h4>\n", page);
	begin_table(page, "parameters", "Parameters", material->file_name);
	put_head(page, "NDF", "", false);
	for (int p = 0; p < PARAMETERS; p++)
		if (is_shown(material, p))
			put_head(page, parameters[p].name, "n", false);
	put_head(page, "further", "long", false);
	fputs("</tr></thead><tbody>\n", page);
	for (size_t r = 0; r < material->n_rows; r++) {
		char *const *row = material->row[r];
		begin_parameters_row(page, row);
		for (int p = 0; p < PARAMETERS; p++)
			if (is_shown(material, p))
				put_parameter(page, row, p);
		put_further(page, row);
		fputs("</tr>\n", page);
	}
	end_table(page);
	if (has_cell(material, RESULT_SIGMA_LO) || has_cell(material, RESULT_IOR_LO))
		fputs("<p class=\"soft\">Below a value: where it may lie, the other parameters refitted, while E stays "
		      "within the per cent that --intervals names among the options; &lt;= and &gt;= are ends of the "
		      "domain.</p>\n",
		      page);
	for (size_t r = 0; r < material->n_rows; r++)
		put_other_bins(page, material->row[r]);
}

/* All else that the result table says of each fit, a line a fit. Columns that are empty for all are left out. */
static void put_certainty(FILE *page, const struct material *material)
{
	bool shown[RESULT_COLUMNS] = {false};
	for (enum result_column c = 0; c < RESULT_COLUMNS; c++)
		shown[c] = is_certainty(c) && has_cell(material, c);
	fputs("<h4>How sure, and how near</h4>\n", page);
	begin_table(page, "certainty", "Certainty and other errors", material->file_name);
	put_head(page, "NDF", "", false);
	for (enum result_column c = 0; c < RESULT_COLUMNS; c++)
		if (shown[c])
			put_head(page, result_columns[c].name, result_columns[c].number ? "n" : "", false);
	fputs("</tr></thead><tbody>\n", page);
	for (size_t r = 0; r < material->n_rows; r++) {
		put_row_head(page, material->row[r]);
		for (enum result_column c = 0; c < RESULT_COLUMNS; c++) {
			if (shown[c] && result_columns[c].number)
				put_number(page, result_number(material->row[r], c), false);
			else if (shown[c])
				put_text_cell(page, material->row[r][c], c == RESULT_STATUS);
		}
		fputs("</tr>\n", page);
	}
	end_table(page);
	fputs("<p class=\"soft\">status, undetermined: parameters over whose whole domain the error, the others "
	      "refitted, moves by less than 0.1 %; starts: local searches; starts_agreeing: how many ended within "
	      "0.1 % of the best; at_bound: parameters that ended on a bound of their domain; error_, rms_ and "
	      "log_: the same parameters under other weights and metrics; albedo_: the largest share of the light "
	      "from one direction that the model sends back; energy, gain: more than it gets.</p>\n",
	      page);
}

static void put_origin(FILE *page, const struct material *material)
{
	static const enum result_column column[] = {RESULT_OPTIONS, RESULT_VERSION, RESULT_PATH, RESULT_INPUT,
						    RESULT_SUSPECTS};
	static const char *const name[] = {"options", "fitted by stdfit", "file", "size and hash",
					   "what looks wrong in it"};
	fputs("<dl>", page);
	for (size_t c = 0; c < sizeof column / sizeof *column; c++) {
		if (column[c] == RESULT_SUSPECTS && !*material->row[0][RESULT_SUSPECTS])
			continue;
		fprintf(page, "<dt>%s</dt><dd>", name[c]);
		html_text(page, *material->row[0][column[c]] ? material->row[0][column[c]] : "not known");
		fputs("</dd>", page);
	}
	fputs("</dl>\n", page);
}

/* The best NDF and its error, behind the name. */
static void put_best(FILE *page, const struct error_grid *grid, const struct error_line *line)
{
	fputs(" <span class=\"soft\">", page);
	if (line->best >= 0) {
		fputs("best: ", page);
		html_text(page, grid->ndf[line->best]);
		fputs(", E ", page);
		put_shown(page, line->error[line->best]);
		fputs(" (weight ", page);
		html_text(page, line->material->row[0][RESULT_WEIGHT]);
		fputs(")", page);
	} else {
		fputs("no fit", page);
	}
	fputs("</span>", page);
}

/* Whether a fit of the same file under the weight that pictures agree with is on the page: then it stands next to this one. */
static bool has_better_weight(const struct page *page, size_t m)
{
	const struct materials *materials = page->materials;
	const char *path = materials->material[m].row[0][RESULT_PATH];
	const size_t first = m < WEIGHT_COUNT ? 0 : m - WEIGHT_COUNT;
	for (size_t i = first; i < materials->n && i <= m + WEIGHT_COUNT; i++) {
		char *const *row = materials->material[i].row[0];
		if (!strcmp(row[RESULT_PATH], path) && !strcmp(row[RESULT_WEIGHT], weight_name(WEIGHT_SOLID_ANGLE)))
			return true;
	}
	return false;
}

static void put_hint(const struct page *page, size_t m)
{
	char *const *best = best_row(&page->grid, &page->grid.line[m]);
	if (!best || !result_looks_wrong(best) || has_better_weight(page, m))
		return;
	fputs("<p class=\"hint\">A fit with <code>--weight solid-angle</code> would most likely look much more like "
	      "the "
	      "measured one: under that weight the error of this fit is ",
	      page->file);
	put_shown(page->file, result_number(best, RESULT_ERROR_SOLID_ANGLE));
	fputs(".</p>\n", page->file);
}

enum status page_material(const struct page *page, size_t m, const struct page_picture *picture, int n_pictures,
			  const char *missing, struct error *error)
{
	const struct material *material = &page->materials->material[m];
	FILE *file = page->file;
	enum status status = STATUS_OK;
	fprintf(file, "<details class=\"material\" id=\"m-%s\"%s><summary><h3>", material->file_name,
		page->divided ? " open" : "");
	html_text(file, material->name);
	fputs("</h3>", file);
	put_best(file, &page->grid, &page->grid.line[m]);
	fputs("</summary>\n", file);
	for (int p = 0; p < n_pictures && status == STATUS_OK; p++)
		status = put_picture(file, material->name, &picture[p], error);
	put_missing(file, missing);
	put_hint(page, m);
	put_parameters(file, material);
	put_certainty(file, material);
	put_origin(file, material);
	fputs("</details>\n", file);
	return status;
}

void page_end(const struct page *page)
{
	fprintf(page->file,
		"</main>\n<footer><p class=\"soft\">Made by stdfit %s.</p></footer>\n<script>\n%s</script>\n</body>\n"
		"</html>\n",
		STDFIT_VERSION, page_script);
}

void page_free(struct page *page)
{
	error_grid_free(&page->grid);
}
