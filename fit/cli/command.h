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

#endif
