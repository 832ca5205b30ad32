/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run_program - the program as a test drives it: in a temporary directory of its own, through the shell, with what it
 * ended with and wrote kept for a look. The program is $STDFIT or build/stdfit. */
#ifndef RUN_PROGRAM_H
#define RUN_PROGRAM_H

#include "check.h"
#include "fit/render/image.h"
#include "fit/results/result.h"

#include <errno.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* ThreadSanitizer keeps files of its own, which a limit on the size of files hits as well. */
#if defined __SANITIZE_THREAD__
#define THREAD_SANITIZER true
#elif defined __has_feature
#define THREAD_SANITIZER __has_feature(thread_sanitizer)
#else
#define THREAD_SANITIZER false
#endif

static char test_directory[] = "/tmp/stdfit-test-XXXXXX";

/* What the last run left. */
static struct {
	int code; /* 128 + signal when killed by one */
	char *out, *err;
} last;

static inline char *slurp(const char *path)
{
	char *text = NULL;
	size_t size = 0;
	FILE *file = fopen(path, "rb"), *memory = open_memstream(&text, &size);
	if (!file)
		fail_msg("%s: %s", path, strerror(errno));
	assert_non_null(file);
	assert_non_null(memory);
	for (int c; (c = fgetc(file)) != EOF;)
		fputc(c, memory);
	fclose(file);
	assert_int_equal(fclose(memory), 0);
	return text;
}

/* Starts a shell command in the temporary directory; `exec` in it makes the process the program itself. */
static inline pid_t start(const char *command)
{
	const pid_t pid = fork();
	assert_true(pid >= 0);
	if (pid == 0) {
		execl("/bin/sh", "sh", "-c", command, (char *)NULL);
		_exit(127);
	}
	return pid;
}

static inline int end(pid_t pid)
{
	int status;
	while (waitpid(pid, &status, 0) < 0)
		assert_int_equal(errno, EINTR);
	return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/* Runs a shell command and keeps its code and streams in `last`. */
static inline void shell(const char *command)
{
	char *whole;
	assert_true(asprintf(&whole, "{ %s\n} >stdout 2>stderr", command) > 0);
	free(last.out);
	free(last.err);
	last.code = end(start(whole));
	last.out = slurp("stdout");
	last.err = slurp("stderr");
	free(whole);
}

/* Runs the program with these arguments. */
static inline void stdfit(const char *arguments)
{
	char *command;
	assert_true(asprintf(&command, "exec \"$STDFIT\" %s", arguments) > 0);
	shell(command);
	free(command);
}

static inline size_t count_lines(const char *text)
{
	size_t n = 0;
	for (; *text; text++)
		n += *text == '\n';
	return n;
}

#define expect_code(wanted) expect_code_at(wanted, __LINE__)
static inline void expect_code_at(int wanted, int line)
{
	if (last.code != wanted)
		fail_msg("line %d: exit code %d, expected %d; standard error: %s", line, last.code, wanted, last.err);
}

/* The run ended with this code, one line on standard error that begins "stdfit: " and has `part`. */
#define expect_error(code, part) expect_error_at(code, part, __LINE__)
static inline void expect_error_at(int code, const char *part, int line)
{
	expect_code_at(code, line);
	if (count_lines(last.err) != 1 || strncmp(last.err, "stdfit: ", 8) != 0 || !strstr(last.err, part))
		fail_msg("line %d: expected one line with '%s' on standard error, found: %s", line, part, last.err);
}

#define expect_out(part) expect_part(last.out, part, __LINE__)
static inline void expect_part(const char *text, const char *part, int line)
{
	if (!strstr(text, part))
		fail_msg("line %d: expected '%s' in: %.2000s", line, part, text);
}

static inline struct csv_table read_table(const char *path)
{
	struct csv_table table = csv_table_make(result_columns, RESULT_COLUMNS);
	struct error error;
	if (csv_table_read(&table, path, RESULT_COLUMNS, NULL, &error))
		fail_msg("%s", error.text);
	return table;
}

/* The table as text, without what differs between runs. */
static inline char *without_seconds(const char *path)
{
	struct csv_table table = read_table(path);
	char *text = NULL, empty[] = "";
	size_t size;
	FILE *file = open_memstream(&text, &size);
	assert_non_null(file);
	for (size_t i = 0; i < table.n_rows; i++) {
		table.row[i][RESULT_SECONDS] = empty;
		csv_write_row(file, table.row[i], RESULT_COLUMNS);
	}
	assert_int_equal(fclose(file), 0);
	csv_table_free(&table);
	return text;
}

/* Waits until the file has this many lines. */
static inline void wait_for_lines(const char *path, size_t lines)
{
	for (bool there = false; !there;) {
		nanosleep(&(struct timespec){.tv_nsec = 2000000}, NULL);
		if (access(path, F_OK) == 0) {
			char *text = slurp(path);
			there = count_lines(text) >= lines;
			free(text);
		}
	}
}

static inline void write_text(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

/* Whether a command can draw plots here. */
static inline bool have_gnuplot(void)
{
	return system("command -v gnuplot >/dev/null") == 0;
}

/* A build without libpng says so first when a page is to have spheres; takes that line off. */
static inline void drop_no_png(void)
{
	if (image_has_png())
		return;
	assert_true(!strncmp(last.err, "stdfit: this build cannot write PNG", 35));
	const char *rest = strchr(last.err, '\n');
	assert_non_null(rest);
	memmove(last.err, rest + 1, strlen(rest));
}

/* A group's set-up, or the first of it: goes into a new directory, with the absolute name of the program in $STDFIT. */
static inline int enter_directory(void **state)
{
	(void)state;
	const char *given = getenv("STDFIT");
	char *program = realpath(given ? given : "build/stdfit", NULL);
	/* The width of whoever runs the tests is none of theirs. */
	const bool ready = program && !setenv("STDFIT", program, 1) && !unsetenv("COLUMNS") &&
			   mkdtemp(test_directory) && !chdir(test_directory);
	free(program);
	alarm(1800); /* a hang ends; a machine that is busy with other things is no hang */
	return ready ? 0 : -1;
}

/* A group's tear-down, or the last of it: removes the directory and all that is in it. */
static inline int leave_directory(void **state)
{
	(void)state;
	free(last.out);
	free(last.err);
	last.out = last.err = NULL;
	const pid_t pid = fork();
	if (pid == 0) {
		execlp("rm", "rm", "-rf", test_directory, (char *)NULL);
		_exit(127);
	}
	return end(pid);
}

#endif
