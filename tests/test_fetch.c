/* SPDX-License-Identifier: GPL-3.0-or-later */
/* scripts/fetch_merl.sh against a server that does what servers do: with curl and with wget, whichever is there. */
#include "http_server.h"
#include "run_program.h"

#include <signal.h>

static struct http_server server, slow_server; /* the second one serves start_slow_runs() */
/* The tool in use, and whether it is there. */
static const char *tool;

static const char *const tools[] = {"curl", "wget"};

/* A directory for $PATH with nothing in it but what the script needs and one of the tools. */
static void make_path(const char *name)
{
	char command[512];
	snprintf(command, sizeof command,
		 "mkdir path-%s && for c in sh cat wc tr od mv rm mkdir sleep sed tail head grep unzip printf setsid "
		 "%s; do "
		 "p=$(command -v $c) && test -e $p && ln -s $p path-%s/$c; done; true",
		 name, name, name);
	shell(command);
}

static bool has(const char *name)
{
	char path[64];
	snprintf(path, sizeof path, "path-%s/%s", name, name);
	return access(path, X_OK) == 0;
}

/* The shell command that runs the script. */
static char *command_of(const struct http_server *from, const char *place, const char *arguments)
{
	char *command;
	assert_true(asprintf(&command, "PATH=$PWD/path-%s exec \"$SCRIPT\" -u http://127.0.0.1:%d/%s %s", tool,
			     from->port, place, arguments) > 0);
	return command;
}

static void fetch(const char *place, const char *arguments)
{
	char *command = command_of(&server, place, arguments);
	shell(command);
	free(command);
}

/* What takes its seconds begins at once and is looked at last: per tool, of each place a run into a directory of that
 * name. */
static const struct {
	const char *place, *options, *materials;
} slow_runs[] = {
	{"dead", "", "brass"},
	{"silent", "-t 1", "brass"},
	{"error", "", "brass chrome nickel steel"},
};
enum { SLOW_RUNS = sizeof slow_runs / sizeof *slow_runs };
static pid_t slow_pid[SLOW_RUNS][2];

static void start_slow_runs(void)
{
	for (int t = 0; t < 2; t++) {
		tool = tools[t];
		for (int i = 0; i < SLOW_RUNS && has(tool); i++) {
			char arguments[256];
			snprintf(arguments, sizeof arguments, "%s slow-%s-%s %s >slow-%s-%s.out 2>slow-%s-%s.err",
				 slow_runs[i].options, tool, slow_runs[i].place, slow_runs[i].materials, tool,
				 slow_runs[i].place, tool, slow_runs[i].place);
			char *command = command_of(&slow_server, slow_runs[i].place, arguments);
			slow_pid[i][t] = start(command);
			free(command);
		}
	}
}

static int set_up(void **state)
{
	static const char *const unwanted[] = {"http_proxy", "HTTP_PROXY",   "all_proxy",
					       "ALL_PROXY",  "MERL_ADDRESS", "WGETRC"};
	char *top = realpath(".", NULL);
	char *script = NULL;
	if (!top || asprintf(&script, "%s/scripts/fetch_merl.sh", top) < 0 || setenv("SCRIPT", script, 1))
		return -1;
	free(script);
	free(top);
	for (size_t i = 0; i < sizeof unwanted / sizeof *unwanted; i++)
		unsetenv(unwanted[i]);
	if (enter_directory(state) || setenv("HOME", test_directory, 1))
		return -1;
	server = http_start("requests");
	slow_server = http_start("slow-requests");
	FILE *file = fopen("expected.binary", "wb");
	if (!server.port || !slow_server.port || !file || fwrite(http_table, sizeof http_table, 1, file) != 1 ||
	    fclose(file))
		return -1;
	for (int t = 0; t < 2; t++)
		make_path(tools[t]);
	start_slow_runs();
	return 0;
}

static int tear_down(void **state)
{
	http_stop(&server);
	http_stop(&slow_server);
	return leave_directory(state);
}

/* Runs a test with each tool that is there. */
static void with_each_tool(void (*test)(void))
{
	bool any = false;
	for (int t = 0; t < 2; t++) {
		tool = tools[t];
		if (!has(tool)) {
			print_message("%s is not installed: not tried\n", tool);
			continue;
		}
		any = true;
		shell("rm -rf d; : >requests");
		test();
	}
	if (!any)
		skip_for_want_of("curl and wget");
}

