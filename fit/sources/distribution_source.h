/* SPDX-License-Identifier: GPL-3.0-or-later */
/* distribution_source - the distributions of `ndf` and `sample`: NAME with --sigma, --gamma, --params,
 * --lambda; or the rows of a result table, --from and --row. */
#ifndef DISTRIBUTION_SOURCE_H
#define DISTRIBUTION_SOURCE_H

#include "fit/cli/distribution.h"
#include "fit/sources/model_source.h"

/* struct described - a distribution and the words for it. */
struct described {
	struct distribution distribution;
	struct distribution_words words; /* point to what is borrowed, or to the texts below */
	enum gaf gaf;
	char sigma[CSV_NUMBER_SIZE], sigma_y[CSV_NUMBER_SIZE], angle[CSV_NUMBER_SIZE], gamma[CSV_NUMBER_SIZE];
	char params[NDF_PARAMS_MAX * 2 * CSV_NUMBER_SIZE];
};

struct distribution_source {
	struct described *item;
	size_t n; /* at least one after success */
	struct model_source models;
};

/* distribution_source_check - whether the options go together. Returns -1, or EXIT_USAGE with a message on standard
 * error. */
MUST_CHECK int distribution_source_check(const struct options *options);

/* distribution_source_read - the distributions that the options ask for. Errors: STATUS_DOMAIN (the words describe
 * none), those of model_source_read(). *source holds nothing then. */
MUST_CHECK enum status distribution_source_read(const struct options *options, struct distribution_source *source,
						struct error *error);
void distribution_source_free(struct distribution_source *source);

/* distribution_end - as options_end(), but invalid words (STATUS_DOMAIN, STATUS_UNSUPPORTED) are wrong
 * usage. */
int distribution_end(const struct options *options, enum status status, const struct error *error,
		     struct csv_table *table);

#endif
