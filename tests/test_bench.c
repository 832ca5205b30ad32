/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program: bench, --trace, --algorithm. Runs $STDFIT or build/stdfit. */
#include "check.h"
#include "fit/results/result.h"
#include "fit/results/trace.h"

#include <sys/wait.h>
#include <unistd.h>

/* Few entries, so that even a little time does. */
#define SMALL "--max-theta 20 m.binary"

static char directory[] = "/tmp/stdfit-bench-XXXXXX";

/* Runs a shell command in the temporary directory: "$STDFIT" is the program. Returns its exit code. */
static int shell(const char *command)
{
	const int status = system(command);

	assert_true(WIFEXITED(status));
	return WEXITSTATUS(status);
}

static void expect_run(const char *command, int code)
{
	const int got = shell(command);

	if (got != code)
		fail_msg("%s: exit code %d, expected %d", command, got, code);
}

/* One line on standard error, kept in `err`, that begins "stdfit: " and has `part`. */
static void expect_message(const char *part)
{
	char line[1024] = "", more[8];
	FILE *file = fopen("err", "r");

	assert_non_null(file);
	assert_non_null(fgets(line, sizeof line, file));
	assert_null(fgets(more, sizeof more, file));
	fclose(file);
	if (strncmp(line, "stdfit: ", 8) != 0 || !strstr(line, part))
		fail_msg("expected '%s', found: %s", part, line);
}

static struct csv_table read_csv(const char *path, const struct csv_column *columns, int n)
{
	struct csv_table table = csv_table_make(columns, n);
	struct error error;

	if (csv_table_read(&table, path, n, NULL, &error) != STATUS_OK)
		fail_msg("%s", error.text);
	return table;
}

static double number(const char *cell)
{
	double x = NAN;

	assert_true(csv_parse_number(cell, &x));
	return x;
}

static int set_up(void **state)
{
	char *top = getcwd(NULL, 0), *path = NULL;
	const char *program = getenv("STDFIT");

	(void)state;
	/* Against a program that does not end. */
	alarm(300);
	assert_non_null(top);
	assert_true(asprintf(&path, "%s/%s", top, program ? program : "build/stdfit") > 0);
	setenv("STDFIT", program && program[0] == '/' ? program : path, 1);
	free(path);
	free(top);
	assert_non_null(mkdtemp(directory));
	assert_int_equal(chdir(directory), 0);
	return shell(
		"\"$STDFIT\" synth m.binary --sigma 0.15 --gamma 1.9 --ndf std --kd 0.1,0.2,0.3 --ks 0.5 --noise 0.2");
}

static int tear_down(void **state)
{
	(void)state;
	return shell("rm -rf \"$PWD\"");
}

/* Within a search and a stage each row is better than the one before, and later. */
static void check_curves(const struct csv_table *t)
{
	assert_true(t->n_rows > 0);
	for (size_t i = 0; i < t->n_rows; i++) {
		char **row = t->row[i], **before = i ? t->row[i - 1] : row;
		bool same = i > 0;

		assert_string_equal(row[TRACE_MATERIAL], "m");
		assert_true(!*row[TRACE_ERROR] || number(row[TRACE_ERROR]) > 0);
		for (int c = TRACE_MATERIAL; c <= TRACE_ALGORITHM; c++)
			same &= !strcmp(row[c], before[c]);
		if (!same)
			continue;
		check_between(number(row[TRACE_SECONDS]), number(before[TRACE_SECONDS]), 1e6, "seconds");
		check_between(number(row[TRACE_EVALUATIONS]), number(before[TRACE_EVALUATIONS]), 1e9, "evaluations");
		if (!strcmp(row[TRACE_STAGE], before[TRACE_STAGE]))
			check_between(number(row[TRACE_ERROR]), 0, nextafter(number(before[TRACE_ERROR]), 0),
				      "falling error");
	}
}

