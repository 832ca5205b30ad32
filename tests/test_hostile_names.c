/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names that nobody expects in pictures, pages, scripts and the formats of other programs. */
#include "fit/render/image.h"
#include "hostile_names.h"
#include "json_check.h"
#include "xml.h"

/* A fit that takes a moment: few free parameters, few entries. */
#define CHEAP "--ndf ggx --sigma 0.2 --ior 1.5 --max-theta 5"

static const char *const hostile_names[] = {HOSTILE_NAMES, "new\nline",   "\xff\xfe", "comma,comma",
					    "a\"b",        "back\\slash", "-->",      "-dash"};
enum { HOSTILE = sizeof hostile_names / sizeof *hostile_names, DRAWN = 4 };

/* hostile/NAME.binary, and hostile.csv: a fit of some of the hostile names, the file there, and of each name at all, without
 * a file. */
static int make_hostile_table(void)
{
	struct csv_table table = read_table("fit.csv");
	FILE *file = fopen("hostile.csv", "w");
	assert_non_null(file);
	csv_write_header(file, result_columns, RESULT_COLUMNS);
	for (size_t n = 0; n < DRAWN + NAMES; n++) {
		char *cell[RESULT_COLUMNS], nowhere[] = "nowhere.binary", name[64];
		memcpy(cell, table.row[0], sizeof cell);
		snprintf(name, sizeof name, "%s%s", n < DRAWN ? "" : "no ",
			 n < DRAWN ? hostile_names[n] : names[n - DRAWN]);
		cell[RESULT_MATERIAL] = name;
		cell[RESULT_PATH] = n < DRAWN ? cell[RESULT_PATH] : nowhere;
		csv_write_row(file, cell, RESULT_COLUMNS);
	}
	csv_table_free(&table);
	return fclose(file);
}

static int set_up(void **state)
{
	if (enter_directory(state))
		return -1;
	shell("\"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5 && mkdir hostile "
	      "&& exec "
	      "\"$STDFIT\" a.binary " CHEAP " -o fit.csv");
	if (last.code)
		return last.code;
	for (size_t n = 0; n < HOSTILE; n++) {
		char path[64];
		snprintf(path, sizeof path, "hostile/%s.binary", hostile_names[n]);
		if (link("a.binary", path))
			return -1;
	}
	return make_hostile_table();
}

/* The name of the directory that they write to. */
#define ODD_PLACE "'out, \"%s\" <b>&{}^_;'\\''`touch pwned`'"

/* One message a material whose file is not there, and nothing else. */
static void expect_nowhere(size_t n)
{
	expect_code(1);
	expect_printable(last.err, __LINE__);
	const char *at = last.err;
	for (; *at; at = strchr(at, '\n') + 1)
		if (strncmp(at, "stdfit: cannot read 'nowhere.binary'", 36))
			fail_msg("%s", at);
	assert_int_equal(count_lines(last.err), n);
}

static void expect_nothing_executed(void)
{
	shell("find . -name 'pwned*' -o -name '*.stdfit-*'");
	assert_string_equal(last.out, "");
}

static void names_do_no_harm_in_plots_and_pages(void **state)
{
	(void)state;
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	stdfit("plot hostile.csv -o " ODD_PLACE);
	expect_nowhere(NAMES);
	expect_nothing_executed();
	/* Every script runs by itself, too, and the pictures are there. */
	shell("cd " ODD_PLACE
	      " && ls */map.svg | wc -l && find . -name '*.svg' -delete && for s in *.gp */*.gp; do (cd "
	      "\"$(dirname \"$s\")\" && LC_ALL=C.UTF-8 gnuplot -d \"${s##*/}\") || exit; done; ls errors.svg */*.svg | "
	      "wc -l");
	expect_code(0);
	assert_string_equal(last.err, "");
	assert_string_equal(last.out, "4\n17\n");
	shell("cat " ODD_PLACE "/*.csv " ODD_PLACE "/*/*.csv " ODD_PLACE "/*.gp " ODD_PLACE "/*/*.gp");
	for (char *at = last.out; (at = strchr(at, '\t'));)
		*at = ' ';
	expect_printable(last.out, __LINE__);
	expect_nothing_executed();

	stdfit("report hostile.csv --size 16 --samples 1 -o " ODD_PLACE);
	drop_no_png();
	expect_nowhere(NAMES);
	shell("cat " ODD_PLACE "/index.html");
	for (char *at = last.out; (at = strchr(at, '\t'));)
		*at = ' ';
	expect_printable(last.out, __LINE__);
	assert_null(strstr(last.out, "<script>alert"));
	assert_null(strstr(last.out, "\"; system"));
	expect_out("<h3>&#60;script&#62;alert(1)&#60;script&#62;&#38;amp;&#38;\\xff&#34;&#39;</h3>");
	expect_out("<h3>&#34;; system(&#34;touch pwned&#34;); &#34;</h3>");
	size_t elements = 0;
	for (const char *at = last.out; (at = strstr(at, "<details ")); at++)
		elements++;
	assert_int_equal(elements, DRAWN + NAMES);
	expect_nothing_executed();
}

