/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Places that cannot take what is written: a full disk, closed streams, directories that are none or closed, inputs. Each
 * file is whole, as it was, or not there, and one line says why. */
#include "fit/render/image.h"
#include "run_program.h"

#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>

/* A fit and a picture that take a moment. */
#define CHEAP "--ndf ggx,beckmann --sigma 0.2 --ior 1.5 --max-theta 5"
#define QUICK "--size 16 --samples 1"
#define MODEL "--ndf ggx --sigma 0.2 --kd 0.3 --ks 0.5"

/* Runs a command as somebody whom permissions bind: root becomes nobody. */
#define UNPRIVILEGED "setpriv --reuid=65534 --regid=65534 --clear-groups"

static int set_up(void **state)
{
	if (enter_directory(state) || chmod(".", 0755))
		return -1;
	shell("\"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5 && mkdir in disk "
	      "&& for m in a "
	      "b c d e f; do ln a.binary in/$m.binary || exit; done && exec \"$STDFIT\" a.binary " CHEAP " -o fit.csv");
	return last.code;
}

/* A small disk of our own at disk/, until unmount_disk(); skips the test where that is not permitted. */
static void mount_disk(const char *options)
{
	static bool apart;
	if (!apart)
		apart = !unshare(CLONE_NEWNS) && !mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL);
	if (apart && !mount("none", "disk", "tmpfs", 0, options))
		return;
	skip_because("a disk cannot be mounted here");
}

static void unmount_disk(void)
{
	shell("find disk -name '*.stdfit-*'");
	assert_string_equal(last.out, "");
	assert_int_equal(umount("disk"), 0);
}

/* One that a failed test has left would stay in the way. */
static int tear_down(void **state)
{
	umount2("disk", MNT_DETACH);
	return leave_directory(state);
}

/* Takes all room of the disk but that many KB. */
static void fill_disk(int left)
{
	char command[128];
	snprintf(command, sizeof command,
		 "rm -f disk/fill; head -c %dK /dev/zero >disk/left; cat /dev/zero >disk/fill; rm "
		 "disk/left",
		 left);
	shell(command);
}

static void a_batch_on_a_full_disk_keeps_its_rows(void **state)
{
	(void)state;
	mount_disk("size=64k");
	stdfit("in " CHEAP " -o whole.csv");
	expect_code(0);
	char *whole = without_seconds("whole.csv");
	fill_disk(4);
	stdfit("in " CHEAP " -o disk/t.csv");
	expect_error(1, "cannot write 'disk/t.csv': No space left on device");
	struct csv_table table = read_table("disk/t.csv");
	assert_true(table.n_rows > 0 && table.n_rows < 12);
	csv_table_free(&table);
	char *kept = without_seconds("disk/t.csv");
	for (char *line = strtok(kept, "\n"); line; line = strtok(NULL, "\n"))
		expect_part(whole, line, __LINE__);
	free(kept);
	shell("cp disk/t.csv kept.csv");
	/* Still full: nothing is lost. */
	stdfit("in " CHEAP " --resume -o disk/t.csv");
	expect_error(1, "cannot write 'disk/t.csv': No space left on device");
	shell("cmp disk/t.csv kept.csv && rm disk/fill");
	expect_code(0);
	stdfit("in " CHEAP " --resume -o disk/t.csv");
	expect_code(0);
	kept = without_seconds("disk/t.csv");
	assert_string_equal(kept, whole);
	free(kept);
	free(whole);
	unmount_disk();
}

