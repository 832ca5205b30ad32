/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `stdfit report`: text and files inside a page, the page as text, and in a browser where one is installed. Runs $STDFIT
 * or build/stdfit. */
#include "fit/page/html.h"
#include "fit/render/image.h"
#include "run_program.h"

#include <sys/resource.h>

/* A fit that takes a moment. */
#define SPHERES "--size 16 --samples 1"
#define CHEAP "--ndf ggx,beckmann --sigma 0.2 --ior 1.5 --max-theta 20"
/* A material's name that is markup, and no UTF-8. */
#define ODD "<i>&\\\"'\\`\xff\xc3\xa9</h3><script>alert(1)</script>"

static char *browser_script;

static void any_text_is_text(void **state)
{
	(void)state;
	char *text = NULL;
	size_t size;
	FILE *file = open_memstream(&text, &size);
	html_text(file, "a<b>&\"c'\n\x1b\xff\xc3\xa9");
	assert_int_equal(fclose(file), 0);
	assert_string_equal(text, "a&#60;b&#62;&#38;&#34;c&#39;\\x0a\\x1b\\xff\xc3\xa9");
	free(text);
}

/* RFC 4648, section 10, and bytes that are no text. */
static void files_become_base64(void **state)
{
	(void)state;
	static const struct {
		const char *bytes, *coded;
		size_t n;
	} vector[] = {{"", "", 0},
		      {"f", "Zg==", 1},
		      {"fo", "Zm8=", 2},
		      {"foo", "Zm9v", 3},
		      {"foob", "Zm9vYg==", 4},
		      {"fooba", "Zm9vYmE=", 5},
		      {"foobar", "Zm9vYmFy", 6},
		      {"\0\xff\xfe\xfb", "AP/++w==", 4}};
	struct error error;
	for (size_t v = 0; v < sizeof vector / sizeof *vector; v++) {
		char *text = NULL, *expected;
		size_t size;
		FILE *file = fopen("bytes", "wb"), *page = open_memstream(&text, &size);
		fwrite(vector[v].bytes, 1, vector[v].n, file);
		assert_int_equal(fclose(file), 0);
		assert_int_equal(html_file(page, "bytes", "image/png", &error), STATUS_OK);
		assert_int_equal(fclose(page), 0);
		assert_true(asprintf(&expected, "data:image/png;base64,%s", vector[v].coded) > 0);
		assert_string_equal(text, expected);
		free(expected);
		free(text);
	}
	assert_int_equal(html_file(stdout, "none", "image/png", &error), STATUS_IO);
	assert_non_null(strstr(error.text, "cannot read 'none'"));
}

static void expect_nothing_left(void)
{
	shell("find . -name '.stdfit*'");
	assert_string_equal(last.out, "");
}

static void expect_in_page(const char *path, const char *part, bool there)
{
	char *page = slurp(path);
	if ((strstr(page, part) != NULL) != there)
		fail_msg("%s: '%s' is %s", path, part, there ? "missing" : "there");
	free(page);
}

/* Elements that stand in pairs do so, and the page is whole. */
static void expect_whole(const char *path)
{
	static const char *const pair[] = {"details", "table", "tr",      "td",     "th",
					   "figure",  "h3",    "section", "script", "span"};
	char *page = slurp(path);
	for (size_t p = 0; p < sizeof pair / sizeof *pair; p++) {
		char opening[16], closing[16];
		int difference = 0, n = 0;
		snprintf(opening, sizeof opening, "<%s", pair[p]);
		snprintf(closing, sizeof closing, "</%s>", pair[p]);
		for (const char *at = page; (at = strstr(at, opening)); at++) {
			const bool element = strchr(" >\n", at[strlen(opening)]);
			difference += element;
			n += element;
		}
		for (const char *at = page; (at = strstr(at, closing)); at++)
			difference--;
		assert_int_equal(difference, 0);
		if (n == 0 && strcmp(pair[p], "figure"))
			fail_msg("%s has no %s", path, pair[p]);
	}
	const size_t length = strlen(page);
	assert_true(length > 8 && !strcmp(page + length - 8, "</html>\n"));
	free(page);
}

