/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/plot/plot_common.h"
#include "data_readers/text_quote.h"
#include "fit/cli/output_directory.h"
#include "fit/results/csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum status plot_open(struct atomic_file *file, const char *directory, const char *name, struct error *error)
{
	char *path;
	enum status status = output_directory_path(directory, name, &path, error);
	if (status == STATUS_OK)
		status = atomic_file_open(file, path, error);
	free(path);
	return status;
}

void plot_number(FILE *file, double x)
{
	char text[CSV_NUMBER_SIZE];
	fprintf(file, ",%s", isnan(x) ? "NaN" : csv_number(text, x));
}

void plot_text(FILE *file, const char *text)
{
	char shown[TEXT_QUOTE_SIZE];
	/* gnuplot knows no quote inside a quoted cell. */
	text_quote(text, shown, sizeof shown);
	for (char *c = shown; *c; c++)
		if (*c == '"')
			*c = '\'';
	fprintf(file, "\"%s\"", shown);
}

const char *plot_colour(const char *ndf, int i)
{
	static const char *const own[][2] = {{"std", "#0077bb"}, {"ggx", "#cc3311"}, {"beckmann", "#000000"},
					     {"pl", "#009988"},  {"low", "#ee7733"}, {"gtr", "#aa4499"}};
	static const char *const other[] = {"#882255", "#999933", "#33bbee", "#666666"};
	for (size_t n = 0; n < sizeof own / sizeof *own; n++)
		if (!strcmp(own[n][0], ndf))
			return own[n][1];
	return other[(size_t)i % (sizeof other / sizeof *other)];
}

int plot_dash(const char *ndf, int i)
{
	static const char *const own[] = {"std", "ggx", "beckmann", "pl", "low", "gtr"};
	enum { DASHES = 5, OWN = sizeof own / sizeof *own };
	for (int n = 0; n < OWN; n++)
		if (!strcmp(own[n], ndf))
			return 1 + n % DASHES;
	return 1 + i % DASHES;
}

void plot_range_add(struct plot_range *range, double x)
{
	if (!(x > 0 && isfinite(x)))
		return;
	range->low = range->low > 0 && range->low < x ? range->low : x;
	range->high = range->high > x ? range->high : x;
}

void plot_log_range(FILE *file, const struct plot_range *range, double below, double above)
{
	const bool known = range->high > 0;
	const double low = known ? range->low / below : 1e-3, high = known ? range->high * above : 1e3;
	const double decades = log10(high / low);
	fprintf(file, "set logscale y\nset mytics 1\nset format y \"10^{%%T}\"\nset yrange [%.3g:%.3g]\nset ytics %g\n",
		low, high,
		decades <= 5    ? 10.0
		: decades <= 10 ? 100.0
				: 1000.0);
}