static void names_do_no_harm_in_traces(void **state)
{
	(void)state;
	char *text = NULL;
	size_t size;
	FILE *file = open_memstream(&text, &size);
	assert_non_null(file);
	fputs("material,ndf,algorithm,stage,evaluations,seconds,error\n", file);
	for (size_t n = 0; n < NAMES; n++) {
		char *cell[7] = {NULL}, name[64], rest[4][8] = {"full", "1", "0.5", "0.25"};
		snprintf(name, sizeof name, "%s", names[n]);
		for (int c = 0; c < 7; c++)
			cell[c] = c < 3 ? name : rest[c - 3];
		csv_write_row(file, cell, 7);
	}
	assert_int_equal(fclose(file), 0);
	write_text("names-trace.csv", text);
	free(text);
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	stdfit("plot names-trace.csv -o trace-plots");
	expect_code(0);
	assert_string_equal(last.err, "");
	shell("cat trace-plots/trace.gp trace-plots/trace.csv | tr '\\t' ' '");
	expect_printable(last.out, __LINE__);
	expect_nothing_executed();
}

static void names_do_no_harm_in_renderings(void **state)
{
	(void)state;
	static const struct csv_column columns[] = {{"material", false}, {"ndf", false},    {"error", true},
						    {"rmse", true},      {"delta_e", true}, {"ssim", true}};
	struct csv_table table = csv_table_make(columns, 6);
	struct error error = {""};
	struct image image;
	stdfit("render hostile --kd 1 --size 16 --samples 1 -o '{}.pfm' >rendered.csv");
	expect_code(0);
	if (csv_table_read(&table, "rendered.csv", 6, NULL, &error))
		fail_msg("%s", error.text);
	assert_int_equal(table.n_rows, HOSTILE);
	for (size_t n = 0; n < HOSTILE; n++) {
		size_t found = 0;
		for (size_t i = 0; i < HOSTILE; i++)
			found += !strcmp(table.row[i][0], hostile_names[n]);
		assert_int_equal(found, 1);
	}
	csv_table_free(&table);
	if (image_read("{}.pfm", &image, &error))
		fail_msg("%s", error.text);
	image_free(&image);
	if (image_has_png()) {
		shell("cd hostile; exec \"$STDFIT\" render *touch* *script* --kd 1 --size 16 --samples 1 -o "
		      "'../{}.png'");
		expect_code(0);
		shell("tail -c 8 {}.png | head -c 4");
		assert_string_equal(last.out, "IEND");
	}
	stdfit("render hostile.csv --size 16 --samples 1 --json -o nowhere.pfm");
	expect_code(1);
	assert_true(json_is_valid(last.out));
	shell("exec \"$STDFIT\" fit hostile/*touch* hostile/*script* " CHEAP " >four.csv");
	expect_code(0);
	stdfit("compare four.csv --pictures --json");
	expect_code(0);
	assert_true(json_is_valid(last.out));
	expect_nothing_executed();
}

static void names_do_no_harm_in_other_formats(void **state)
{
	(void)state;
	static const char *const format[] = {"json", "gltf", "mitsuba", "pbrt", "brdf"};
	for (size_t f = 0; f < sizeof format / sizeof *format; f++) {
		char command[256];
		snprintf(
			command, sizeof command,
			"n=0; for m in hostile/*; do \"$STDFIT\" export -q --kd 0.3 --format %s -o export-$n -- \"$m\" "
			"|| exit; "
			"n=$((n + 1)); done",
			format[f]);
		shell(command);
		expect_code(0);
		for (int n = 0; n < HOSTILE; n++) {
			char path[32];
			snprintf(path, sizeof path, "export-%d", n);
			char *text = slurp(path);
			for (char *at = text; (at = strchr(at, '\t'));)
				*at = ' ';
			expect_printable(text, __LINE__);
			if (f < 2)
				assert_true(json_is_valid(text));
			if (f == 2)
				xml_free(xml_parse(text));
			/* There a name is part of a comment only, which ends with its line. */
			const char *at = f > 2 ? strstr(text, "touch pwned") : NULL;
			while (at && at > text && at[-1] != '\n')
				at--;
			assert_true(!at || *at == '#' || !strncmp(at, "//", 2));
			free(text);
		}
	}
	/* A model's JSON, read, says the same again, what was no UTF-8 being so now. */
	shell("for m in hostile/*; do \"$STDFIT\" export --kd 0.3 --format json -- \"$m\" >1.json && \"$STDFIT\" "
	      "export "
	      "--from "
	      "1.json --format json >2.json && \"$STDFIT\" export --from 2.json --format json >3.json && cmp 2.json "
	      "3.json || exit; done");
	expect_code(0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(names_do_no_harm_in_renderings),
		cmocka_unit_test(names_do_no_harm_in_plots_and_pages),
		cmocka_unit_test(names_do_no_harm_in_traces),
		cmocka_unit_test(names_do_no_harm_in_other_formats),
	};
	return cmocka_run_group_tests(tests, set_up, leave_directory);
}
