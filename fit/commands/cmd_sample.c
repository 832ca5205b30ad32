/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit sample - random normals of a distribution, and the directions into which they reflect. */
#include "fit/commands/commands.h"
#include "fit/sources/distribution_source.h"
#include "src/sampling.h"
#include "src/vndf.h"

#include <gsl/gsl_rng.h>

enum sample_column {
	SAMPLE_MX,
	SAMPLE_MY,
	SAMPLE_MZ,
	SAMPLE_PDF,
	SAMPLE_OX,
	SAMPLE_OY,
	SAMPLE_OZ,
	SAMPLE_PDF_O,
	SAMPLE_WEIGHT,
	SAMPLE_COLUMNS
};

static const struct csv_column columns[SAMPLE_COLUMNS] = {
	[SAMPLE_MX] = {"m_x", true},  [SAMPLE_MY] = {"m_y", true},       [SAMPLE_MZ] = {"m_z", true},
	[SAMPLE_PDF] = {"pdf", true}, [SAMPLE_OX] = {"wo_x", true},      [SAMPLE_OY] = {"wo_y", true},
	[SAMPLE_OZ] = {"wo_z", true}, [SAMPLE_PDF_O] = {"pdf_wo", true}, [SAMPLE_WEIGHT] = {"weight", true},
};

/* Seen from somewhere, or not: wi.z = NaN. */
static enum status add_sample(const struct described *item, const struct sampler *sampler, struct vec3 wi, double u1,
			      double u2, struct csv_table *output)
{
	const struct vec3 m = sampler_sample(sampler, wi, u1, u2);
	const double pdf = sampler_pdf(sampler, wi, m);
	const double cos_d = vec3_dot(wi, m);
	const struct vec3 wo = vec3_sub(vec3_scale(m, 2 * cos_d), wi);
	const bool reflects = cos_d > 0; /* false for NaN */
	const double number[SAMPLE_COLUMNS] = {
		[SAMPLE_MX] = m.x,
		[SAMPLE_MY] = m.y,
		[SAMPLE_MZ] = m.z,
		[SAMPLE_PDF] = pdf,
		[SAMPLE_OX] = reflects ? wo.x : NAN,
		[SAMPLE_OY] = reflects ? wo.y : NAN,
		[SAMPLE_OZ] = reflects ? wo.z : NAN,
		[SAMPLE_PDF_O] = reflects ? pdf / (4 * cos_d) : NAN,
		[SAMPLE_WEIGHT] = isnan(wi.z) ? NAN : vndf_weight(&item->distribution.ndf, item->gaf, wi, m, pdf),
	};
	char text[SAMPLE_COLUMNS][CSV_NUMBER_SIZE];
	const char *cell[SAMPLE_COLUMNS];
	for (int c = 0; c < SAMPLE_COLUMNS; c++)
		cell[c] = csv_number(text[c], number[c]);
	return csv_table_add(output, cell);
}

/* The way that --sampling names, or else the best that there is. */
static enum status choose(const struct options *options, const struct described *item, struct sampler *sampler,
			  struct error *error)
{
	const bool given = options_given(options, "sampling"), seen = !isnan(options->theta_i);
	enum sampling sampling = given || seen ? options->sampling : SAMPLING_NDF;
	enum status status = STATUS_OK;
	if (given)
		status = sampler_init(sampler, &item->distribution.ndf, sampling);
	else
		sampling = sampler_init_near(sampler, &item->distribution.ndf, sampling);
	if (status != STATUS_OK)
		return error_set(error, STATUS_UNSUPPORTED, "%s has no --sampling %s%s", item->distribution.name,
				 sampling_name(sampling),
				 sampling == SAMPLING_RATIONAL ? ": that is for ggx, and gamma 2" : "");
	if (sampling != SAMPLING_NDF && !seen)
		return error_set(error, STATUS_DOMAIN, "visible normals need --theta-i");
	return STATUS_OK;
}

static enum status draw(const struct options *options, const struct described *item, struct csv_table *output,
			struct error *error)
{
	const struct vec3 wi = distribution_direction(options->theta_i, options->phi_i);
	struct sampler sampler;
	enum status status = choose(options, item, &sampler, error);
	if (status != STATUS_OK)
		return status;
	gsl_rng *rng = gsl_rng_alloc(gsl_rng_mt19937);
	status = rng ? STATUS_OK : STATUS_NO_MEMORY;
	if (rng)
		gsl_rng_set(rng, (unsigned long)options->fit.seed);
	for (int i = 0; i < options->count && status == STATUS_OK; i++) {
		const double u1 = gsl_rng_uniform(rng), u2 = gsl_rng_uniform(rng);
		status = *options->cancel ? STATUS_INTERRUPTED : add_sample(item, &sampler, wi, u1, u2, output);
	}
	if (rng)
		gsl_rng_free(rng);
	return status != STATUS_OK ? error_set(error, status, "%s", status_str(status)) : STATUS_OK;
}

static enum status run(const struct options *options, struct csv_table *output, struct error *error)
{
	struct distribution_source source;
	enum status status = distribution_source_read(options, &source, error);
	if (status != STATUS_OK)
		return status;
	status = source.n == 1 ? draw(options, &source.item[0], output, error)
			       : error_set(error, STATUS_FORMAT, "%zu rows are meant: choose one with --row", source.n);
	distribution_source_free(&source);
	return status;
}

int cmd_sample(int argc, char **argv, atomic_bool *cancel)
{
	struct options options;
	struct error error = {""};
	int code = options_parse(&options, COMMAND_SAMPLE, argc, argv, cancel);
	if (code < 0)
		code = distribution_source_check(&options);
	if (code >= 0)
		return code;
	struct csv_table output = csv_table_make(columns, SAMPLE_COLUMNS);
	const enum status status = run(&options, &output, &error);
	return distribution_end(&options, status, &error, &output);
}
