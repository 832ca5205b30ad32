/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the name of an output means, and who may write there: links, descriptors, devices and pipes, locks, backups, inputs,
 * and rows that contradict each other. Runs $STDFIT or build/stdfit. */
#include "data_readers/atomic_file.h"
#include "fit/results/store.h"
#include "run_program.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>

/* A fit that takes a moment. */
#define CHEAP "--ndf ggx --sigma 0.2 --ior 1.5 --max-theta 5"
#define MODEL "--ndf ggx --sigma 0.2 --kd 0.3 --ks 0.5"
#define QUICK "--size 16 --samples 1"

/* A file system without hard links, for what this program itself writes. */
static bool no_links;

int linkat(int from_at, const char *from, int to_at, const char *to, int flags)
{
	if (no_links) {
		errno = EPERM;
		return -1;
	}
	return (int)syscall(SYS_linkat, from_at, from, to_at, to, flags);
}

int link(const char *from, const char *to)
{
	return linkat(AT_FDCWD, from, AT_FDCWD, to, 0);
}

static int set_up(void **state)
{
	if (enter_directory(state))
		return -1;
	shell("\"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5 && ln a.binary "
	      "b.binary && \"$STDFIT\" a.binary " CHEAP " -o a.csv && exec \"$STDFIT\" b.binary " CHEAP " -o b.csv");
	return last.code;
}

/* The commands that write one table or model, with what they write on standard output without -o. */
static const char *const command[] = {"a.binary " CHEAP,   "a.binary " CHEAP " --json",
				      "compare a.csv",     "compare a.csv --json",
				      "merge a.csv b.csv", "export " MODEL " --format json"};

enum { N_COMMANDS = sizeof command / sizeof *command };

/* Runs a command of the list, then compares what it wrote with what it writes without -o, but for seconds. */
static void expect_same_as_without(int c, const char *output, const char *redirection, const char *file, int line)
{
	char text[512];
	snprintf(text, sizeof text,
		 "\"$STDFIT\" %s >plain && \"$STDFIT\" %s -o %s %s && sed -E 's/[0-9.]+,(a|b).binary/\\1.binary/; "
		 "s/\"seconds\": [0-9.e-]+//' plain >plain.cut && sed -E 's/[0-9.]+,(a|b).binary/\\1.binary/; "
		 "s/\"seconds\": [0-9.e-]+//' %s | cmp - plain.cut",
		 command[c], command[c], output, redirection, file);
	shell(text);
	if (last.code || *last.out || *last.err)
		fail_msg("line %d: %s -o %s %s: code %d, %s%s", line, command[c], output, redirection, last.code,
			 last.out, last.err);
}

/* The links are this test's own: those in /dev are not put at risk. */
static void descriptors_are_written_in_order(void **state)
{
	(void)state;
	shell("mkdir links; ln -s /proc/self/fd/1 links/out; ln -s /proc/self/fd links/fd; ln -s out links/again");
	for (int c = 0; c < N_COMMANDS; c++) {
		expect_same_as_without(c, "links/out", ">got", "got", __LINE__);
		expect_same_as_without(c, "links/again", "| cat >got", "got", __LINE__);
		expect_same_as_without(c, "links/fd/1", ">got", "got", __LINE__);
		expect_same_as_without(c, "/dev/fd/3", "3>got", "got", __LINE__);
		expect_same_as_without(c, "-", ">got", "got", __LINE__);
	}
	shell("test -L links/out && test -L links/fd && test -L links/again && ls -A links && ls -A | grep -e '~$' -e "
	      "tmp$ -e '^-$'");
	assert_string_equal(last.out, "again\nfd\nout\n");
	/* Others who write to the descriptor go on behind what is there. */
	shell("{ echo before >&3; \"$STDFIT\" export " MODEL " --format json -o /dev/fd/3; echo after >&3; } 3>got;"
	      "head -n 1 got; tail -n 1 got; sed '1d; $d' got >middle; \"$STDFIT\" export " MODEL
	      " --format json | cmp - middle");
	expect_code(0);
	assert_string_equal(last.out, "before\nafter\n");
	shell("{ echo before >&3; \"$STDFIT\" a.binary " CHEAP
	      " -o /dev/fd/3; echo after >&3; } 3>got; cut -c 1-6 got");
	assert_string_equal(last.out, "before\nmateri\na,ggx,\nafter\n");
	/* One that takes nothing. */
	shell("exec \"$STDFIT\" a.binary " CHEAP " -o /dev/fd/3 3<a.csv");
	expect_error(1, "cannot write '/dev/fd/3': Bad file descriptor");
}