static void a_bench_has_a_row_an_algorithm(void **state)
{
	static const struct csv_column columns[] = {{"material", false},   {"ndf", false},       {"algorithm", false},
						    {"error_0.1s", true},  {"error_0.3s", true}, {"error_1s", true},
						    {"error_3s", true},    {"error_10s", true},  {"error", true},
						    {"evaluations", true}, {"seconds", true}};
	static const char *const names[] = {"crs2", "default", "sbplx-joint"};
	enum { COLUMNS = sizeof columns / sizeof *columns, ERROR = 8, EVALUATIONS, SECONDS };
	struct csv_table table, trace;

	(void)state;
	/* On a slow machine some may find nothing in time: their cells are empty then. */
	expect_run("\"$STDFIT\" bench " SMALL " --algorithm crs2,default,sbplx-joint --time 0.4 --trace t.csv >b.csv",
		   0);
	table = read_csv("b.csv", columns, COLUMNS);
	trace = read_csv("t.csv", trace_columns, TRACE_COLUMNS);
	check_curves(&trace);
	assert_int_equal(table.n_rows, 3);
	for (int i = 0; i < 3; i++) {
		char **row = table.row[i];
		double before = INFINITY, end = NAN;

		assert_string_equal(row[0], "m");
		assert_string_equal(row[1], "std");
		assert_string_equal(row[2], names[i]);
		/* Only evaluations within the time; none is above the one before. */
		for (int c = 3; c < ERROR; c++) {
			if (!*row[c])
				continue;
			assert_true(c <= 4);
			check_between(number(row[c]), 0, before, columns[c].name);
			before = number(row[c]);
		}
		if (*row[ERROR])
			check_between(number(row[ERROR]), 0, before, "end");
		else
			assert_true(isinf(before));
		check_between(number(row[EVALUATIONS]), 1, 1e9, "evaluations");
		check_between(number(row[SECONDS]), 0, 0.4, "seconds");
		/* The curve's last point is the row's error. */
		for (size_t n = 0; n < trace.n_rows; n++)
			if (!strcmp(trace.row[n][TRACE_ALGORITHM], names[i]))
				end = number(trace.row[n][TRACE_ERROR]);
		check_abs(end, number(row[ERROR]), 0, "end of the curve");
	}
	csv_table_free(&trace);
	csv_table_free(&table);
}

/* The default's curve, each shape of which was judged by the full table, ends where a fit ends. */
static void the_default_of_a_bench_is_the_fit(void **state)
{
	struct csv_table fit, trace;

	(void)state;
	expect_run("\"$STDFIT\" bench " SMALL " --algorithm default --ndf ggx --time 1000 --trace t.csv >b.csv", 0);
	expect_run("\"$STDFIT\" fit " SMALL " --ndf ggx >f.csv", 0);
	fit = read_csv("f.csv", result_columns, RESULT_COLUMNS);
	trace = read_csv("t.csv", trace_columns, TRACE_COLUMNS);
	check_curves(&trace);
	char **end = trace.row[trace.n_rows - 1];

	assert_string_equal(end[TRACE_STAGE], "end");
	check_rel(number(end[TRACE_ERROR]), result_number(fit.row[0], RESULT_ERROR), 1e-5, "error");
	check_abs(number(end[TRACE_EVALUATIONS]), result_number(fit.row[0], RESULT_EVALUATIONS), 0, "evaluations");
	for (size_t i = 1; i < trace.n_rows; i++)
		check_between(number(trace.row[i][TRACE_ERROR]), 0, number(trace.row[i - 1][TRACE_ERROR]),
			      "full table");
	csv_table_free(&trace);
	csv_table_free(&fit);
}

enum { FORM_NAME = 2, FORM_ERROR, FORM_EXACT, FORM_SIGMA, FORM_GAMMA, FORM_IOR, FORM_EVALUATIONS, FORM_SECONDS, FORMS };

static struct csv_table bench_forms(const char *arguments)
{
	static const struct csv_column columns[FORMS] = {
		{"material", false}, {"ndf", false},  {"lambda", false}, {"error", true},       {"error_exact", true},
		{"sigma", true},     {"gamma", true}, {"ior", true},     {"evaluations", true}, {"seconds", true}};
	char command[256];

	snprintf(command, sizeof command, "\"$STDFIT\" bench --forms %s >b.csv", arguments);
	expect_run(command, 0);
	return read_csv("b.csv", columns, FORMS);
}

