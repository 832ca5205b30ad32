/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stdfit - the program: finds the command, catches signals, ends. */
#include "fit/cli/completion.h"
#include "fit/cli/manual.h"
#include "fit/cli/messages.h"
#include "fit/cli/options.h"
#include "fit/cli/stack.h"
#include "fit/commands/commands.h"

#include <errno.h>
#include <fcntl.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_version.h>
#include <nlopt.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>
#include <xxhash.h>

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

static void print_version(void)
{
	int major, minor, bugfix;
	nlopt_version(&major, &minor, &bugfix);
	const unsigned xxh = XXH_versionNumber();
	printf("stdfit %s (%s %s; nlopt %d.%d.%d, GSL %s, xxhash %u.%u.%u)\n", STDFIT_VERSION,
#ifdef __clang__
	       "clang", __clang_version__,
#else
	       "gcc", __VERSION__,
#endif
	       major, minor, bugfix, gsl_version, xxh / 10000, xxh / 100 % 100, xxh % 100);
}

static int completion(const char *shell)
{
	if (completion_write(stdout, shell))
		return EXIT_DONE;
	report_error("expected --completion bash or --completion zsh");
	return EXIT_USAGE;
}

static int dispatch(int argc, char **argv)
{
	static int (*const run[COMMAND_COUNT])(int, char **, atomic_bool *) = {
#define COMMAND_ENTRY(NAME, name) [COMMAND_##NAME] = cmd_##name,
		COMMANDS(COMMAND_ENTRY)
#undef COMMAND_ENTRY
	};
	const char *first = argc > 1 ? argv[1] : "";
	if (!strcmp(first, "--version")) {
		print_version();
		return EXIT_DONE;
	}
	if (!strcmp(first, "--man")) {
		manual_write(stdout);
		return EXIT_DONE;
	}
	if (!strcmp(first, "--completion"))
		return completion(argc > 2 ? argv[2] : "");
	if (!strcmp(first, "--help") || !strcmp(first, "-h")) {
		options_overview();
		return EXIT_DONE;
	}
	const enum command command = options_find_command(first);
	return command < COMMAND_COUNT ? run[command](argc - 1, argv + 1, &cancel) : cmd_fit(argc, argv, &cancel);
}

int main(int argc, char **argv)
{
	occupy_standard_streams();
	catch_signals();
	gsl_set_error_handler_off();
	const int unfit = stack_prepare();
	const int code = unfit >= 0 ? unfit : dispatch(argc, argv);
	errno = 0;
	const bool failed = ferror(stdout);
	if ((!fclose(stdout) && !failed) || code == EXIT_INTERRUPTED || code == EXIT_FAILED)
		return code;
	report_error("cannot write standard output: %s", errno ? strerror(errno) : "an earlier write failed");
	return EXIT_FAILED;
}
