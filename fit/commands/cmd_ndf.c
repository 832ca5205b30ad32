/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit ndf - the functions of a distribution as a table over angles, or of one distribution after another. */
#include "fit/cli/angles.h"
#include "fit/cli/messages.h"
#include "fit/commands/commands.h"
#include "fit/sources/distribution_source.h"

#include <string.h>

enum ndf_column {
	NDF_NDF,
	NDF_SIGMA,
	NDF_SIGMA_Y,
	NDF_GAMMA,
	NDF_PARAMS,
	NDF_LAMBDA_FORM,
	NDF_THETA,
	NDF_PHI,
	NDF_THETA_I,
	NDF_GIVEN, /* so far what a row of standard input may have */
	NDF_D = NDF_GIVEN,
	NDF_P22,
	NDF_P2,
	NDF_LAMBDA,
	NDF_G1,
	NDF_PDF,
	NDF_VISIBLE_PDF,
	NDF_WEIGHT,
	NDF_COLUMNS
};

static const struct csv_column columns[NDF_COLUMNS] = {
	[NDF_NDF] = {"ndf", false},
	[NDF_SIGMA] = {"sigma", true},
	[NDF_SIGMA_Y] = {"sigma_y", true},
	[NDF_GAMMA] = {"gamma", true},
	[NDF_PARAMS] = {"params", false},
	[NDF_LAMBDA_FORM] = {"lambda", false},
	[NDF_THETA] = {"theta", true},
	[NDF_PHI] = {"phi", true},
	[NDF_THETA_I] = {"theta_i", true},
	[NDF_D] = {"D", true},
	[NDF_P22] = {"P22", true},
	[NDF_P2] = {"P2", true},
	[NDF_LAMBDA] = {"Lambda", true},
	[NDF_G1] = {"G1", true},
	[NDF_PDF] = {"pdf", true},
	[NDF_VISIBLE_PDF] = {"visible_pdf", true},
	[NDF_WEIGHT] = {"visible_weight", true},
};

/* What is read has to be looked at row by row: a cell that is no number is an error of its row alone. */
static const struct csv_column given_columns[NDF_GIVEN] = {
	[NDF_NDF] = {"ndf", false},     [NDF_SIGMA] = {"sigma", false},   [NDF_SIGMA_Y] = {"sigma_y", false},
	[NDF_GAMMA] = {"gamma", false}, [NDF_PARAMS] = {"params", false}, [NDF_LAMBDA_FORM] = {"lambda", false},
	[NDF_THETA] = {"theta", false}, [NDF_PHI] = {"phi", false},       [NDF_THETA_I] = {"theta_i", false},
};

/* Where a distribution is looked at, degrees. */
struct directions {
	double theta, phi, theta_i; /* theta_i NaN: nobody looks */
};

/* A line of output: the cells of the description, then numbers. */
struct line {
	const char *cell[NDF_COLUMNS];
	char text[NDF_COLUMNS][CSV_NUMBER_SIZE];
};

static void set(struct line *line, enum ndf_column column, double x)
{
	line->cell[column] = csv_number(line->text[column], x);
}

static void evaluate(struct line *line, const struct distribution *distribution, enum gaf gaf,
		     struct directions directions)
{
	const struct vec3 m = vec3_from_spherical_deg(directions.theta, directions.phi);
	const double slope = hypot(m.x, m.y) / m.z;
	set(line, NDF_THETA, directions.theta);
	set(line, NDF_PHI, directions.phi);
	set(line, NDF_THETA_I, directions.theta_i);
	set(line, NDF_D, distribution_D(distribution, m));
	set(line, NDF_P22, m.z > 0 ? distribution_P22(distribution, -m.x / m.z, -m.y / m.z) : NAN);
	set(line, NDF_P2, m.z > 0 ? distribution_P2(distribution, directions.phi * M_PI / 180, slope) : NAN);
	set(line, NDF_LAMBDA, distribution_lambda(distribution, m));
	set(line, NDF_G1, distribution_G1(distribution, m));
	set(line, NDF_PDF, distribution_D(distribution, m) * m.z);
	if (isnan(directions.theta_i))
		return;
	const struct vec3 wi = vec3_from_spherical_deg(directions.theta_i, 0);
	const double pdf = distribution_visible_pdf(distribution, wi, m);
	set(line, NDF_VISIBLE_PDF, pdf);
	set(line, NDF_WEIGHT, pdf > 0 ? distribution_weight(distribution, gaf, wi, m, pdf) : 0);
}

static enum status add(struct csv_table *output, const struct line *line, struct error *error)
{
	return csv_table_add(output, line->cell) ? error_set(error, STATUS_NO_MEMORY, "out of memory") : STATUS_OK;
}

/* All rows are in memory before the first is written. */
static enum status check_count(const struct angles *theta, const struct angles *phi, struct error *error)
{
	if (theta->n * phi->n <= ANGLES_MAX)
		return STATUS_OK;
	return error_set(error, STATUS_DOMAIN, "%zu angles theta and %zu phi: expected at most %d rows", theta->n,
			 phi->n, ANGLES_MAX);
}

/* Every theta with every phi. */
static enum status tabulate(const struct options *options, const struct described *item, struct line *line,
			    struct csv_table *output, struct error *error)
{
	struct angles theta, phi = {0};
	enum status status = angles_parse(options->theta, 0, 90, &theta, error);
	if (status == STATUS_OK)
		status = angles_parse(options->phi ? options->phi : "0", -360, 360, &phi, error);
	if (status == STATUS_OK)
		status = check_count(&theta, &phi, error);
	for (size_t i = 0; status == STATUS_OK && i < theta.n; i++)
		for (size_t j = 0; status == STATUS_OK && j < phi.n; j++) {
			evaluate(line, &item->distribution, item->gaf,
				 (struct directions){theta.deg[i], phi.deg[j], options->theta_i});
			status = *options->cancel ? STATUS_INTERRUPTED : add(output, line, error);
		}
	angles_free(&theta);
	angles_free(&phi);
	return status;
}

