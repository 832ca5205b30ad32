/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/manual.h"
#include "fit/cli/option_value.h"
#include "fit/cli/text_stream.h"

#include <stdlib.h>

/* The date of the text below. A page needs one; the day of the build would make every build differ. */
#define MANUAL_DATE "2026-11-22"

static void write_character(FILE *file, char c)
{
	switch (c) {
	case '\\':
		fputs("\\e", file);
		break;
	case '-':
		fputs("\\-", file);
		break;
	case '~':
		fputs("\\(ti", file);
		break;
	case '^':
		fputs("\\(ha", file);
		break;
	case '`':
		fputs("\\(ga", file);
		break;
	case '\'':
		fputs("\\(aq", file);
		break;
	default:
		fputc(c, file);
	}
}

/* Text with all that roff would interpret escaped. Lines are filled, except those that begin with a space; an empty line
 * ends a paragraph. The lines of the output are kept short. */
static void write_text(FILE *file, const char *text)
{
	enum { FOLD = 55 };
	int column = 0;
	bool fixed = false;
	for (; *text; text++) {
		if (!column)
			fixed = *text == ' ';
		if (!column && *text == '\n') {
			fputs(".PP\n", file);
		} else if (*text == '\n' || (*text == ' ' && column >= FOLD && !fixed)) {
			fputc('\n', file);
			column = 0;
		} else {
			if (!column && *text == '.')
				fputs("\\&", file);
			write_character(file, *text);
			column++;
		}
	}
}

static void write_in(FILE *file, char font, const char *text)
{
	fprintf(file, "\\f%c", font);
	write_text(file, text);
	fputs("\\fR", file);
}

static void write_usage(FILE *file, enum command c)
{
	const struct command_text *command = options_command(c);
	write_in(file, 'B', "stdfit");
	fputs(c == COMMAND_FIT ? " [" : " ", file);
	write_in(file, 'B', command->name);
	fputs(c == COMMAND_FIT ? "] [" : " [", file);
	write_in(file, 'I', "OPTION");
	fputs("]... ", file);
	write_in(file, 'I', command->arguments);
}

static void write_option(FILE *file, const struct options *defaults, const struct option_spec *spec)
{
	struct text_stream stream;
	fputs(".TP\n", file);
	if (spec->letter) {
		const char letter[] = {'-', (char)spec->letter, '\0'};
		write_in(file, 'B', letter);
		fputs(", ", file);
	}
	fputs("\\fB\\-\\-", file);
	write_text(file, spec->name);
	fputs("\\fR", file);
	if (spec->argument) {
		fputc(' ', file);
		write_in(file, 'I', spec->argument);
	}
	fputc('\n', file);
	if (text_stream_open(&stream)) {
		option_describe(stream.file, defaults, spec);
		char *text = text_stream_close(&stream);
		if (text)
			write_text(file, text);
		free(text);
	}
	fputs(".\n", file);
}

static void write_command(FILE *file, enum command c)
{
	struct options defaults = options_default(c);
	defaults.fit.threads = 0; /* all processors, however many there are here */
	fputs(".SS ", file);
	write_text(file, options_command(c)->name);
	fputc('\n', file);
	write_usage(file, c);
	fputs("\n.PP\n", file);
	write_text(file, options_command(c)->help);
	for (const struct option_spec *spec = option_specs; spec->name; spec++)
		if (option_applies(spec, c))
			write_option(file, &defaults, spec);
	fputs(".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nThe options, with the defaults of this build.\n"
	      ".TP\n\\fB\\-V\\fR, \\fB\\-\\-version\\fR\nAs \\fBstdfit \\-\\-version\\fR.\n",
	      file);
}

static const char description[] =
	"Turns a measured BRDF into a few physical numbers: reads MERL tables, 90 x 90 x 180 or 90 x 90 x 360 entries, "
	"and finds the Cook-Torrance model that comes closest to each: diffuse and specular colour, roughness, index "
	"of "
	"refraction and, for some distributions, the shape of the tail.\n"
	"\n"
	"A first word that is no command is a file to fit. Results go to standard output, words to standard error. On "
	"a "
	"terminal results are shown as a readable table, else as CSV: one row per material and distribution, numbers "
	"so "
	"that they read back exactly.\n";

static const char general[] =
	".TP\n\\fBstdfit \\-\\-help\\fR\nThe commands.\n"
	".TP\n\\fBstdfit \\-\\-version\\fR\nThe versions of the program, the compiler and the libraries.\n"
	".TP\n\\fBstdfit \\-\\-man\\fR\nThis page.\n"
	".TP\n\\fBstdfit \\-\\-completion\\fR \\fIbash\\fR|\\fIzsh\\fR\n"
	"What that shell needs to complete command lines.\n";

static const char rest[] =
	".SH FILES\n"
	".TP\n\\fIFILE\\fR\\(ti\n"
	"What stood in an output before it was replaced.\n"
	".TP\n\\&.stdfit\\-*.tmp\n"
	"An output under way; of a program that was killed. May be deleted.\n"
	".SH EXIT STATUS\n"
	".TP\n0\ndone\n"
	".TP\n1\nsome file failed, or an output could not be written\n"
	".TP\n2\nthe command line is wrong\n"
	".TP\n130\ninterrupted; with \\fB\\-o\\fR what was done is kept, and \\fB\\-\\-resume\\fR goes on\n"
	".SH EXAMPLES\n"
	".TP\nFit one material, readably\n\\fBstdfit merl/nickel.binary \\-\\-table\\fR\n"
	".TP\nFit a directory into a table; after Ctrl\\-C, the same with \\-\\-resume goes on\n"
	"\\fBstdfit merl \\-o fits.csv\\fR\n"
	".TP\nWhich distribution is the best, and by how much\n\\fBstdfit compare fits.csv\\fR\n"
	".TP\nThe same directory on two machines\n"
	"\\fBstdfit merl \\-\\-shard 1/2 \\-o part\\-1.csv\\fR\n.br\n"
	"\\fBstdfit merl \\-\\-shard 2/2 \\-o part\\-2.csv\\fR\n.br\n"
	"\\fBstdfit merge part\\-1.csv part\\-2.csv merl \\-o fits.csv\\fR\n";

void manual_write(FILE *file)
{
	fputs(".TH STDFIT 1 " MANUAL_DATE " \"stdfit " STDFIT_VERSION "\" \"User Commands\"\n"
	      ".SH NAME\nstdfit \\- fit Cook\\-Torrance models to measured BRDFs\n.SH SYNOPSIS\n",
	      file);
	for (enum command c = 0; c < COMMAND_COUNT; c++) {
		fputs(c ? ".br\n" : "", file);
		write_usage(file, c);
		fputc('\n', file);
	}
	fputs(".SH DESCRIPTION\n", file);
	write_text(file, description);
	fputs(general, file);
	fputs(".SH COMMANDS\n", file);
	for (enum command c = 0; c < COMMAND_COUNT; c++)
		write_command(file, c);
	fputs(rest, file);
}