/* The directory has the right file, and nothing else. */
#define expect_only(names) expect_only_at(names, __LINE__)
static void expect_only_at(const char *names, int line)
{
	char *out = last.out, *err = last.err;
	const int code = last.code;
	last.out = last.err = NULL;
	shell("ls -A d | tr '\\n' ' '; for f in d/*.binary; do test ! -e \"$f\" || cmp \"$f\" expected.binary >&2 || "
	      "echo differs; done");
	if (strcmp(last.out, names))
		fail_msg("line %d: %s: in the directory: %s, expected %s; messages: %s", line, tool, last.out, names,
			 err);
	free(last.out);
	free(last.err);
	last.out = out;
	last.err = err;
	last.code = code;
}

#define expect_words(code, part) expect_words_at(code, part, __LINE__)
static void expect_words_at(int code, const char *part, int line)
{
	expect_code_at(code, line);
	expect_part(last.err, part, line);
	for (const char *at = last.err; *at; at = strchr(at, '\n') + 1)
		if (strncmp(at, "fetch_merl.sh: ", 15))
			fail_msg("line %d: %s: a line that is not the script's own: %s", line, tool, last.err);
}

static void good(void)
{
	fetch("good", "d brass");
	expect_code(0);
	assert_string_equal(last.err, "");
	expect_out("1 of 1 files are in d");
	expect_only("brass.binary ");
	/* What is there is not asked for again; MERL_ADDRESS does as -u does. */
	char command[256];
	snprintf(command, sizeof command,
		 ": >requests; MERL_ADDRESS=http://127.0.0.1:%d/good/ PATH=$PWD/path-%s \"$SCRIPT\" d brass nickel && "
		 "cat "
		 "requests",
		 server.port, tool);
	shell(command);
	expect_code(0);
	expect_out("\ngood/nickel.binary 0\n");
	assert_null(strstr(last.out, "good/brass"));
	expect_only("brass.binary nickel.binary ");
}

static void a_connection_that_breaks_off(void)
{
	fetch("cut", "d brass");
	expect_code(0);
	expect_only("brass.binary ");
	char *requests = slurp("requests");
	assert_string_equal(requests, "cut/brass.binary 0\ncut/brass.binary 12000000\ncut/brass.binary 24000000\n");
	free(requests);
}

static void part_of_an_earlier_run(void)
{
	shell("mkdir d; head -c 20000000 expected.binary >d/brass.binary.part");
	fetch("good", "d brass");
	expect_code(0);
	expect_only("brass.binary ");
	char *requests = slurp("requests");
	assert_string_equal(requests, "good/brass.binary 20000000\n");
	free(requests);
	/* A whole one needs no server; one that is too long begins anew. */
	shell("rm d/*; : >requests; cp expected.binary d/brass.binary.part; cp expected.binary "
	      "d/chrome.binary.part; echo more >>d/chrome.binary.part");
	fetch("good", "d brass chrome");
	expect_code(0);
	expect_only("brass.binary chrome.binary ");
	requests = slurp("requests");
	assert_string_equal(requests, "good/chrome.binary 0\n");
	free(requests);
}

static void a_server_that_ignores_ranges(void)
{
	shell("mkdir d; head -c 20000000 expected.binary >d/brass.binary.part");
	fetch("norange", "d brass");
	expect_code(0);
	expect_only("brass.binary ");
}

static void lies_about_the_size(void)
{
	/* All bytes came: the file is right, whatever was said. */
	fetch("long", "d brass");
	expect_code(0);
	expect_only("brass.binary ");
	fetch("short", "d chrome");
	expect_words(1, "d/chrome.binary: what the server has is 1000 bytes, expected 34992012\n");
	expect_words(1, "missing: chrome\n");
	expect_only("brass.binary ");
}

static void other_than_data(void)
{
	fetch("nowhere", "d brass");
	expect_words(1, "d/brass.binary: HTTP 404\n");
	expect_only("");
	fetch("html", "d brass");
	expect_words(1, "d/brass.binary: what the server has is 25 bytes, expected 34992012\n");
	expect_only("");
	fetch("wrong", "d brass");
	expect_words(1, "no MERL table");
	expect_only("");
	fetch("endless", "d brass");
	expect_words(1, "d/brass.binary: more than 34992012 bytes came\n");
	expect_only("");
	fetch("loop", "d brass");
	expect_code(1);
	expect_only("");
	fetch("moved", "d brass");
	expect_code(0);
	expect_only("brass.binary ");
}

static void a_bad_one_costs_only_itself(void)
{
	fetch("mixed", "d brass chrome nickel");
	expect_words(1, "d/brass.binary: HTTP 404\n");
	expect_words(1, "d/chrome.binary: what the server has is 25 bytes");
	expect_words(1, "missing: brass chrome\n");
	expect_out("1 of 3 files are in d");
	expect_only("nickel.binary ");
}

