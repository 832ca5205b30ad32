/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/report.h"
#include "data_readers/text_quote.h"
#include "fit/cli/terminal.h"
#include "fit/results/interval_text.h"
#include "fit/results/result.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* JSON */

static void json_string(FILE *file, const char *text)
{
	fputc('"', file);
	while (*text) {
		uint32_t code;
		const size_t length = text_character(text, &code);
		if (*text == '"' || *text == '\\')
			fprintf(file, "\\%c", *text);
		else if (text_printable(text))
			fwrite(text, 1, length, file);
		else
			fprintf(file, "\\u%04x", length ? (unsigned)code : 0xfffdu);
		text += length ? length : 1;
	}
	fputc('"', file);
}

static void json_cell(FILE *file, const char *cell, bool number)
{
	char text[CSV_NUMBER_SIZE];
	double x = NAN;
	if (!*cell)
		fputs("null", file);
	else if (number && csv_parse_number(cell, &x) && isfinite(x))
		fputs(csv_number(text, x), file);
	else
		json_string(file, cell);
}

void report_json(FILE *file, const struct csv_table *table)
{
	fputs("[", file);
	for (size_t i = 0; i < table->n_rows; i++) {
		fputs(i ? ",\n {" : "\n {", file);
		for (int c = 0; c < table->n_columns; c++) {
			fputs(c ? ", " : "", file);
			json_string(file, table->column[c].name);
			fputs(": ", file);
			json_cell(file, table->row[i][c], table->column[c].number);
		}
		fputs("}", file);
	}
	fputs("\n]\n", file);
}

/* Readable tables */

static int text_width(const char *text)
{
	return terminal_columns(text, strlen(text));
}

static void print_padded(FILE *file, const char *text, int width, bool right)
{
	const int padding = width > text_width(text) ? width - text_width(text) : 0;
	if (right)
		fprintf(file, "%*s%s", padding, "", text);
	else
		fprintf(file, "%s%*s", text, padding, "");
}

enum { SHOWN_SIZE = 160 };

/* A cell in readable form. */
static const char *shown_cell(char text[SHOWN_SIZE], const char *cell, bool number)
{
	double x = NAN;
	if (number && *cell && csv_parse_number(cell, &x) && strlen(cell) > 5)
		snprintf(text, SHOWN_SIZE, fabs(x) < 1e15 && x == rint(x) ? "%.0f" : "%.5g", x);
	else
		text_quote(cell, text, SHOWN_SIZE);
	return text;
}

enum { GAP = 2, HEADING_LINES = 4 };

/* Line `line` of a heading that is broken at its underscores. */
static const char *heading_line(const char *name, int line, char text[SHOWN_SIZE])
{
	text[0] = '\0';
	for (; line > 0 && name; line--) {
		name = strchr(name, '_');
		name += name != NULL;
	}
	if (name)
		snprintf(text, SHOWN_SIZE, "%.*s", (int)strcspn(name, "_"), name);
	return text;
}

/* The columns that cells need; the heading whole, or broken. Returns the width of the table. */
static int column_widths(const struct csv_table *table, bool broken, int *width)
{
	char text[SHOWN_SIZE];
	int sum = 0;
	for (int c = 0; c < table->n_columns; c++) {
		width[c] = 0;
		for (int line = 0; line < (broken ? HEADING_LINES : 1); line++) {
			const char *heading = broken ? heading_line(table->column[c].name, line, text)
						     : shown_cell(text, table->column[c].name, false);
			width[c] = text_width(heading) > width[c] ? text_width(heading) : width[c];
		}
		for (size_t i = 0; i < table->n_rows; i++) {
			const int needed = text_width(shown_cell(text, table->row[i][c], table->column[c].number));
			width[c] = needed > width[c] ? needed : width[c];
		}
		sum += width[c] + (c ? GAP : 0);
	}
	return sum;
}

