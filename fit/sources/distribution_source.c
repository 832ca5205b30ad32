/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/sources/distribution_source.h"
#include "fit/cli/option_value.h"
#include "fit/cli/report.h"

#include <stdlib.h>
#include <string.h>

int distribution_source_check(const struct options *options)
{
	if (options_given(options, "phi-i") && isnan(options->theta_i))
		return options_usage(options->command, "--phi-i means nothing without --theta-i");
	if (!options->from && options->n_paths != 1)
		return options_usage(options->command, "expected one NAME, or --from, found %d", options->n_paths);
	if (!options->from)
		return -1;
	if (options->n_paths)
		return options_usage(options->command, "NAME and --from exclude each other");
	if (options_given(options, "params"))
		return options_usage(options->command, "--params and --from exclude each other");
	if (options_given(options, "nodes"))
		return options_usage(options->command, "--nodes and --from exclude each other");
	return model_source_check(options, false);
}

/* From NAME and options; sigma may be two values. */
static enum status describe(const struct options *options, struct described *item, struct error *error)
{
	const char *sigma = options->sigma_words ? options->sigma_words : "", *comma = strchr(sigma, ',');
	const size_t length = comma ? (size_t)(comma - sigma) : strlen(sigma);
	snprintf(item->sigma, sizeof item->sigma, "%.*s", (int)length, sigma);
	snprintf(item->sigma_y, sizeof item->sigma_y, "%s", comma ? comma + 1 : "");
	item->gaf = options->fit.criterion.gaf;
	item->words = (struct distribution_words){
		.name = options->path[0],
		.sigma = item->sigma,
		.sigma_y = item->sigma_y,
		.angle = csv_number(item->angle, options->fit.angle),
		.gamma = options->gamma_words,
		.params = options->params,
		.nodes = options->nodes,
		.lambda = options_given(options, "lambda") ? lambda_form_name(options->fit.lambda) : NULL,
	};
	if (length >= sizeof item->sigma || (comma && strlen(comma + 1) >= sizeof item->sigma_y))
		return error_set(error, STATUS_DOMAIN, "bad --sigma: expected one number or two");
	struct error why;
	const enum status status = distribution_make(&item->words, &item->distribution, &why);
	return status == STATUS_OK ? status : error_set(error, status, "%.400s%s", why.text, option_comma_hint(sigma));
}

/* The distribution of a model, whose table stays with the model, and the words that describe it; a table has
 * none. */
static void move_model(const struct source_model *model, struct described *item)
{
	const struct ndf *ndf = &model->model.ndf;
	item->distribution = (struct distribution){.name = ndf_name(ndf->class), .ndf = *ndf};
	item->gaf = model->model.gaf;
	item->words = (struct distribution_words){.name = item->distribution.name,
						  .sigma = item->sigma,
						  .sigma_y = item->sigma_y,
						  .gamma = item->gamma,
						  .params = item->params,
						  .lambda = lambda_form_name(ndf->lambda_form)};
	for (int i = 0; ndf_param_at(ndf->class, i); i++) {
		const struct ndf_param *param = ndf_param_at(ndf->class, i);
		char number[CSV_NUMBER_SIZE];
		const size_t used = strlen(item->params);
		csv_number(number, ndf->param[i]);
		if (param->role == NDF_ROLE_SIGMA)
			strcpy(item->sigma, number);
		else if (param->role == NDF_ROLE_GAMMA)
			strcpy(item->gamma, number);
		else
			snprintf(item->params + used, sizeof item->params - used, "%s%s=%s", used ? ";" : "",
				 param->name, number);
	}
	if (ndf_is_anisotropic(ndf) && !ndf_is_tabulated(ndf->class))
		csv_number(item->sigma_y, ndf->sigma_y);
	if (ndf_is_tilted(ndf)) {
		char x[CSV_NUMBER_SIZE], y[CSV_NUMBER_SIZE];
		snprintf(item->params, sizeof item->params, "tilt_x=%s;tilt_y=%s", csv_number(x, ndf->tilt_x),
			 csv_number(y, ndf->tilt_y));
	}
}

enum status distribution_source_read(const struct options *options, struct distribution_source *source,
				     struct error *error)
{
	enum status status = STATUS_OK;
	*source = (struct distribution_source){0};
	if (options->from)
		status = model_source_read(options, NULL, &source->models, error);
	if (status != STATUS_OK)
		return status;
	const size_t n = options->from ? source->models.n : 1;
	source->item = calloc(n, sizeof *source->item);
	if (!source->item)
		status = error_set(error, STATUS_NO_MEMORY, "out of memory");
	else if (!options->from)
		status = describe(options, &source->item[0], error);
	for (size_t i = 0; status == STATUS_OK && options->from && i < n; i++)
		move_model(&source->models.model[i], &source->item[i]);
	source->n = n;
	if (status != STATUS_OK)
		distribution_source_free(source);
	return status;
}

void distribution_source_free(struct distribution_source *source)
{
	for (size_t i = 0; source->item && i < source->n; i++)
		distribution_free(&source->item[i].distribution);
	free(source->item);
	model_source_free(&source->models);
	*source = (struct distribution_source){0};
}

int distribution_end(const struct options *options, enum status status, const struct error *error,
		     struct csv_table *table)
{
	if (status != STATUS_DOMAIN && status != STATUS_UNSUPPORTED)
		return options_end(options, status, error, table, report_table);
	csv_table_free(table);
	return options_usage(options->command, "%s", error->text);
}
