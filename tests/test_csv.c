/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV: numbers that read back exactly, quotes, and files that are not as they should be. */
#include "check.h"
#include "fit/results/csv.h"

#include <float.h>
#include <unistd.h>

static const struct csv_column columns[] = {{"name", false}, {"value", true}, {"note", false}};
enum { NAME, VALUE, NOTE, COLUMNS };

static char path[] = "/tmp/stdfit-csv-XXXXXX";

static int set_up(void **state)
{
	(void)state;
	const int fd = mkstemp(path);
	return fd < 0 || close(fd);
}

static int tear_down(void **state)
{
	(void)state;
	return unlink(path);
}

static void write_bytes(const void *bytes, size_t size)
{
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(bytes, 1, size, file), size);
	assert_int_equal(fclose(file), 0);
}

static enum status read_bytes(struct csv_table *table, const void *bytes, size_t size, size_t *complete,
			      struct error *error)
{
	write_bytes(bytes, size);
	*table = csv_table_make(columns, COLUMNS);
	error->text[0] = '\0';
	return csv_table_read(table, path, 2, complete, error);
}

static enum status read_string(struct csv_table *table, const char *text, size_t *complete, struct error *error)
{
	return read_bytes(table, text, strlen(text), complete, error);
}

static void check_number(double x)
{
	char text[CSV_NUMBER_SIZE];
	double back = 0;
	assert_true(csv_parse_number(csv_number(text, x), &back));
	if (memcmp(&back, &x, sizeof x) != 0)
		fail_msg("%.17g was written as %s and came back as %.17g", x, text, back);
}

static void numbers_read_back(void **state)
{
	(void)state;
	static const double odd[] = {0,       -0.0,         0.1,  1.0 / 3, 2.385,    DBL_MAX,
				     DBL_MIN, DBL_TRUE_MIN, 1e22, -7,      INFINITY, -INFINITY};
	for (size_t i = 0; i < sizeof odd / sizeof *odd; i++)
		check_number(odd[i]);
	uint64_t bits = 88172645463325252u; /* xorshift64 */
	for (int i = 0; i < 200000; i++) {
		bits ^= bits << 13;
		bits ^= bits >> 7;
		bits ^= bits << 17;
		double x;
		memcpy(&x, &bits, sizeof x);
		if (!isnan(x) && !isinf(x))
			check_number(x);
	}
}

static void numbers_are_short(void **state)
{
	(void)state;
	char text[CSV_NUMBER_SIZE];
	assert_string_equal(csv_number(text, 0.1), "0.1");
	assert_string_equal(csv_number(text, 1500), "1500");
	assert_string_equal(csv_number(text, INFINITY), "inf");
	assert_string_equal(csv_number(text, NAN), "");
}

static void what_is_no_number_is_refused(void **state)
{
	(void)state;
	static const char *const bad[] = {" 1",   "1 ",    "1,5",    "0x10",  "nan",      "NaN", "infinity",
					  "+inf", "1e999", "-1e999", "1.2.3", "--1",      "e5",  ".",
					  "+",    "1e",    "one",    "1\n",   "\302\2401"};
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		double x = 4.25;
		if (csv_parse_number(bad[i], &x))
			fail_msg("'%s' was taken for the number %g", bad[i], x);
		assert_true(x == 4.25);
	}
	double x = 1;
	assert_true(csv_parse_number("", &x));
	assert_true(isnan(x));
}

static void cells_come_back(void **state)
{
	(void)state;
	static const char *const cells[][COLUMNS] = {
		{"plain", "1", "nothing special"},
		{"comma, and \"quotes\"", "-2.5e-300", "\"\""},
		{"line\nbreak", "inf", "carriage\rreturn\r\n"},
		{"\xff\xfe bytes \x80", "", ","},
		{"", "", ""},
		{" spaces ", "-inf", "\""},
	};
	enum { ROWS = sizeof cells / sizeof *cells };
	struct csv_table table = csv_table_make(columns, COLUMNS), back;
	struct error error;
	FILE *file = fopen(path, "wb");
	assert_non_null(file);
	csv_write_header(file, columns, COLUMNS);
	for (int i = 0; i < ROWS; i++) {
		assert_int_equal(csv_table_add(&table, cells[i]), STATUS_OK);
		csv_write_row(file, table.row[i], COLUMNS);
	}
	assert_int_equal(fclose(file), 0);
	back = csv_table_make(columns, COLUMNS);
	assert_int_equal(csv_table_read(&back, path, COLUMNS, NULL, &error), STATUS_OK);
	assert_int_equal(back.n_rows, ROWS);
	for (int i = 0; i < ROWS; i++)
		for (int c = 0; c < COLUMNS; c++)
			assert_string_equal(back.row[i][c], cells[i][c]);
	csv_table_free(&table);
	csv_table_free(&back);
}

static void columns_are_found_by_name(void **state)
{
	(void)state;
	struct csv_table table;
	struct error error;
	/* A byte order mark, CR LF, an unknown column, an absent one, an empty line, no newline at the end. */
	assert_int_equal(read_string(&table, "\xef\xbb\xbfother,value,name\r\nx,2,a\r\n\r\n\"y,y\",,\"b\"\"\"\r\nz,3,c",
				     NULL, &error),
			 STATUS_OK);
	assert_int_equal(table.n_rows, 3);
	assert_string_equal(table.row[0][NAME], "a");
	assert_string_equal(table.row[0][VALUE], "2");
	assert_string_equal(table.row[0][NOTE], "");
	assert_string_equal(table.row[1][NAME], "b\"");
	assert_string_equal(table.row[1][VALUE], "");
	assert_string_equal(table.row[2][NAME], "c");
	csv_table_free(&table);
}