/* Columns of a table that stand beside each other: the first, and from `from` to before `to`. */
struct block {
	int from, to;
	bool broken; /* headings are */
	const int *width;
};

/* The column behind `c` in a block. */
static int next_column(const struct block *block, int c)
{
	return c == 0 ? block->from : c + 1;
}

static void print_heading(FILE *file, const struct csv_table *table, const struct block *block)
{
	char text[SHOWN_SIZE];
	bool more = true;
	for (int line = 0; more; line++) {
		more = false;
		for (int c = 0; c < block->to; c = next_column(block, c)) {
			const struct csv_column *column = &table->column[c];
			const char *heading = block->broken ? heading_line(column->name, line, text)
							    : shown_cell(text, column->name, false);
			fputs(c ? "  " : "", file);
			print_padded(file, heading, block->width[c], column->number);
			char next[SHOWN_SIZE];
			more |= block->broken && line + 1 < HEADING_LINES &&
				*heading_line(column->name, line + 1, next);
		}
		fputc('\n', file);
	}
}

static void print_block(FILE *file, const struct csv_table *table, const struct block *block)
{
	char text[SHOWN_SIZE];
	print_heading(file, table, block);
	for (size_t i = 0; i < table->n_rows; i++) {
		for (int c = 0; c < block->to; c = next_column(block, c)) {
			const struct csv_column *column = &table->column[c];
			shown_cell(text, table->row[i][c], column->number);
			fputs(c ? "  " : "", file);
			print_padded(file, terminal_cut(text, block->width[c]), block->width[c], column->number);
		}
		fputc('\n', file);
	}
}

/* Names give way to numbers, down to this. */
enum { NAME_LEAST = 16 };

void report_table(FILE *file, const struct csv_table *table)
{
	int *width = calloc((size_t)table->n_columns, sizeof(*width));
	if (!width)
		return;
	/* Where a terminal is too narrow, long headings are broken, then names in the first column cut, then columns go below. */
	const int limit = terminal_table_width(file);
	struct block block = {.from = 1, .width = width};
	block.broken = column_widths(table, false, width) > limit;
	const int excess = column_widths(table, block.broken, width) - limit;
	if (excess > 0 && !table->column[0].number && width[0] > NAME_LEAST)
		width[0] = width[0] - excess > NAME_LEAST ? width[0] - excess : NAME_LEAST;
	do {
		int sum = width[0];
		for (block.to = block.from; block.to < table->n_columns; sum += GAP + width[block.to++])
			if (block.to > block.from && sum + GAP + width[block.to] > limit)
				break;
		fputs(block.from > 1 ? "\n" : "", file);
		print_block(file, table, &block);
		block.from = block.to;
	} while (block.from < table->n_columns);
	free(width);
}

void report_records(FILE *file, const struct csv_table *table)
{
	char text[SHOWN_SIZE];
	for (size_t i = 0; i < table->n_rows; i++) {
		if (i)
			fputc('\n', file);
		for (int c = 0; c < table->n_columns; c++)
			fprintf(file, "%-20s %s\n", table->column[c].name,
				shown_cell(text, table->row[i][c], table->column[c].number));
	}
}

void report_output(const struct csv_table *table, enum show show, report_readable *readable)
{
	if (show == SHOW_JSON)
		report_json(stdout, table);
	else if (show == SHOW_READABLE)
		readable(stdout, table);
	else if (show == SHOW_CSV)
		csv_write(stdout, table);
}

/* Three factors in one column; one number if they are equal, as those of a gray model are. */
static const char *rgb_text(char text[SHOWN_SIZE], char *const *row, enum result_column first)
{
	const double x[3] = {result_number(row, first), result_number(row, first + 1), result_number(row, first + 2)};
	if (isnan(x[0]))
		return "-";
	snprintf(text, SHOWN_SIZE, "%.4f %.4f %.4f", x[0], x[1], x[2]);
	return text;
}

