/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Files and names that nobody expects: the program takes them or says in one line why not, and ends. */
#include "hostile_names.h"
#include "json_check.h"
#include "run_program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>

/* A fit that takes a moment: few free parameters, few entries. */
#define CHEAP "--ndf ggx --sigma 0.2 --ior 1.5 --max-theta 5"

/* Runs a command as somebody whom permissions bind: root becomes nobody. */
#define UNPRIVILEGED "setpriv --reuid=65534 --regid=65534 --clear-groups"

static int set_up(void **state)
{
	if (enter_directory(state))
		return -1;
	stdfit("synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5");
	return last.code || chmod(".", 0755);
}

/* How many files there are in the directory whose names begin so. */
static int leftovers(void)
{
	shell("find . -name '.stdfit-*' | wc -l");
	return atoi(last.out);
}

/* Directories */

static void links_in_all_directions_are_followed_once(void **state)
{
	(void)state;
	/* From each of twelve directories to each: nearly 12! ways through them. */
	shell("mkdir web; cd web; for i in a b c d e f g h i j k l; do mkdir $i; for j in a b c d e f g h i j k l; do "
	      "ln -s ../$j $i/to-$j; done; done; ln ../a.binary l/x.binary");
	expect_code(0);
	stdfit("-r web " CHEAP);
	expect_code(0);
	assert_string_equal(last.err, "");
	struct csv_table table = read_table("stdout");
	assert_int_equal(table.n_rows, 1);
	csv_table_free(&table);
}

static void directories_that_cannot_be_read_are_reported(void **state)
{
	(void)state;
	char command[1024];
	const bool root = geteuid() == 0;
	shell("mkdir -p closed/b closed/c/below closed/d; ln a.binary closed/a.binary; ln a.binary closed/b/x.binary;"
	      "ln a.binary closed/d/z.binary; chmod 000 closed/b; chmod 444 closed/c; chmod 644 a.binary");
	expect_code(0);
	snprintf(command, sizeof command, "%s test -x \"$STDFIT\"", root ? UNPRIVILEGED : "");
	shell(command);
	if (last.code)
		skip_because("root is refused nothing, and cannot run the program as somebody else here");
	snprintf(command, sizeof command, "exec %s \"$STDFIT\" -r closed " CHEAP, root ? UNPRIVILEGED : "");
	shell(command);
	expect_code(1);
	assert_string_equal(last.err, "stdfit: cannot read 'closed/b': Permission denied\n"
				      "stdfit: cannot read 'closed/c/below': Permission denied\n");
	struct csv_table table = read_table("stdout");
	assert_int_equal(table.n_rows, 2); /* what stands before and behind them */
	assert_string_equal(table.row[1][RESULT_PATH], "closed/d/z.binary");
	csv_table_free(&table);
	shell("chmod -R 755 closed");
}

static void directories_deeper_than_names_reach_end_in_a_message(void **state)
{
	(void)state;
	static const char name[] = "a-directory-in-a-directory-and-so-on-until-the-name-of-it-all-is-too-long";
	const int here = open(".", O_RDONLY | O_DIRECTORY);
	assert_true(here >= 0);
	assert_int_equal(mkdir("deep", 0755), 0);
	assert_int_equal(chdir("deep"), 0);
	for (int i = 0; i < 200; i++) {
		assert_int_equal(mkdir(name, 0755), 0);
		assert_int_equal(chdir(name), 0);
	}
	assert_int_equal(fchdir(here), 0);
	close(here);
	shell("mkdir deep/b; ln a.binary deep/b/x.binary");
	stdfit("-r deep " CHEAP);
	expect_error(1, "File name too long");
	struct csv_table table = read_table("stdout");
	assert_int_equal(table.n_rows, 1);
	csv_table_free(&table);
}