static void pictures_and_tables_of_bytes_go_to_standard_output(void **state)
{
	(void)state;
	shell("\"$STDFIT\" synth whole.binary --kd 0.5 && \"$STDFIT\" synth - --kd 0.5 | cmp - whole.binary && "
	      "\"$STDFIT\" export --kd 0.5 --format merl -q -o - | cmp - whole.binary && ! test -e ./-");
	expect_code(0);
	const char *name = image_has_png() ? "whole.png" : "whole.pfm";
	char text[256];
	snprintf(text, sizeof text,
		 "\"$STDFIT\" render a.binary " MODEL " " QUICK " -o %s >table && \"$STDFIT\" render a.binary " MODEL
		 " " QUICK " -o - | cmp - %s && test -s table",
		 name, name);
	shell(text);
	expect_code(0);
	stdfit("render a.binary " MODEL " " QUICK " -o - --json");
	expect_error(2, "--json and --table need standard output, as does -o -");
	stdfit("plot a.csv -o -");
	expect_error(2, "expected -o DIR, a directory: there are several files to write");
	stdfit("report a.csv -o -");
	expect_error(2, "expected -o DIR, a directory: there are several files to write");
}

static void what_is_no_file_is_not_resumed(void **state)
{
	(void)state;
	stdfit("a.binary " CHEAP " --resume -o -");
	expect_error(2, "--resume needs -o FILE, not standard output");
	shell("exec \"$STDFIT\" a.binary " CHEAP " --resume -o links/out >got");
	expect_error(2, "--resume needs -o FILE, not standard output");
	shell("exec \"$STDFIT\" a.binary " CHEAP " --resume -o /dev/fd/3 3>got");
	expect_error(1, "cannot resume '/dev/fd/3': expected a file, found a pipe, a device or a descriptor");
	stdfit("a.binary " CHEAP " --resume -o /dev/null");
	expect_error(1, "cannot resume '/dev/null': expected a file, found a pipe, a device or a descriptor");
	stdfit("a.binary " CHEAP " --trace -");
	expect_error(2, "--trace on standard output needs -o FILE");
	shell("\"$STDFIT\" a.binary " CHEAP " --trace - -o traced.csv | head -n 1 && test -s traced.csv");
	assert_string_equal(last.out, "material,ndf,algorithm,stage,evaluations,seconds,error\n");
}

static void links_are_followed(void **state)
{
	(void)state;
	for (int c = 0; c < N_COMMANDS; c++) {
		char text[512];
		const bool keeps = !strstr(command[c], "export");
		snprintf(text, sizeof text,
			 "rm -rf far; mkdir far; echo old >far/real; ln -sf far/real link; ln -sf link link2; "
			 "\"$STDFIT\" %s "
			 "-o link2 && test -L link && test -L link2 && ! test -e link~ && ! test -e link2~ && ls -A "
			 "far; "
			 "cat far/real~",
			 command[c]);
		shell(text);
		assert_string_equal(last.out, keeps ? "real\nreal~\nold\n" : "real\n");
	}
	/* A name below /proc may lead to an ordinary file. */
	shell("echo old >there.csv; \"$STDFIT\" a.binary " CHEAP " -o /proc/self/cwd/there.csv && cat there.csv~");
	expect_code(0);
	assert_string_equal(last.out, "old\n");
}