static void a_table_becomes_a_page(void **state)
{
	(void)state;
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	stdfit("report odd.csv -o odd " SPHERES);
	expect_code(0);
	assert_string_equal(last.out, "");
	if (image_has_png())
		assert_string_equal(last.err, "");
	expect_nothing_left();
	const char *page = "odd/index.html";
	expect_whole(page);
	expect_in_page(page, "<meta name=\"viewport\"", true);
	expect_in_page(page, "<title>stdfit: fits of 3 materials</title>", true);
	expect_in_page(page, "src=\"data:image/svg+xml;base64,", true);
	expect_in_page(page, "src=\"data:image/png;base64,", true);
	/* Names are text, wherever they stand. */
	expect_in_page(page, "<i>", false);
	expect_in_page(page, "<script>alert", false);
	expect_in_page(page, "&#60;i&#62;&#38;&#34;&#39;&#96;\\xff", false); /* ` needs no escape */
	expect_in_page(page, "&#60;i&#62;&#38;&#34;&#39;`\\xff\xc3\xa9&#60;/h3&#62;", true);
	/* Nothing is to be fetched. */
	expect_in_page(page, "http:", false);
	expect_in_page(page, "https:", false);
	expect_in_page(page, "gaf=uncorrelated", true);
	expect_in_page(page, "fitted by stdfit</dt><dd>" STDFIT_VERSION, true);
	expect_in_page(page, "Pictures are missing", !image_has_png());
	expect_in_page(page, ": sphere, as measured.", image_has_png());
	expect_in_page(page, "Spheres in the same light (studio; 1 samples a pixel)", image_has_png());
	expect_in_page(page, "Mean CIEDE2000 and SSIM: beckmann ", image_has_png());
	/* Angles are set as angles, parameters come as options. */
	expect_in_page(page, "\xcf\x86<sub>d</sub> = 90", true);
	expect_in_page(page, "\xce\xb8_", false);
	expect_in_page(page,
		       " data-options=\"--ndf ggx --gaf uncorrelated --fresnel dielectric --sigma 0.2 --ior 1.5 --kd ",
		       true);
}

static void a_browser_shows_it_without_errors(void **state)
{
	(void)state;
	if (!have_gnuplot() || access("odd/index.html", F_OK))
		skip_for_want_of("gnuplot-nox");
	char *command;
	assert_true(asprintf(&command, "timeout 120 '%s' odd/index.html", browser_script) > 0);
	shell(command);
	free(command);
	if (last.code == 77)
		skip_for_want_of("chromium, chromium-driver or curl");
	assert_string_equal(last.err, "");
	expect_code(0);
}

/* Fitted or read, the same rows make the same page; what was fitted is kept. */
static void files_are_fitted_first(void **state)
{
	(void)state;
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	stdfit("report a.binary -q -o new " SPHERES " " CHEAP);
	expect_code(0);
	stdfit("report new/fits.csv --threads 1 -o again " SPHERES);
	expect_code(0);
	shell("cmp new/index.html again/index.html");
	expect_code(0);
	expect_in_page("new/index.html", "weight=solid-angle", true);
	/* What the button copies gives the model of the row to eval. */
	shell("set -- $(sed -n 's/.*<tr data-options=\"\\([^\"]*\\)\".*/\\1/p' new/index.html | head -n 1); [ $# -ge "
	      "14 ] && "
	      "\"$STDFIT\" eval a.binary \"$@\" --max-theta 20 | tail -n 1 | cut -d, -f3-5; cut -d, -f2,25-27 "
	      "new/fits.csv | sed -n "
	      "'s/^ggx,//p'");
	expect_code(0);
	char *second = strchr(last.out, '\n');
	assert_non_null(second);
	*second++ = '\0';
	second[strcspn(second, "\n")] = '\0';
	assert_string_equal(last.out, second);
	stdfit("report a.binary -o told " SPHERES " " CHEAP);
	drop_no_png();
	expect_error(0, "fitted under --weight solid-angle");
	stdfit("report a.binary --weight none -o named " SPHERES " " CHEAP);
	expect_code(0);
	drop_no_png();
	assert_string_equal(last.err, "");
	expect_in_page("named/index.html", "weight=none", true);
	expect_whole("new/index.html");
	expect_in_page("new/index.html", "<title>stdfit: fits of a</title>", true);
	/* Why one has no fit is told once, and in the page. */
	write_text("text.binary", "text\n");
	stdfit("report text.binary -o none " CHEAP);
	expect_error(1, "cannot read 'text.binary'");
	expect_whole("none/index.html");
	expect_in_page("none/index.html", "failed: cannot read", true);
}

