/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit compare - the NDFs side by side: errors per material, and what they come to in all. */
#include "data_readers/text_quote.h"
#include "fit/cli/messages.h"
#include "fit/cli/report.h"
#include "fit/commands/commands.h"
#include "fit/results/store.h"
#include "fit/sources/batch.h"
#include "fit/sources/row_pictures.h"

#include <gsl/gsl_statistics_double.h>
#include <stdlib.h>
#include <string.h>

/* Columns: material, one error per NDF, winner, gains, distances from the floor, errors of pictures. */
enum { MOST_VALUES = 4 * FIT_NDFS_MAX + 2, COLUMNS_MAX = MOST_VALUES + 2, NAME_SIZE = 64 };

/* A column that follows from two errors: how much lower that of `of` is than that of `over`, or, above the floor, how
 * much higher; percent of the latter. */
struct relation {
	const char *of, *over;
	bool above;
};

struct comparison {
	int n_ndf;
	const char *ndf[FIT_NDFS_MAX]; /* names, borrowed from the rows */
	int n_relations;
	bool pictures;
	int n_values; /* the errors, these, and per NDF delta E and SSIM of its picture if there are pictures */
	struct relation relation[FIT_NDFS_MAX + 2];
	char column_name[MOST_VALUES][NAME_SIZE];
	struct csv_column column[COLUMNS_MAX];
	double *value[MOST_VALUES]; /* column by column; one per material, NaN = none */
	size_t n_materials;
	const struct options *options;
	struct environment light; /* of the pictures */
	size_t n_failed;          /* materials without pictures */
	int wins[FIT_NDFS_MAX], ties;
	struct csv_table table;
};

/* The piecewise-linear NDF is no rival but a bound: what any isotropic NDF could reach. */
static const char floor_ndf[] = "pl";

/* The place of an NDF in the list; -1 when it is not there. */
static int ndf_place(const struct comparison *c, const char *ndf)
{
	for (int i = 0; i < c->n_ndf; i++)
		if (!strcmp(c->ndf[i], ndf))
			return i;
	return -1;
}

/* Finds the NDFs of the rows, in the order in which they come first. */
static enum status collect_ndfs(struct comparison *c, const struct csv_table *rows, struct error *error)
{
	for (size_t i = 0; i < rows->n_rows; i++) {
		const char *ndf = rows->row[i][RESULT_NDF];
		if (ndf_place(c, ndf) >= 0)
			continue;
		if (c->n_ndf == FIT_NDFS_MAX)
			return error_set(error, STATUS_UNSUPPORTED, "expected at most %d NDFs", FIT_NDFS_MAX);
		c->ndf[c->n_ndf++] = ndf;
	}
	return STATUS_OK;
}

static void set_relations(struct comparison *c)
{
	c->relation[c->n_relations++] = (struct relation){"std", "ggx", false};
	c->relation[c->n_relations++] = (struct relation){"std", "beckmann", false};
	for (int i = 0; i < c->n_ndf && ndf_place(c, floor_ndf) >= 0; i++)
		if (strcmp(c->ndf[i], floor_ndf))
			c->relation[c->n_relations++] = (struct relation){c->ndf[i], floor_ndf, true};
	c->n_values = c->n_ndf + c->n_relations + (c->pictures ? 2 * c->n_ndf : 0);
}

/* The first of the columns of pictures: delta E of each NDF, then SSIM. */
static int first_picture(const struct comparison *c)
{
	return c->n_ndf + c->n_relations;
}

static void name_column(struct comparison *c, int i, char name[NAME_SIZE])
{
	const int picture = i - first_picture(c);
	const struct relation *r = &c->relation[i >= c->n_ndf && picture < 0 ? i - c->n_ndf : 0];
	if (i < c->n_ndf)
		snprintf(name, NAME_SIZE, "error_%s", c->ndf[i]);
	else if (picture >= c->n_ndf)
		snprintf(name, NAME_SIZE, "ssim_%s", c->ndf[picture - c->n_ndf]);
	else if (picture >= 0)
		snprintf(name, NAME_SIZE, "delta_e_%s", c->ndf[picture]);
	else if (r->above)
		snprintf(name, NAME_SIZE, "%s_above_%s", r->of, r->over);
	else
		snprintf(name, NAME_SIZE, "gain_over_%s", r->over);
}