/* As a kill between backup and rename leaves them. */
static void a_backup_that_is_the_table_itself(void **state)
{
	(void)state;
	shell("cp a.csv q.csv; ln q.csv q.csv~; exec \"$STDFIT\" b.binary " CHEAP " -o q.csv");
	expect_code(0);
	shell("cmp a.csv q.csv~; cut -d, -f1,2 q.csv; ls -a | grep tmp$");
	assert_string_equal(last.out, "material,ndf\nb,ggx\n");
	/* A run that is killed then, before it writes the table anew. */
	struct store store;
	struct error error;
	struct csv_table rows = read_table("b.csv");
	shell("cp a.csv q.csv; ln -f q.csv q.csv~");
	assert_int_equal(store_open(&store, "q.csv", false, &error), STATUS_OK);
	assert_int_equal(store_append(&store, &rows, &error), STATUS_OK);
	store_close(&store);
	shell("cmp a.csv q.csv~; cmp b.csv q.csv");
	assert_string_equal(last.out, "");
	shell("cp a.csv q.csv; ln -f q.csv q.csv~");
	assert_int_equal(store_open(&store, "q.csv", true, &error), STATUS_OK);
	assert_int_equal(store_append(&store, &rows, &error), STATUS_OK);
	store_close(&store);
	csv_table_free(&rows);
	shell("test -e q.csv~ && ! cmp a.csv q.csv~; cut -d, -f1,2 q.csv");
	assert_string_equal(last.out, "material,ndf\na,ggx\nb,ggx\n");
	shell("cp a.csv q.csv; ln -f q.csv q.csv~; exec \"$STDFIT\" a.binary b.binary " CHEAP " --resume -o q.csv");
	expect_code(0);
	assert_string_equal(last.err, "");
	shell("\"$STDFIT\" merge a.csv b.csv | cut -d, -f1-3 >both; cut -d, -f1-3 q.csv | cmp - both");
	expect_code(0);
	/* Rows that are redone are in the backup, and the backup is another file. */
	shell("cp a.csv q.csv; ln -f q.csv q.csv~; \"$STDFIT\" a.binary " CHEAP
	      " --gray --resume -o q.csv && head -n 2 q.csv~ | cmp - a.csv && ! test q.csv -ef q.csv~");
	expect_code(0);
	shell("cp a.csv q.csv; ln -f q.csv q.csv~; \"$STDFIT\" merge b.csv -o q.csv && cmp q.csv b.csv && cmp q.csv~ "
	      "a.csv");
	expect_code(0);
}

/* What the other process writes, this test: it holds the lock, as a run of the program does. */
static void one_writer_at_a_time(void **state)
{
	(void)state;
	static const char *const writer[] = {"a.binary " CHEAP " -o held.csv",
					     "a.binary " CHEAP " --resume -o held.csv",
					     "a.binary " CHEAP " --json -o held.csv",
					     "a.binary " CHEAP " --trace held.csv -o other.csv",
					     "compare b.csv -o held.csv",
					     "merge b.csv -o held.csv",
					     "export " MODEL " --format json -o held.csv",
					     "export " MODEL " --format merl -o held.csv",
					     "synth held.csv --kd 0.5",
					     "a.binary " CHEAP " -o held_link.csv"};
	char expected[128], plain[128];
	shell("cp a.csv held.csv; ln -s held.csv held_link.csv");
	const int fd = open("held.csv", O_WRONLY | O_CLOEXEC);
	assert_true(fd >= 0);
	assert_int_equal(flock(fd, LOCK_EX | LOCK_NB), 0);
	shell("grep -q \"FLOCK.*WRITE $PPID \" /proc/locks");
	const bool told = last.code == 0;
	for (size_t w = 0; w < sizeof writer / sizeof *writer; w++) {
		const char *name = strstr(writer[w], "held_link") ? "held_link.csv" : "held.csv";
		snprintf(expected, sizeof expected, "cannot write '%s': process %ld is writing it", name,
			 (long)getpid());
		snprintf(plain, sizeof plain, "cannot write '%s': another process is writing it", name);
		stdfit(writer[w]);
		expect_error(1, told ? expected : plain);
	}
	shell("cmp a.csv held.csv; ls -a | grep -e held.csv~ -e tmp$");
	assert_string_equal(last.out, "");
	close(fd);
	stdfit("b.binary " CHEAP " --resume -o held.csv");
	expect_code(0);
}