static void what_is_there_already(void)
{
	shell("mkdir d; echo mine >d/brass.binary; cp expected.binary d/mine.binary");
	fetch("good", "d brass");
	expect_words(1, "d/brass.binary: 5 bytes, expected 34992012; left alone");
	expect_words(1, "d/mine.binary: no material of the database");
	char *mine = slurp("d/brass.binary"), *requests = slurp("requests");
	assert_string_equal(mine, "mine\n");
	assert_string_equal(requests, "");
	free(mine);
	free(requests);
	shell("rm d/*; ln expected.binary d/chrome.binary");
	fetch("good", "-c d brass chrome");
	expect_words(1, "missing: brass\n");
	expect_words(1, "BRDFDatabase.zip");
	expect_out("1 of 2 files are in d");
	fetch("good", "-c d chrome");
	expect_code(0);
	assert_string_equal(last.err, "");
}

/* A port where nobody listens: the server's, once it is away. */
static void no_server(void)
{
	char command[256];
	struct http_server gone = http_start("requests");
	assert_true(gone.port);
	kill(gone.pid, SIGKILL);
	end(gone.pid);
	snprintf(command, sizeof command, "PATH=$PWD/path-%s exec \"$SCRIPT\" -u http://127.0.0.1:%d d", tool,
		 gone.port);
	shell(command);
	expect_words(1, "nothing comes from http://127.0.0.1:");
	expect_words(1, "to get the database by hand: open https://www.merl.com/research/downloads/BRDF");
	expect_only("");
}

static void disk_full(void)
{
	shell("mkdir d; ln -s /dev/full d/brass.binary.part");
	fetch("good", "d brass chrome");
	expect_words(1, "cannot write 'd/brass.binary.part'");
	fetch("good", "/proc/nowhere brass");
	expect_words(1, "cannot make the directory '/proc/nowhere'");
}

/* Ctrl-C, which a terminal sends to all: what came stays, and the next run goes on from there. */
static void an_interrupt(void)
{
	char command[512];
	snprintf(command, sizeof command,
		 "PATH=$PWD/path-%s exec setsid \"$SCRIPT\" -u http://127.0.0.1:%d/stuck d brass 2>stderr", tool,
		 server.port);
	const pid_t pid = start(command);
	shell("i=0; until test -s d/brass.binary.part; do i=$((i + 1)); test $i -lt 600 || exit 1; sleep 0.1; done");
	expect_code(0);
	assert_int_equal(kill(-pid, SIGINT), 0);
	assert_int_equal(end(pid), 130);
	shell("n=$(wc -c <d/brass.binary.part); cmp -n $n d/brass.binary.part expected.binary && ls -A d && printf "
	      "'stuck/brass.binary 0\\ngood/brass.binary %d\\n' $n >wanted");
	assert_string_equal(last.out, "brass.binary.part\n");
	fetch("good", "d brass");
	expect_code(0);
	expect_only("brass.binary ");
	char *requests = slurp("requests"), *wanted = slurp("wanted");
	assert_string_equal(requests, wanted);
	free(wanted);
	free(requests);
}

#define EACH(name)                                                                                                     \
	static void name##_each(void **state)                                                                          \
	{                                                                                                              \
		(void)state;                                                                                           \
		with_each_tool(name);                                                                                  \
	}
EACH(good)
EACH(a_connection_that_breaks_off)
EACH(part_of_an_earlier_run)
EACH(a_server_that_ignores_ranges)
EACH(lies_about_the_size)
EACH(other_than_data)
EACH(a_bad_one_costs_only_itself)
EACH(what_is_there_already)
EACH(no_server)
EACH(disk_full)
EACH(an_interrupt)

