/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit ndf - the functions of a distribution as a table over angles, or of one distribution after another. */
#include "fit/cli/messages.h"
#include "fit/commands/commands.h"
#include "fit/sources/distribution_table.h"

#include <string.h>

static enum status run_options(const struct options *options, struct csv_table *output, struct error *error)
{
	struct distribution_source source;
	enum status status = distribution_source_read(options, &source, error);
	if (status != STATUS_OK)
		return status;
	for (size_t i = 0; i < source.n && status == STATUS_OK; i++)
		status = distribution_table_tabulate(output, options, &source.item[i], error);
	distribution_source_free(&source);
	return status;
}

/* One row of standard input. *bad: it describes nothing, which is reported; the other rows go on. */
static enum status run_row(const struct options *options, char *const *row, size_t number, struct csv_table *output,
			   bool *bad, struct error *error)
{
	struct error why;
	const enum status status = distribution_table_evaluate(output, options, row, &why);
	if (status == STATUS_DOMAIN) {
		*bad = true;
		report_error("row %zu: %.400s", number, why.text);
		return STATUS_OK;
	}
	return status != STATUS_OK ? error_set(error, status, "row %zu: %.400s", number, why.text) : STATUS_OK;
}

static enum status run_input(const struct options *options, struct csv_table *output, bool *bad, struct error *error)
{
	struct csv_table rows = csv_table_make(distribution_given_columns, DISTRIBUTION_GIVEN);
	enum status status = csv_table_read(&rows, "/dev/stdin", DISTRIBUTION_NDF + 1, NULL, error);
	for (size_t i = 0; i < rows.n_rows && status == STATUS_OK; i++)
		status = *options->cancel ? STATUS_INTERRUPTED
					  : run_row(options, rows.row[i], i + 1, output, bad, error);
	csv_table_free(&rows);
	return status;
}

/* With rows from standard input only --theta-i, --phi-i and --gaf say something. */
static int check_input(const struct options *options)
{
	static const char *const useful[] = {"theta-i", "phi-i", "gaf", "json", "table", NULL};
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
	struct csv_table output = csv_table_make(distribution_columns, DISTRIBUTION_COLUMNS);
	const enum status status =
		input ? run_input(&options, &output, &bad, &error) : run_options(&options, &output, &error);
	code = distribution_end(&options, status, &error, &output);
	return code == EXIT_DONE && bad ? EXIT_FAILED : code;
}
