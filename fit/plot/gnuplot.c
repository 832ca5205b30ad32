/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/plot/gnuplot.h"
#include "data_readers/text_quote.h"
#include "fit/cli/output_directory.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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
	for (const char *c = shown; *c; c++)
		if (*c == '\'')
			fputs("'.\"'\".'", file);
		else
			fputc(*c, file);
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
		"set key noenhanced samplen 3.5\n"
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

/* The last line that gnuplot printed. */
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

/* Runs gnuplot with these arguments in the directory; what it prints goes to `said`. */
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

static enum status cannot_write(const char *directory, const char *picture, const char *why, struct error *error)
{
	char shown[TEXT_QUOTE_SIZE];
	text_quote(directory, shown, sizeof shown);
	return error_set(error, STATUS_IO, "cannot write '%s/%s': %s", shown, picture, why);
}

/* Whether a picture has its end: gnuplot does not check that it could write all of it. NULL, or why not. */
static const char *check_end(int fd)
{
	static const char *const end[] = {"IEND\xae\x42\x60\x82", "</svg>\n\n", "</svg>\n"};
	char tail[16] = "";
	struct stat st;
	if (fstat(fd, &st) || fsync(fd))
		return strerror(errno);
	const off_t n = st.st_size < (off_t)sizeof tail ? st.st_size : (off_t)sizeof tail;
	const bool read = pread(fd, tail, (size_t)n, st.st_size - n) == n;
	for (size_t e = 0; e < sizeof end / sizeof *end && read; e++) {
		const size_t length = strlen(end[e]);
		if ((size_t)n >= length && !memcmp(tail + (size_t)n - length, end[e], length))
			return NULL;
	}
	return "gnuplot has not written it as a whole";
}

/* Renames a finished picture to its name, or removes it. Allocates nothing, so no temporary file is left behind. at: the
 * open directory. */
static enum status settle(int at, const char *directory, const char *name, const char *format, const char *part,
			  bool keep, struct error *error)
{
	char picture[NAME_SIZE + 8], temp[2 * NAME_SIZE + 8];
	snprintf(picture, sizeof picture, "%s.%s", name, format);
	snprintf(temp, sizeof temp, "%s%s", picture, part);
	const int fd = keep ? openat(at, temp, O_RDONLY | O_CLOEXEC) : -1;
	const char *why = !keep ? NULL : fd < 0 ? strerror(errno) : check_end(fd);
	if (fd >= 0)
		close(fd);
	if (keep && !why)
		why = output_file_problem(at, picture);
	if (keep && !why && renameat(at, temp, at, picture))
		why = strerror(errno);
	if (!keep || why)
		unlinkat(at, temp, 0);
	return why ? cannot_write(directory, picture, why, error) : STATUS_OK;
}

enum status gnuplot_draw(const char *directory, const char *const *name, int n, const atomic_bool *cancel,
			 struct error *error)
{
	char script[SCRIPTS_MAX][NAME_SIZE], part[NAME_SIZE], definition[NAME_SIZE + 8];
	char program[] = "gnuplot", defaults[] = "-d", execute[] = "-e";
	char *argument[SCRIPTS_MAX + 5] = {program, defaults, execute, definition};
	if (n > SCRIPTS_MAX)
		return error_set(error, STATUS_UNSUPPORTED, "more pictures than gnuplot_draw() draws at once");
	snprintf(part, sizeof part, ".stdfit-%ld.tmp", (long)getpid());
	snprintf(definition, sizeof definition, "part='%s'", part);
	for (int i = 0; i < n; i++) {
		snprintf(script[i], NAME_SIZE, "%s.gp", name[i]);
		argument[4 + i] = script[i];
	}
	const int at = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	FILE *said = at < 0 ? NULL : tmpfile();
	enum status status = said ? run(directory, argument, said, cancel, error)
				  : error_set(error, STATUS_IO, "cannot run gnuplot: %s", strerror(errno));
	const bool drawn = status == STATUS_OK;
	for (int i = 0; i < n && said; i++)
		for (int f = 0; f < FORMATS; f++) {
			const enum status settled = settle(at, directory, name[i], formats[f], part, drawn,
							   drawn && status == STATUS_OK ? error : NULL);
			status = status != STATUS_OK ? status : settled;
		}
	if (said)
		fclose(said);
	if (at >= 0)
		close(at);
	return status;
}
