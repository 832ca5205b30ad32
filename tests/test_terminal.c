/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the program writes to a terminal: tables that fit it, and the line of progress. Runs $STDFIT or build/stdfit. */
#include "fit/cli/terminal.h"
#include "run_program.h"

#include <fcntl.h>
#include <sys/ioctl.h>

#define CHEAP "--ndf ggx,beckmann --sigma 0.2 --ior 1.5 --max-theta 10"
#define LONG_NAME "a-material-whose-name-is-longer-than-a-column-should-be"

static int set_up(void **state)
{
	if (enter_directory(state))
		return -1;
	shell("\"$STDFIT\" synth a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5 && ln a.binary "
	      "b.binary && mkdir -p tree/below && ln a.binary tree/a.binary && ln a.binary tree/below/b.binary && ln "
	      "a.binary " LONG_NAME ".binary && \"$STDFIT\" " LONG_NAME ".binary " CHEAP " --no-diffuse -o fits.csv && "
	      "for n in std gtr hyper-cauchy t-family; do sed -n \"s/,ggx,/,$n,/p\" fits.csv; done | cat fits.csv - "
	      ">all.csv");
	return last.code;
}

/* Runs a shell command whose terminal has so many columns; returns what comes to it, to be freed. */
static char *in_terminal(int columns, const char *command)
{
	const struct winsize size = {.ws_row = 24, .ws_col = (unsigned short)columns};
	const int master = posix_openpt(O_RDWR | O_NOCTTY);
	char *text = NULL;
	size_t length = 0;
	FILE *memory = open_memstream(&text, &length);

	assert_true(master >= 0 && grantpt(master) == 0 && unlockpt(master) == 0);
	assert_non_null(memory);
	const int terminal = open(ptsname(master), O_RDWR | O_NOCTTY);

	assert_true(terminal >= 0);
	const pid_t pid = fork();

	assert_true(pid >= 0);
	if (pid == 0) {
		if (ioctl(terminal, TIOCSWINSZ, &size) || dup2(terminal, 1) < 0 || dup2(terminal, 2) < 0)
			_exit(126);
		close(terminal);
		execl("/bin/sh", "sh", "-c", command, (char *)NULL);
		_exit(127);
	}
	close(terminal);
	char block[4096];

	/* An error when nobody has the other side any more. */
	for (ssize_t n; (n = read(master, block, sizeof block)) > 0;)
		fwrite(block, 1, (size_t)n, memory);
	close(master);
	last.code = end(pid);
	assert_int_equal(fclose(memory), 0);
	return text;
}

/* The longest line has from `least` to `most` columns. */
static void check_lines(const char *text, int least, int most, const char *what)
{
	int longest = 0;

	for (const char *line = text; *line;) {
		const size_t n = strcspn(line, "\r\n");
		const int columns = terminal_columns(line, n);
		longest = columns > longest ? columns : longest;
		line += n;
		line += strspn(line, "\r\n");
	}
	if (longest < least || longest > most)
		fail_msg("%s: the longest line has %d columns, expected %d to %d: %s", what, longest, least, most,
			 text);
}

static void tables_fit_the_terminal(void **state)
{
	(void)state;
	static const char *const shown[] = {"merge all.csv", "compare all.csv", "compare --help",
					    (LONG_NAME ".binary " CHEAP " -q"),
					    "ndf std --sigma 0.2 --gamma 2 --theta 10 --theta-i 20"};
	static const int columns[] = {80, 100};

	for (size_t i = 0; i < sizeof shown / sizeof *shown; i++)
		for (size_t c = 0; c < sizeof columns / sizeof *columns; c++) {
			char command[256];
			snprintf(command, sizeof command, "exec \"$STDFIT\" %s", shown[i]);
			char *text = in_terminal(columns[c], command);
			assert_int_equal(last.code, 0);
			check_lines(text, 40, columns[c], shown[i]);
			free(text);
		}
	/* Nothing is lost: what does not stand beside each other stands below. */
	char *text = in_terminal(80, "exec \"$STDFIT\" compare all.csv");

	expect_part(text, "\na-material-who..  ", __LINE__);
	expect_part(text, "hyper-cauchy", __LINE__);
	expect_part(text, "(mean)", __LINE__);
	expect_part(strstr(text, "(wins)"), "(wins)", __LINE__);
	assert_non_null(strstr(strstr(text, "(wins)") + 1, "(wins)"));
	free(text);
	/* A wide one has all in one line; a file always has. */
	text = in_terminal(300, "exec \"$STDFIT\" compare all.csv");
	expect_part(text, LONG_NAME, __LINE__);
	expect_part(text, "error_hyper-cauchy", __LINE__);
	free(text);
}