static enum status name_columns(struct comparison *c, size_t n_rows)
{
	int n = 0;
	c->column[n++] = (struct csv_column){"material", false};
	for (int i = 0; i < c->n_values; i++) {
		if (i == c->n_ndf)
			c->column[n++] = (struct csv_column){"winner", false};
		name_column(c, i, c->column_name[i]);
		c->column[n++] = (struct csv_column){c->column_name[i], true};
	}
	c->table = csv_table_make(c->column, n);
	for (int i = 0; i < c->n_values; i++) {
		c->value[i] = calloc(n_rows + 1, sizeof(double));
		if (!c->value[i])
			return STATUS_NO_MEMORY;
	}
	return STATUS_OK;
}

/* A line: numbers for the value columns, text for the two others. */
static enum status add_line(struct comparison *c, const char *material, const double *number, const char *winner)
{
	char text[MOST_VALUES][CSV_NUMBER_SIZE];
	const char *cell[COLUMNS_MAX];
	int n = 0;
	cell[n++] = material;
	for (int i = 0; i < c->n_values; i++) {
		if (i == c->n_ndf)
			cell[n++] = winner;
		cell[n++] = csv_number(text[i], number[i]);
	}
	return csv_table_add(&c->table, cell);
}

/* The NDF of the lowest error; "tie" when others have the same, "" when there is no error at all. */
static const char *find_winner(struct comparison *c, const double *error)
{
	int best = -1, same = 0;
	for (int i = 0; i < c->n_ndf; i++) {
		if (isnan(error[i]) || (c->n_ndf > 1 && !strcmp(c->ndf[i], floor_ndf)))
			continue;
		if (best < 0 || error[i] < error[best]) {
			best = i;
			same = 1;
		} else {
			same += error[i] == error[best];
		}
	}
	if (best < 0)
		return "";
	c->wins[best] += same == 1;
	c->ties += same > 1;
	return same > 1 ? "tie" : c->ndf[best];
}

static double find_relation(const struct comparison *c, const double *error, const struct relation *r)
{
	const int of = ndf_place(c, r->of), over = ndf_place(c, r->over);
	if (of < 0 || over < 0)
		return NAN;
	return r->above ? 100 * (error[of] / error[over] - 1) : 100 * (1 - error[of] / error[over]);
}

/* Numbers for the columns of pictures. What cannot be rendered is told and left empty. */
static void add_pictures(struct comparison *c, char **const *rows, size_t n, double *number)
{
	struct picture_error *errors = calloc(n, sizeof *errors);
	struct error error = {"out of memory"};
	const int first = first_picture(c);
	for (int i = 0; i < 2 * c->n_ndf; i++)
		number[first + i] = NAN;
	const enum status status =
		errors ? row_pictures_errors(rows, n, &c->options->fit, &c->light, errors, &error) : STATUS_NO_MEMORY;
	for (size_t i = 0; i < n && errors; i++) {
		const int ndf = ndf_place(c, rows[i][RESULT_NDF]);
		number[first + ndf] = errors[i].delta_e;
		number[first + c->n_ndf + ndf] = errors[i].ssim;
	}
	free(errors);
	if (status != STATUS_OK && status != STATUS_INTERRUPTED)
		report_error("%s", error.text);
	c->n_failed += status != STATUS_OK;
}

/* Adds the line of rows[0 .. n-1], which are of one material. */
static enum status add_material(struct comparison *c, char **const *rows, size_t n)
{
	double number[MOST_VALUES] = {0};
	for (int i = 0; i < c->n_ndf; i++)
		number[i] = NAN;
	for (size_t i = 0; i < n; i++)
		number[ndf_place(c, rows[i][RESULT_NDF])] = result_number(rows[i], RESULT_ERROR);
	for (int r = 0; r < c->n_relations; r++)
		number[c->n_ndf + r] = find_relation(c, number, &c->relation[r]);
	if (c->pictures)
		add_pictures(c, rows, n, number);
	for (int i = 0; i < c->n_values; i++)
		c->value[i][c->n_materials] = number[i];
	c->n_materials++;
	return add_line(c, rows[0][RESULT_MATERIAL], number, find_winner(c, number));
}

