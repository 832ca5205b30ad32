/* SPDX-License-Identifier: GPL-3.0-or-later */
/* distribution_table - the functions of distributions as a table: D, P22, P2, Lambda, G1, the densities of sampling,
 * CDFs and moments. */
#ifndef DISTRIBUTION_TABLE_H
#define DISTRIBUTION_TABLE_H

#include "fit/sources/distribution_source.h"

enum distribution_column {
	DISTRIBUTION_NDF,
	DISTRIBUTION_SIGMA,
	DISTRIBUTION_SIGMA_Y,
	DISTRIBUTION_GAMMA,
	DISTRIBUTION_PARAMS,
	DISTRIBUTION_LAMBDA_FORM,
	DISTRIBUTION_THETA, /* degrees, as the next three */
	DISTRIBUTION_PHI,
	DISTRIBUTION_THETA_I,
	DISTRIBUTION_PHI_I,
	DISTRIBUTION_GIVEN, /* so far what a row that is read may have */
	DISTRIBUTION_D = DISTRIBUTION_GIVEN,
	DISTRIBUTION_P22,
	DISTRIBUTION_P2,
	DISTRIBUTION_LAMBDA,
	DISTRIBUTION_G1,
	DISTRIBUTION_PDF,
	DISTRIBUTION_VISIBLE_PDF,
	DISTRIBUTION_WEIGHT,
	DISTRIBUTION_CDF,
	DISTRIBUTION_CDF_PHI,
	DISTRIBUTION_CDF_THETA,
	DISTRIBUTION_VISIBLE_CDF,
	DISTRIBUTION_ACROSS_CDF,
	DISTRIBUTION_MOMENT_2,
	DISTRIBUTION_MOMENT_4,
	DISTRIBUTION_KURTOSIS,
	DISTRIBUTION_COLUMNS
};

extern const struct csv_column distribution_columns[DISTRIBUTION_COLUMNS];
/* Of a table that is read: all text, as a cell that is no number is an error of its row alone. */
extern const struct csv_column distribution_given_columns[DISTRIBUTION_GIVEN];

/* distribution_table_tabulate - adds a row for each theta with each phi of the options. Errors: STATUS_DOMAIN (no
 * angles, or too many), STATUS_NO_MEMORY, STATUS_INTERRUPTED. */
MUST_CHECK enum status distribution_table_tabulate(struct csv_table *table, const struct options *options,
						   const struct described *item, struct error *error);

/* distribution_table_evaluate - adds the row that `given` describes, its first DISTRIBUTION_GIVEN cells; an empty
 * theta_i or phi_i, and G, are those of the options, an empty phi is 0. Errors: STATUS_DOMAIN: it describes nothing, why
 * is in `error`, and its row, which is added, has no values; STATUS_NO_MEMORY and what distribution_make() returns: no
 * row is added. */
MUST_CHECK enum status distribution_table_evaluate(struct csv_table *table, const struct options *options,
						   char *const *given, struct error *error);

#endif
