/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/outputs.h"
#include "data_readers/output.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

bool outputs_standard(const char *name)
{
	struct output output;
	/* What is wrong with the name shows when it is opened. */
	if (output_find(&output, name, NULL) != STATUS_OK)
		return false;
	const bool standard = output_is_standard(&output);
	output_close(&output);
	return standard;
}

bool outputs_end_with(const char *name, const char *extension)
{
	const size_t length = strlen(name), n = strlen(extension);
	return length > n && !strcasecmp(name + length - n, extension);
}

/* Commands whose older table becomes FILE~. */
static bool keeps_backup(const struct options *options)
{
	const enum command command = options->command;
	return command == COMMAND_FIT || command == COMMAND_COMPARE || command == COMMAND_MERGE;
}

/* The name of the backup of an output, newly allocated; NULL: there will be none, or we are out of memory. */
static char *backup_of(const char *name)
{
	struct output output;
	if (output_find(&output, name, NULL) != STATUS_OK)
		return NULL;
	char *backup = output.in_order ? NULL : output_backup_name(&output);
	output_close(&output);
	return backup;
}

/* The last path of synth and convert is their output. */
static bool has_output_path(const struct options *options)
{
	return (options->command == COMMAND_SYNTH && options->n_paths == 1) ||
	       (options->command == COMMAND_CONVERT && options->n_paths == 2);
}

static int count_inputs(const struct options *options)
{
	return options->n_paths - has_output_path(options);
}

/* Whether a name of the command line, or one of `path`, is the file `name`. */
static bool is_read(const struct options *options, char *const *path, size_t n, const char *name)
{
	bool read = options->from && files_same(options->from, name);
	read |= options->nodes && files_same(options->nodes, name);
	/* A light has a built-in name or is a file. */
	read |= options->environment && !access(options->environment, F_OK) && files_same(options->environment, name);
	for (int i = 0; i < count_inputs(options) && !read; i++)
		read = files_same(options->path[i], name);
	for (size_t i = 0; i < n && !read; i++)
		read = files_same(path[i], name);
	return read;
}

int outputs_check(const struct options *options, char *const *path, size_t n)
{
	const char *output = options->picture ? options->picture : options->output, *trace = options->trace;
	const bool last = has_output_path(options);
	if (last)
		output = options->path[options->n_paths - 1];
	if (options->to_standard_output || (output && !strcmp(output, "-")))
		output = "/dev/stdout";
	if (output && is_read(options, path, n, output))
		return options_usage(options->command, "%s names a file that is to be read", last ? "OUT" : "--output");
	if (trace && is_read(options, path, n, trace))
		return options_usage(options->command, "--trace names a file that is to be read");
	if (output && trace && files_same(output, trace))
		return options_usage(options->command, "--trace and --output name the same file");
	char *backup = output && keeps_backup(options) ? backup_of(output) : NULL;
	const bool read = backup && is_read(options, path, n, backup),
		   traced = backup && trace && files_same(backup, trace);
	free(backup);
	if (read)
		return options_usage(options->command,
				     "the backup of --output, FILE~, would replace a file that is to be read");
	return traced ? options_usage(options->command, "--trace names the backup of --output, FILE~") : -1;
}

int outputs_check_rows(const struct options *options, const struct csv_table *rows)
{
	int code = -1;
	for (size_t i = 0; i < rows->n_rows && code < 0; i++)
		if (*rows->row[i][RESULT_PATH])
			code = outputs_check(options, &rows->row[i][RESULT_PATH], 1);
	return code;
}