static void odd_things_called_binary_are_refused(void **state)
{
	(void)state;
	shell("mkdir odd odd/directory.binary; ln a.binary odd/a.binary; ln -s loop.binary odd/loop.binary; "
	      "ln -s nowhere odd/nowhere.binary; mkfifo odd/pipe.binary; ln -s /dev/zero odd/zero.binary; "
	      "truncate -s 1T odd/terabyte.binary; : >odd/.binary");
	expect_code(0);
	stdfit("odd " CHEAP);
	expect_code(1);
	expect_part(last.err, "'odd/loop.binary': Too many levels", __LINE__);
	expect_part(last.err, "'odd/nowhere.binary': No such file", __LINE__);
	expect_part(last.err, "'odd/pipe.binary': expected a regular file", __LINE__);
	expect_part(last.err, "'odd/zero.binary': expected a regular file", __LINE__);
	expect_part(last.err, "'odd/terabyte.binary': ", __LINE__);
	assert_int_equal(count_lines(last.err), 5);
	struct csv_table table = read_table("stdout");
	assert_int_equal(table.n_rows, 6);
	csv_table_free(&table);
	stdfit("odd/directory.binary " CHEAP);
	expect_error(1, "no measurement of a known format in this directory");
}

static void ten_thousand_files_are_listed(void **state)
{
	(void)state;
	shell("mkdir many; cd many; seq -f %05g.binary 10000 | xargs touch");
	expect_code(0);
	stdfit("many " CHEAP " -o many.csv");
	expect_code(1);
	assert_int_equal(count_lines(last.err), 10000);
	struct csv_table table = read_table("many.csv");
	assert_int_equal(table.n_rows, 10000);
	for (size_t i = 0; i < table.n_rows; i++)
		assert_true(result_failed(table.row[i]));
	assert_string_equal(table.row[9999][RESULT_MATERIAL], "10000");
	csv_table_free(&table);
	/* A reader of the messages who goes away stops nothing. */
	shell("{ \"$STDFIT\" many " CHEAP " -o piped.csv; echo $? >code; } 2>&1 | head -n 1");
	assert_int_equal(count_lines(last.out), 1);
	shell("cat code");
	assert_string_equal(last.out, "1\n");
	shell("cut -d, -f1-3 many.csv >1; cut -d, -f1-3 piped.csv >2; cmp 1 2");
	expect_code(0);
}

/* Names */

/* The materials of a table are the names, each once. */
static void expect_names(const char *path)
{
	struct csv_table table = read_table(path);
	assert_int_equal(table.n_rows, NAMES);
	for (size_t n = 0; n < NAMES; n++) {
		size_t found = 0;
		char wanted[64];
		snprintf(wanted, sizeof wanted, "names/%s.binary", names[n]);
		for (size_t i = 0; i < NAMES; i++)
			found += !strcmp(table.row[i][RESULT_MATERIAL], names[n]) &&
				 !strcmp(table.row[i][RESULT_PATH], wanted);
		if (found != 1)
			fail_msg("'%s' stands there %zu times", names[n], found);
	}
	csv_table_free(&table);
}

static void names_of_any_bytes_come_back(void **state)
{
	(void)state;
	assert_int_equal(mkdir("names", 0755), 0);
	assert_int_equal(mkdir("bad-names", 0755), 0);
	for (size_t n = 0; n < NAMES; n++) {
		char path[64];
		snprintf(path, sizeof path, "names/%s.binary", names[n]);
		assert_int_equal(link("a.binary", path), 0);
		snprintf(path, sizeof path, "bad-names/%s.binary", names[n]);
		assert_int_equal(mknod(path, S_IFREG | 0644, 0), 0);
	}
	stdfit("names " CHEAP " -o names.csv");
	expect_code(0);
	expect_names("names.csv");
	stdfit("names " CHEAP " --resume -o names.csv");
	expect_code(0);
	expect_names("names.csv");
	stdfit("names " CHEAP " --json");
	expect_code(0);
	assert_true(json_is_valid(last.out));
	stdfit("names " CHEAP " --table");
	expect_code(0);
	expect_printable(last.out, __LINE__);
	assert_int_equal(count_lines(last.out), 1 + NAMES);
	stdfit("info names/* --json");
	expect_code(0);
	assert_true(json_is_valid(last.out));
	stdfit("compare names.csv --json");
	expect_code(0);
	assert_true(json_is_valid(last.out));
	stdfit("compare names.csv --table");
	expect_code(0);
	expect_printable(last.out, __LINE__);
	assert_int_equal(count_lines(last.out), 1 + NAMES + 4);
	stdfit("bad-names " CHEAP);
	expect_code(1);
	expect_printable(last.err, __LINE__);
	assert_int_equal(count_lines(last.err), NAMES);
	stdfit("-- names/-dash.binary " CHEAP);
	expect_code(1); /* behind -- the options are names, too */
	shell("cd names; exec \"$STDFIT\" " CHEAP " -- -dash.binary --ndf.binary");
	expect_code(0);
	shell("cd names; for f in *; do \"$STDFIT\" eval --from ../names.csv --json -- \"$f\" || exit 1; done");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 3 * NAMES);
	shell("\"$STDFIT\" --ndf \"$(printf 'x\\377\\n')\" a.binary; \"$STDFIT\" \"-$(printf '\\377')\" a.binary; "
	      "\"$STDFIT\" \"$(printf -- '--\\033')\" a.binary");
	expect_printable(last.err, __LINE__);
	assert_int_equal(count_lines(last.err), 3);
}

