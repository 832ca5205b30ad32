/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/results/csv.h"
#include "data_readers/measurement_read.h"
#include "data_readers/text_file.h"
#include "data_readers/text_quote.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* No result table comes near this; it keeps a wrong file from filling the memory. */
enum { FILE_SIZE_MAX = 256 * 1024 * 1024 };
/* More than this behind the last complete line is not the rest of one interrupted write. */
enum { CUT_LINE_MAX = 65536 };

struct csv_table csv_table_make(const struct csv_column *column, int n_columns)
{
	return (struct csv_table){.column = column, .n_columns = n_columns};
}

void csv_table_free(struct csv_table *table)
{
	for (size_t i = 0; i < table->n_rows; i++)
		free(table->row[i]);
	free(table->row);
	*table = csv_table_make(table->column, table->n_columns);
}

static enum status table_reserve(struct csv_table *table, size_t n_rows)
{
	if (n_rows <= table->capacity)
		return STATUS_OK;
	const size_t capacity = n_rows > 2 * table->capacity ? n_rows : 2 * table->capacity;
	char ***row = realloc(table->row, capacity * sizeof(*row));
	if (!row)
		return STATUS_NO_MEMORY;
	table->row = row;
	table->capacity = capacity;
	return STATUS_OK;
}

enum status csv_table_add(struct csv_table *table, const char *const *cell)
{
	const size_t n = (size_t)table->n_columns;
	size_t size = n * sizeof(char *);
	for (size_t c = 0; c < n; c++)
		size += (cell[c] ? strlen(cell[c]) : 0) + 1;
	if (table_reserve(table, table->n_rows + 1) != STATUS_OK)
		return STATUS_NO_MEMORY;
	char **row = malloc(size);
	if (!row)
		return STATUS_NO_MEMORY;
	char *text = (char *)(row + n);
	for (size_t c = 0; c < n; c++) {
		row[c] = text;
		text = stpcpy(text, cell[c] ? cell[c] : "") + 1;
	}
	table->row[table->n_rows++] = row;
	return STATUS_OK;
}

enum status csv_table_move(struct csv_table *table, struct csv_table *from)
{
	if (table_reserve(table, table->n_rows + from->n_rows) != STATUS_OK)
		return STATUS_NO_MEMORY;
	for (size_t i = 0; i < from->n_rows; i++)
		table->row[table->n_rows++] = from->row[i];
	from->n_rows = 0;
	csv_table_free(from);
	return STATUS_OK;
}

bool csv_is_name(const char *path)
{
	const size_t length = strlen(path);
	return length > 4 && !strcasecmp(path + length - 4, ".csv") && !measurement_is_known(path);
}

/* Writing */

static void write_cell(FILE *file, const char *cell)
{
	if (!cell[strcspn(cell, ",\"\r\n")]) {
		fputs(cell, file);
		return;
	}
	fputc('"', file);
	for (; *cell; cell++) {
		if (*cell == '"')
			fputc('"', file);
		fputc(*cell, file);
	}
	fputc('"', file);
}

void csv_write_row(FILE *file, char *const *cell, int n_columns)
{
	for (int c = 0; c < n_columns; c++) {
		write_cell(file, cell[c]);
		fputc(c + 1 < n_columns ? ',' : '\n', file);
	}
}

void csv_write_header(FILE *file, const struct csv_column *column, int n_columns)
{
	for (int c = 0; c < n_columns; c++) {
		write_cell(file, column[c].name);
		fputc(c + 1 < n_columns ? ',' : '\n', file);
	}
}

/* Reading */

struct reader {
	const char *path;
	char name[TEXT_QUOTE_SIZE]; /* the path, for messages */
	char *text, *at, *end;      /* the file, followed by a NUL; fields are cut out where they stand */
	size_t line, next_line;     /* of the record just read; of the one to come */
	char **field;
	size_t n_fields, capacity;
	bool terminated; /* the record just read ended with a newline */
};

static enum status read_text(struct reader *r, struct error *error)
{
	size_t size;
	struct error why;
	const enum status status = text_file_read(r->path, "a result table", FILE_SIZE_MAX, &r->text, &size, &why);
	if (status != STATUS_OK)
		return error_set(error, status, "cannot read '%s': %.200s", r->name, why.text);
	r->at = r->text;
	r->end = r->text + size;
	/* A byte order mark, as spreadsheets leave it. */
	if (!strncmp(r->at, "\xef\xbb\xbf", 3))
		r->at += 3;
	return STATUS_OK;
}

/* Undoes the quotes of the field at r->at where it stands and leaves r->at behind the closing one. */
static enum status unquote(struct reader *r, struct error *error)
{
	char *to = r->at;
	for (char *from = r->at + 1; from < r->end; from++) {
		if (*from == '"' && from[1] != '"') {
			*to = '\0';
			r->at = from + 1;
			if (r->at[0] == '\r' && r->at[1] == '\n')
				r->at++;
			if (*r->at && *r->at != ',' && *r->at != '\n')
				return error_set(error, STATUS_FORMAT,
						 "'%s' line %zu: expected a comma behind the closing quote", r->name,
						 r->next_line);
			return STATUS_OK;
		}
		if (*from == '"')
			from++;
		r->next_line += *from == '\n';
		*to++ = *from;
	}
	r->at = r->end;
	return error_set(error, STATUS_FORMAT, "'%s' line %zu: expected a closing quote, found the end of the file",
			 r->name, r->line);
}