static void a_bench_of_forms_has_a_row_a_form(void **state)
{
	static const char *const names[] = {"exact", "2f1", "integer", "half-integer", "rational"};
	struct csv_table table = bench_forms(SMALL " --sigma 0.15 --ior 1.5");
	double gamma[5], error[5], error_exact[5];

	(void)state;
	assert_int_equal(table.n_rows, 5);
	for (int i = 0; i < 5; i++) {
		char **row = table.row[i];

		assert_string_equal(row[0], "m");
		assert_string_equal(row[1], "std");
		assert_string_equal(row[FORM_NAME], names[i]);
		error[i] = number(row[FORM_ERROR]);
		error_exact[i] = number(row[FORM_EXACT]);
		gamma[i] = number(row[FORM_GAMMA]);
		check_between(error[i], 0.01, 0.99, "error");
		check_abs(number(row[FORM_SIGMA]), 0.15, 0, "sigma");
		check_abs(number(row[FORM_IOR]), 1.5, 0, "ior");
		check_between(number(row[FORM_EVALUATIONS]), 1, 1e9, "evaluations");
		check_between(number(row[FORM_SECONDS]), 0, 1e6, "seconds");
	}
	check_abs(error_exact[0], error[0], 0, "error of the exact form");
	/* The same function: the same optimum, as near as a search comes to it. */
	check_rel(error_exact[1], error[1], 1e-9, "2f1 is exact");
	check_rel(error[1], error[0], 1e-6, "2f1 and exact");
	/* Only some gammas: each sum has the one next to 1.9 or further, and cannot be better. */
	check_abs(gamma[2], round(gamma[2]), 0, "integer");
	check_abs(gamma[3] - 0.5, round(gamma[3] - 0.5), 0, "half-integer");
	check_between(error[2], error[0] * (1 - 1e-6), 0.99, "integer");
	check_between(error[3], error[2], 0.99, "half-integer");
	/* Off by some tenths of a percent in G1: another E, and none below the exact one's own. */
	assert_true(error_exact[4] != error[4]);
	check_between(error_exact[4], error[0] * (1 - 1e-6), error[0] * 1.01, "rational");
	csv_table_free(&table);
}

/* 2.5 is a half-integer: no row but the integer's stays empty, whose name remains. */
static void a_form_without_the_gamma_has_an_empty_row(void **state)
{
	struct csv_table table = bench_forms(SMALL " --ndf t-family --sigma 0.15 --ior 1.5 --gamma 2.5");

	(void)state;
	assert_int_equal(table.n_rows, 5);
	for (int i = 0; i < 5; i++) {
		char **row = table.row[i];
		const bool empty = !strcmp(row[FORM_NAME], "integer");

		assert_string_equal(row[1], "t-family");
		for (int c = FORM_ERROR; c < FORMS; c++)
			assert_int_equal(!*row[c], empty);
		if (!empty)
			check_abs(number(row[FORM_GAMMA]), 2.5, 0, "gamma");
	}
	assert_string_equal(table.row[2][FORM_NAME], "integer");
	csv_table_free(&table);
}

static void a_fit_records_its_algorithm(void **state)
{
	struct csv_table rows, trace;

	(void)state;
	expect_run("\"$STDFIT\" fit " SMALL " --ndf ggx,beckmann --algorithm cobyla --time 0.05 --trace t.csv >f.csv",
		   0);
	rows = read_csv("f.csv", result_columns, RESULT_COLUMNS);
	trace = read_csv("t.csv", trace_columns, TRACE_COLUMNS);
	check_curves(&trace);
	assert_int_equal(rows.n_rows, 2);
	for (int i = 0; i < 2; i++) {
		assert_string_equal(rows.row[i][RESULT_STATUS], "limit");
		assert_non_null(strstr(rows.row[i][RESULT_OPTIONS], "algorithm=cobyla time=0.05"));
	}
	for (size_t i = 0; i < trace.n_rows; i++)
		assert_string_equal(trace.row[i][TRACE_ALGORITHM], "cobyla");
	csv_table_free(&trace);
	csv_table_free(&rows);
	/* The default is silent about it, and its trace has its stages. */
	expect_run("\"$STDFIT\" fit " SMALL " --ndf ggx --trace t.csv >f.csv", 0);
	rows = read_csv("f.csv", result_columns, RESULT_COLUMNS);
	trace = read_csv("t.csv", trace_columns, TRACE_COLUMNS);
	check_curves(&trace);
	assert_null(strstr(rows.row[0][RESULT_OPTIONS], "algorithm"));
	assert_string_equal(trace.row[0][TRACE_STAGE], "scan");
	assert_string_equal(trace.row[0][TRACE_ALGORITHM], "default");
	assert_string_equal(trace.row[trace.n_rows - 1][TRACE_STAGE], "full");
	csv_table_free(&trace);
	csv_table_free(&rows);
}