static void columns_stand_for_a_terminal(void **state)
{
	(void)state;
	static const struct {
		const char *arguments;
		int columns; /* 80 is what is promised */
	} shown[] = {{"compare --table all.csv", 60}, {"merge --table all.csv", 85}, {"compare --help", 75}};

	for (size_t i = 0; i < sizeof shown / sizeof *shown; i++) {
		char command[128];
		const char *what = shown[i].arguments;
		const int columns = shown[i].columns;
		snprintf(command, sizeof command, "COLUMNS=%d exec \"$STDFIT\" %s", columns, what);
		shell(command);
		expect_code(0);
		check_lines(last.out, 40, columns, what);
		/* The terminal knows better. */
		char *text = in_terminal(150, command);
		check_lines(text, columns + 1, 150, what);
		free(text);
		/* One that does not know its width asks for them; what is no number is none. */
		text = in_terminal(0, command);
		check_lines(text, 40, columns, what);
		free(text);
		snprintf(command, sizeof command, "COLUMNS=4O exec \"$STDFIT\" %s", what);
		text = in_terminal(0, command);
		check_lines(text, 61, 80, what);
		free(text);
	}
}

static void progress_is_told(void **state)
{
	(void)state;
	/* Of a single file, with standard output in a pipe or file. */
	char *text = in_terminal(80, "exec \"$STDFIT\" a.binary " CHEAP " >out");

	expect_part(text, "0 of 1 files", __LINE__);
	free(text);
	shell("wc -l <out");
	assert_int_equal(atoi(last.out), 3);
	text = in_terminal(80, "\"$STDFIT\" a.binary " CHEAP " | cat >out");
	expect_part(text, "0 of 1 files", __LINE__);
	free(text);
	text = in_terminal(80, "exec \"$STDFIT\" a.binary -q " CHEAP " >out");
	assert_string_equal(text, "");
	free(text);
	/* What was kept is told, and is no work that tells how long the rest will take. */
	text = in_terminal(80, "exec \"$STDFIT\" a.binary " CHEAP " -o kept.csv >out");
	free(text);
	text = in_terminal(80, "exec \"$STDFIT\" a.binary b.binary " CHEAP " --resume -o kept.csv >out");
	expect_part(text, "2 of 2 files in ", __LINE__);
	expect_part(text, " s, 1 kept, 0 failed", __LINE__);
	free(text);
	/* Without a terminal there is neither. */
	stdfit("a.binary b.binary " CHEAP " --resume -o kept.csv");
	expect_code(0);
	assert_string_equal(last.err, "");
}

static void info_takes_directories(void **state)
{
	(void)state;
	stdfit("info tree");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 2);
	expect_out("\ntree/a.binary,");
	stdfit("info -r tree");
	expect_code(0);
	assert_int_equal(count_lines(last.out), 3);
	expect_out("\ntree/below/b.binary,");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tables_fit_the_terminal),
		cmocka_unit_test(columns_stand_for_a_terminal),
		cmocka_unit_test(progress_is_told),
		cmocka_unit_test(info_takes_directories),
	};

	return cmocka_run_group_tests_name("terminal", tests, set_up, leave_directory);
}