/* A model of many terms: all of it is shown and copied; below its values stand their intervals. */
static void richer_models_and_intervals_are_shown(void **state)
{
	static const char set[] =
		"kg_r=0.1;kg_g=0.2;kg_b=0.3;exponent=4;ks2_r=0.4;ks2_g=0.3;ks2_b=0.2;sigma2=0.5;gamma2=2;"
		"sigma_lo=0.0001;sigma_hi=0.25;open_ends=sigma_lo;other_bins=error=0.5|sigma=0.3";
	(void)state;
	char *command;
	assert_true(asprintf(&command,
			     "awk -F, -v OFS=, -v set='%s' 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; "
			     "n = split(set, s, \";\"); print } NR > 1 && $2 == \"ggx\" { for (i = 1; i <= n; i++) { "
			     "e = index(s[i], \"=\"); v = substr(s[i], e + 1); gsub(/[|]/, \";\", v); "
			     "$(at[substr(s[i], 1, e - 1)]) = v } print; exit }' fits.csv >rich.csv && "
			     "PATH=/nowhere \"$STDFIT\" report rich.csv -o rich -q " SPHERES,
			     set) > 0);
	shell(command);
	free(command);
	drop_no_png();
	expect_code(0);
	expect_in_page("rich/index.html", "<th scope=\"col\" class=\"n\">exponent</th>", true);
	expect_in_page("rich/index.html", "<td class=\"n\" data-v=\"0.5\">0.5</td>", true);
	expect_in_page("rich/index.html", "0.2<span class=\"range\">&#60;=0.0001 to 0.25</span></td>", true);
	expect_in_page("rich/index.html", "<p>ggx with entries at the centres of the bins: E 0.5, sigma +50 %.</p>",
		       true);
	expect_in_page("rich/index.html", "sigma_lo", false);
	shell("set -- $(sed -n 's/.*<tr data-options=\"\\([^\"]*\\)\".*/\\1/p' rich/index.html) && \"$STDFIT\" eval "
	      "a.binary "
	      "\"$@\" --max-theta 20 >options.out && \"$STDFIT\" eval a.binary --from rich.csv >row.out && cmp "
	      "options.out "
	      "row.out && grep -c , options.out");
	assert_string_equal(last.err, "");
	expect_code(0);
	assert_string_equal(last.out, "2\n");
}

/* Where another weight would look much better the page says so, unless it has that fit, too; so does fit on a terminal. */
static void another_weight_is_hinted_at(void **state)
{
	(void)state;
	shell("\"$STDFIT\" synth noisy.binary --ndf ggx --sigma 0.2 --kd 0.3,0.2,0.1 --ks 0.5 --noise 0.5 && "
	      "\"$STDFIT\" "
	      "noisy.binary a.binary " CHEAP
	      " --weight none,solid-angle -o hints.csv && grep -v solid-angle, hints.csv >hint.csv && "
	      "for t in hint hints; do PATH=/nowhere \"$STDFIT\" report $t.csv -o $t -q " SPHERES "; done");
	shell("grep -c 'class=.hint' hint/index.html; grep -c 'class=.hint' hints/index.html");
	assert_string_equal(last.out, "1\n0\n");
	expect_in_page("hints/index.html", "<th scope=\"row\">ggx, solid-angle</th>", true);
	expect_in_page("hints/index.html", "<title>stdfit: fits of 2 materials</title>", true);
	expect_in_page("hints/index.html", ">noisy</a></th><td>solid-angle</td>", true);
	expect_in_page("hint/index.html", "<th scope=\"row\">ggx</th>", true);
	shell("command -v script");
	if (last.code)
		skip_for_want_of("script, of bsdutils");
	shell("for w in none none,solid-angle; do script -qec \"'$STDFIT' noisy.binary a.binary " CHEAP
	      " --weight $w\" /dev/null </dev/null | grep -c 'hint: with --weight solid-angle the pictures of .noisy. "
	      "'; done");
	assert_string_equal(last.out, "1\n0\n");
	stdfit("noisy.binary " CHEAP);
	assert_string_equal(last.err, "");
}

static void without_gnuplot(void **state)
{
	(void)state;
	shell("PATH=/nowhere exec \"$STDFIT\" report fits.csv -o bare " SPHERES);
	if (image_has_png())
		expect_error(0, "gnuplot is not installed (on Debian: apt install gnuplot-nox): the page has no plots");
	expect_code(0);
	expect_whole("bare/index.html");
	expect_in_page("bare/index.html", "Pictures are missing: gnuplot is not installed", true);
	expect_in_page("bare/index.html", "<td class=\"n\"", true);
	expect_nothing_left();
}

