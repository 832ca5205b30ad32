/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/compare.h"

#include <gsl/gsl_statistics_double.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char floor_ndf[] = "pl";

/* The index of an NDF in the list; -1 when it is not there. */
static int ndf_index(const struct comparison *c, const char *ndf)
{
	for (int i = 0; i < c->n_ndf; i++)
		if (!strcmp(c->ndf[i], ndf))
			return i;
	return -1;
}

static enum status collect_ndfs(struct comparison *c, const struct csv_table *rows, struct error *error)
{
	for (size_t i = 0; i < rows->n_rows; i++) {
		const char *ndf = rows->row[i][RESULT_NDF];
		if (ndf_index(c, ndf) >= 0)
			continue;
		if (c->n_ndf == FIT_NDFS_MAX)
			return error_set(error, STATUS_UNSUPPORTED, "expected at most %d NDFs", FIT_NDFS_MAX);
		c->ndf[c->n_ndf++] = ndf;
	}
	return STATUS_OK;
}

static void set_relations(struct comparison *c)
{
	c->relation[c->n_relations++] = (struct compare_relation){"std", "ggx", false};
	c->relation[c->n_relations++] = (struct compare_relation){"std", "beckmann", false};
	for (int i = 0; i < c->n_ndf && ndf_index(c, floor_ndf) >= 0; i++)
		if (strcmp(c->ndf[i], floor_ndf) != 0)
			c->relation[c->n_relations++] = (struct compare_relation){c->ndf[i], floor_ndf, true};
	c->n_values = c->n_ndf + c->n_relations + (c->pictures ? 2 * c->n_ndf : 0);
}

/* The first of the columns of pictures: delta E of each NDF, then SSIM. */
static int first_picture(const struct comparison *c)
{
	return c->n_ndf + c->n_relations;
}

static void name_column(const struct comparison *c, int i, char name[COMPARE_NAME_SIZE])
{
	const int picture = i - first_picture(c);
	const struct compare_relation *r = &c->relation[i >= c->n_ndf && picture < 0 ? i - c->n_ndf : 0];
	if (i < c->n_ndf)
		snprintf(name, COMPARE_NAME_SIZE, "error_%s", c->ndf[i]);
	else if (picture >= c->n_ndf)
		snprintf(name, COMPARE_NAME_SIZE, "ssim_%s", c->ndf[picture - c->n_ndf]);
	else if (picture >= 0)
		snprintf(name, COMPARE_NAME_SIZE, "delta_e_%s", c->ndf[picture]);
	else if (r->above)
		snprintf(name, COMPARE_NAME_SIZE, "%s_above_%s", r->of, r->over);
	else
		snprintf(name, COMPARE_NAME_SIZE, "gain_over_%s", r->over);
}

static enum status name_columns(struct comparison *c, size_t n_rows)
{
	int n = 0;
	c->column[n++] = (struct csv_column){"material", false};
	if (c->weights)
		c->column[n++] = (struct csv_column){"weight", false};
	for (int i = 0; i < c->n_values; i++) {
		if (i == c->n_ndf)
			c->column[n++] = (struct csv_column){"winner", false};
		name_column(c, i, c->name[i]);
		c->column[n++] = (struct csv_column){c->name[i], true};
	}
	c->table = csv_table_make(c->column, n);
	for (int i = 0; i < c->n_values; i++) {
		c->value[i] = calloc(n_rows + 1, sizeof(double));
		if (!c->value[i])
			return STATUS_NO_MEMORY;
	}
	return STATUS_OK;
}

static int material_order(const void *a, const void *b)
{
	char *const *row_a = *(char **const *)a, *const *row_b = *(char **const *)b;
	int order = strcmp(row_a[RESULT_WEIGHT], row_b[RESULT_WEIGHT]);
	if (!order)
		order = strcmp(row_a[RESULT_MATERIAL], row_b[RESULT_MATERIAL]);
	return order ? order : strcmp(row_a[RESULT_PATH], row_b[RESULT_PATH]);
}

enum status comparison_init(struct comparison *c, struct csv_table *rows, bool pictures, bool by_gain,
			    struct error *error)
{
	*c = (struct comparison){.pictures = pictures, .by_gain = by_gain};
	for (size_t i = 1; i < rows->n_rows; i++)
		c->weights |= strcmp(rows->row[0][RESULT_WEIGHT], rows->row[i][RESULT_WEIGHT]) != 0;
	enum status status = collect_ndfs(c, rows, error);
	if (status != STATUS_OK)
		return status;
	set_relations(c);
	status = name_columns(c, rows->n_rows);
	if (status != STATUS_OK)
		return error_set(error, status, "%s", status_str(status));
	qsort(rows->row, rows->n_rows, sizeof(*rows->row), material_order);
	return STATUS_OK;
}

void comparison_free(struct comparison *c)
{
	for (int i = 0; i < c->n_values; i++)
		free(c->value[i]);
	csv_table_free(&c->table);
}

size_t comparison_material_end(const struct csv_table *rows, size_t start)
{
	size_t end = start + 1;
	while (end < rows->n_rows && !material_order(&rows->row[start], &rows->row[end]))
		end++;
	return end;
}

/* A line: numbers for the value columns, text for the others. */
static enum status add_line(struct comparison *c, const char *material, const double *number, const char *winner)
{
	char text[COMPARE_VALUES_MAX][CSV_NUMBER_SIZE];
	const char *cell[COMPARE_VALUES_MAX + 3];
	int n = 0;
	cell[n++] = material;
	if (c->weights)
		cell[n++] = c->weight;
	for (int i = 0; i < c->n_values; i++) {
		if (i == c->n_ndf)
			cell[n++] = winner;
		cell[n++] = csv_number(text[i], number[i]);
	}
	return csv_table_add(&c->table, cell);
}