/* Tables */

static void tables_that_are_none_are_refused(void **state)
{
	(void)state;
	shell("mkfifo pipe.csv; ln -s /dev/zero zero.csv; truncate -s 1T terabyte.csv; ln -s loop.csv loop.csv; mkdir "
	      "directory.csv");
	static const char *const command[] = {"compare %s", "eval a.binary --from %s", "merge %s -o merged.csv",
					      "a.binary " CHEAP " --resume -o %s"};
	static const char *const bad[] = {"terabyte.csv", "loop.csv", "directory.csv", "pipe.csv", "zero.csv"};
	for (size_t c = 0; c < sizeof command / sizeof *command; c++)
		for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) {
			char arguments[128];
			snprintf(arguments, sizeof arguments, command[c], bad[b]);
			stdfit(arguments);
			expect_error(1, bad[b]);
		}
	assert_int_equal(access("merged.csv", F_OK), -1);
	/* A pipe that somebody writes to is a table like any other. */
	write_text("table.csv", "material,ndf,error\na,ggx,0.5\n");
	shell("{ sleep 0.1; cat table.csv; } >pipe.csv & sleep 0.05; exec \"$STDFIT\" compare /dev/fd/3.csv "
	      "3<pipe.csv");
	expect_code(1); /* no such name, and no hang */
	shell("{ sleep 0.1; cat table.csv; } | { ln -s /dev/fd/0 standard.csv; exec \"$STDFIT\" compare standard.csv; "
	      "}");
	expect_code(0);
	expect_out("\na,0.5,ggx");
}

/* Commands that read a model, or what may be one; a hang ends after a minute, with 124. */
static void models_that_are_none_are_refused(void **state)
{
	(void)state;
	shell("mkfifo pipe.json pipe.hdr; ln -s /dev/zero zero.json; truncate -s 1T terabyte.json; ln -s loop.json "
	      "loop.json;"
	      "mkdir directory.json; : >empty.json; printf '{\"ndf\": \\0}' >null.json");
	static const char *const command[] = {"eval a.binary --from %s", "ndf --theta 10 --from %s", "sample --from %s",
					      "export --format json --from %s -o new.json",
					      "render a.binary --from %s -o new.png"};
	static const char *const bad[] = {"pipe.json",  "zero.json",      "terabyte.json", "loop.json",
					  "empty.json", "directory.json", "null.json",     "missing.json"};
	for (size_t c = 0; c < sizeof command / sizeof *command; c++)
		for (size_t b = 0; b < sizeof bad / sizeof *bad; b++) {
			char arguments[128], whole[192];
			snprintf(arguments, sizeof arguments, command[c], bad[b]);
			snprintf(whole, sizeof whole, "exec timeout 60 \"$STDFIT\" %s", arguments);
			shell(whole);
			expect_error(1, bad[b]);
		}
	shell("exec timeout 60 \"$STDFIT\" plot pipe.csv -o pipe-plots");
	expect_error(1, "'pipe.csv' line 1: expected a header");
	shell("exec timeout 60 \"$STDFIT\" render a.binary --kd 1 -e pipe.hdr");
	expect_error(1, "'pipe.hdr': expected a regular file");
	assert_int_equal(access("new.json", F_OK), -1);
	assert_int_equal(access("new.png", F_OK), -1);
	/* A pipe that somebody writes to is a model like any other. */
	shell("\"$STDFIT\" export --kd 1,0.5,0.25 --format json >model.json && ln -s /dev/fd/0 standard.json &&"
	      "{ sleep 0.1; cat model.json; } | \"$STDFIT\" export --from standard.json --format json | cmp - "
	      "model.json");
	expect_code(0);
}