static void describe(struct line *line, const struct distribution_words *words)
{
	line->cell[NDF_NDF] = words->name;
	line->cell[NDF_SIGMA] = words->sigma;
	line->cell[NDF_SIGMA_Y] = words->sigma_y;
	line->cell[NDF_GAMMA] = words->gamma;
	line->cell[NDF_PARAMS] = words->params;
	line->cell[NDF_LAMBDA_FORM] = words->lambda;
}

static enum status run_options(const struct options *options, struct csv_table *output, struct error *error)
{
	struct distribution_source source;
	enum status status = distribution_source_read(options, &source, error);
	if (status != STATUS_OK)
		return status;
	for (size_t i = 0; i < source.n && status == STATUS_OK; i++) {
		struct line line = {.cell = {0}};
		describe(&line, &source.item[i].words);
		status = tabulate(options, &source.item[i], &line, output, error);
	}
	distribution_source_free(&source);
	return status;
}

/* The place of a row; what it leaves empty comes from the options. */
static enum status row_directions(const struct options *options, char *const *row, struct directions *directions,
				  struct error *error)
{
	static const struct {
		enum ndf_column column;
		double min, max;
	} angle[] = {{NDF_THETA, 0, 90}, {NDF_PHI, -360, 360}, {NDF_THETA_I, 0, 89.999999}};
	double value[3] = {NAN, 0, options->theta_i};
	for (int i = 0; i < 3; i++) {
		double x;
		if (!csv_parse_number(row[angle[i].column], &x) || x < angle[i].min || x > angle[i].max)
			return error_set(error, STATUS_DOMAIN, "bad %s: expected degrees from %g to %g",
					 given_columns[angle[i].column].name, angle[i].min, angle[i].max);
		if (!isnan(x))
			value[i] = x;
	}
	*directions = (struct directions){value[0], value[1], value[2]};
	return isnan(value[0]) ? error_set(error, STATUS_DOMAIN, "theta is empty") : STATUS_OK;
}

/* One row of standard input. *bad: it describes nothing; told, and its line has no values. */
static enum status run_row(const struct options *options, char *const *row, size_t number, struct csv_table *output,
			   bool *bad, struct error *error)
{
	const struct distribution_words words = {row[NDF_NDF],   row[NDF_SIGMA],  row[NDF_SIGMA_Y],
						 row[NDF_GAMMA], row[NDF_PARAMS], row[NDF_LAMBDA_FORM]};
	struct distribution distribution;
	struct line line = {.cell = {0}};
	struct directions directions;
	struct error why;
	for (int c = 0; c < NDF_GIVEN; c++) {
		double x;
		line.cell[c] = !columns[c].number || csv_parse_number(row[c], &x) ? row[c] : "";
	}
	enum status status = distribution_make(&words, &distribution, &why);
	if (status == STATUS_OK) {
		status = row_directions(options, row, &directions, &why);
		if (status == STATUS_OK)
			evaluate(&line, &distribution, options->fit.criterion.gaf, directions);
		distribution_free(&distribution);
	}
	if (status == STATUS_DOMAIN) {
		*bad = true;
		report_error("row %zu: %.400s", number, why.text);
	} else if (status != STATUS_OK) {
		return error_set(error, status, "row %zu: %.400s", number, why.text);
	}
	return add(output, &line, error);
}

static enum status run_input(const struct options *options, struct csv_table *output, bool *bad, struct error *error)
{
	struct csv_table rows = csv_table_make(given_columns, NDF_GIVEN);
	enum status status = csv_table_read(&rows, "/dev/stdin", NDF_NDF + 1, NULL, error);
	for (size_t i = 0; i < rows.n_rows && status == STATUS_OK; i++)
		status = *options->cancel ? STATUS_INTERRUPTED
					  : run_row(options, rows.row[i], i + 1, output, bad, error);
	csv_table_free(&rows);
	return status;
}

/* With rows from standard input only --theta-i and --gaf say something. */
static int check_input(const struct options *options)
{
	static const char *const useful[] = {"theta-i", "gaf", "json", "table", NULL};
	const char *ignored = options_given_beside(options, useful);
	return ignored ? options_usage(COMMAND_NDF, "--%s means nothing with -: rows have their own", ignored) : -1;
}

static int check(const struct options *options, bool input)
{
	const int code = input ? check_input(options) : distribution_source_check(options);
	if (code >= 0 || input)
		return code;
	return options->theta ? -1 : options_usage(COMMAND_NDF, "expected --theta");
}

int cmd_ndf(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error = {""};
	bool bad = false;
	int code = options_parse(&options, COMMAND_NDF, argc, argv, cancel);
	if (code >= 0)
		return code;
	const bool input = options.n_paths == 1 && !strcmp(options.path[0], "-");
	code = check(&options, input);
	if (code >= 0)
		return code;
	struct csv_table output = csv_table_make(columns, NDF_COLUMNS);
	const enum status status =
		input ? run_input(&options, &output, &bad, &error) : run_options(&options, &output, &error);
	code = distribution_end(&options, status, &error, &output);
	return code == EXIT_DONE && bad ? EXIT_FAILED : code;
}
