/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/merge.h"
#include "data_readers/text_quote.h"
#include "fit/results/store.h"

#include <stdlib.h>
#include <string.h>

/* "'part-1.csv' row 3", for messages. */
enum { LOCATION_SIZE = TEXT_QUOTE_SIZE / 2 + 32 };
static const char *location(char text[LOCATION_SIZE], const struct merge_part *part)
{
	char name[TEXT_QUOTE_SIZE / 2];
	text_quote(part->table, name, sizeof name);
	snprintf(text, LOCATION_SIZE, "'%s' row %zu", name, part->number);
	return text;
}

static int weight_order(const struct merge_part *x, const struct merge_part *y)
{
	return strcmp(x->cell[RESULT_WEIGHT], y->cell[RESULT_WEIGHT]);
}

/* Of one file: by weight, then NDF. */
static int fit_order(const struct merge_part *x, const struct merge_part *y)
{
	const int order = weight_order(x, y);
	return order ? order : strcmp(x->cell[RESULT_NDF], y->cell[RESULT_NDF]);
}

/* qsort order: file, weight, NDF, turn. */
static int part_order(const void *a, const void *b)
{
	const struct merge_part *x = a, *y = b;
	int order = strcmp(x->cell[RESULT_PATH], y->cell[RESULT_PATH]);
	if (!order)
		order = fit_order(x, y);
	return order ? order : (x->turn > y->turn) - (x->turn < y->turn);
}

static enum status read_tables(struct merge *m, struct error *error)
{
	size_t n = 0;
	m->table = calloc((size_t)m->n_paths, sizeof(*m->table));
	if (!m->table)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	for (int t = 0; t < m->n_paths; t++)
		m->table[t] = csv_table_make(result_columns, RESULT_COLUMNS);
	for (int t = 0; t < m->n_paths; t++) {
		enum status status = store_check_columns(m->path[t], error);
		if (status == STATUS_OK)
			status = csv_table_read(&m->table[t], m->path[t], RESULT_LATER, NULL, error);
		if (status != STATUS_OK)
			return status;
		n += m->table[t].n_rows;
	}
	if (!n)
		return error_set(error, STATUS_NO_DATA, "no rows to merge");
	m->part = calloc(n, sizeof(*m->part));
	if (!m->part)
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	m->n = 0;
	for (int t = 0; t < m->n_paths; t++)
		for (size_t i = 0; i < m->table[t].n_rows; i++, m->n++)
			m->part[m->n] = (struct merge_part){m->table[t].row[i], m->path[t], i + 1, m->n};
	return STATUS_OK;
}

/* Takes the next word off a text of options. */
static size_t next_word(const char **text, const char **word)
{
	*word = *text + strspn(*text, " ");
	const size_t length = strcspn(*word, " ");
	*text = *word + length;
	return length;
}

static bool has_word(const char *text, const char *word, size_t length)
{
	const char *other;
	for (size_t n; (n = next_word(&text, &other));)
		if (n == length && !strncmp(other, word, length))
			return true;
	return false;
}

/* The first option of `text` that `other` has not; its length is 0 when there is none. */
static const char *word_of_one(const char *text, const char *other, size_t *length)
{
	const char *word;
	do
		*length = next_word(&text, &word);
	while (*length && has_word(other, word, *length));
	return word;
}

static enum status other_options(const struct merge_part *part, const struct merge_part *first, struct error *error)
{
	char here[LOCATION_SIZE], there[LOCATION_SIZE], word[64], shown[64];
	const char *text = part->cell[RESULT_OPTIONS], *other = first->cell[RESULT_OPTIONS], *which = "with";
	size_t length;
	const char *differs = word_of_one(text, other, &length);
	if (!length) {
		which = "without";
		differs = word_of_one(other, text, &length);
	}
	snprintf(word, sizeof word, "%.*s", (int)(length < sizeof word ? length : sizeof word), differs);
	text_quote(word, shown, sizeof shown);
	return error_set(error, STATUS_FORMAT, "%s: made with other options than %s: %s '%s'", location(here, part),
			 location(there, first), which, shown);
}

