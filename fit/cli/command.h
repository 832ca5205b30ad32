/* SPDX-License-Identifier: GPL-3.0-or-later */
/* command - the commands of `stdfit`, and its exit codes. */
#ifndef COMMAND_H
#define COMMAND_H

/* Exit codes of the program. */
enum {
	EXIT_DONE = 0,
	EXIT_FAILED = 1, /* some file failed, or an output could not be written */
	EXIT_USAGE = 2,  /* the command line is wrong */
	EXIT_INTERRUPTED = 130,
};

/* The commands in the order of the help: COMMAND_<NAME> and cmd_<name>(). */
#define COMMANDS(X)                                                                                                    \
	X(FIT, fit)                                                                                                    \
	X(COMPARE, compare)                                                                                            \
	X(MERGE, merge)                                                                                                \
	X(BENCH, bench)                                                                                                \
	X(EVAL, eval)                                                                                                  \
	X(INFO, info)                                                                                                  \
	X(CONVERT, convert)                                                                                            \
	X(SYNTH, synth)                                                                                                \
	X(EXPORT, export)                                                                                              \
	X(NDF, ndf)                                                                                                    \
	X(SAMPLE, sample)                                                                                              \
	X(PLOT, plot)                                                                                                  \
	X(RENDER, render)                                                                                              \
	X(REPORT, report)

enum command {
#define COMMAND_NUMBER(NAME, name) COMMAND_##NAME,
	COMMANDS(COMMAND_NUMBER)
#undef COMMAND_NUMBER
		COMMAND_COUNT
};

#endif