static int material_order(const void *a, const void *b)
{
	char *const *row_a = *(char **const *)a, *const *row_b = *(char **const *)b;
	const int order = strcmp(row_a[RESULT_MATERIAL], row_b[RESULT_MATERIAL]);
	return order ? order : strcmp(row_a[RESULT_PATH], row_b[RESULT_PATH]);
}

static enum status add_materials(struct comparison *c, struct csv_table *rows)
{
	qsort(rows->row, rows->n_rows, sizeof(*rows->row), material_order);
	for (size_t start = 0, end; start < rows->n_rows; start = end) {
		for (end = start + 1; end < rows->n_rows; end++)
			if (material_order(&rows->row[start], &rows->row[end]))
				break;
		if (add_material(c, rows->row + start, end - start))
			return STATUS_NO_MEMORY;
		if (c->pictures && *c->options->cancel)
			return STATUS_INTERRUPTED;
	}
	return STATUS_OK;
}

/* Whether the smallest value of a column is the worst: so it is of gains and of SSIM. */
static bool worst_is_least(const struct comparison *c, int i)
{
	const int picture = i - first_picture(c);
	return picture >= 0 ? picture >= c->n_ndf : i >= c->n_ndf && !c->relation[i - c->n_ndf].above;
}

/* Mean, median and worst of each value column. */
static enum status add_summary(struct comparison *c)
{
	double mean[MOST_VALUES] = {0}, median[MOST_VALUES] = {0}, worst[MOST_VALUES] = {0}, wins[MOST_VALUES] = {0};
	for (int i = 0; i < c->n_values; i++) {
		double *x = c->value[i];
		size_t n = 0;
		for (size_t m = 0; m < c->n_materials; m++)
			if (!isnan(x[m]))
				x[n++] = x[m];
		const bool error = i < c->n_ndf;
		wins[i] = error ? (double)c->wins[i] : (double)NAN;
		mean[i] = n ? gsl_stats_mean(x, 1, n) : NAN;
		worst[i] = !n ? NAN : worst_is_least(c, i) ? gsl_stats_min(x, 1, n) : gsl_stats_max(x, 1, n);
		median[i] = n ? gsl_stats_median(x, 1, n) : NAN;
	}
	char ties[NAME_SIZE];
	snprintf(ties, sizeof ties, "%d %s", c->ties, c->ties == 1 ? "tie" : "ties");
	if (add_line(c, "(mean)", mean, "") || add_line(c, "(median)", median, "") ||
	    add_line(c, "(worst)", worst, "") || add_line(c, "(wins)", wins, ties))
		return STATUS_NO_MEMORY;
	return STATUS_OK;
}

static void comparison_free(struct comparison *c)
{
	for (int i = 0; i < c->n_values; i++)
		free(c->value[i]);
	environment_free(&c->light);
	csv_table_free(&c->table);
}

static enum status write_output(const struct options *options, const struct csv_table *table, struct error *error)
{
	report_output(table, options_show(options), report_table);
	if (!options->output)
		return STATUS_OK;
	return store_write(options->output, table, options->json ? report_json : csv_write, error);
}

static enum status fill_table(struct comparison *c, struct csv_table *rows, struct error *error)
{
	enum status status = c->pictures ? environment_named("studio", &c->light) : STATUS_OK;
	set_relations(c);
	if (status == STATUS_OK)
		status = name_columns(c, rows->n_rows);
	if (status == STATUS_OK)
		status = add_materials(c, rows);
	if (status == STATUS_OK)
		status = add_summary(c);
	return status != STATUS_OK ? error_set(error, status, "%s", status_str(status)) : STATUS_OK;
}

/* Compares the rows, which get reordered, and writes the outcome. Returns the exit code. */
static int compare(const struct options *options, struct csv_table *rows)
{
	struct comparison c = {.options = options, .pictures = options->pictures};
	struct error error;
	enum status status = collect_ndfs(&c, rows, &error);
	if (status == STATUS_OK)
		status = fill_table(&c, rows, &error);
	if (status == STATUS_OK)
		status = write_output(options, &c.table, &error);
	if (status != STATUS_OK && status != STATUS_INTERRUPTED)
		report_error("%s", error.text);
	comparison_free(&c);
	if (status == STATUS_INTERRUPTED)
		return EXIT_INTERRUPTED;
	return status || c.n_failed ? EXIT_FAILED : EXIT_DONE;
}