static void wrong_usage_is_refused(void **state)
{
	static const struct {
		const char *arguments, *part;
	} wrong[] = {
		{"fit m.binary --algorithm nelder", "expected one of default, esch, esch-joint"},
		{"fit m.binary --algorithm crs2,isres", "expected one of"},
		{"fit m.binary --time 3", "--time means nothing"},
		{"fit m.binary --algorithm crs2 --time 0", "bad value '0' for --time"},
		{"fit m.binary --algorithm crs2 --starts 3", "--starts means nothing"},
		{"fit m.binary --trace t.csv --within 1%", "exclude each other"},
		{"fit m.binary --trace t.csv -o t.csv", "the same file"},
		{"bench m.binary m.binary", "expected one FILE"},
		{"bench m.binary --ndf std,ggx", "--ndf takes one name"},
		{"bench m.binary --algorithm crs2,crs2", "twice"},
		{"bench", "expected FILE"},
		{"bench m.binary --forms --algorithm crs2", "--forms and --algorithm exclude each other"},
		{"bench m.binary --forms --time 3", "--forms and --time exclude each other"},
		{"bench m.binary --forms --trace t.csv", "--forms and --trace exclude each other"},
		{"bench m.binary --forms --lambda 2f1", "--forms and --lambda exclude each other"},
		{"bench m.binary --forms --no-specular", "--forms and --no-specular exclude each other"},
		{"bench m.binary --forms --gaf v-groove", "which has no Lambda"},
		{"bench m.binary --forms --ndf ggx", "--forms means nothing for ggx"},
	};

	(void)state;
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		char command[256];

		snprintf(command, sizeof command, "\"$STDFIT\" %s 2>err >out", wrong[i].arguments);
		expect_run(command, 2);
		expect_message(wrong[i].part);
	}
	expect_run("\"$STDFIT\" bench nowhere.binary 2>err", 1);
	expect_message("nowhere.binary");
	expect_run("\"$STDFIT\" bench m.binary --trace none/t.csv 2>err", 1);
	expect_message("none/t.csv");
	/* A trace of nothing takes no older one's place, and leaves nothing beside it. */
	expect_run("echo precious >old.csv; \"$STDFIT\" fit nowhere.binary --trace old.csv 2>err >out", 1);
	expect_run("[ \"$(cat old.csv)\" = precious ] && ! ls -A | grep -q '[.]tmp$'", 0);
}

/* An interrupt ends a bench early, with what it had come to. */
static void a_bench_can_be_interrupted(void **state)
{
	(void)state;
	/* Its trace under way shows that it has begun. */
	expect_run("\"$STDFIT\" bench " SMALL
		   " --algorithm default,crs2 --time 100000 --trace way.csv >b.csv & pid=$!; "
		   "until ls -A | grep -q '[.]tmp$'; do sleep 0.05; kill -0 $pid || exit 1; done; kill -INT $pid; wait "
		   "$pid",
		   130);
	expect_run("[ \"$(head -n 1 b.csv | cut -d, -f1-3)\" = material,ndf,algorithm ]", 0);
	expect_run("ls -A | grep -q '[.]tmp$'", 1);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_bench_has_a_row_an_algorithm),
		cmocka_unit_test(the_default_of_a_bench_is_the_fit),
		cmocka_unit_test(a_bench_of_forms_has_a_row_a_form),
		cmocka_unit_test(a_form_without_the_gamma_has_an_empty_row),
		cmocka_unit_test(a_fit_records_its_algorithm),
		cmocka_unit_test(wrong_usage_is_refused),
		cmocka_unit_test(a_bench_can_be_interrupted),
	};

	return cmocka_run_group_tests_name("bench", tests, set_up, tear_down);
}
