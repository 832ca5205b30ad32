/* SPDX-License-Identifier: GPL-3.0-or-later */
/* outputs - no output of a command takes the place of one of its inputs, nor of another output. */
#ifndef OUTPUTS_H
#define OUTPUTS_H

#include "fit/cli/options.h"
#include "fit/results/result.h"

/* outputs_check - whether the files that --output and --trace name, or the last path of synth and convert, are other
 * files than what is to be read: the paths of the command line, --from, --environment, and the n paths in `path`, which
 * the command has found in directories and tables (none: n = 0). Where the command keeps an older file as FILE~, that
 * must be no input, either. Directories that are outputs: output_directory_spares().
 * Returns -1, or the exit code to end with; what is wrong is then reported. */
MUST_CHECK int outputs_check(const struct options *options, char *const *path, size_t n);

/* outputs_check_rows - the same for the files that the rows of a result table name. */
MUST_CHECK int outputs_check_rows(const struct options *options, const struct csv_table *rows);

/* outputs_standard - whether an output's name stands for standard output: "-", /dev/stdout and the like. */
bool outputs_standard(const char *name);

/* outputs_end_with - whether a name has this extension, in any case of letters, and something before it. */
bool outputs_end_with(const char *name, const char *extension);

#endif
