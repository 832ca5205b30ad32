/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/contradiction.h"
#include "data_readers/text_quote.h"

#include <stdlib.h>
#include <string.h>

/* A row, its number, and the columns that say which fit it is of. */
struct numbered {
	char *const *row;
	size_t number;
	const enum result_column *key;
};

enum { KEY_MOST = 5 };
static const enum result_column key_of[][KEY_MOST + 1] = {
	[SAME_RUN] = {RESULT_PATH, RESULT_NDF, RESULT_OPTIONS, RESULT_VERSION, RESULT_INPUT, RESULT_COLUMNS},
	[SAME_LINE] = {RESULT_MATERIAL, RESULT_PATH, RESULT_NDF, RESULT_OPTIONS, RESULT_COLUMNS},
};

/* What a row has in a column of its key. Of the NDFs, --within takes one. */
static const char *key_text(char *const *row, enum result_column column)
{
	const bool any_ndf = column == RESULT_NDF && result_one_row_a_file(row) && !result_failed(row);
	return any_ndf ? "" : row[column];
}

static int key_order(const struct numbered *a, const struct numbered *b)
{
	int order = 0;
	for (int k = 0; a->key[k] < RESULT_COLUMNS && !order; k++)
		order = strcmp(key_text(a->row, a->key[k]), key_text(b->row, b->key[k]));
	return order;
}

static int numbered_order(const void *a, const void *b)
{
	const struct numbered *x = a, *y = b;
	const int order = key_order(x, y);
	return order ? order : (x->number > y->number) - (x->number < y->number);
}

/* The rows of one fit. */
static void look_at_group(const struct numbered *group, size_t n, struct contradiction *found, bool *doubtful,
			  bool *repeated)
{
	bool differ = false;
	for (size_t i = 1; i < n; i++) {
		const enum result_column column = result_difference(group[0].row, group[i].row);
		const bool first = !found->first || group[i].number < found->second;
		if (column < RESULT_COLUMNS && !differ && first)
			*found = (struct contradiction){group[0].number, group[i].number, column};
		differ |= column < RESULT_COLUMNS;
	}
	for (size_t i = 0; i < n; i++) {
		if (doubtful)
			doubtful[group[i].number - 1] = differ;
		if (repeated)
			repeated[group[i].number - 1] = i > 0 && !differ;
	}
}

enum status contradiction_find(const struct csv_table *rows, enum same_fit same, struct contradiction *found,
			       bool *doubtful, bool *repeated)
{
	size_t n = 0;
	struct numbered *sorted = calloc(rows->n_rows + 1, sizeof *sorted);
	*found = (struct contradiction){.column = RESULT_COLUMNS};
	if (!sorted)
		return STATUS_NO_MEMORY;
	for (size_t i = 0; i < rows->n_rows; i++)
		if (same != SAME_RUN || !result_failed(rows->row[i]))
			sorted[n++] = (struct numbered){rows->row[i], i + 1, key_of[same]};
	qsort(sorted, n, sizeof *sorted, numbered_order);
	for (size_t start = 0, end; start < n; start = end) {
		for (end = start + 1; end < n && !key_order(&sorted[start], &sorted[end]);)
			end++;
		look_at_group(sorted + start, end - start, found, doubtful, repeated);
	}
	free(sorted);
	return STATUS_OK;
}

enum status contradiction_check(const struct csv_table *rows, const char *path, struct error *error)
{
	struct contradiction found;
	char name[TEXT_QUOTE_SIZE];
	const enum status status = contradiction_find(rows, SAME_LINE, &found, NULL, NULL);
	if (status != STATUS_OK)
		return error_set(error, status, "out of memory");
	if (!found.first)
		return STATUS_OK;
	text_quote(path, name, sizeof name);
	return error_set(error, STATUS_FORMAT, "'%s' rows %zu and %zu, of the same fit, differ in %s", name,
			 found.first, found.second, result_columns[found.column].name);
}
