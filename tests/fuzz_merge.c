/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit merge of two result tables. The first byte chooses the form of the output. The tables stand behind each other,
 * a byte 0xff between them, each as fuzz_rows.h describes. */
#include "fit/commands/commands.h"
#include "fit/results/store.h"
#include "fuzz_rows.h"
#include "json_check.h"

enum { BETWEEN = 0xff };

static char directory[64], first_path[80], second_path[80], merged_path[80];

static void clean_up(void)
{
	unlink(first_path);
	unlink(second_path);
	unlink(merged_path);
	rmdir(directory);
}

static void make_directory(void)
{
	if (directory[0])
		return;
	fuzz_make_directory(directory);
	snprintf(first_path, sizeof first_path, "%s/a.csv", directory);
	snprintf(second_path, sizeof second_path, "%s/b.csv", directory);
	snprintf(merged_path, sizeof merged_path, "%s/c.csv", directory);
	atexit(clean_up);
}

/* Returns the exit code; *output is what was written, to be freed. */
static int merge(char *a, char *b, char *form, char **output)
{
	static char name[] = "merge";
	char *argv[] = {name, a, b, form, NULL};
	atomic_bool cancel = false;
	struct capture out = capture_begin(stdout), err = capture_begin(stderr);
	const int code = cmd_merge(form ? 4 : 3, argv, &cancel);
	capture_end(&err, stderr);
	capture_end(&out, stdout);
	/* EXIT_USAGE: both files are measurements, whatever their names. */
	PROMISE(code == EXIT_DONE || code == EXIT_FAILED || code == EXIT_USAGE);
	PROMISE(code == EXIT_DONE ? err.size == 0 : is_message(err.text));
	PROMISE((code == EXIT_DONE) == (out.size > 0));
	*output = out.text;
	free(err.text);
	return code;
}

static struct csv_table read_rows(const char *path)
{
	struct csv_table rows = csv_table_make(result_columns, RESULT_COLUMNS);
	struct error error;
	PROMISE(csv_table_read(&rows, path, RESULT_LATER, NULL, &error) == STATUS_OK);
	return rows;
}

static bool has_row(const struct csv_table *table, char *const *row)
{
	for (size_t i = 0; i < table->n_rows; i++)
		if (result_difference(table->row[i], row) == RESULT_COLUMNS)
			return true;
	return false;
}

/* Every row of `some` stands in `all`, but for its seconds. */
static void check_rows(const struct csv_table *some, const struct csv_table *all)
{
	for (size_t i = 0; i < some->n_rows; i++)
		PROMISE(has_row(all, some->row[i]));
}

/* No row is lost, none is invented, and merged again with one of its parts nothing changes. */
static void check_merged(const char *text)
{
	char *again;
	fuzz_write_file(merged_path, text, strlen(text));
	struct csv_table a = read_rows(first_path), b = read_rows(second_path), c = read_rows(merged_path);
	check_rows(&a, &c);
	check_rows(&b, &c);
	PROMISE(c.n_rows <= a.n_rows + b.n_rows);
	for (size_t i = 0; i < c.n_rows; i++)
		PROMISE(has_row(&a, c.row[i]) || has_row(&b, c.row[i]));
	PROMISE(merge(merged_path, second_path, NULL, &again) == EXIT_DONE);
	PROMISE(!strcmp(again, text));
	free(again);
	csv_table_free(&c);
	csv_table_free(&b);
	csv_table_free(&a);
}

static void check(char *form)
{
	char *text, *turned;
	const int code = merge(first_path, second_path, form, &text);
	/* What fits together does so in either order. */
	PROMISE(merge(second_path, first_path, form, &turned) == code);
	if (code == EXIT_DONE && !form)
		check_merged(text);
	if (code == EXIT_DONE && form && !strcmp(form, "--json"))
		PROMISE(json_is_valid(text));
	free(turned);
	free(text);
}

int fuzz_merge(const uint8_t *data, size_t size)
{
	static char json[] = "--json", table[] = "--table";
	const uint8_t *between = size > 1 ? memchr(data + 2, BETWEEN, size - 2) : NULL;
	if (!between || between + 1 == data + size)
		return 0;
	make_directory();
	fuzz_write_table(first_path, data + 1, (size_t)(between - data) - 1);
	fuzz_write_table(second_path, between + 1, (size_t)(data + size - between) - 1);
	check(data[0] % 4 == 1 ? json : data[0] % 4 == 2 ? table : NULL);
	return 0;
}