/* A file that is gone, a fit that failed: told, on the page too, and the rest is there. */
static void what_is_missing_is_told(void **state)
{
	(void)state;
	shell("{ cat fits.csv; sed 1d fits.csv | sed 's/^a,/gone,/; s/a\\.binary/gone.binary/'; sed 1d fits.csv | sed "
	      "'s/^a,\\([^,]*\\),[^,]*,/failed,\\1,,/; s/converged/failed: <b>reason/'; } >three.csv");
	shell("PATH=/nowhere exec \"$STDFIT\" report three.csv -o three " SPHERES);
	expect_code(1);
	assert_int_equal(count_lines(last.err), image_has_png() ? 3 : 4);
	assert_non_null(strstr(last.err, "cannot read 'gone.binary'"));
	assert_non_null(strstr(last.err, "cannot show 'failed': it has no fit"));
	expect_whole("three/index.html");
	expect_in_page("three/index.html", "Pictures are missing: cannot read &#39;gone.binary&#39;", true);
	expect_in_page("three/index.html", "failed: &#60;b&#62;reason", true);
	expect_in_page("three/index.html", "no fit</span>", true);
}

static void wrong_input_is_refused(void **state)
{
	(void)state;
	write_text("other.csv", "name,value\nx,1\n");
	shell("touch file; mkdir -p taken/index.html");
	static const struct {
		const char *arguments, *message;
		int code;
	} wrong[] = {
		{"report fits.csv", "expected -o DIR", 2},
		{"report -o out", "expected PATH", 2},
		{"report fits.csv -o x --gaf correlated", "--gaf means nothing", 2},
		{"report other.csv -o x", "'other.csv' line 1: expected a header with column material", 1},
		{"report none.csv -o x", "cannot read 'none.csv'", 1},
		{"report fits.csv -o x --environment nowhere.hdr", "nowhere.hdr", 1},
		{"report fits.csv -o x --environment fits.csv", "fits.csv", 1},
		{"report fits.csv -o file", "cannot write to directory 'file': Not a directory", 1},
		{"report fits.csv -o no/such", "cannot write to directory 'no/such'", 1},
		{"report fits.csv -o taken", "cannot write 'taken/index.html'", 1},
	};
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		stdfit(wrong[i].arguments);
		expect_error(wrong[i].code, wrong[i].message);
		assert_string_equal(last.out, "");
	}
	expect_nothing_left();
}

/* More than a page is good for: a file each, and one that leads to them. Equal names are told apart, in no time. */
static void many_materials_have_a_page_each(void **state)
{
	(void)state;
	shell("awk 'NR == 2 { for (i = 1; i <= 3000; i++) { r = $0; sub(/,a[.]binary,/, \",no/\" i \".binary,\", r); "
	      "print r } "
	      "} NR == 1' fits.csv >most.csv; { head -n 51 most.csv; sed -n '52s/^a,/A-2,/p' most.csv; } >many.csv");
	stdfit("report many.csv -o many --size 16 -q");
	assert_int_equal(last.code, 1); /* no picture: there are no such files */
	expect_nothing_left();
	const char *page = "many/index.html";
	expect_in_page(page, "<title>stdfit: fits of 51 materials</title>", true);
	expect_in_page(page, "<a href=\"materials/a.html\">a</a>", true);
	expect_in_page(page, "<a href=\"materials/A-2.html\">A-2</a>", true);
	expect_in_page(page, "<a href=\"materials/a-2.html\">", false);
	expect_in_page(page, "<a href=\"materials/a-3.html\">a</a>", true);
	expect_in_page(page, "<a href=\"materials/a-51.html\">a</a>", true);
	expect_in_page(page, "<details", false);
	page = "many/materials/a-51.html";
	expect_whole(page);
	expect_in_page(page, "<title>stdfit: fits of a</title>", true);
	expect_in_page(page, "<a href=\"../index.html\">All 51 materials</a>", true);
	expect_in_page(page, "id=\"m-a-51\" open>", true);
	shell("ls many/materials | wc -l");
	assert_int_equal(atoi(last.out), 51);
	/* One less stands in one file. */
	shell("sed -i '$d' many.csv; rm -r many; exec \"$STDFIT\" report many.csv -o many --size 16 -q");
	expect_whole("many/index.html");
	expect_in_page("many/index.html", "id=\"m-a-50\">", true);
	shell("[ ! -e many/materials ]");
	expect_code(0);
	/* That equal names are told apart takes no 15 s of processor time, after which the system ends the program. */
	shell("ulimit -t 15; exec \"$STDFIT\" plot most.csv -o most -q");
	assert_int_equal(last.code, 1);
}

