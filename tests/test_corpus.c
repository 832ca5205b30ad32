/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every fuzz target over its corpus, without a fuzzer. */
#include "check.h"
#include "fuzz.h"
#include "json_check.h"

#include <dirent.h>
#include <signal.h>
#include <unistd.h>

static const char *volatile input; /* the file that is looked at */

static void on_abort(int number)
{
	static const char words[] = "this was ";
	(void)number;
	if (write(STDERR_FILENO, words, sizeof words - 1) > 0 && write(STDERR_FILENO, input, strlen(input)) > 0)
		(void)!write(STDERR_FILENO, "\n", 1);
}

static void run_file(const char *path, int (*target)(const uint8_t *, size_t))
{
	FILE *file = fopen(path, "rb");
	if (!file || fseek(file, 0, SEEK_END))
		fail_msg("cannot read %s", path);
	const size_t size = (size_t)ftell(file);
	rewind(file);
	uint8_t *data = malloc(size + 1);
	assert_non_null(data);
	assert_int_equal(fread(data, 1, size, file), size);
	fclose(file);
	input = path;
	assert_int_equal(target(data, size), 0);
	free(data);
}

static void run_corpus(const char *name, int (*target)(const uint8_t *, size_t))
{
	char path[512];
	int n = 0;
	snprintf(path, sizeof path, "tests/corpus/%s", name);
	DIR *directory = opendir(path);
	if (!directory)
		fail_msg("there is no %s", path);
	for (const struct dirent *entry; (entry = readdir(directory)); n++) {
		if (entry->d_name[0] == '.')
			continue;
		snprintf(path, sizeof path, "tests/corpus/%s/%s", name, entry->d_name);
		run_file(path, target);
	}
	closedir(directory);
	assert_true(n > 2);
}

static void merl_reader_keeps_its_promises(void **state)
{
	(void)state;
	run_corpus("merl", fuzz_merl);
}

static void rgl_reader_keeps_its_promises(void **state)
{
	(void)state;
	run_corpus("rgl", fuzz_rgl);
}

static void models_keep_their_promises(void **state)
{
	(void)state;
	run_corpus("model", fuzz_model);
}

static void pictures_keep_their_promises(void **state)
{
	(void)state;
	run_corpus("image", fuzz_image);
}

static void result_tables_keep_their_promises(void **state)
{
	(void)state;
	run_corpus("table", fuzz_table);
}

static void ndf_of_rows_keeps_its_promises(void **state)
{
	(void)state;
	run_corpus("ndf", fuzz_ndf);
}

static void merge_keeps_its_promises(void **state)
{
	(void)state;
	run_corpus("merge", fuzz_merge);
}

static void command_lines_keep_their_promises(void **state)
{
	(void)state;
	run_corpus("command_line", fuzz_command_line);
}

static void csv_reader_keeps_its_promises(void **state)
{
	(void)state;
	run_corpus("csv", fuzz_csv);
}

static void alta_reader_keeps_its_promises(void **state)
{
	(void)state;
	run_corpus("alta", fuzz_alta);
}

static void cornell_reader_keeps_its_promises(void **state)
{
	(void)state;
	run_corpus("cornell", fuzz_cornell);
}

static void zemax_reader_keeps_its_promises(void **state)
{
	(void)state;
	run_corpus("zemax", fuzz_zemax);
}

static void json_check_knows_json(void **state)
{
	(void)state;
	static const char *const sound[] = {"null", " [ ] ", "{\"a\": [1, -0.5e+3, true, \"\\u00e4\\n\xc3\xa4\"]}",
					    "0"};
	static const char *const unsound[] = {
		"",      "[",        "[1,]",        "{a: 1}",   "{\"a\" 1}", "01",           "1.",
		".5",    "nan",      "inf",         "\"\n\"",   "\"\xff\"",  "\"\\x\"",      "\"",
		"[] []", "+1",       "\"\\u12g4\"", "{\"a\":}", "[1 2]",     "\"\xc0\x80\"", "-",
		"1e",    "[\"\\\"]", "tru",
	};
	for (size_t i = 0; i < sizeof sound / sizeof *sound; i++)
		if (!json_is_valid(sound[i]))
			fail_msg("not taken for JSON: %s", sound[i]);
	for (size_t i = 0; i < sizeof unsound / sizeof *unsound; i++)
		if (json_is_valid(unsound[i]))
			fail_msg("taken for JSON: %s", unsound[i]);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(json_check_knows_json),
		cmocka_unit_test(merl_reader_keeps_its_promises),
		cmocka_unit_test(rgl_reader_keeps_its_promises),
		cmocka_unit_test(models_keep_their_promises),
		cmocka_unit_test(pictures_keep_their_promises),
		cmocka_unit_test(result_tables_keep_their_promises),
		cmocka_unit_test(ndf_of_rows_keeps_its_promises),
		cmocka_unit_test(merge_keeps_its_promises),
		cmocka_unit_test(command_lines_keep_their_promises),
		cmocka_unit_test(csv_reader_keeps_its_promises),
		cmocka_unit_test(alta_reader_keeps_its_promises),
		cmocka_unit_test(cornell_reader_keeps_its_promises),
		cmocka_unit_test(zemax_reader_keeps_its_promises),
	};
	signal(SIGABRT, on_abort); /* returns, and then it ends all the same */
	alarm(120);                /* a hang ends */
	return cmocka_run_group_tests(tests, NULL, NULL);
}