/* Makes all.zip: a good file, and one that is too short. */
static void the_archive(void **state)
{
	(void)state;
	tool = tools[!has(tools[0])];
	shell("mkdir -p x/BRDFDatabase/brdfs && cd x && ln ../expected.binary BRDFDatabase/brdfs/brass.binary && head "
	      "-c "
	      "1000 ../expected.binary >BRDFDatabase/brdfs/nickel.binary && zip -q -0 -r ../all.zip BRDFDatabase");
	if (last.code || !has(tool) || access("path-curl/unzip", X_OK))
		skip_for_want_of("zip, unzip, or curl and wget");
	/* In pieces, of which an earlier run left some. */
	shell("rm -rf d; mkdir d; : >requests; head -c 5000 all.zip >d/all.zip.part");
	fetch("cutfile/all.zip?download=1", "d brass nickel steel");
	expect_words(1, "d/nickel.binary: 1000 bytes, expected 34992012\n");
	expect_words(1, "d/steel.binary: not in 'd/all.zip'\n");
	expect_only("all.zip brass.binary ");
	char *requests = slurp("requests");
	assert_string_equal(requests, "cutfile/all.zip 5000\ncutfile/all.zip 12005000\ncutfile/all.zip 24005000\n");
	free(requests);
	/* One that was put there by hand, with a byte changed in a file. */
	shell("rm d/*.binary; printf x | dd of=d/all.zip bs=1 seek=20000000 conv=notrunc 2>/dev/null");
	fetch("nowhere/all.zip", "d brass");
	expect_words(1, "d/brass.binary: damaged in 'd/all.zip'");
	expect_only("all.zip ");
	shell("truncate -s 1000000 d/all.zip");
	fetch("file/all.zip", "d brass");
	expect_words(1, "d/all.zip: no whole zip archive; left alone");
	expect_only("all.zip ");
	shell("rm d/*");
	fetch("html/all.zip", "d brass");
	expect_words(1, "d/all.zip: what the server has, 25 bytes, is no zip archive\n");
	expect_words(1, "to get the database by hand");
	expect_only("");
	fetch("nowhere/all.zip", "d brass");
	expect_words(1, "d/all.zip: HTTP 404\n");
	expect_only("");
}

static void wrong_usage_is_refused(void **state)
{
	(void)state;
	static const char *const wrong[] = {"-x",   "-u",    "-u ftp://x/y", "-u http://",      "-t 0",
					    "-t x", "-t ''", "d glass",      "d 'brass chrome'"};
	tool = "curl";
	for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
		char command[256];
		snprintf(command, sizeof command, "exec \"$SCRIPT\" %s", wrong[i]);
		shell(command);
		expect_words(2, "(see fetch_merl.sh -h)");
		assert_int_equal(count_lines(last.err), 1);
	}
	shell("exec \"$SCRIPT\" -l");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 100);
	expect_out("alum-bronze\n");
	expect_out("\nyellow-plastic\n");
	shell("mkdir none; ln -s \"$(command -v cat)\" none; PATH=$PWD/none exec /bin/sh \"$SCRIPT\" d brass");
	expect_words(1, "neither curl nor wget is installed");
	expect_words(1, "by hand");
}

static void slow_servers(void **state)
{
	(void)state;
	bool any = false;
	for (int t = 0; t < 2; t++)
		for (int i = 0; i < SLOW_RUNS; i++) {
			if (!slow_pid[i][t])
				continue;
			any = true;
			tool = tools[t];
			const int code = end(slow_pid[i][t]);
			char command[512];
			snprintf(command, sizeof command, "cat slow-%s-%s.err >&2; rm -rf d; mv slow-%s-%s d; exit %d",
				 tool, slow_runs[i].place, tool, slow_runs[i].place, code);
			shell(command);
			if (!strcmp(slow_runs[i].place, "dead")) {
				expect_words(1, "; 1000 of 34992012 bytes are there; run again to go on\n");
				shell("cmp -n 1000 d/brass.binary.part expected.binary && ls -A d");
				expect_code(0);
				assert_string_equal(last.out, "brass.binary.part\n");
			} else if (!strcmp(slow_runs[i].place, "silent")) {
				expect_words(1, "; 0 of 34992012 bytes are there");
				expect_only("");
			} else {
				/* Three in a row without a byte: no use to ask for the others. */
				expect_words(1, "/nickel.binary: HTTP 503");
				expect_words(1, "nothing comes from http://127.0.0.1:");
				assert_null(strstr(last.err, "steel"));
				expect_only("");
			}
		}
	if (!any)
		skip_for_want_of("curl and wget");
}

int main(void)
{
	/* Started in the background, a shell script that inherits an ignored signal could not be interrupted. */
	signal(SIGINT, SIG_DFL);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(good_each),
		cmocka_unit_test(a_connection_that_breaks_off_each),
		cmocka_unit_test(part_of_an_earlier_run_each),
		cmocka_unit_test(a_server_that_ignores_ranges_each),
		cmocka_unit_test(lies_about_the_size_each),
		cmocka_unit_test(other_than_data_each),
		cmocka_unit_test(a_bad_one_costs_only_itself_each),
		cmocka_unit_test(what_is_there_already_each),
		cmocka_unit_test(no_server_each),
		cmocka_unit_test(disk_full_each),
		cmocka_unit_test(an_interrupt_each),
		cmocka_unit_test(the_archive),
		cmocka_unit_test(wrong_usage_is_refused),
		cmocka_unit_test(slow_servers),
	};
	return cmocka_run_group_tests(tests, set_up, tear_down);
}