/* The most memory that a report of these fits had at once, in bytes. */
static long memory_of_report(const char *fits)
{
	char command[256];
	struct rusage usage;
	int status;

	snprintf(command, sizeof command,
		 "PATH=/nowhere exec \"$STDFIT\" report %s -o much --size 128 --samples 1 -q 2>stderr", fits);
	const pid_t pid = start(command);
	assert_int_equal(wait4(pid, &status, 0, &usage), pid);
	assert_int_equal(status, 0);
	return usage.ru_maxrss * 1024;
}

/* 51 materials need hardly more memory than one: no page is held while others are made. */
static void memory_does_not_grow_with_materials(void **state)
{
	(void)state;
#if defined __SANITIZE_ADDRESS__
	skip_because("AddressSanitizer keeps what is freed");
#endif
	shell("mkdir own; for i in $(seq 51); do ln a.binary own/$i.binary; done; sed -n 1p fits.csv >one.csv; grep "
	      ",ggx, fits.csv >row; cat row >>one.csv; { cat one.csv; for i in $(seq 51); do sed "
	      "\"s/^a,/$i,/; s/,a[.]binary,/,own\\/$i.binary,/\" row; done; } >several.csv; sed -i 2d several.csv");
	expect_code(0);
	const long one = memory_of_report("one.csv"), all = memory_of_report("several.csv");
	shell("cat much/materials/*.html | wc -c");
	const long pages = atol(last.out);
	assert_true(pages > 4000000);
	assert_true(all - one < pages / 3);
}

static void an_interrupt_leaves_the_old_page(void **state)
{
	(void)state;
	write_text("gnuplot", "#!/bin/sh\ntouch ../../begun\nexec sleep 100\n");
	shell("mkdir -p slow held; chmod +x gnuplot; mv gnuplot slow; echo old >held/index.html; PATH=$PWD/slow:$PATH "
	      "\"$STDFIT\" report fits.csv -o held --size 16 & pid=$!; until [ -e begun ]; do sleep 0.02; kill -0 $pid "
	      "|| exit "
	      "1; "
	      "done; kill -INT $pid; wait $pid");
	expect_code(130);
	drop_no_png();
	assert_string_equal(last.err, "");
	expect_in_page("held/index.html", "old", true);
	expect_nothing_left();
}

static int set_up(void **state)
{
	browser_script = realpath("tests/browser.sh", NULL);
	if (!browser_script || enter_directory(state))
		return -1;
	/* Three materials of one file. */
	shell("\"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5 && \"$STDFIT\" fit "
	      "a.binary -q -o fits.csv " CHEAP);
	if (last.code)
		return last.code;
	shell("odd=\"" ODD "\"; { cat fits.csv; sed 1d fits.csv | sed 's/^a,\\([^,]*\\),[^,]*,/b-with-a-long-name-"
	      "that-does-not-end-where-a-telephone-does,\\1,0.125,/'; sed 1d fits.csv | while read -r row; do printf "
	      "'\"%s\",%s\\n' \"$(printf %s \"$odd\" | sed 's/\"/\"\"/g')\" \"$(printf %s \"$row\" | sed "
	      "'s/^a,\\([^,]*\\),[^,]*,/\\1,0.25,/')\"; done; } >odd.csv");
	return last.code;
}

static int tear_down(void **state)
{
	free(browser_script);
	return leave_directory(state);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(any_text_is_text),
		cmocka_unit_test(files_become_base64),
		cmocka_unit_test(a_table_becomes_a_page),
		cmocka_unit_test(a_browser_shows_it_without_errors),
		cmocka_unit_test(files_are_fitted_first),
		cmocka_unit_test(richer_models_and_intervals_are_shown),
		cmocka_unit_test(another_weight_is_hinted_at),
		cmocka_unit_test(without_gnuplot),
		cmocka_unit_test(what_is_missing_is_told),
		cmocka_unit_test(wrong_input_is_refused),
		cmocka_unit_test(many_materials_have_a_page_each),
		cmocka_unit_test(an_interrupt_leaves_the_old_page),
		cmocka_unit_test(memory_does_not_grow_with_materials),
	};
	/* The last one takes its time. */
	const size_t count = sizeof tests / sizeof *tests - (case_step(2) > 1);

	return _cmocka_run_group_tests("report", tests, count, set_up, tear_down);
}