static void numbers_too_long_to_be_cut_are_refused(void **state)
{
	(void)state;
	/* Cut after 31 digits this would be 0.1. */
	stdfit("eval a.binary --kd 0.10000000000000000000000000000000000e1,0,0");
	expect_error(2, "for --kd");
}

/* Outputs */

static void outputs_in_the_place_of_inputs_are_refused(void **state)
{
	(void)state;
	shell("cp a.binary in.binary; ln -s in.binary link.binary; mkdir in; ln in.binary in/x.binary");
	stdfit("in.binary " CHEAP " -o in.binary");
	expect_error(2, "--output names a file that is to be read");
	stdfit("in " CHEAP " -o ./link.binary");
	expect_error(2, "--output names a file that is to be read");
	stdfit("in " CHEAP " --json -o ./link.binary");
	expect_error(2, "--output names a file that is to be read");
	stdfit("link.binary " CHEAP " --trace in/x.binary");
	expect_error(2, "--trace names a file that is to be read");
	stdfit("compare in " CHEAP " -o in.binary");
	expect_error(2, "--output names a file that is to be read");
	stdfit("bench in.binary --ndf ggx --algorithm crs2 --time 0.1 --trace link.binary");
	expect_error(2, "--trace names a file that is to be read");
	stdfit("export in.binary --kd 1 --format json -o ./in.binary");
	expect_error(2, "--output names a file that is to be read");
	shell("\"$STDFIT\" export a.binary --kd 1 --format json -o model.json && exec \"$STDFIT\" export --from "
	      "model.json "
	      "--format brdf -o ./model.json");
	expect_error(2, "--output names a file that is to be read");
	stdfit("a.binary " CHEAP " -o /dev/null --trace /dev/null");
	expect_code(0);
	stdfit("a.binary " CHEAP " -o twice.csv --trace in/../twice.csv");
	expect_error(2, "--trace and --output name the same file");
	shell("cmp a.binary in.binary; ls in.binary~ twice.csv");
	assert_int_equal(count_lines(last.out), 0);
	assert_int_equal(leftovers(), 0);
}

static void outputs_behind_links_follow_them(void **state)
{
	(void)state;
	shell("mkdir there; ln -s there/new.csv link.csv; ln -s round.csv round.csv");
	stdfit("a.binary " CHEAP " -o link.csv");
	expect_code(0);
	struct csv_table table = read_table("there/new.csv");
	assert_int_equal(table.n_rows, 1);
	csv_table_free(&table);
	stdfit("in/x.binary " CHEAP " --resume -o link.csv");
	expect_code(0);
	table = read_table("there/new.csv");
	assert_int_equal(table.n_rows, 2);
	csv_table_free(&table);
	shell("test -L link.csv");
	expect_code(0);
	stdfit("a.binary " CHEAP " -o round.csv");
	expect_error(1, "cannot write 'round.csv': Too many levels");
	assert_int_equal(leftovers(), 0);
}

static void outputs_go_into_a_pipe(void **state)
{
	(void)state;
	shell("mkfifo rows; cat rows >got.csv & \"$STDFIT\" a.binary " CHEAP " -o rows; code=$?; wait; exit $code");
	expect_code(0);
	struct csv_table table = read_table("got.csv");
	assert_int_equal(table.n_rows, 1);
	csv_table_free(&table);
	/* There is nothing to resume, and nobody to wait for. */
	stdfit("a.binary " CHEAP " --resume -o rows");
	expect_error(1, "cannot resume 'rows': expected a file, found a pipe, a device or a descriptor");
}

