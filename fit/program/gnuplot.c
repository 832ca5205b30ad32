/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gnuplot.h"
#include "text_quote.h"

#include <errno.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { SCRIPTS_MAX = 8, NAME_SIZE = 64 };
static const char *const formats[] = {"png", "svg"};
enum { FORMATS = sizeof formats / sizeof *formats };

void gnuplot_string(FILE *file, const char *text)
{
	char shown[TEXT_QUOTE_SIZE];
	text_quote(text, shown, sizeof shown);
	fputc('\'', file);
	for (const char *c = shown; *c; c++) {
		if (*c == '\'')
			fputc('\'', file);
		fputc(*c, file);
	}
	fputc('\'', file);
}

void gnuplot_begin(FILE *file, const char *name, int width, int height)
{
	fprintf(file,
		"# Made by stdfit %s. To draw again: gnuplot %s.gp\n"
		"reset\n"
		"if (!exists(\"part\")) part = \"\"\n"
		"set encoding utf8\n"
		"set datafile separator \",\"\n"
		"set grid lc rgb \"#dddddd\" lt 1\n"
		"set tics nomirror\n"
		"set border 3\n"
		"set key noenhanced samplen 2\n"
		"do for [format in \"png svg\"] {\n"
		"if (format eq \"png\") {\n"
		"\tset terminal pngcairo size %d,%d font \"sans,11\"\n"
		"} else {\n"
		"\tset terminal svg size %d,%d dynamic font \"sans,14\" background \"white\"\n"
		"}\n"
		"set output \"%s.\".format.part\n",
		STDFIT_VERSION, name, width, height, width, height, name);
}

void gnuplot_end(FILE *file)
{
	fputs("unset output\n}\n", file);
}

/* The last line of what gnuplot said. */
static void last_words(FILE *said, char *text, size_t size)
{
	char line[256];
	snprintf(text, size, "it failed without a word");
	rewind(said);
	while (fgets(line, sizeof line, said)) {
		line[strcspn(line, "\n")] = '\0';
		if (line[strspn(line, " \t^")])
			text_quote(line, text, size);
	}
}

/* Waits for the process; stops it when *cancel is set. Returns its status as of waitpid(). */
static int wait_for(pid_t pid, const atomic_bool *cancel)
{
	const struct timespec tick = {.tv_nsec = 5000000};
	int status = -1;
	bool killed = false;
	for (pid_t ended = 0; ended == 0;) {
		ended = waitpid(pid, &status, WNOHANG);
		if (ended < 0 && errno == EINTR)
			ended = 0;
		if (ended == 0 && *cancel && !killed)
			killed = !kill(pid, SIGKILL);
		if (ended == 0)
			nanosleep(&tick, NULL);
	}
	return status;
}

/* Runs gnuplot with these arguments in the directory, its words into `said`. */
static enum status run(const char *directory, char *const *argument, FILE *said, const atomic_bool *cancel,
		       struct error *error)
{
	posix_spawn_file_actions_t actions;
	extern char **environ;
	pid_t pid;
	if (posix_spawn_file_actions_init(&actions))
		return error_set(error, STATUS_NO_MEMORY, "out of memory");
	int errnum = posix_spawn_file_actions_addchdir_np(&actions, directory);
	for (int fd = STDOUT_FILENO; fd <= STDERR_FILENO && !errnum; fd++)
		errnum = posix_spawn_file_actions_adddup2(&actions, fileno(said), fd);
	if (!errnum)
		errnum = posix_spawnp(&pid, argument[0], &actions, NULL, argument, environ);
	posix_spawn_file_actions_destroy(&actions);
	if (errnum == ENOENT)
		return error_set(error, STATUS_UNSUPPORTED,
				 "gnuplot is not installed (on Debian: apt install gnuplot-nox)");
	if (errnum)
		return error_set(error, STATUS_IO, "cannot run gnuplot: %s", strerror(errnum));
	const int status = wait_for(pid, cancel);
	if (*cancel)
		return error_set(error, STATUS_INTERRUPTED, "interrupted");
	if (WIFEXITED(status) && WEXITSTATUS(status) == 0)
		return STATUS_OK;
	char words[TEXT_QUOTE_SIZE], where[TEXT_QUOTE_SIZE];
	last_words(said, words, sizeof words);
	text_quote(directory, where, sizeof where);
	return error_set(error, STATUS_IO, "gnuplot cannot draw in '%.120s': %s", where, words);
}

/* DIRECTORY/NAME.FORMAT, and the same with `part` behind it; NULL when out of memory. */
static char *picture_path(const char *directory, const char *name, const char *format, const char *part)
{
	char *path;
	return asprintf(&path, "%s/%s.%s%s", directory, name, format, part) < 0 ? NULL : path;
}

/* Puts a picture in its place, or drops it. */
static enum status settle(const char *directory, const char *name, const char *format, const char *part, bool keep,
			  struct error *error)
{
	char *path = picture_path(directory, name, format, ""), *temp = picture_path(directory, name, format, part);
	enum status status = STATUS_OK;
	if (!path || !temp) {
		status = error_set(error, STATUS_NO_MEMORY, "out of memory");
	} else if (keep && rename(temp, path)) {
		char shown[TEXT_QUOTE_SIZE];
		const int errnum = errno;
		text_quote(path, shown, sizeof shown);
		status = error_set(error, STATUS_IO, "cannot write '%s': %s", shown, strerror(errnum));
	}
	if (temp && (!keep || status))
		unlink(temp);
	free(temp);
	free(path);
	return status;
}

enum status gnuplot_draw(const char *directory, const char *const *name, int n, const atomic_bool *cancel,
			 struct error *error)
{
	char script[SCRIPTS_MAX][NAME_SIZE], part[NAME_SIZE], definition[NAME_SIZE + 8];
	char program[] = "gnuplot", defaults[] = "-d", execute[] = "-e";
	char *argument[SCRIPTS_MAX + 5] = {program, defaults, execute, definition};
	if (n > SCRIPTS_MAX)
		return error_set(error, STATUS_UNSUPPORTED, "more pictures than gnuplot_draw() takes at once");
	snprintf(part, sizeof part, ".stdfit-%ld.tmp", (long)getpid());
	snprintf(definition, sizeof definition, "part='%s'", part);
	for (int i = 0; i < n; i++) {
		snprintf(script[i], NAME_SIZE, "%s.gp", name[i]);
		argument[4 + i] = script[i];
	}
	FILE *said = tmpfile();
	if (!said)
		return error_set(error, STATUS_IO, "cannot make a temporary file: %s", strerror(errno));
	enum status status = run(directory, argument, said, cancel, error);
	fclose(said);
	const bool drawn = !status;
	for (int i = 0; i < n; i++)
		for (int f = 0; f < FORMATS; f++) {
			const enum status settled =
				settle(directory, name[i], formats[f], part, drawn, drawn && !status ? error : NULL);
			status = status ? status : settled;
		}
	return status;
}