/* A remark behind a row, or below it. */
static void print_remark(FILE *file, const char *text, bool narrow)
{
	enum { INDENT = 4 };
	if (!narrow) {
		fprintf(file, "  %s", text);
		return;
	}
	fprintf(file, "\n%*s", INDENT, "");
	terminal_wrap(file, text, INDENT, INDENT, terminal_table_width(file));
}

/* A status that is not the usual one. */
static void print_status(FILE *file, const char *status, bool narrow)
{
	char text[SHOWN_SIZE], remark[SHOWN_SIZE + 2];
	if (!strcmp(status, "converged"))
		return;
	text_quote(strcmp(status, "limit") ? status : "stopped by a limit", text, sizeof text);
	snprintf(remark, sizeof remark, "(%s)", text);
	print_remark(file, remark, narrow);
}

/* The roughness along both axes, of which the column sigma has the geometric mean. */
static void print_axes(FILE *file, char *const *row, bool narrow)
{
	const double x = result_number(row, RESULT_SIGMA_X), y = result_number(row, RESULT_SIGMA_Y);
	double tilt_x, tilt_y;
	char text[SHOWN_SIZE], tilt[SHOWN_SIZE] = "";
	if (isnan(x) || isnan(y))
		return;
	if (result_param(row[RESULT_PARAMS], "tilt_x", &tilt_x) && result_param(row[RESULT_PARAMS], "tilt_y", &tilt_y))
		snprintf(tilt, sizeof tilt, ", tilt %.4g,%.4g", tilt_x, tilt_y);
	snprintf(text, sizeof text, "(sigma_x %.5g, sigma_y %.5g, angle %.4g%.40s)", x, y,
		 result_number(row, RESULT_ANGLE), tilt);
	print_remark(file, text, narrow);
}

/* Between which values the parameters may lie, below the row. */
static void print_intervals(FILE *file, char *const *row)
{
	static const char *const name[INTERVAL_PARAMETERS] = {
		"sigma", "gamma", "n", "k", "exponent", "sigma2", "gamma2", "sigma_x/sigma_y", "angle"};
	char text[INTERVAL_PARAMETERS * (INTERVAL_TEXT_SIZE + SHOWN_SIZE)] = "", one[INTERVAL_TEXT_SIZE];
	int used = 0;
	for (enum interval_parameter p = 0; p < INTERVAL_PARAMETERS; p++)
		if (*interval_text(one, row, p))
			used += snprintf(text + used, sizeof text - (size_t)used, "%s%s %s", used ? ", " : "", name[p],
					 one);
	if (used)
		print_remark(file, text, true);
}

/* And how far they move when the entries are taken to stand elsewhere. */
static void print_other_bins(FILE *file, char *const *row)
{
	static const char lead[] = "at bin centres ";
	char text[sizeof lead + OTHER_BINS_SIZE], moves[OTHER_BINS_SIZE];
	if (!*other_bins_text(moves, row))
		return;
	snprintf(text, sizeof text, "%s%s", lead, moves);
	print_remark(file, text, true);
}

/* What a model of more terms than two has beside the columns. */
static void print_terms(FILE *file, char *const *row, bool narrow)
{
	char a[SHOWN_SIZE], text[3 * SHOWN_SIZE + 32];

	if (*row[RESULT_F0_R]) {
		char b[SHOWN_SIZE], c[SHOWN_SIZE];

		snprintf(text, sizeof text, "(F0 %s, F82 %s, F90 %s)", rgb_text(a, row, RESULT_F0_R),
			 rgb_text(b, row, RESULT_F82_R), rgb_text(c, row, RESULT_F90_R));
		print_remark(file, text, narrow);
	}
	if (*row[RESULT_KG_R]) {
		snprintf(text, sizeof text, "(kg %s, exponent %.4g)", rgb_text(a, row, RESULT_KG_R),
			 result_number(row, RESULT_EXPONENT));
		print_remark(file, text, narrow);
	}
	if (*row[RESULT_SIGMA2]) {
		snprintf(text, sizeof text, "(ks2 %s, sigma2 %.5g, gamma2 %.5g)", rgb_text(a, row, RESULT_KS2_R),
			 result_number(row, RESULT_SIGMA2), result_number(row, RESULT_GAMMA2));
		print_remark(file, text, narrow);
	}
}

