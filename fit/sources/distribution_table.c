/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/distribution_table.h"
#include "fit/cli/angles.h"
#include "src/ndf_slopes.h"
#include "src/vndf.h"

#include <math.h>

const struct csv_column distribution_columns[DISTRIBUTION_COLUMNS] = {
	[DISTRIBUTION_NDF] = {"ndf", false},
	[DISTRIBUTION_SIGMA] = {"sigma", true},
	[DISTRIBUTION_SIGMA_Y] = {"sigma_y", true},
	[DISTRIBUTION_GAMMA] = {"gamma", true},
	[DISTRIBUTION_PARAMS] = {"params", false},
	[DISTRIBUTION_LAMBDA_FORM] = {"lambda", false},
	[DISTRIBUTION_THETA] = {"theta", true},
	[DISTRIBUTION_PHI] = {"phi", true},
	[DISTRIBUTION_THETA_I] = {"theta_i", true},
	[DISTRIBUTION_PHI_I] = {"phi_i", true},
	[DISTRIBUTION_D] = {"D", true},
	[DISTRIBUTION_P22] = {"P22", true},
	[DISTRIBUTION_P2] = {"P2", true},
	[DISTRIBUTION_LAMBDA] = {"Lambda", true},
	[DISTRIBUTION_G1] = {"G1", true},
	[DISTRIBUTION_PDF] = {"pdf", true},
	[DISTRIBUTION_VISIBLE_PDF] = {"visible_pdf", true},
	[DISTRIBUTION_WEIGHT] = {"visible_weight", true},
	[DISTRIBUTION_CDF] = {"cdf", true},
	[DISTRIBUTION_CDF_PHI] = {"cdf_phi", true},
	[DISTRIBUTION_CDF_THETA] = {"cdf_theta", true},
	[DISTRIBUTION_VISIBLE_CDF] = {"visible_cdf", true},
	[DISTRIBUTION_ACROSS_CDF] = {"across_cdf", true},
	[DISTRIBUTION_MOMENT_2] = {"moment_2", true},
	[DISTRIBUTION_MOMENT_4] = {"moment_4", true},
	[DISTRIBUTION_KURTOSIS] = {"kurtosis", true},
};

const struct csv_column distribution_given_columns[DISTRIBUTION_GIVEN] = {
	[DISTRIBUTION_NDF] = {"ndf", false},         [DISTRIBUTION_SIGMA] = {"sigma", false},
	[DISTRIBUTION_SIGMA_Y] = {"sigma_y", false}, [DISTRIBUTION_GAMMA] = {"gamma", false},
	[DISTRIBUTION_PARAMS] = {"params", false},   [DISTRIBUTION_LAMBDA_FORM] = {"lambda", false},
	[DISTRIBUTION_THETA] = {"theta", false},     [DISTRIBUTION_PHI] = {"phi", false},
	[DISTRIBUTION_THETA_I] = {"theta_i", false}, [DISTRIBUTION_PHI_I] = {"phi_i", false},
};

/* Where a distribution is evaluated, degrees. */
struct directions {
	double theta, phi, theta_i, phi_i; /* theta_i NaN: no light */
};

/* A line of output: the cells of the description, then numbers. */
struct line {
	const char *cell[DISTRIBUTION_COLUMNS];
	char text[DISTRIBUTION_COLUMNS][CSV_NUMBER_SIZE];
};

static void set(struct line *line, enum distribution_column column, double x)
{
	line->cell[column] = csv_number(line->text[column], x);
}

static void evaluate(struct line *line, const struct distribution *distribution, enum gaf gaf,
		     struct directions directions)
{
	const struct ndf *ndf = &distribution->ndf;
	const struct vec3 m = vec3_from_spherical_deg(directions.theta, directions.phi);
	const struct vec3 wi = distribution_direction(directions.theta_i, directions.phi_i);
	const double slope = hypot(m.x, m.y) / m.z, azimuth = directions.phi * M_PI / 180;
	const struct distribution_cdf cdf = distribution_cdf(distribution, wi, directions.theta, directions.phi);
	set(line, DISTRIBUTION_THETA, directions.theta);
	set(line, DISTRIBUTION_PHI, directions.phi);
	set(line, DISTRIBUTION_THETA_I, directions.theta_i);
	set(line, DISTRIBUTION_D, ndf_D(ndf, m));
	set(line, DISTRIBUTION_P22, m.z > 0 ? ndf_P22(ndf, -m.x / m.z, -m.y / m.z) : NAN);
	set(line, DISTRIBUTION_P2, m.z > 0 ? ndf_P2(ndf, azimuth, slope) : NAN);
	set(line, DISTRIBUTION_LAMBDA, ndf_lambda(ndf, m));
	set(line, DISTRIBUTION_G1, ndf_G1(ndf, m));
	set(line, DISTRIBUTION_PDF, ndf_D(ndf, m) * m.z);
	set(line, DISTRIBUTION_CDF, cdf.joint);
	set(line, DISTRIBUTION_CDF_PHI, cdf.phi);
	set(line, DISTRIBUTION_CDF_THETA, cdf.theta);
	set(line, DISTRIBUTION_MOMENT_2, distribution_moment(distribution, azimuth, 2));
	set(line, DISTRIBUTION_MOMENT_4, distribution_moment(distribution, azimuth, 4));
	set(line, DISTRIBUTION_KURTOSIS, distribution_kurtosis(distribution));
	if (isnan(directions.theta_i))
		return;
	set(line, DISTRIBUTION_PHI_I, directions.phi_i);
	set(line, DISTRIBUTION_VISIBLE_CDF, cdf.along);
	set(line, DISTRIBUTION_ACROSS_CDF, cdf.across);
	const double pdf = vndf_pdf(ndf, wi, m);
	set(line, DISTRIBUTION_VISIBLE_PDF, pdf);
	set(line, DISTRIBUTION_WEIGHT, pdf > 0 ? vndf_weight(ndf, gaf, wi, m, pdf) : 0);
}