/* An old file is there still, and nothing beside it. */
static void old_files_on_a_full_disk_stay(void **state)
{
	(void)state;
	static const struct {
		const char *arguments, *output;
	} command[] = {
		{"export " MODEL " --format brdf", "x.brdf"},   {"export " MODEL " --format json", "x.json"},
		{"export " MODEL " --format merl", "x.binary"}, {"synth", "x.binary"},
		{"render a.binary " MODEL " " QUICK, "x.pfm"},  {"render a.binary " MODEL " " QUICK, "x.png"},
		{"compare fit.csv --pictures", "x.csv"},        {"merge fit.csv", "x.csv"},
		{"a.binary " CHEAP " --json", "x.json"},        {"a.binary " CHEAP, "x.csv"},
	};
	mount_disk("size=64k");
	for (size_t c = 0; c < sizeof command / sizeof *command; c++) {
		const bool place = !strcmp(command[c].arguments, "synth"); /* its output has no option */
		char text[256];
		if (strstr(command[c].output, ".png") && !image_has_png())
			continue;
		snprintf(text, sizeof text, "rm -f disk/*; echo old >disk/%s", command[c].output);
		shell(text);
		fill_disk(0);
		snprintf(text, sizeof text, "%s %s disk/%s%s >out", command[c].arguments, place ? "" : "-o",
			 command[c].output, place ? " --kd 0.5" : "");
		stdfit(text);
		expect_error(1, "No space left on device");
		snprintf(text, sizeof text, "cat disk/%s; ls disk", command[c].output);
		shell(text);
		snprintf(text, sizeof text, "old\nfill\n%s\n", command[c].output);
		assert_string_equal(last.out, text);
	}
	unmount_disk();
}

/* Whatever room there is, each file is the same as with plenty; there are all of them only if the program says so. */
static void plots_on_a_small_disk_are_whole_or_absent(void **state)
{
	(void)state;
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	mount_disk("size=2m");
	stdfit("plot fit.csv -o plots");
	expect_code(0);
	static const int room[] = {0, 16, 40, 64, 128, 1500};
	for (size_t r = 0; r < sizeof room / sizeof *room; r++) {
		shell("rm -rf disk/plots; mkdir disk/plots");
		fill_disk(room[r]);
		stdfit("plot fit.csv -o disk/plots");
		const int code = last.code;
		if (code && (code != 1 || !strstr(last.err, "disk/plots")))
			fail_msg("%d KB: exit code %d, %s", room[r], code, last.err);
		assert_true((code == 0) == (room[r] >= 1000));
		shell("cd disk/plots && find . -type f | while read -r f; do cmp \"$f\" \"../../plots/$f\"; done; find "
		      ". -type f | "
		      "wc -l; cd ../../plots; find . -type f | wc -l");
		int there = 0, all = 0;
		if (sscanf(last.out, "%d %d", &there, &all) != 2 || *last.err || (code == 0) != (there == all))
			fail_msg("%d KB: %s%s", room[r], last.out, last.err);
		shell("find disk -name '*.stdfit-*'");
		assert_string_equal(last.out, "");
	}
	unmount_disk();
}

/* A page is the old one, or whole, though perhaps without pictures, which it says. */
static void pages_on_a_small_disk_are_whole_or_absent(void **state)
{
	(void)state;
	if (!have_gnuplot())
		skip_for_want_of("gnuplot-nox");
	mount_disk("size=16m");
	stdfit("report fit.csv " QUICK " -o page");
	expect_code(0);
	static const int room[] = {0, 16, 40, 64, 128, 12000};
	for (size_t r = 0; r < sizeof room / sizeof *room; r++) {
		shell("rm -rf disk/page; mkdir disk/page; echo old >disk/page/index.html");
		fill_disk(room[r]);
		stdfit("report fit.csv " QUICK " -o disk/page");
		expect_code(room[r] >= 1000 ? 0 : 1);
		assert_true(last.code == 0 || *last.err);
		char *page = slurp("disk/page/index.html"), *whole = slurp("page/index.html");
		const size_t length = strlen(page);
		if (last.code == 0)
			assert_string_equal(page, whole);
		else if (strcmp(page, "old\n") && (length < 8 || strcmp(page + length - 8, "</html>\n") ||
						   !strstr(page, "Pictures are missing: ")))
			fail_msg("%d KB: the page is neither whole nor the old one", room[r]);
		free(page);
		free(whole);
		shell("ls -A disk/page");
		assert_string_equal(last.out, "index.html\n");
	}
	unmount_disk();
}