/* What cannot be read for the moment keeps the rows that it has; what is something else now does not. */
static void files_that_went_away_are_reported(void **state)
{
	(void)state;
	shell("mkdir away; cp a.binary away/x.binary; ln away/x.binary away/y.binary");
	stdfit("away/x.binary away/y.binary " CHEAP " -o away.csv");
	expect_code(0);
	shell("cp away.csv kept.csv; mv away/x.binary away/moved; exec \"$STDFIT\" away/x.binary away/y.binary " CHEAP
	      " --resume -o away.csv");
	expect_error(1, "cannot read 'away/x.binary': No such file");
	shell("cmp away.csv kept.csv");
	expect_code(0);
	shell("echo text >away/x.binary; exec \"$STDFIT\" away/x.binary away/y.binary " CHEAP " --resume -o away.csv");
	expect_error(1, "cannot read 'away/x.binary': expected a binary MERL table");
	struct csv_table table = read_table("away.csv");
	assert_int_equal(table.n_rows, 2);
	assert_true(result_failed(table.row[0]));
	csv_table_free(&table);
	shell("cmp away.csv~ kept.csv");
	expect_code(1); /* the failed row had been appended there already */
	shell("head -n 3 away.csv~ | cmp - kept.csv");
	expect_code(0);
}

static void outputs_on_a_full_disk_leave_the_old(void **state)
{
	(void)state;
	if (THREAD_SANITIZER)
		skip_because("a limit on the size of files hits ThreadSanitizer's own");
	stdfit("a.binary " CHEAP " -o full.csv");
	expect_code(0);
	/* Room for less than a row: the old table stays where it is. */
	shell("cp full.csv old.csv; ulimit -f 1; exec \"$STDFIT\" in/x.binary " CHEAP " -o full.csv");
	expect_error(1, "cannot write 'full.csv': File too large");
	shell("cmp old.csv full.csv && ! test -e full.csv~");
	expect_code(0);
	/* What a row has left is no row: nothing of it is there. */
	shell("cp old.csv full.csv; size=$(stat -c %s old.csv); "
	      "ulimit -f $((size / 512 + 1)); exec \"$STDFIT\" in/x.binary " CHEAP " --resume -o full.csv");
	expect_error(1, "cannot write 'full.csv': File too large");
	shell("cmp old.csv full.csv");
	expect_code(0);
	shell("ulimit -f 1; exec \"$STDFIT\" compare a.binary --ndf ggx,std,beckmann,gtr --no-specular -o summary.csv");
	assert_true(last.code == 0 || last.code == 1);
	assert_int_equal(last.code == 0, access("summary.csv", F_OK) == 0);
	assert_int_equal(leftovers(), 0);
}

static void closed_streams_lose_nothing_silently(void **state)
{
	(void)state;
	/* With no standard error the messages are lost, and nothing else; above all they go to no other file. */
	shell(": >empty.binary");
	stdfit("empty.binary a.binary " CHEAP " -o silent.csv 2>&- >&- <&-");
	expect_code(1);
	struct csv_table table = read_table("silent.csv");
	assert_int_equal(table.n_rows, 2);
	csv_table_free(&table);
	stdfit("missing.binary 2>&-");
	expect_code(1);
	stdfit("--nonsense 2>&-");
	expect_code(2);
	stdfit("a.binary " CHEAP " 2>/dev/full");
	expect_code(0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(links_in_all_directions_are_followed_once),
		cmocka_unit_test(directories_that_cannot_be_read_are_reported),
		cmocka_unit_test(directories_deeper_than_names_reach_end_in_a_message),
		cmocka_unit_test(odd_things_called_binary_are_refused),
		cmocka_unit_test(ten_thousand_files_are_listed),
		cmocka_unit_test(names_of_any_bytes_come_back),
		cmocka_unit_test(tables_that_are_none_are_refused),
		cmocka_unit_test(models_that_are_none_are_refused),
		cmocka_unit_test(numbers_too_long_to_be_cut_are_refused),
		cmocka_unit_test(outputs_in_the_place_of_inputs_are_refused),
		cmocka_unit_test(outputs_behind_links_follow_them),
		cmocka_unit_test(outputs_go_into_a_pipe),
		cmocka_unit_test(files_that_went_away_are_reported),
		cmocka_unit_test(outputs_on_a_full_disk_leave_the_old),
		cmocka_unit_test(closed_streams_lose_nothing_silently),
	};
	return cmocka_run_group_tests(tests, set_up, leave_directory);
}
