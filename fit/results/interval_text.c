/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/interval_text.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *sign(char *const *row, enum result_column end, const char *when_open)
{
	return strstr(row[RESULT_OPEN_ENDS], result_columns[end].name) ? when_open : "";
}

/* Appends one "LO:HI" of the column of other intervals. */
static void add_other(char text[INTERVAL_TEXT_SIZE], const char *ends)
{
	char one[64], *rest;
	const double lo = strtod(ends, &rest);
	if (*rest != ':')
		return;
	const double hi = strtod(rest + 1, NULL);
	snprintf(one, sizeof one, " or %.4g to %.4g", lo, hi);
	if (strlen(text) + strlen(one) < INTERVAL_TEXT_SIZE)
		strcat(text, one);
}

const char *interval_text(char text[INTERVAL_TEXT_SIZE], char *const *row, enum interval_parameter parameter)
{
	const enum result_column lo = result_interval_column(parameter), hi = lo + 1;
	const char *name = interval_parameter_name(parameter);
	const size_t length = strlen(name);
	*text = '\0';
	if (isnan(result_number(row, lo)) || isnan(result_number(row, hi)))
		return text;
	snprintf(text, INTERVAL_TEXT_SIZE, "%s%.4g to %s%.4g", sign(row, lo, "<="), result_number(row, lo),
		 sign(row, hi, ">="), result_number(row, hi));
	for (const char *other = row[RESULT_OTHER_INTERVALS]; other && *other;) {
		if (!strncmp(other, name, length) && other[length] == '=')
			add_other(text, other + length + 1);
		other = strchr(other, ';');
		other += other ? 1 : 0;
	}
	return text;
}

/* A parameter of one number, or of three that are added up. */
static const struct moving {
	const char *name;
	enum result_column first;
	int n;
} moving[] = {{"sigma", RESULT_SIGMA, 1},       {"gamma", RESULT_GAMMA, 1},   {"n", RESULT_IOR, 1},
	      {"exponent", RESULT_EXPONENT, 1}, {"sigma2", RESULT_SIGMA2, 1}, {"gamma2", RESULT_GAMMA2, 1},
	      {"kd", RESULT_KD_R, 3},           {"kg", RESULT_KG_R, 3},       {"ks", RESULT_KS_R, 3},
	      {"ks2", RESULT_KS2_R, 3},         {"F0", RESULT_F0_R, 3},       {"F82", RESULT_F82_R, 3},
	      {"F90", RESULT_F90_R, 3}};

/* NaN where either fit has it not. */
static double other_number(char *const *row, const struct moving *parameter)
{
	double sum = 0, one;
	for (int c = 0; c < parameter->n; c++) {
		const enum result_column column = parameter->first + (enum result_column)c;
		sum += result_param(row[RESULT_OTHER_BINS], result_columns[column].name, &one) ? one : NAN;
	}
	return sum;
}

static double own_number(char *const *row, const struct moving *parameter)
{
	double sum = 0;
	for (int c = 0; c < parameter->n; c++)
		sum += result_number(row, parameter->first + (enum result_column)c);
	return sum;
}

/* One more of "name +22 %". */
static void add_move(char text[OTHER_BINS_SIZE], const char *name, double own, double other)
{
	const size_t used = strlen(text);
	if (isnan(own) || isnan(other) || own == other)
		return;
	if (isfinite(own) && isfinite(other) && own != 0)
		snprintf(text + used, OTHER_BINS_SIZE - used, ", %s %+.3g %%", name, 100 * (other / own - 1));
	else
		snprintf(text + used, OTHER_BINS_SIZE - used, ", %s %.4g to %.4g", name, own, other);
}

const char *other_bins_text(char text[OTHER_BINS_SIZE], char *const *row)
{
	double own, other;
	*text = '\0';
	if (!result_param(row[RESULT_OTHER_BINS], "error", &other))
		return text;
	snprintf(text, OTHER_BINS_SIZE, "E %.4g", other);
	for (size_t p = 0; p < sizeof moving / sizeof *moving; p++)
		add_move(text, moving[p].name, own_number(row, &moving[p]), other_number(row, &moving[p]));
	if (result_param(row[RESULT_PARAMS], "k", &own) && result_param(row[RESULT_OTHER_BINS], "k", &other))
		add_move(text, "k", own, other);
	return text;
}