/* Without a disk of our own: a limit on the size of files. */
static void files_that_grow_too_large_are_reported(void **state)
{
	(void)state;
	if (THREAD_SANITIZER)
		skip_because("a limit on the size of files hits ThreadSanitizer's own");
	shell("echo old >large.pfm; ulimit -f 1; exec \"$STDFIT\" render a.binary " MODEL
	      " --size 64 --samples 1 -o large.pfm >out");
	expect_error(1, "cannot write 'large.pfm': File too large");
	shell("mkdir large; echo old >large/index.html; ulimit -f 16; PATH=/nowhere exec \"$STDFIT\" report fit.csv -o "
	      "large");
	expect_code(1);
	expect_part(last.err, "File too large", __LINE__);
	shell("cat large.pfm large/index.html; ls -A large");
	assert_string_equal(last.out, "old\nold\nindex.html\n");
}

static void streams_that_take_nothing_are_reported(void **state)
{
	(void)state;
	stdfit("render a.binary " MODEL " " QUICK " -o there.pfm");
	expect_code(0);
	static const char *const command[] = {
		"render a.binary " MODEL " " QUICK " -o taken.pfm", "compare fit.csv --pictures",
		"export " MODEL " --format pbrt --gaf correlated", "export " MODEL " --format json"};
	static const char *const closed[] = {">&-", ">/dev/full"};
	for (size_t c = 0; c < sizeof command / sizeof *command; c++)
		for (size_t k = 0; k < sizeof closed / sizeof *closed; k++) {
			char text[256];
			snprintf(text, sizeof text, "%s %s", command[c], closed[k]);
			stdfit(text);
			expect_error(1, "cannot write standard output");
		}
	shell("cmp there.pfm taken.pfm");
	expect_code(0);
	/* The messages are lost, and nothing else. */
	shell(": >empty.binary; \"$STDFIT\" render a.binary empty.binary " MODEL " " QUICK
	      " -o silent.pfm >&- 2>&- <&-");
	expect_code(1);
	shell("PATH=/nowhere \"$STDFIT\" report fit.csv " QUICK " -o silent >&- 2>&- <&-");
	expect_code(0);
	shell("test -s silent.pfm && tail -n 1 silent/index.html");
	assert_string_equal(last.out, "</html>\n");
	if (!have_gnuplot())
		return;
	stdfit("plot fit.csv -o silent >&- 2>&- <&-");
	expect_code(0);
	shell("ls silent/a/*.png | wc -l");
	assert_string_equal(last.out, "4\n");
}

static void pictures_go_into_a_pipe(void **state)
{
	(void)state;
	shell("mkfifo pipe.pfm; cat pipe.pfm >got.pfm & \"$STDFIT\" render a.binary " MODEL " " QUICK
	      " -o pipe.pfm >out; code=$?; wait; exit $code");
	expect_code(0);
	stdfit("render a.binary " MODEL " " QUICK " -o file.pfm");
	shell("cmp got.pfm file.pfm && test -p pipe.pfm");
	expect_code(0);
	/* A reader who goes away. */
	shell("head -c 10 <pipe.pfm >out & exec \"$STDFIT\" render a.binary " MODEL
	      " --size 200 --samples 1 -o pipe.pfm >out");
	expect_error(1, "cannot write 'pipe.pfm': Broken pipe");
}

/* One file of several is not waited for at a pipe, and no directory is in its place; the rest stays and gets done. */
static void names_that_are_taken_are_refused(void **state)
{
	(void)state;
	static const char *const name[] = {"errors.csv", "a/map.gp", "a/ndf.png", "index.html", "fits.csv"};
	static const char *const make[] = {"mkfifo", "mkdir"};
	static const char *const found[] = {"found a pipe or device", "found a directory"};
	for (size_t n = 0; n < sizeof name / sizeof *name; n++)
		for (size_t m = 0; m < sizeof make / sizeof *make; m++) {
			char text[256];
			const bool picture = strstr(name[n], ".png");
			if (picture && !have_gnuplot())
				continue;
			snprintf(text, sizeof text, "rm -rf place; mkdir -p place/a; %s place/%s", make[m], name[n]);
			shell(text);
			expect_code(0);
			snprintf(text, sizeof text, "%s \"$STDFIT\" %s -o place", picture ? "" : "PATH=/nowhere",
				 !strcmp(name[n], "index.html") ? "report fit.csv"
				 : !strcmp(name[n], "fits.csv") ? "plot a.binary " CHEAP
								: "plot fit.csv");
			shell(text);
			expect_code(1);
			snprintf(text, sizeof text, "cannot write 'place/%s': expected a file or nothing there, %s\n",
				 name[n], found[m]);
			expect_part(last.err, text, __LINE__);
		}
	shell("rm -r place");
}

