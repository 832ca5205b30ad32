/* SPDX-License-Identifier: GPL-3.0-or-later */
/* commands - what `stdfit` can do, and how it ends. */
#ifndef COMMANDS_H
#define COMMANDS_H

#include <stdatomic.h>

/* Exit codes of the program. */
enum {
	EXIT_DONE = 0,
	EXIT_FAILED = 1, /* some file failed, or an output could not be written */
	EXIT_USAGE = 2,  /* the command line is wrong */
	EXIT_INTERRUPTED = 130,
};

enum command {
	COMMAND_FIT,
	COMMAND_COMPARE,
	COMMAND_MERGE,
	COMMAND_BENCH,
	COMMAND_EVAL,
	COMMAND_INFO,
	COMMAND_SYNTH,
	COMMAND_EXPORT,
	COMMAND_NDF,
	COMMAND_SAMPLE,
	COMMAND_PLOT,
	COMMAND_RENDER,
	COMMAND_REPORT,
	COMMAND_COUNT
};

/* Each takes argv[0] = its own name and returns the exit code. Setting *cancel stops it at the next occasion. */
int cmd_fit(int argc, char **argv, atomic_bool *cancel);
int cmd_compare(int argc, char **argv, atomic_bool *cancel);
int cmd_merge(int argc, char **argv, atomic_bool *cancel);
int cmd_bench(int argc, char **argv, atomic_bool *cancel);
int cmd_eval(int argc, char **argv, atomic_bool *cancel);
int cmd_info(int argc, char **argv, atomic_bool *cancel);
int cmd_export(int argc, char **argv, atomic_bool *cancel);
int cmd_ndf(int argc, char **argv, atomic_bool *cancel);
int cmd_sample(int argc, char **argv, atomic_bool *cancel);
int cmd_synth(int argc, char **argv, atomic_bool *cancel);
int cmd_plot(int argc, char **argv, atomic_bool *cancel);
int cmd_render(int argc, char **argv, atomic_bool *cancel);
int cmd_report(int argc, char **argv, atomic_bool *cancel);

#endif