/* Two runs at the same time on one name that is not there yet, or is: one row each, whoever has to wait. */
static void rows_of_two_writers(void **state)
{
	(void)state;
	const int runs = case_step(25) > 1 ? 2 : 50;
	for (int run = 0; run < runs; run++) {
		shell(run % 2 ? "rm -f two.csv*; cp a.csv two.csv" : "rm -f two.csv*");
		char text[512];
		/* Whoever is refused says so, and comes again. */
		snprintf(
			text, sizeof text,
			"for m in a b; do (while ! \"$STDFIT\" $m.binary " CHEAP " --resume -o two.csv; do sleep "
			"0.0%d; done 2>$m.refused) & done; wait; grep -hv 'is writing it' a.refused b.refused; cut -d, "
			"-f1,2 two.csv",
			1 + run % 7);
		shell(text);
		assert_string_equal(last.out, "material,ndf\na,ggx\nb,ggx\n");
	}
	/* Without --resume the one that comes later replaces the table, and keeps it. */
	for (int run = 0; run < runs; run++) {
		shell("rm -f two.csv*; for m in a b; do \"$STDFIT\" $m.binary " CHEAP
		      " -o two.csv 2>$m.err & done; wait; cat a.err b.err; for f in two.csv two.csv~; do test -e $f && "
		      "grep -c . $f; done");
		const char *taken = strstr(last.out, "is writing it\n");
		assert_string_equal(taken ? taken : last.out, taken ? "is writing it\n2\n" : "2\n2\n");
	}
}

static void a_lock_follows_the_name(void **state)
{
	(void)state;
	/* A run that has replaced the table still has it: the new file is locked as the old one was. */
	struct store store;
	struct error error;
	struct csv_table rows = read_table("b.csv");
	shell("cp a.csv moved.csv");
	assert_int_equal(store_open(&store, "moved.csv", false, &error), STATUS_OK);
	stdfit("b.binary " CHEAP " -o moved.csv");
	expect_error(1, "is writing it");
	assert_int_equal(store_append(&store, &rows, &error), STATUS_OK);
	stdfit("b.binary " CHEAP " -o moved.csv");
	expect_error(1, "is writing it");
	/* The name is taken from it, and given to another file, which another run is writing. */
	shell("mv moved.csv away.csv; cp b.csv moved.csv");
	const int fd = open("moved.csv", O_WRONLY | O_CLOEXEC);
	assert_int_equal(flock(fd, LOCK_EX | LOCK_NB), 0);
	assert_int_equal(store_rewrite(&store, &rows, &error), STATUS_IO);
	expect_part(error.text, "cannot write 'moved.csv': ", __LINE__);
	store_close(&store);
	close(fd);
	csv_table_free(&rows);
	shell("cmp moved.csv b.csv && cmp away.csv b.csv && ! ls -a | grep tmp$");
	expect_code(0);
}