static void directories_that_take_nothing_are_reported(void **state)
{
	(void)state;
	static const char *const command[] = {"plot fit.csv -o shut",
					      "plot fit.csv -o shut/new",
					      "report fit.csv -o shut",
					      "report fit.csv -o shut/new",
					      "render a.binary " MODEL " " QUICK " -o shut/x.pfm",
					      "export " MODEL " --format json -o shut/x.json",
					      "compare fit.csv --pictures -o shut/x.csv"};
	static const char *const file[] = {"plot fit.csv -o a.binary", "report fit.csv -o a.binary",
					   "render a.binary --kd 1 -o a.binary/x.pfm", "plot fit.csv -o a.binary/below",
					   "report fit.csv -o a.binary/below"};
	for (size_t f = 0; f < sizeof file / sizeof *file; f++) {
		stdfit(file[f]);
		expect_error(1, "Not a directory");
	}
	char text[256];
	const char *who = geteuid() == 0 ? UNPRIVILEGED : "";
	shell("mkdir shut; chmod 555 shut; chmod 644 a.binary fit.csv");
	snprintf(text, sizeof text, "%s test -x \"$STDFIT\"", who);
	shell(text);
	if (last.code)
		skip_because("root is refused nothing, and cannot run the program as somebody else here");
	for (size_t c = 0; c < sizeof command / sizeof *command; c++) {
		snprintf(text, sizeof text, "exec %s \"$STDFIT\" %s >out", who, command[c]);
		shell(text);
		expect_error(1, "Permission denied");
	}
	shell("ls -A shut; chmod 755 shut");
	assert_string_equal(last.out, "");
}

static void outputs_that_are_inputs_are_refused(void **state)
{
	(void)state;
	shell("mkdir -p own/a linked; cp fit.csv own/a/map.csv; cp fit.csv table.csv; ln -s ../table.csv "
	      "linked/index.html; ln -s "
	      "../in/a.binary linked/fits.csv; cp a.binary a.pfm; { printf 'PF\\n8 4\\n-1\\n'; head -c 384 /dev/zero | "
	      "tr '\\0' "
	      "'?'; } >map.pfm; md5sum own/a/map.csv table.csv in/a.binary a.pfm map.pfm >sums");
	expect_code(0);
	stdfit("plot own/a/map.csv -o own");
	expect_code(1);
	expect_part(last.err, "expected another directory: map.csv in this one is to be read", __LINE__);
	stdfit("report table.csv -o linked");
	expect_error(2, "expected another directory: index.html in this one is to be read");
	stdfit("report in/a.binary " CHEAP " -o linked");
	expect_error(2, "expected another directory: fits.csv in this one is to be read");
	stdfit("plot in " CHEAP " -o linked");
	expect_error(2, "expected another directory: fits.csv in this one is to be read");
	stdfit("render a.pfm --kd 1 " QUICK " -o ./a.pfm");
	expect_error(2, "--output names a file that is to be read");
	stdfit("render a.binary --kd 1 " QUICK " -e map.pfm -o ./map.pfm");
	expect_error(2, "--output names a file that is to be read");
	shell("md5sum -c --quiet sums");
	expect_code(0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_batch_on_a_full_disk_keeps_its_rows),
		cmocka_unit_test(old_files_on_a_full_disk_stay),
		cmocka_unit_test(plots_on_a_small_disk_are_whole_or_absent),
		cmocka_unit_test(pages_on_a_small_disk_are_whole_or_absent),
		cmocka_unit_test(files_that_grow_too_large_are_reported),
		cmocka_unit_test(streams_that_take_nothing_are_reported),
		cmocka_unit_test(pictures_go_into_a_pipe),
		cmocka_unit_test(directories_that_take_nothing_are_reported),
		cmocka_unit_test(names_that_are_taken_are_refused),
		cmocka_unit_test(outputs_that_are_inputs_are_refused),
	};
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