static enum status push_field(struct reader *r, char *field)
{
	if (r->n_fields == r->capacity) {
		const size_t capacity = r->capacity ? 2 * r->capacity : 64;
		char **fields = realloc(r->field, capacity * sizeof(*fields));
		if (!fields)
			return STATUS_NO_MEMORY;
		r->field = fields;
		r->capacity = capacity;
	}
	r->field[r->n_fields++] = field;
	return STATUS_OK;
}

/* Reads the next record; none left: n_fields = 0. */
static enum status read_record(struct reader *r, struct error *error)
{
	r->n_fields = 0;
	r->line = r->next_line;
	r->terminated = false;
	for (bool more = r->at < r->end; more;) {
		char *field = r->at;
		if (*field == '"') {
			const enum status status = unquote(r, error);
			if (status != STATUS_OK)
				return status;
		} else {
			r->at += strcspn(r->at, ",\n");
		}
		const char separator = *r->at;
		/* Of a line that ends in CR LF, the CR is no part of the last field. */
		if (separator == '\n' && r->at > field && r->at[-1] == '\r')
			r->at[-1] = '\0';
		if (separator)
			*r->at++ = '\0';
		if (push_field(r, field) != STATUS_OK)
			return error_set(error, STATUS_NO_MEMORY, "cannot read '%s': out of memory", r->name);
		r->terminated = separator == '\n';
		r->next_line += r->terminated;
		more = separator == ',';
		if (r->terminated && r->n_fields == 1 && !*field) { /* an empty line */
			r->n_fields = 0;
			r->line = r->next_line;
			more = r->at < r->end;
		}
	}
	return STATUS_OK;
}

static enum status add_record(struct csv_table *table, struct reader *r, const size_t *index, size_t n_header,
			      const char **cell, struct error *error)
{
	if (r->n_fields != n_header)
		return error_set(error, STATUS_FORMAT, "'%s' line %zu: expected %zu fields, found %zu", r->name,
				 r->line, n_header, r->n_fields);
	for (int c = 0; c < table->n_columns; c++) {
		cell[c] = index[c] < n_header ? r->field[index[c]] : "";
		double x;
		if (table->column[c].number && !csv_parse_number(cell[c], &x)) {
			char found[64];
			text_quote(cell[c], found, sizeof found);
			return error_set(error, STATUS_FORMAT,
					 "'%s' line %zu: expected a number in column %s, found '%s'", r->name, r->line,
					 table->column[c].name, found);
		}
	}
	if (csv_table_add(table, cell) != STATUS_OK)
		return error_set(error, STATUS_NO_MEMORY, "cannot read '%s': out of memory", r->name);
	return STATUS_OK;
}

/* index[c]: where the header has column c; n_fields of the header when nowhere. */
static enum status find_columns(const struct csv_table *table, const struct reader *r, int needed, size_t *index,
				struct error *error)
{
	for (int c = 0; c < table->n_columns; c++) {
		index[c] = 0;
		while (index[c] < r->n_fields && strcmp(r->field[index[c]], table->column[c].name) != 0)
			index[c]++;
		if (index[c] == r->n_fields && c < needed)
			return error_set(error, STATUS_FORMAT,
					 "'%s' line 1: expected a header with column %s, found none", r->name,
					 table->column[c].name);
	}
	return STATUS_OK;
}

static enum status read_rows(struct csv_table *table, struct reader *r, int needed, size_t *complete,
			     struct error *error)
{
	size_t *index = calloc((size_t)table->n_columns, sizeof(*index));
	const char **cell = calloc((size_t)table->n_columns, sizeof(*cell));
	enum status status = STATUS_OK;
	if (!index || !cell) {
		status = error_set(error, STATUS_NO_MEMORY, "cannot read '%s': out of memory", r->name);
		goto out;
	}
	status = read_record(r, error);
	if (status == STATUS_OK)
		status = find_columns(table, r, needed, index, error);
	const size_t n_header = r->n_fields;
	if (status == STATUS_OK && complete)
		*complete = (size_t)(r->at - r->text);
	while (status == STATUS_OK) {
		const char *start = r->at;
		struct error why;
		status = read_record(r, &why);
		if (complete && !r->terminated && r->end - start < CUT_LINE_MAX) {
			status = STATUS_OK;
			break;
		}
		if (status != STATUS_OK)
			error_set(error, status, "%s", why.text);
		if (status != STATUS_OK || !r->n_fields)
			break;
		status = add_record(table, r, index, n_header, cell, error);
		if (complete)
			*complete = (size_t)(r->at - r->text);
	}
out:
	free(cell);
	free(index);
	return status;
}

enum status csv_table_read(struct csv_table *table, const char *path, int needed, size_t *complete, struct error *error)
{
	struct reader r = {.path = path, .next_line = 1};
	text_quote(path, r.name, sizeof r.name);
	enum status status = read_text(&r, error);
	if (status == STATUS_OK)
		status = read_rows(table, &r, needed, complete, error);
	if (status != STATUS_OK)
		csv_table_free(table);
	free(r.field);
	free(r.text);
	return status;
}

void csv_write(FILE *file, const struct csv_table *table)
{
	csv_write_header(file, table->column, table->n_columns);
	for (size_t i = 0; i < table->n_rows; i++)
		csv_write_row(file, table->row[i], table->n_columns);
}