static void backups_without_hard_links(void **state)
{
	(void)state;
	struct csv_table rows = read_table("b.csv");
	struct error error;
	struct rlimit old, low;
	shell("cat a.csv a.csv a.csv a.csv >plain.csv; cp plain.csv older.csv; rm -f plain.csv~");
	no_links = true;
	assert_int_equal(store_write("plain.csv", &rows, csv_write, &error), STATUS_OK);
	shell("cmp plain.csv b.csv && cmp plain.csv~ older.csv");
	expect_code(0);
	/* A limit on the size of files stands for a full disk: there is room for the new table, not for a copy. */
	shell("cp older.csv plain.csv; rm plain.csv~");
	struct stat info;
	assert_int_equal(stat("b.csv", &info), 0);
	signal(SIGXFSZ, SIG_IGN);
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
	low = old;
	low.rlim_cur = (rlim_t)info.st_size + 1;
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &low), 0);
	const enum status whole = store_write("plain.csv", &rows, csv_write, &error);
	struct store store;
	assert_int_equal(store_open(&store, "plain.csv", false, &error), STATUS_OK);
	const enum status appended = store_append(&store, &rows, &error);
	store_close(&store);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
	signal(SIGXFSZ, SIG_DFL);
	no_links = false;
	assert_int_equal(whole, STATUS_IO);
	assert_int_equal(appended, STATUS_IO);
	expect_part(error.text, "cannot keep 'plain.csv' as FILE~: File too large", __LINE__);
	shell("cmp plain.csv older.csv && ! test -e plain.csv~ && ! ls -a | grep tmp$");
	expect_code(0);
	csv_table_free(&rows);
	/* What is no file has the backup's name. */
	shell("mkdir in_the_way.csv~; cp a.csv in_the_way.csv");
	static const char *const kept[] = {"a.binary " CHEAP " -o in_the_way.csv", "merge b.csv -o in_the_way.csv"};
	for (size_t k = 0; k < sizeof kept / sizeof *kept; k++) {
		stdfit(kept[k]);
		expect_error(1, "cannot keep 'in_the_way.csv' as FILE~: Is a directory");
	}
	shell("cmp a.csv in_the_way.csv && ! ls -a | grep tmp$");
	expect_code(0);
}

/* Every command, every way to name a file. */
static void inputs_are_no_outputs(void **state)
{
	(void)state;
	static const char *const refused[] = {
		"compare in.csv -o in.csv",
		"compare in.csv --json -o ./in.csv",
		"merge in.csv b.csv -o in.csv",
		"merge b.csv in.csv -o hard.csv",
		"merge in.csv in.binary -o in.binary",
		"merge in.csv directory -o in.binary",
		"in.binary " CHEAP " -o in.binary",
		"directory " CHEAP " -o in.binary",
		"compare directory " CHEAP " -o in.binary",
		"compare in.csv --pictures -o in.binary",
		"export --from in.csv --row 1 --format json -o in.binary",
		"export in.binary --kd 1 --format merl -o in.binary",
		"render in.csv -o in.pfm",
		"render in.pfm --kd 1 -o in.pfm",
	};
	shell("cp a.binary in.binary; ln in.binary in.pfm; mkdir directory; ln in.binary directory/x.binary; "
	      "\"$STDFIT\" "
	      "in.binary " CHEAP " -o in.csv; ln in.csv hard.csv; md5sum in.binary in.csv >sums");
	for (size_t r = 0; r < sizeof refused / sizeof *refused; r++) {
		stdfit(refused[r]);
		expect_error(2, "--output names a file that is to be read");
	}
	stdfit("convert in.binary directory/../in.pfm");
	expect_error(2, "OUT names a file that is to be read");
	shell("\"$STDFIT\" convert a.binary samples.csv -q && \"$STDFIT\" convert a.binary - -q | cmp - samples.csv && "
	      "rm "
	      "samples.csv");
	expect_code(0);
	shell("exec \"$STDFIT\" merge in.csv b.csv -o - >>in.csv");
	expect_error(2, "--output names a file that is to be read");
	/* The backup of an output. */
	shell("ln in.binary q~; ln -s q q_link; ln in.csv r.csv");
	static const char *const backed_up[] = {"q~ " CHEAP " -o q", "q~ " CHEAP " --resume -o q_link",
						"in.binary " CHEAP " -o q", "compare q~ " CHEAP " -o q"};
	for (size_t b = 0; b < sizeof backed_up / sizeof *backed_up; b++) {
		stdfit(backed_up[b]);
		expect_error(2, "the backup of --output, FILE~, would replace a file that is to be read");
	}
	stdfit("b.binary " CHEAP " --trace t.csv~ -o t.csv");
	expect_error(2, "--trace names the backup of --output, FILE~");
	/* Directories: what is written there, and what rows name. */
	shell("mkdir -p page plots/in; ln in.binary page/index.html; ln in.binary plots/in/map.csv");
	stdfit("report in.csv -o page");
	expect_error(2, "expected another directory: index.html in this one is to be read");
	stdfit("report directory " CHEAP " -o page");
	expect_error(2, "expected another directory: index.html in this one is to be read");
	stdfit("plot in.csv -o plots");
	expect_code(1);
	expect_part(last.err, "expected another directory: map.csv in this one is to be read", __LINE__);
	shell("md5sum -c --quiet sums && ! test -e q && ! test -e t.csv && cmp in.binary q~");
	expect_code(0);
}