static const char *find_winner(struct comparison *c, const double *error)
{
	int best = -1, same = 0;
	for (int i = 0; i < c->n_ndf; i++) {
		if (isnan(error[i]) || (c->n_ndf > 1 && !strcmp(c->ndf[i], floor_ndf)))
			continue;
		if (best < 0 || error[i] < error[best]) {
			best = i;
			same = 1;
		} else {
			same += error[i] == error[best];
		}
	}
	if (best < 0)
		return "";
	c->wins[best] += same == 1;
	c->ties += same > 1;
	return same > 1 ? "tie" : c->ndf[best];
}

static double find_relation(const struct comparison *c, const double *error, const struct compare_relation *r)
{
	const int of = ndf_index(c, r->of), over = ndf_index(c, r->over);
	if (of < 0 || over < 0)
		return NAN;
	return r->above ? 100 * (error[of] / error[over] - 1) : 100 * (1 - error[of] / error[over]);
}

/* Whether the smallest value of a column is the worst: so it is of gains and of SSIM. */
static bool worst_is_least(const struct comparison *c, int i)
{
	const int picture = i - first_picture(c);
	return picture >= 0 ? picture >= c->n_ndf : i >= c->n_ndf && !c->relation[i - c->n_ndf].above;
}

struct gain_line {
	double gain;
	size_t place;
	char **row;
};

static int gain_order(const void *a, const void *b)
{
	const struct gain_line *p = a, *q = b;
	if (p->gain != q->gain)
		return p->gain > q->gain ? -1 : 1;
	return p->place < q->place ? -1 : 1;
}

/* Orders the lines of one weight, whose values are still as they were added. */
static enum status sort_by_gain(struct comparison *c)
{
	const double *gain = c->value[c->n_ndf]; /* the first relation: STD over GGX */
	struct gain_line *line = calloc(c->n_materials + 1, sizeof *line);
	if (!line)
		return STATUS_NO_MEMORY;
	for (size_t i = 0; i < c->n_materials; i++)
		line[i] = (struct gain_line){isnan(gain[i]) ? -INFINITY : gain[i], i, c->table.row[c->first_line + i]};
	qsort(line, c->n_materials, sizeof *line, gain_order);
	for (size_t i = 0; i < c->n_materials; i++)
		c->table.row[c->first_line + i] = line[i].row;
	free(line);
	return STATUS_OK;
}

/* The summary of the lines of one weight, after which those of the next begin. */
static enum status end_weight(struct comparison *c)
{
	enum { MEAN, MEDIAN, WORST, WINS, LINES };
	static const char *const name[LINES] = {"(mean)", "(median)", "(worst)", "(wins)"};
	double number[LINES][COMPARE_VALUES_MAX] = {{0}};
	if (c->by_gain && sort_by_gain(c) != STATUS_OK)
		return STATUS_NO_MEMORY;
	for (int i = 0; i < c->n_values; i++) {
		double *x = c->value[i];
		size_t n = 0;
		for (size_t m = 0; m < c->n_materials; m++)
			if (!isnan(x[m]))
				x[n++] = x[m];
		number[WINS][i] = i < c->n_ndf ? (double)c->wins[i] : (double)NAN;
		number[MEAN][i] = n ? gsl_stats_mean(x, 1, n) : NAN;
		number[WORST][i] = !n ? NAN : worst_is_least(c, i) ? gsl_stats_min(x, 1, n) : gsl_stats_max(x, 1, n);
		number[MEDIAN][i] = n ? gsl_stats_median(x, 1, n) : NAN; /* reorders x */
	}
	char ties[COMPARE_NAME_SIZE];
	snprintf(ties, sizeof ties, "%d %s", c->ties, c->ties == 1 ? "tie" : "ties");
	for (int line = 0; line < LINES; line++)
		if (add_line(c, name[line], number[line], line == WINS ? ties : "") != STATUS_OK)
			return STATUS_NO_MEMORY;
	c->first_line = c->table.n_rows;
	c->n_materials = 0;
	c->ties = 0;
	memset(c->wins, 0, sizeof c->wins);
	return STATUS_OK;
}

enum status comparison_add(struct comparison *c, char **const *rows, size_t n, const struct compare_picture *picture)
{
	const int first = first_picture(c);
	double number[COMPARE_VALUES_MAX] = {0};
	const char *weight = rows[0][RESULT_WEIGHT];
	if (c->weights && c->weight && strcmp(c->weight, weight) != 0 && end_weight(c) != STATUS_OK)
		return STATUS_NO_MEMORY;
	c->weight = weight;
	for (int i = 0; i < c->n_values; i++)
		number[i] = NAN;
	for (size_t i = 0; i < n; i++) {
		const int ndf = ndf_index(c, rows[i][RESULT_NDF]);
		number[ndf] = result_number(rows[i], RESULT_ERROR);
		if (!c->pictures)
			continue;
		number[first + ndf] = picture[i].delta_e;
		number[first + c->n_ndf + ndf] = picture[i].ssim;
	}
	for (int r = 0; r < c->n_relations; r++)
		number[c->n_ndf + r] = find_relation(c, number, &c->relation[r]);
	for (int i = 0; i < c->n_values; i++)
		c->value[i][c->n_materials] = number[i];
	c->n_materials++;
	return add_line(c, rows[0][RESULT_MATERIAL], number, find_winner(c, number));
}

enum status comparison_end(struct comparison *c)
{
	return end_weight(c);
}