static enum status other_version(const struct merge_part *part, const struct merge_part *first, struct error *error)
{
	char here[LOCATION_SIZE], there[LOCATION_SIZE], version[32], other[32];
	text_quote(part->cell[RESULT_VERSION], version, sizeof version);
	text_quote(first->cell[RESULT_VERSION], other, sizeof other);
	return error_set(error, STATUS_FORMAT, "%s: made by version '%s', but %s by '%s'", location(here, part),
			 version, location(there, first), other);
}

/* All rows were made with the same options, but for the weight, by the same version. */
static enum status check_origin(const struct merge *m, struct error *error)
{
	const struct merge_part *first = &m->part[0];
	for (size_t i = 1; i < m->n; i++) {
		const struct merge_part *part = &m->part[i];
		if (strcmp(part->cell[RESULT_VERSION], first->cell[RESULT_VERSION]))
			return other_version(part, first, error);
		if (!result_same_but_weight(part->cell, first->cell))
			return other_options(part, first, error);
	}
	return STATUS_OK;
}

/* Two rows of one file: both say the same of its bytes, and of one fit there is one result. Returns whether they are
 * the same row in *same. */
static enum status check_pair(const struct merge *m, const struct merge_part *a, const struct merge_part *b, bool *same,
			      struct error *error)
{
	char here[LOCATION_SIZE], there[LOCATION_SIZE];
	*same = !fit_order(a, b);
	const bool rivals = *same || (result_one_row_a_file(m->part[0].cell) && !weight_order(a, b) &&
				      !(result_failed(a->cell) && result_failed(b->cell)));
	const enum result_column c = rivals ? result_difference(b->cell, a->cell) : RESULT_COLUMNS;
	if (c < RESULT_COLUMNS)
		return error_set(error, STATUS_FORMAT, "%s: differs in %s from %s, of the same file", location(here, b),
				 result_columns[c].name, location(there, a));
	if (strcmp(a->cell[RESULT_INPUT], b->cell[RESULT_INPUT]))
		return error_set(error, STATUS_FORMAT, "%s: made from other bytes than %s, of the same file",
				 location(here, b), location(there, a));
	return STATUS_OK;
}

/* Puts the rows in order and leaves the first of equal ones. */
static enum status sort_parts(struct merge *m, struct error *error)
{
	size_t kept = 0;
	if (m->n > 0)
		qsort(m->part, m->n, sizeof(*m->part), part_order);
	for (size_t i = 0; i < m->n; i++) {
		bool same = false;
		const struct merge_part *last = kept ? &m->part[kept - 1] : NULL;
		if (last && !strcmp(last->cell[RESULT_PATH], m->part[i].cell[RESULT_PATH])) {
			const enum status status = check_pair(m, last, &m->part[i], &same, error);
			if (status != STATUS_OK)
				return status;
		}
		if (!same)
			m->part[kept++] = m->part[i];
	}
	m->n = kept;
	return STATUS_OK;
}

/* The first row of the next file. */
static size_t next_file(const struct merge *m, size_t i)
{
	const struct merge_part *first = m->part + i;
	while (i < m->n && !strcmp(m->part[i].cell[RESULT_PATH], first->cell[RESULT_PATH]))
		i++;
	return i;
}

static enum status lacks(const struct merge_part *without, const struct merge_part *with, struct error *error)
{
	const bool one_row = result_one_row_a_file(with->cell);
	char path[TEXT_QUOTE_SIZE / 2], there[LOCATION_SIZE], what[32];
	text_quote(without->cell[RESULT_PATH], path, sizeof path);
	text_quote(with->cell[one_row ? RESULT_WEIGHT : RESULT_NDF], what, sizeof what);
	return error_set(error, STATUS_FORMAT,
			 "no row of '%s' for %s, as in %s: another %s, or a share that did not end", path, what,
			 location(there, with), one_row ? "--weight" : "--ndf or --weight");
}

