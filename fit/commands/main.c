/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit - the program: finds the command, catches signals, ends. */
#include "fit/cli/completion.h"
#include "fit/cli/manual.h"
#include "fit/cli/messages.h"
#include "fit/cli/options.h"
#include "fit/cli/stack.h"
#include "fit/cli/terminal.h"
#include "fit/cli/version.h"
#include "fit/commands/commands.h"

#include <errno.h>
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

/* A signal handler reaches nothing else. */
static atomic_bool cancel;

static void on_signal(int number)
{
	(void)number;
	cancel = true;
}

static void catch_signals(void)
{
	/* The first one stops the work, the second one the program. */
	struct sigaction action = {.sa_handler = on_signal, .sa_flags = (int)(SA_RESETHAND | SA_RESTART)};
	sigemptyset(&action.sa_mask);
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	/* A reader that goes away, and a file that outgrows its limit, show as a failed write. */
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN);
}

/* Without this, a file could get the number of a closed standard stream and take what is meant for that. */
static void occupy_standard_streams(void)
{
	int fd;
	do
		fd = open("/dev/null", O_RDONLY | O_CLOEXEC);
	while (fd >= 0 && fd <= STDERR_FILENO);
	if (fd > STDERR_FILENO)
		close(fd);
}

static int completion(const char *shell)
{
	if (completion_write(stdout, shell))
		return EXIT_DONE;
	report_error("expected --completion bash or --completion zsh");
	return EXIT_USAGE;
}

static int run_command(enum command command, int argc, char **argv)
{
	static int (*const run[COMMAND_COUNT])(int, char **, atomic_bool *) = {
#define COMMAND_ENTRY(NAME, name) [COMMAND_##NAME] = cmd_##name,
		COMMANDS(COMMAND_ENTRY)
#undef COMMAND_ENTRY
	};
	return run[command](argc, argv, &cancel);
}

static bool is_file(const char *name)
{
	return access(name, F_OK) == 0;
}

/* `stdfit help` and `stdfit help COMMAND`. */
static int help(const char *name)
{
	if (!name) {
		options_overview();
		return EXIT_DONE;
	}
	const enum command command = options_find_command(name);
	char word[] = "help", option[] = "--help", *const argv[] = {word, option, NULL};
	return command < COMMAND_COUNT ? run_command(command, 2, (char **)argv) : options_unknown_command(name);
}

/* What the first word asks for beside the commands; -1: nothing. The words without a dash may also be files. */
static int about(const char *first, const char *second)
{
	if (!strcmp(first, "--version") || !strcmp(first, "-V") || (!strcmp(first, "version") && !is_file(first))) {
		version_print();
		return EXIT_DONE;
	}
	if (!strcmp(first, "--help") || !strcmp(first, "-h"))
		return help(NULL);
	if (!strcmp(first, "help") && !is_file(first))
		return help(second);
	if (!strcmp(first, "--man")) {
		manual_write(stdout);
		return EXIT_DONE;
	}
	return strcmp(first, "--completion") ? -1 : completion(second ? second : "");
}

static int dispatch(int argc, char **argv)
{
	if (argc < 2) {
		options_overview();
		return EXIT_USAGE;
	}
	const int code = about(argv[1], argv[2]);
	if (code >= 0)
		return code;
	const enum command command = options_find_command(argv[1]);
	return command < COMMAND_COUNT ? run_command(command, argc - 1, argv + 1)
				       : run_command(COMMAND_FIT, argc, argv);
}

int main(int argc, char **argv)
{
	occupy_standard_streams();
	catch_signals();
	gsl_set_error_handler_off();
	const int unfit = stack_prepare();
	const int code = unfit >= 0 ? unfit : dispatch(argc, argv);
	errno = 0;
	const bool failed = fflush(stdout) || ferror(stdout), gone = failed && terminal_reader_is_gone();
	if ((!fclose(stdout) && !failed) || code == EXIT_INTERRUPTED || code == EXIT_FAILED)
		return code;
	if (gone)
		return EXIT_FAILED;
	report_error("cannot write standard output: %s", errno ? strerror(errno) : "an earlier write failed");
	return EXIT_FAILED;
}