static enum status add(struct csv_table *table, const struct line *line, struct error *error)
{
	return csv_table_add(table, line->cell) != STATUS_OK ? error_set(error, STATUS_NO_MEMORY, "out of memory")
							     : STATUS_OK;
}

/* All rows are in memory before the first is written. */
static enum status check_count(const struct angles *theta, const struct angles *phi, struct error *error)
{
	if (theta->n * phi->n <= ANGLES_MAX)
		return STATUS_OK;
	return error_set(error, STATUS_DOMAIN, "%zu angles theta and %zu phi: expected at most %d rows", theta->n,
			 phi->n, ANGLES_MAX);
}

static void describe(struct line *line, const struct distribution_words *words)
{
	line->cell[DISTRIBUTION_NDF] = words->name;
	line->cell[DISTRIBUTION_SIGMA] = words->sigma;
	line->cell[DISTRIBUTION_SIGMA_Y] = words->sigma_y;
	line->cell[DISTRIBUTION_GAMMA] = words->gamma;
	line->cell[DISTRIBUTION_PARAMS] = words->params;
	line->cell[DISTRIBUTION_LAMBDA_FORM] = words->lambda;
}

enum status distribution_table_tabulate(struct csv_table *table, const struct options *options,
					const struct described *item, struct error *error)
{
	struct line line = {.cell = {0}};
	struct angles theta, phi = {0};
	describe(&line, &item->words);
	enum status status = angles_parse(options->theta, 0, 90, &theta, error);
	if (status == STATUS_OK)
		status = angles_parse(options->phi ? options->phi : "0", -360, 360, &phi, error);
	if (status == STATUS_OK)
		status = check_count(&theta, &phi, error);
	for (size_t i = 0; status == STATUS_OK && i < theta.n; i++)
		for (size_t j = 0; status == STATUS_OK && j < phi.n; j++) {
			evaluate(&line, &item->distribution, item->gaf,
				 (struct directions){theta.deg[i], phi.deg[j], options->theta_i, options->phi_i});
			status = *options->cancel ? STATUS_INTERRUPTED : add(table, &line, error);
		}
	angles_free(&theta);
	angles_free(&phi);
	return status;
}

/* The directions of a row. What it leaves empty comes from the options. */
static enum status row_directions(const struct options *options, char *const *row, struct directions *directions,
				  struct error *error)
{
	static const struct {
		enum distribution_column column;
		double min, max;
	} angle[] = {{DISTRIBUTION_THETA, 0, 90},
		     {DISTRIBUTION_PHI, -360, 360},
		     {DISTRIBUTION_THETA_I, 0, 90},
		     {DISTRIBUTION_PHI_I, -360, 360}};
	double value[4] = {NAN, 0, options->theta_i, options->phi_i};
	for (int i = 0; i < 4; i++) {
		double x;
		if (!csv_parse_number(row[angle[i].column], &x) || x < angle[i].min || x > angle[i].max)
			return error_set(error, STATUS_DOMAIN, "bad %s: expected degrees from %g to %g",
					 distribution_given_columns[angle[i].column].name, angle[i].min, angle[i].max);
		if (!isnan(x))
			value[i] = x;
	}
	*directions = (struct directions){value[0], value[1], value[2], value[3]};
	return isnan(value[0]) ? error_set(error, STATUS_DOMAIN, "theta is empty") : STATUS_OK;
}

enum status distribution_table_evaluate(struct csv_table *table, const struct options *options, char *const *given,
					struct error *error)
{
	const struct distribution_words words = {.name = given[DISTRIBUTION_NDF],
						 .sigma = given[DISTRIBUTION_SIGMA],
						 .sigma_y = given[DISTRIBUTION_SIGMA_Y],
						 .gamma = given[DISTRIBUTION_GAMMA],
						 .params = given[DISTRIBUTION_PARAMS],
						 .lambda = given[DISTRIBUTION_LAMBDA_FORM]};
	struct distribution distribution;
	struct line line = {.cell = {0}};
	struct directions directions;
	struct error why;
	for (int c = 0; c < DISTRIBUTION_GIVEN; c++) {
		double x;
		line.cell[c] = !distribution_columns[c].number || csv_parse_number(given[c], &x) ? given[c] : "";
	}
	enum status status = distribution_make(&words, &distribution, error);
	if (status == STATUS_OK) {
		status = row_directions(options, given, &directions, error);
		if (status == STATUS_OK)
			evaluate(&line, &distribution, options->fit.criterion.gaf, directions);
		distribution_free(&distribution);
	}
	if (status != STATUS_OK && status != STATUS_DOMAIN)
		return status;
	if (add(table, &line, &why) != STATUS_OK)
		return error_set(error, STATUS_NO_MEMORY, "%s", why.text);
	return status;
}
