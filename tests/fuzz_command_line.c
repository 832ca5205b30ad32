/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The bytes are arguments, each ended by a zero byte, as in /proc/self/cmdline; the first may name the command. */
#include "fit/cli/options.h"
#include "fuzz.h"

enum { ARGUMENTS_MAX = 64 };

/* Cuts text into arguments; returns how many there are. argv ends with NULL. */
static int cut(char *text, size_t size, char **argv)
{
	int argc = 0;
	for (size_t at = 0; at < size && argc < ARGUMENTS_MAX; at += strlen(text + at) + 1)
		argv[argc++] = text + at;
	argv[argc] = NULL;
	return argc;
}

/* What goes to the column `options` of a result: one line of plain text. */
static void check_text(const struct options *options)
{
	char *text = options_text(options, options->fit.criterion.weight);
	PROMISE(text != NULL);
	for (const char *c = text; *c; c++)
		PROMISE(*c >= ' ' && *c <= '~' && *c != '"');
	free(text);
}

/* Returns what options_model() does. */
static int check_model(const struct options *options)
{
	struct cook_torrance model = {.n = -1};
	struct distribution distribution;
	const int code = options_model(options, &model, &distribution);
	PROMISE(code == -1 || code == EXIT_USAGE || (code == EXIT_FAILED && options->nodes));
	if (code == -1)
		PROMISE(model.n > 0 && model.ks[0] >= 0 && model.kd[2] >= 0 && model.ndf.sigma_x > 0);
	distribution_free(&distribution);
	return code;
}

static int parse(int argc, char **argv)
{
	static char fit[] = "fit";
	char *whole[ARGUMENTS_MAX + 2] = {fit};
	const enum command command = argc > 0 ? options_find_command(argv[0]) : COMMAND_COUNT;
	const bool named = command < COMMAND_COUNT;
	atomic_bool cancel = false;
	struct options options;
	memcpy(whole + !named, argv, ((size_t)argc + 1) * sizeof *argv);
	const int code = options_parse(&options, named ? command : COMMAND_FIT, argc + !named, whole, &cancel);
	if (code >= 0)
		return code;
	PROMISE(options.n_paths >= 0 && options.path[options.n_paths] == NULL);
	check_text(&options);
	return command == COMMAND_EVAL || command == COMMAND_SYNTH ? check_model(&options) : code;
}

int fuzz_command_line(const uint8_t *data, size_t size)
{
	char *argv[ARGUMENTS_MAX + 1];
	char *text = calloc(size + 1, 1);
	if (!text)
		abort();
	memcpy(text, data, size);
	const int argc = cut(text, size, argv);
	struct capture out = capture_begin(stdout), err = capture_begin(stderr);
	const int code = parse(argc, argv);
	capture_end(&err, stderr);
	capture_end(&out, stdout);
	/* EXIT_FAILED: an input that is not there. */
	PROMISE(code == -1 || code == EXIT_DONE || code == EXIT_USAGE || code == EXIT_FAILED);
	PROMISE(code == EXIT_USAGE || code == EXIT_FAILED ? is_message(err.text) : err.size == 0);
	PROMISE((code == EXIT_DONE) == (out.size > 0));
	free(out.text);
	free(err.text);
	free(text);
	return 0;
}