/* The last row of the fit that row i is of: of --within, whose rows of a weight are one or failures, that weight's. */
static size_t last_of_fit(const struct merge *m, size_t i, size_t end)
{
	while (result_one_row_a_file(m->part[i].cell) && i + 1 < end && !weight_order(&m->part[i], &m->part[i + 1]))
		i++;
	return i;
}

/* Every file has rows of the same weights and NDFs; of --within, of the same weights. */
static enum status check_ndfs(const struct merge *m, struct error *error)
{
	const bool one_row = m->n > 0 && result_one_row_a_file(m->part[0].cell);
	size_t i = 0, j = next_file(m, 0);
	while (j < m->n) {
		const size_t end_i = j, end_j = next_file(m, j), start = j;
		for (; i < end_i || j < end_j; i++, j++) {
			i = i < end_i ? last_of_fit(m, i, end_i) : i;
			j = j < end_j ? last_of_fit(m, j, end_j) : j;
			const int order = i == end_i   ? 1
					  : j == end_j ? -1
					  : one_row    ? weight_order(&m->part[i], &m->part[j])
						       : fit_order(&m->part[i], &m->part[j]);
			if (order)
				return order < 0 ? lacks(&m->part[start], &m->part[i], error)
						 : lacks(&m->part[end_i - 1], &m->part[j], error);
		}
		i = start;
		j = end_j;
	}
	return STATUS_OK;
}

static const char *base_name(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? slash + 1 : path;
}

static bool is_given(const struct merge_files *files, const char *path)
{
	for (size_t f = 0; f < files->n; f++)
		if (!strcmp(files->path[f], path))
			return true;
	return false;
}

/* A file without a row: its share is not there, or the shares know it by another path. */
static enum status no_row(const struct merge *m, const struct merge_files *files, const char *path, struct error *error)
{
	char name[TEXT_QUOTE_SIZE / 2], other[TEXT_QUOTE_SIZE / 2], there[LOCATION_SIZE];
	text_quote(path, name, sizeof name);
	for (size_t i = 0; i < m->n; i++) {
		const char *fitted = m->part[i].cell[RESULT_PATH];
		if (strcmp(base_name(fitted), base_name(path)) != 0 || is_given(files, fitted))
			continue;
		text_quote(fitted, other, sizeof other);
		return error_set(error, STATUS_NO_DATA,
				 "no row of '%s', but %s is of '%s': expected the paths that were fitted", name,
				 location(there, &m->part[i]), other);
	}
	return error_set(error, STATUS_NO_DATA, "no row of '%s': its share is missing or did not end", name);
}

/* The rows are those of these files, which are in order, and of no others. */
static enum status check_files(const struct merge *m, const struct merge_files *files, struct error *error)
{
	char name[TEXT_QUOTE_SIZE / 2], here[LOCATION_SIZE];
	size_t i = 0;
	for (size_t f = 0; f < files->n || i < m->n; f++) {
		const int order = i == m->n       ? -1
				  : f == files->n ? 1
						  : strcmp(files->path[f], m->part[i].cell[RESULT_PATH]);
		if (order < 0)
			return no_row(m, files, files->path[f], error);
		if (order > 0) {
			text_quote(m->part[i].cell[RESULT_PATH], name, sizeof name);
			return error_set(error, STATUS_FORMAT, "%s: of '%s', which is not among the files given",
					 location(here, &m->part[i]), name);
		}
		i = next_file(m, i);
	}
	return STATUS_OK;
}

enum status merge_tables(struct merge *m, const struct merge_files *files, struct error *error)
{
	enum status status = read_tables(m, error);
	if (status == STATUS_OK)
		status = check_origin(m, error);
	if (status == STATUS_OK)
		status = sort_parts(m, error);
	if (status == STATUS_OK)
		status = check_ndfs(m, error);
	if (status == STATUS_OK && files)
		status = check_files(m, files, error);
	return status;
}

void merge_free(struct merge *m)
{
	for (int t = 0; m->table && t < m->n_paths; t++)
		csv_table_free(&m->table[t]);
	free(m->table);
	free(m->part);
}
