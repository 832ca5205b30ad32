/* SPDX-License-Identifier: GPL-3.0-or-later */
/* commands - the functions behind the names of command.h. */
#ifndef COMMANDS_H
#define COMMANDS_H

#include "fit/cli/command.h"

#include <stdatomic.h>

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