/* Rows that can be compared were made with the same options. */
static enum status check_rows(const struct csv_table *rows, const char *path, struct error *error)
{
	char name[TEXT_QUOTE_SIZE];
	text_quote(path, name, sizeof name);
	if (!rows->n_rows)
		return error_set(error, STATUS_NO_DATA, "'%s' has no rows to compare", name);
	for (size_t i = 1; i < rows->n_rows; i++)
		if (strcmp(rows->row[0][RESULT_OPTIONS], rows->row[i][RESULT_OPTIONS]))
			return error_set(error, STATUS_FORMAT, "'%s' row %zu: made with other options than row 1", name,
					 i + 1);
	return STATUS_OK;
}

static int compare_table(const struct options *options)
{
	struct error error;
	struct csv_table rows = csv_table_make(result_columns, RESULT_COLUMNS);
	static const char *const useful[] = {"output", "json", "table", "pictures", "threads", NULL};
	const char *path = options->path[0], *ignored = options_given_beside(options, useful);
	if (!ignored && !options->pictures && options_given(options, "threads"))
		ignored = "threads";
	if (ignored)
		return options_usage(COMMAND_COMPARE, "--%s means nothing for a table that is there already", ignored);
	if (options->n_paths > 1)
		return options_usage(COMMAND_COMPARE, "expected one table and nothing beside it, found %d paths",
				     options->n_paths);
	enum status status = csv_table_read(&rows, path, RESULT_ERROR + 1, NULL, &error);
	if (status == STATUS_OK)
		status = check_rows(&rows, path, &error);
	if (status != STATUS_OK)
		report_error("%s", error.text);
	const int code = status ? EXIT_FAILED : compare(options, &rows);
	csv_table_free(&rows);
	return code;
}

/* Fits, then compares what came out. */
static int compare_fits(const struct options *options)
{
	struct files files;
	struct batch batch;
	struct error error = {""};
	struct csv_table rows = csv_table_make(result_columns, RESULT_COLUMNS);
	const int bad = files_collect(&files, options->path, options->n_paths, options->recursive, options->cancel);
	const bool replaces = bad >= 0 && options->output && files_has(&files, options->output);
	if (replaces)
		options_usage(COMMAND_COMPARE, "--output names a file that is to be read");
	if (bad < 0 || replaces || batch_init(&batch, options, &files)) {
		files_free(&files);
		return replaces ? EXIT_USAGE : EXIT_FAILED;
	}
	enum status status = options->output ? store_probe(options->output, &error) : STATUS_OK;
	int code = *options->cancel                 ? EXIT_INTERRUPTED
		   : files.n && status == STATUS_OK ? batch_run(&batch)
						    : EXIT_FAILED;
	for (size_t i = 0; i < batch.n && status == STATUS_OK; i++)
		if (csv_table_move(&rows, &batch.file[i].rows))
			status = error_set(&error, STATUS_NO_MEMORY, "out of memory");
	if (status != STATUS_OK)
		report_error("%s", error.text);
	const int compared =
		status == STATUS_OK && rows.n_rows && code != EXIT_INTERRUPTED ? compare(options, &rows) : EXIT_DONE;
	csv_table_free(&rows);
	batch_free(&batch);
	files_free(&files);
	if (compared != EXIT_DONE)
		return compared;
	return code == EXIT_DONE && (bad || status != STATUS_OK) ? EXIT_FAILED : code;
}

int cmd_compare(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	const int code = options_parse(&options, COMMAND_COMPARE, argc, argv, cancel);
	if (code >= 0)
		return code;
	for (int i = 0; i < options.n_paths; i++)
		if (csv_is_name(options.path[i])) {
			char *path = options.path[0];
			options.path[0] = options.path[i];
			options.path[i] = path;
			return compare_table(&options);
		}
	return compare_fits(&options);
}