static void malformed_files_are_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text, *message;
	} bad[] = {
		{"", "line 1: expected a header with column name"},
		{"\n\n", "expected a header with column name"},
		{"nome,value\na,1\n", "line 1: expected a header with column name"},
		{"name\na\n", "line 1: expected a header with column value"},
		{"name,value\na\n", "line 2: expected 2 fields, found 1"},
		{"name,value\na,1\nb,2,3\n", "line 3: expected 2 fields, found 3"},
		{"name,value\na,1\nb,\"2\"x\n", "line 3: expected a comma behind the closing quote"},
		{"name,value\n\"a\nb\",1\nc,\"2\n", "line 4: expected a closing quote"},
		{"name,value\na,one\n", "line 2: expected a number in column value, found 'one'"},
		{"name,value\na,1e999\n", "line 2: expected a number in column value"},
		{"name,value\na,\n,x\x1b[2J\n", "line 3: expected a number in column value, found 'x\\x1b[2J'"},
	};
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		struct csv_table table;
		struct error error;
		if (read_string(&table, bad[i].text, NULL, &error) != STATUS_FORMAT)
			fail_msg("accepted: %s", bad[i].text);
		if (!strstr(error.text, bad[i].message) || !strstr(error.text, path) || strchr(error.text, '\n'))
			fail_msg("'%s' lacks '%s'", error.text, bad[i].message);
		assert_int_equal(table.n_rows, 0);
		csv_table_free(&table);
	}
}

static void zero_bytes_are_refused(void **state)
{
	(void)state;
	static const char text[] = "name,value\na\0b,1\n";
	struct csv_table table;
	struct error error;
	assert_int_equal(read_bytes(&table, text, sizeof text - 1, NULL, &error), STATUS_FORMAT);
	assert_non_null(strstr(error.text, "zero byte"));
}

static void missing_files_and_directories_are_refused(void **state)
{
	(void)state;
	struct csv_table table = csv_table_make(columns, COLUMNS);
	struct error error;
	assert_int_equal(csv_table_read(&table, "/nowhere/at/all.csv", 1, NULL, &error), STATUS_IO);
	assert_string_equal(error.text, "cannot read '/nowhere/at/all.csv': No such file or directory");
	assert_int_equal(csv_table_read(&table, "/", 1, NULL, &error), STATUS_IO);
	assert_string_equal(error.text, "cannot read '/': Is a directory");
}

/* However a write is cut short, what was complete before it is there, and it says where that ends. */
static void every_cut_keeps_the_complete_lines(void **state)
{
	(void)state;
	static const char text[] = "name,value,note\na,1,x\n\"b\nb\",2,\"q\"\"q\"\nc,3,\n";
	const size_t header = strlen("name,value,note\n");
	for (size_t size = header; size < sizeof text; size++) {
		struct csv_table table;
		struct error error;
		size_t complete = 0;
		assert_int_equal(read_bytes(&table, text, size, &complete, &error), STATUS_OK);
		const size_t ends[] = {header, header + 6, header + 21, header + 26};
		size_t rows = 0;
		while (rows + 1 < 4 && ends[rows + 1] <= size)
			rows++;
		assert_int_equal(table.n_rows, rows);
		assert_int_equal(complete, ends[rows]);
		csv_table_free(&table);
	}
}

static void damage_never_crashes(void **state)
{
	(void)state;
	static const char sound[] = "name,value,note\na,1,x\n\"b\nb\",2,\"q\"\"q\"\r\nc,3,\n";
	static const char bytes[] = {'"', ',', '\n', '\r', '\0', 'e', '\xff'};
	enum { SIZE = sizeof sound - 1 };
	for (size_t at = 0; at < SIZE; at++)
		for (size_t b = 0; b < sizeof bytes; b++) {
			char text[SIZE];
			struct csv_table table;
			struct error error;
			size_t complete = 0;
			memcpy(text, sound, SIZE);
			text[at] = bytes[b];
			const enum status status = read_bytes(&table, text, SIZE, b % 2 ? &complete : NULL, &error);
			assert_true(status == STATUS_OK || status == STATUS_FORMAT);
			assert_true((status == STATUS_OK) == !*error.text);
			assert_true(complete <= SIZE);
			assert_true(table.n_rows <= SIZE);
			csv_table_free(&table);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(numbers_read_back),
		cmocka_unit_test(numbers_are_short),
		cmocka_unit_test(what_is_no_number_is_refused),
		cmocka_unit_test(cells_come_back),
		cmocka_unit_test(columns_are_found_by_name),
		cmocka_unit_test(malformed_files_are_refused),
		cmocka_unit_test(zero_bytes_are_refused),
		cmocka_unit_test(missing_files_and_directories_are_refused),
		cmocka_unit_test(every_cut_keeps_the_complete_lines),
		cmocka_unit_test(damage_never_crashes),
	};
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