static void rows_that_contradict_each_other(void **state)
{
	(void)state;
	/* Row 2 is as row 1 but for the error; row 3 agrees with row 1. */
	shell("cp a.csv odd.csv; tail -n 1 a.csv | sed 's/^a,ggx,[^,]*/a,ggx,0.75/' >>odd.csv; tail -n 1 a.csv "
	      ">>odd.csv; "
	      "tail -n 1 b.csv >>odd.csv; cp odd.csv kept.csv");
	stdfit("compare odd.csv");
	expect_error(1, "'odd.csv' rows 1 and 2, of the same fit, differ in error");
	stdfit("report odd.csv -o odd_page");
	expect_error(1, "'odd.csv' rows 1 and 2, of the same fit, differ in error");
	stdfit("plot odd.csv -o odd_plots");
	expect_error(1, "'odd.csv' rows 1 and 2, of the same fit, differ in error");
	/* No command takes one of the two silently; --row says which. */
	static const char *const from[] = {"eval a.binary --from odd.csv",
					   "export a.binary --from odd.csv --format json",
					   "render a.binary b.binary --from odd.csv " QUICK,
					   "render odd.csv " QUICK,
					   "ndf --from odd.csv --theta 0",
					   "sample --from odd.csv"};
	for (size_t i = 0; i < sizeof from / sizeof *from; i++) {
		stdfit(from[i]);
		expect_error(1, "'odd.csv' rows 1 and 2, of the same fit, differ in error");
		assert_string_equal(last.out, "");
	}
	stdfit("eval a.binary --from odd.csv --row 2");
	expect_code(0);
	/* Another file's: they stay, and are named. */
	stdfit("b.binary " CHEAP " --resume -o odd.csv");
	expect_error(0, "'odd.csv' rows 1 and 2, of the same fit, differ in error: such fits are made again");
	struct csv_table table = read_table("odd.csv");
	assert_int_equal(table.n_rows, 4);
	csv_table_free(&table);
	stdfit("a.binary b.binary " CHEAP " --resume -o odd.csv");
	expect_error(0, "of the same fit, differ in error: such fits are made again");
	shell("\"$STDFIT\" merge a.csv b.csv | cut -d, -f1-30 >both; cut -d, -f1-30 odd.csv | cmp - both; \"$STDFIT\" "
	      "compare "
	      "odd.csv >compared; grep -c ggx,0.75, odd.csv~");
	expect_code(0);
	assert_string_equal(last.out, "1\n");
	/* Rows that agree count once. */
	shell("cp a.csv same.csv; tail -n 1 a.csv >>same.csv; \"$STDFIT\" compare same.csv && \"$STDFIT\" "
	      "a.binary " CHEAP " --resume -o same.csv && cmp same.csv a.csv");
	expect_code(0);
	assert_string_equal(last.err, "");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(descriptors_are_written_in_order),
		cmocka_unit_test(pictures_and_tables_of_bytes_go_to_standard_output),
		cmocka_unit_test(what_is_no_file_is_not_resumed),
		cmocka_unit_test(links_are_followed),
		cmocka_unit_test(a_backup_that_is_the_table_itself),
		cmocka_unit_test(one_writer_at_a_time),
		cmocka_unit_test(rows_of_two_writers),
		cmocka_unit_test(a_lock_follows_the_name),
		cmocka_unit_test(backups_without_hard_links),
		cmocka_unit_test(inputs_are_no_outputs),
		cmocka_unit_test(rows_that_contradict_each_other),
	};
	return cmocka_run_group_tests(tests, set_up, leave_directory);
}
