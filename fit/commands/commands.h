/* SPDX-License-Identifier: GPL-3.0-or-later */
/* commands - the functions behind the names of command.h. */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "fit/cli/command.h"

#include <stdatomic.h>

/* Each takes argv[0] = its own name and returns the exit code. Setting *cancel stops it at the next occasion. */
#define COMMAND_FUNCTION(NAME, name) int cmd_##name(int argc, char **argv, atomic_bool *cancel);
COMMANDS(COMMAND_FUNCTION)
#undef COMMAND_FUNCTION

#endif