/* The columns of a table of fits; of its names, at least: a wider terminal shares the rest between them and remarks. */
enum { FITS_WIDTH = 126, FITS_NAME = 22 };

/* A terminal too narrow for all columns gets the factors on a line of their own. */
static bool is_narrow(FILE *file)
{
	return terminal_table_width(file) < FITS_WIDTH;
}

enum { WEIGHT_WIDTH = 11 };

static void print_fit(FILE *file, char *const *row, bool narrow, bool weights)
{
	static const struct {
		enum result_column column;
		int width;
		const char *format;
	} number[] = {
		{RESULT_ERROR, 9, "%.5f"},
		{RESULT_SIGMA, 9, "%.5f"},
		{RESULT_GAMMA, 8, "%.5g"},
		{RESULT_IOR, 8, "%.5g"},
	};
	char text[SHOWN_SIZE];
	text_quote(row[RESULT_MATERIAL], text, sizeof text);
	terminal_cut(text, FITS_NAME + (narrow ? 0 : (terminal_table_width(file) - FITS_WIDTH) / 2));
	print_padded(file, text, FITS_NAME, false);
	fputs("  ", file);
	text_quote(row[RESULT_NDF], text, sizeof text);
	print_padded(file, text, 8, false);
	if (weights) {
		fputs("  ", file);
		text_quote(row[RESULT_WEIGHT], text, sizeof text);
		print_padded(file, text, WEIGHT_WIDTH, false);
	}
	if (result_failed(row)) {
		text_quote(row[RESULT_STATUS], text, sizeof text);
		print_remark(file, text, narrow);
		fputc('\n', file);
		return;
	}
	for (size_t i = 0; i < sizeof number / sizeof *number; i++) {
		const double x = result_number(row, number[i].column);
		snprintf(text, sizeof text, number[i].format, x);
		fprintf(file, " %*s", number[i].width, isnan(x) ? "-" : text);
	}
	fprintf(file, narrow ? "\n    kd %-20s" : "  %-20s", rgb_text(text, row, RESULT_KD_R));
	fprintf(file, narrow ? "  ks %-20s" : "  %-20s", rgb_text(text, row, RESULT_KS_R));
	text_quote(row[RESULT_AT_BOUND], text, sizeof text);
	char bound[SHOWN_SIZE + 16];
	snprintf(bound, sizeof bound, "%s%s", narrow ? "at bound: " : "", text);
	if (*text)
		print_remark(file, bound, narrow);
	print_axes(file, row, narrow);
	print_terms(file, row, narrow);
	print_status(file, row[RESULT_STATUS], narrow);
	if (!strcmp(row[RESULT_ENERGY], "gain"))
		print_remark(file, "(sends back more light than it gets)", narrow);
	print_intervals(file, row);
	print_other_bins(file, row);
	fputc('\n', file);
}

void report_fits(FILE *file, const struct csv_table *results, bool heading, bool weights)
{
	const bool narrow = is_narrow(file);
	if (heading) {
		fprintf(file, "%-*s  %-8s", FITS_NAME, "material", "ndf");
		if (weights)
			fprintf(file, "  %-*s", WEIGHT_WIDTH, "weight");
		fprintf(file, " %9s %9s %8s %8s", "error", "sigma", "gamma", "n");
		if (!narrow)
			fprintf(file, "  %-20s  %-20s  %s", "kd", "ks", "at bound");
		fputc('\n', file);
	}
	for (size_t i = 0; i < results->n_rows; i++)
		print_fit(file, results->row[i], narrow, weights);
}
