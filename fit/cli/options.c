/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/options.h"
#include "data_readers/text_quote.h"
#include "fit/cli/files.h"
#include "fit/cli/messages.h"
#include "fit/cli/nearest.h"
#include "fit/cli/option_value.h"
#include "fit/cli/outputs.h"
#include "fit/cli/report.h"
#include "fit/cli/terminal.h"
#include "fit/cli/text_stream.h"
#include "fit/cli/version.h"
#include "fit/error/objective.h"
#include "fit/results/csv.h"

#include <errno.h>
#include <getopt.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const struct command_text commands[COMMAND_COUNT] = {
	[COMMAND_FIT] = {"fit", "PATH...", "fit measurements",
			 "Fits a Cook-Torrance model with each NDF to each measurement. A directory stands for\n"
			 "every file of a known format in it. A terminal shows a readable table, a pipe gets CSV. With "
			 "-o, rows\n"
			 "are appended as files are done and put in order at the end, so that Ctrl-C or a kill\n"
			 "loses nothing that was done; --resume goes on from there.\n"},
	[COMMAND_COMPARE] = {"compare", "PATH...", "errors of the NDFs side by side, per material and in all",
			     "Fits measurements or directories, or takes one result table (FILE.csv) as it is. Shows\n"
			     "the error of each NDF, the winner, by how much STD's error is lower than GGX's and\n"
			     "Beckmann's (in % of theirs), then mean, median, worst and wins.\n"},
	[COMMAND_MERGE] = {"merge", "CSV... [PATH...]", "join the tables of a batch's shares (fit --shard) into one",
			   "Writes the table that one run over all files would have written. It refuses rows made\n"
			   "with other options or by another version, rows of the same file and NDF that differ (in\n"
			   "more than seconds), files that lack an NDF that others have, and what is no whole table\n"
			   "of stdfit fit. Given the files or directories that were fitted, too, it refuses unless\n"
			   "each file has its rows, and no other: so no share is missing or unfinished. Equal rows\n"
			   "may stand in several tables; the seconds are those of the first. Failed rows stay.\n"},
	[COMMAND_BENCH] =
		{"bench", "FILE", "error against run time, the default search beside others",
		 "Fits one NDF to one measurement, read already, with one algorithm after the other, each alone\n"
		 "on all threads, and shows the error that each had reached after 0.1, 0.3, 1, 3 and 10 s, at\n"
		 "the end of --time, and the shapes it had evaluated. Every error is that of the full table:\n"
		 "shapes that the default search judged by a sample of the table are judged anew afterwards.\n"
		 "Its seconds include that sampling and, for std, the fits of ggx and beckmann inside; where\n"
		 "it ends early its error stays. The figures depend on the machine and on what else it does.\n"
		 "With --forms it fits with each form of Lambda instead, and shows the error, that of the same\n"
		 "parameters with the exact Lambda, and what the search took. integer and half-integer fit\n"
		 "every gamma they have; where a form does not take a fixed --gamma, its row is empty.\n"},
	[COMMAND_EVAL] = {"eval", "FILE", "error of given parameters, no fit",
			  "Measures how far a model is from a measurement, under every weight and metric. The model\n"
			  "comes from options, or from rows of a result table (--from), which also bring their\n"
			  "G, Fresnel term, bins and largest theta.\n"},
	[COMMAND_INFO] = {"info", "PATH...", "what is in a measurement: format, validity, ranges, suspects",
			  "Shows size, hash, valid, negative and non-finite entries, the range of the valid values\n"
			  "above the horizon per channel (1/sr), the directional albedo of the data at 0, 30 and 60\n"
			  "degrees with the share of the hemisphere that is measured, and what looks wrong.\n"},
	[COMMAND_EXPORT] =
		{"export", "[FILE]", "a model for another program: BRDF Explorer, Mitsuba 3, pbrt-v4, MaterialX, ...",
		 "Writes one model: fitted to FILE, from the row of FILE's material in a result table, from\n"
		 "any row of it (--row), or from given parameters (--kd, --ks, ...). The first lines say\n"
		 "whether the export is exact or approximate, and why. Where the target has no such model, one\n"
		 "that it has is fitted in its place, to FILE or the file of the row if that can be read, else\n"
		 "to the model's own table, under --weight, solid-angle by default; the export says what that\n"
		 "costs in error and how it looks. bsdf and bsdf-rgb (spectra, rgb) are for the measured materials\n"
		 "of pbrt-v4 and Mitsuba 3: any model, as a table.\n"},
	[COMMAND_NDF] =
		{"ndf", "[NAME]", "D, P22, P2, Lambda, G1 and pdf of a distribution as a table",
		 "Tabulates a normal distribution function: D and pdf of the normal at theta and phi, P22 of its\n"
		 "slope, P2 of the slope tan(theta) along phi and its moments, Lambda and G1 of the direction there,\n"
		 "the shares of normals below theta and in (0, phi); with --theta-i the density of the normal among\n"
		 "those visible, the weight of such a sample, and the CDFs of its slopes along and across that\n"
		 "direction. NAME is an NDF, or - for rows of standard input: a CSV with the columns ndf,\n"
		 "sigma, sigma_y, gamma, params, lambda, theta, phi, theta_i, phi_i, as far as needed. With --from,\n"
		 "the NDFs of a result table.\n"},
	[COMMAND_SAMPLE] =
		{"sample", "[NAME]", "random normals of a distribution, and where they reflect to",
		 "Draws normals m, visible or all, with their density. With --theta-i also the direction wo into\n"
		 "which each reflects, its density, and its weight: the mean of the weights is the directional\n"
		 "albedo of the lobe without its Fresnel term.\n"},
	[COMMAND_CONVERT] =
		{"convert", "IN OUT", "a measurement as CSV of samples, as a MERL or an RGL file",
		 "Writes a measurement of any format as OUT.csv, samples in linear sRGB or gray with the solid angle\n"
		 "that each stands for, or as OUT.binary, a MERL file: interpolated, -1 where nothing was measured,\n"
		 "with the mean of both orders of wi and wo unless --phi 360; or as OUT.bsdf, an RGL file, which "
		 "pbrt-v4\n"
		 "and Mitsuba 3 read as measured. One line tells what was lost.\n"},
	[COMMAND_SYNTH] =
		{"synth", "OUT", "write a measurement of a model: a MERL file, or a CSV of samples",
		 "Writes the table that an ideal measurement of the model would give; -1 below the horizon. OUT.csv\n"
		 "gets samples instead, wi on a grid and wo by half vectors around the mirror direction: anisotropic\n"
		 "models (--sigma SX,SY) need these.\n"},
	[COMMAND_RENDER] =
		{"render", "[PATH...]", "spheres of measured materials beside those of their models, as PNG",
		 "Renders a sphere of each measured table and of each model of it in the same light, one row a\n"
		 "material, with their differences in false colours if there is one material only. The models\n"
		 "are fitted, taken from a result table (--from, or FILE.csv as the only path: the files it\n"
		 "names), or given (--kd, --ks, ...). A model given so, or by --from FILE.json, may do without\n"
		 "PATH: its sphere stands alone. Reports how different model and table look: rmse of linear values,\n"
		 "delta_e the mean CIEDE2000, ssim the structural similarity; these numbers are all that is\n"
		 "made without -o. With --transmission it takes no PATH, and shows spheres of rough glass.\n"},
	[COMMAND_PLOT] =
		{"plot", "PATH...", "fits, or the course of searches, as plots by gnuplot",
		 "Takes a result table (FILE.csv), or fits measurements or directories. Writes into the directory\n"
		 "of -o the errors of all materials, sorted; and per material D and G1 of each fit against the\n"
		 "NDF read off the data, slices, measured against fitted, and the error over theta_h and\n"
		 "theta_d: each as PNG, SVG, CSV and the script that draws it. Of a trace (see fit --trace) it\n"
		 "draws the error against time.\n"},
	[COMMAND_REPORT] =
		{"report", "PATH...", "fits as one HTML page that needs no other file",
		 "Takes a result table (FILE.csv), or fits measurements or directories. Writes index.html into the\n"
		 "directory of -o: a summary, a table that can be sorted, and per material its spheres (see\n"
		 "stdfit render), plots (see stdfit plot), parameters, their certainty, options and versions.\n"
		 "Of more than 50 materials each has a page of its own, in materials/ beside index.html.\n"},
};

const struct command_text *options_command(enum command command)
{
	return &commands[command];
}

static bool is_recorded(const struct options *options, const struct option_spec *spec)
{
	switch (spec->recorded) {
	case RECORDED:
		return true;
	case RECORDED_WITHIN:
		return !isnan(options->within);
	case RECORDED_GIVEN:
		return options->given[spec - option_specs];
	case RECORDED_ANISOTROPIC:
		return options->fit.anisotropic;
	case RECORDED_ALGORITHM:
		return options->fit.algorithm;
	default:
		return false;
	}
}

struct read_options options_reading(const struct options *options, int threads)
{
	return (struct read_options){.threads = threads, .quantity = options->quantity, .gamut = options->gamut};
}

char *options_text(const struct options *options, enum weight weight)
{
	struct text_stream stream;
	struct options one = *options;
	one.fit.criterion.weight = weight;
	one.n_weights = 0;
	if (!text_stream_open(&stream))
		return NULL;
	const char *between = "";
	for (const struct option_spec *spec = option_specs; spec->name; spec++) {
		if (!is_recorded(options, spec))
			continue;
		fprintf(stream.file, "%s%s=", between, spec->name);
		option_write(stream.file, &one, spec);
		between = " ";
	}
	return text_stream_close(&stream);
}

/* Help */

enum { HELP_WIDTH = 21, HELP_INDENT = HELP_WIDTH + 7 };

/* False when out of memory. */
static bool print_option(const struct options *defaults, const struct option_spec *spec, int width)
{
	char name[64];
	struct text_stream stream;
	snprintf(name, sizeof name, "--%s %s", spec->name, spec->argument ? spec->argument : "");
	const char letter[] = {'-', (char)spec->letter, ',', '\0'};
	if (!text_stream_open(&stream))
		return false;
	option_describe(stream.file, defaults, spec);
	char *text = text_stream_close(&stream);
	if (!text)
		return false;
	const int at = printf("  %3s %-*s ", spec->letter ? letter : "", HELP_WIDTH, name);
	terminal_wrap(stdout, text, at, HELP_INDENT, width);
	printf("\n");
	free(text);
	return true;
}

/* Lines of a help are filled anew, but for those that begin with a blank or are empty. */
static void print_filled(const char *text, int width)
{
	char line[2048];
	size_t n = 0;
	for (; *text; text++) {
		const bool ends = *text == '\n' && (text[1] == '\0' || text[1] == '\n' || text[1] == ' ');
		if (n + 1 < sizeof line)
			line[n++] = *text;
		if (line[n - 1] == '\n')
			line[n - 1] = ' ';
		if (!ends)
			continue;
		line[n - 1] = '\0';
		if (line[0] == ' ')
			fputs(line, stdout);
		else
			terminal_wrap(stdout, line, 0, 0, width);
		fputs("\n", stdout);
		n = 0;
	}
}

static int print_help(const struct options *defaults)
{
	const enum command command = defaults->command;
	const int width = terminal_width(stdout);
	printf("usage: stdfit %s%s%s [OPTION]... %s\n\n", command == COMMAND_FIT ? "[" : "", commands[command].name,
	       command == COMMAND_FIT ? "]" : "", commands[command].arguments);
	print_filled(commands[command].help, width);
	printf("\noptions:\n");
	for (const struct option_spec *spec = option_specs; spec->name; spec++)
		if (option_applies(spec, command) && !print_option(defaults, spec, width)) {
			report_error("out of memory");
			return EXIT_FAILED;
		}
	printf("  -h, %-*s this text\n", HELP_WIDTH, "--help");
	printf("  -V, %-*s the version of the program and its libraries\n", HELP_WIDTH, "--version");
	printf("\nexit code: 0 done, 1 some file failed, 2 wrong usage, 130 interrupted\n");
	return EXIT_DONE;
}

void options_overview(void)
{
	const int width = terminal_width(stdout);
	terminal_wrap(stdout, "stdfit fits Cook-Torrance models with STD, GGX and Beckmann NDFs to measured BRDFs.", 0,
		      0, width);
	printf("\n\n");
	for (enum command c = 0; c < COMMAND_COUNT; c++) {
		enum { SUMMARY = 35 };
		const int at = printf("  stdfit %-7s %-16s  ", c == COMMAND_FIT ? "[fit]" : commands[c].name,
				      commands[c].arguments);
		terminal_wrap(stdout, commands[c].summary, at, SUMMARY, width);
		printf("\n");
	}
	printf("\n");
	terminal_wrap(stdout,
		      "`stdfit COMMAND --help` tells its options, `stdfit --version` the versions of the program and "
		      "its libraries. `stdfit --man` writes the manual page, `stdfit --completion bash` and `zsh` what "
		      "these shells need to complete command lines.",
		      0, 0, width);
	printf("\n");
}

enum command options_find_command(const char *name)
{
	enum command c = 0;
	while (c < COMMAND_COUNT && strcmp(commands[c].name, name))
		c++;
	return c;
}

/* The command line */

int options_usage(enum command command, const char *format, ...)
{
	struct error text;
	va_list list;
	va_start(list, format);
	vsnprintf(text.text, sizeof text.text, format, list);
	va_end(list);
	report_error("%s (see stdfit %s --help)", text.text, commands[command].name);
	return EXIT_USAGE;
}

/* Whether what a command makes is to be looked at. Then its own fits have the weight that pictures agree with best. */
static bool makes_pictures(enum command command)
{
	return command == COMMAND_RENDER || command == COMMAND_PLOT || command == COMMAND_REPORT ||
	       command == COMMAND_EXPORT;
}

void options_say_weight(const struct options *options)
{
	if (makes_pictures(options->command) && !options->quiet && !options_given(options, "weight"))
		report_error(
			"fitted under --weight %s, with which pictures agree best; --weight none is the paper's error",
			weight_name(options->fit.criterion.weight));
}

struct options options_default(enum command command)
{
	struct options options = {
		.fit = fit_options_default(),
		.command = command,
		.within = NAN,
		.intervals = NAN,
		.n_phi_d = 180,
		.theta_i = NAN,
		.count = 1000,
		.ks = {0, 0, 0},
		.kd = {0, 0, 0},
		.f82 = {{0, 0, 0}, {0, 0, 0}, {1, 1, 1}},
		.sigma2 = NAN,
		.gamma2 = NAN,
		.environment = "studio",
		.size = 256,
		.accuracy = 0.2,
		.file_size = 32e6,
		.pixel_samples = 64,
	};
	if (command == COMMAND_EVAL || command == COMMAND_SYNTH) {
		options.fit.n_ndf = 1;
		options.fit.ior = 1.5;
	}
	if (command == COMMAND_REPORT) /* a page may hold a hundred of them */
		options.pixel_samples = 16;
	if (command == COMMAND_BENCH || command == COMMAND_EXPORT)
		options.fit.n_ndf = 1;
	if (makes_pictures(command))
		options.fit.criterion.weight = WEIGHT_SOLID_ANGLE;
	return options;
}

enum { LONG_OPTION = 256 }; /* what getopt_long returns for row i of the table is this + i */

/* Fills getopt_long's own table and short letters; see options_parse for their room. */
static void fill_getopt(enum command command, struct option *longs, char *letters)
{
	*letters++ = ':'; /* tell a missing argument from an unknown option */
	*letters++ = 'h';
	*letters++ = 'V';
	*longs++ = (struct option){"help", no_argument, NULL, 'h'};
	*longs++ = (struct option){"version", no_argument, NULL, 'V'};
	for (int i = 0; option_specs[i].name; i++) {
		if (!option_applies(&option_specs[i], command))
			continue;
		const int argument = option_specs[i].argument ? required_argument : no_argument;
		*longs++ = (struct option){option_specs[i].name, argument, NULL, LONG_OPTION + i};
		if (option_specs[i].letter) {
			*letters++ = (char)option_specs[i].letter;
			if (argument == required_argument)
				*letters++ = ':';
		}
	}
	*longs = (struct option){0};
	*letters = '\0';
}

static int spec_of_letter(enum command command, int letter)
{
	int i = 0;
	while (option_specs[i].letter != letter || !option_applies(&option_specs[i], command))
		i++;
	return i;
}

static int take_option(struct options *options, int i, const char *text)
{
	struct error error;
	/* The earlier value would be ignored; a switch says the same again. */
	if (options->given[i] && option_specs[i].argument)
		return options_usage(options->command, "--%s stands there twice", option_specs[i].name);
	options->given[i] = true;
	if (option_parse(options, &option_specs[i], text, &error) == STATUS_OK)
		return -1;
	char shown[TEXT_QUOTE_SIZE];
	text_quote(text, shown, sizeof shown);
	return options_usage(options->command, "bad value '%s' for --%s: %s%s", shown, option_specs[i].name, error.text,
			     option_comma_hint(text));
}

/* Names of the long options of *data, a command, in the order of its table, then "help" and "version". */
static const char *option_name_at(const void *data, int i)
{
	const enum command *command = data;
	for (const struct option_spec *spec = option_specs; spec->name; spec++)
		if (option_applies(spec, *command) && i-- == 0)
			return spec->name;
	return i == 0 ? "help" : i == 1 ? "version" : NULL;
}

/* "--n: --ndf, --no-diffuse" of the options that begin so, or of one that is like it; empty where there is neither. */
static void hint_of(enum command command, const char *typed, char *hint, size_t size, int *n_beginning)
{
	const size_t length = strcspn(typed, "=");
	char name[64];
	*n_beginning = 0;
	hint[0] = '\0';
	for (int i = 0; option_name_at(&command, i); i++)
		if (strncmp(option_name_at(&command, i), typed, length) == 0) {
			const size_t used = strlen(hint);
			snprintf(hint + used, size - used, "%s--%s", *n_beginning ? ", " : "",
				 option_name_at(&command, i));
			++*n_beginning;
		}
	if (*n_beginning > 1 || length >= sizeof name)
		return;
	memcpy(name, typed, length);
	name[length] = '\0';
	const int near = nearest_word(name, option_name_at, &command);
	if (near >= 0)
		snprintf(hint, size, ": did you mean --%s?", option_name_at(&command, near));
}

static int bad_option(enum command command, int code, char **argv)
{
	/* getopt_long leaves the letter of a short option. --help=x, of the long ones, has a letter too. */
	const bool takes_none = optopt >= LONG_OPTION || (code == '?' && (optopt == 'h' || optopt == 'V'));
	const bool is_short = optopt != 0 && optopt < LONG_OPTION && !takes_none;
	const char letter[] = {'-', (char)optopt, '\0'};
	char shown[TEXT_QUOTE_SIZE], hint[256] = "";
	int n_beginning = 0;
	text_quote(is_short ? letter : argv[optind - 1], shown, sizeof shown);
	if (code == ':' || takes_none)
		return options_usage(command, "%s '%s'",
				     code == ':' ? "expected an argument behind" : "expected no argument in", shown);
	if (!is_short)
		hint_of(command, argv[optind - 1] + 2, hint, sizeof hint, &n_beginning);
	if (n_beginning > 1)
		return options_usage(command, "ambiguous option '%s': %s", shown, hint);
	return options_usage(command, "unknown option '%s'%s", shown, hint);
}

static const char *command_name_at(const void *data, int i)
{
	(void)data;
	return i < COMMAND_COUNT ? commands[i].name : NULL;
}

int options_unknown_command(const char *typed)
{
	const int near = nearest_word(typed, command_name_at, NULL);
	char shown[TEXT_QUOTE_SIZE];
	text_quote(typed, shown, sizeof shown);
	if (near >= 0)
		report_error("there is no command or file '%s': did you mean stdfit %s?", shown, commands[near].name);
	else
		report_error("there is no command or file '%s' (see stdfit --help)", shown);
	return EXIT_USAGE;
}

/* Which of the words behind a command name files that are read. */
static bool is_input(enum command command, int i, const char *word)
{
	/* merge has tables first, and says more of what is missing; export may take no more than a name. */
	if (command == COMMAND_NDF || command == COMMAND_SAMPLE || command == COMMAND_SYNTH ||
	    command == COMMAND_MERGE || command == COMMAND_EXPORT)
		return false;
	return !(command == COMMAND_CONVERT && i > 0) && strcmp(word, "-") != 0;
}

/* Whether the file system's answer about an input refuses it before anything is done. Of a file that is there but cannot be
 * looked at, there are rows that say so; but shares of a list that another host sees as directories would not be the same. */
static bool is_refused(const struct options *options, int error)
{
	return error == ENOENT || error == ENOTDIR || error == ELOOP || options->shard.n > 0;
}

/* A file that was typed and is not there, or only as a link that leads nowhere. -1: all are. */
static int check_inputs(const struct options *options)
{
	const enum command command = options->command;
	for (int i = 0; i < options->n_paths; i++) {
		const char *path = options->path[i];
		struct stat info;
		if (!is_input(command, i, path) || stat(path, &info) == 0 || !is_refused(options, errno))
			continue;
		char shown[TEXT_QUOTE_SIZE];
		const int error = errno;
		text_quote(path, shown, sizeof shown);
		if (command == COMMAND_FIT && options_find_command(path) < COMMAND_COUNT)
			return options_usage(command, "there is no file '%s', and a command comes first: stdfit %s ...",
					     shown, shown);
		if (command == COMMAND_FIT && i == 0 && !strpbrk(path, "./") &&
		    nearest_word(path, command_name_at, NULL) >= 0)
			return options_unknown_command(path);
		report_error("cannot read '%s': %s", shown, strerror(error));
		return EXIT_FAILED;
	}
	return -1;
}

static bool any_has_gamma(const struct fit_options *fit)
{
	for (int i = 0; i < fit->n_ndf; i++)
		if (ndf_has_gamma(fit->ndf[i]))
			return true;
	return false;
}

static bool has_tabulated(const struct fit_options *fit)
{
	for (int i = 0; i < fit->n_ndf; i++)
		if (ndf_is_tabulated(fit->ndf[i]))
			return true;
	return false;
}

/* Whether some NDF takes another form of Lambda than the exact one. */
static bool any_has_lambda_forms(const struct fit_options *fit)
{
	for (int i = 0; i < fit->n_ndf; i++)
		if (ndf_is_student_t(fit->ndf[i]))
			return true;
	return false;
}

static int check_lambda(const struct options *options)
{
	const struct fit_options *fit = &options->fit;
	if (fit->lambda == LAMBDA_EXACT)
		return -1;
	if (!any_has_lambda_forms(fit))
		return options_usage(options->command, "--lambda means nothing for these NDFs");
	if (fit->criterion.gaf == GAF_V_GROOVE)
		return options_usage(options->command,
				     "--lambda means nothing with --gaf v-groove, which has no Lambda");
	return -1;
}

/* Only a conductor's n may be below 1. */
static int low_index(const struct options *options)
{
	return options_usage(options->command,
			     "invalid value for --ior: below %g it needs --fresnel conductor, found %g", FIT_IOR_MIN,
			     options->fit.ior);
}

/* Options of the specular term that it does not have, or where there is none. */
static int check_specular(const struct options *options)
{
	const struct fit_options *fit = &options->fit;
	static const char *const of_lobe[] = {"sigma",   "gamma",  "ior",    "gaf",
					      "fresnel", "lambda", "starts", "intervals"};
	for (size_t i = 0; i < sizeof of_lobe / sizeof *of_lobe; i++)
		if (!fit->specular && options_given(options, of_lobe[i]))
			return options_usage(options->command, "--%s means nothing with --no-specular", of_lobe[i]);
	if (!fresnel_has_ior(fit->fresnel) && options_given(options, "ior"))
		return options_usage(options->command, "--ior means nothing with --fresnel %s",
				     fresnel_name(fit->fresnel));
	if (fit->ior < fit_ior_min(fit->fresnel))
		return low_index(options);
	if (options_index_per_channel(options))
		return options_usage(options->command, "--ior R,G,B gives a model, a fit takes one number");
	if (fit->per_channel_ior && fit->fresnel != FRESNEL_CONDUCTOR)
		return options_usage(options->command, "--per-channel-ior needs --fresnel conductor");
	if (options_given(options, "gamma") && !any_has_gamma(fit))
		return options_usage(options->command, "--gamma means nothing for these NDFs");
	return check_lambda(options);
}

/* Combinations in which some option would be ignored, or nothing could come out. */
int options_check_fit(const struct options *options)
{
	const struct fit_options *fit = &options->fit;
	struct error why = {""};
	const enum fit_rule broken = fit_options_rule(fit, &why);
	if (broken == FIT_RULE_TERMS)
		return options_usage(options->command, "--no-diffuse and --no-specular leave nothing to fit");
	const int code = check_specular(options);
	if (code >= 0)
		return code;
	if (!fit->anisotropic && (!isnan(fit->sigma_y) || !isnan(fit->angle)))
		return options_usage(options->command, "--%s needs --anisotropic",
				     isnan(fit->angle) ? "sigma SX,SY" : "angle");
	if (fit->anisotropic && !isnan(fit->sigma) && isnan(fit->sigma_y))
		return options_usage(options->command, "--sigma with --anisotropic takes SX,SY");
	if (!fit->grazing && options_given(options, "exponent"))
		return options_usage(options->command, "--exponent means nothing without --diffuse burley");
	if (broken == FIT_RULE_TABULATED ||
	    (has_tabulated(fit) &&
	     (options->command == COMMAND_BENCH || options_given(options, "trace") || !isnan(options->within))))
		return options_usage(options->command,
				     "--ndf pl goes with neither --no-specular, --algorithm, --trace, "
				     "--within nor bench");
	if (broken == FIT_RULE_GAMMA)
		return options_usage(options->command, "invalid value for --gamma: %s", why.text);
	if (broken != FIT_RULE_KEPT)
		return options_usage(options->command, "%s", why.text);
	if (options->command == COMMAND_FIT && !fit->algorithm && options_given(options, "time"))
		return options_usage(options->command, "--time means nothing without another --algorithm than default");
	if (fit->algorithm && options_given(options, "starts"))
		return options_usage(options->command, "--starts means nothing with another --algorithm than default");
	if (options->command != COMMAND_BENCH && options_given(options, "seed") && !fit->starts && !fit->algorithm)
		return options_usage(options->command, "--seed means nothing without --starts");
	if (options->trace && options->n_weights > 1)
		return options_usage(options->command, "--trace takes one --weight");
	if (options->trace && !isnan(options->within))
		return options_usage(options->command, "--trace and --within exclude each other");
	if (options->resume && !options->output)
		return options_usage(options->command, "--resume needs -o FILE");
	if (options->resume && options->json)
		return options_usage(options->command, "--resume needs a CSV, not --json");
	if (options->readable && options->json && !options->output)
		return options_usage(options->command, "--table and --json exclude each other without -o");
	return -1;
}

/* -o - and -o /dev/stdout of a command that writes to standard output anyway: as without -o, but CSV on a terminal, too. */
static int find_standard_output(struct options *options)
{
	const enum command command = options->command;
	const bool standard = options->output && outputs_standard(options->output);
	if (options->trace && outputs_standard(options->trace) && (standard || !options->output))
		return options_usage(command, "--trace on standard output needs -o FILE");
	if (!standard)
		return -1;
	if (command == COMMAND_PLOT || command == COMMAND_REPORT)
		return options_usage(command, "expected -o DIR, a directory: there are several files to write");
	if (options->resume)
		return options_usage(command, "--resume needs -o FILE, not standard output");
	options->to_standard_output = true;
	if (command != COMMAND_EXPORT || !export_is_binary(options->format))
		options->output = NULL;
	return -1;
}

int options_parse(struct options *options, enum command command, int argc, char **argv, atomic_bool *cancel)
{
	struct option longs[OPTIONS_MAX + 3];
	char letters[2 * OPTIONS_MAX + 4];
	fill_getopt(command, longs, letters);
	*options = options_default(command);
	opterr = 0;
	optind = 0;
	for (int code; (code = getopt_long(argc, argv, letters, longs, NULL)) != -1;) {
		if (code == 'h') {
			const struct options defaults = options_default(command);
			return print_help(&defaults);
		}
		if (code == 'V') {
			version_print();
			return EXIT_DONE;
		}
		if (code == '?' || code == ':')
			return bad_option(command, code, argv);
		const int i = code >= LONG_OPTION ? code - LONG_OPTION : spec_of_letter(command, code);
		const int end = take_option(options, i, optarg ? optarg : "");
		if (end >= 0)
			return end;
	}
	options->path = argv + optind;
	options->n_paths = argc - optind;
	options->cancel = cancel;
	options->fit.cancel = cancel;
	if (!options->n_paths && commands[command].arguments[0] != '[' && !options->transmission)
		return options_usage(command, "expected %s, found nothing", commands[command].arguments);
	const bool fits = command == COMMAND_FIT || command == COMMAND_COMPARE || command == COMMAND_BENCH;
	int wrong = find_standard_output(options);
	if (wrong < 0 && fits)
		wrong = options_check_fit(options);
	if (wrong < 0)
		wrong = check_inputs(options);
	return wrong >= 0 ? wrong : outputs_check(options, NULL, 0);
}

bool options_given(const struct options *options, const char *name)
{
	for (int i = 0; option_specs[i].name; i++)
		if (options->given[i] && !strcmp(option_specs[i].name, name))
			return true;
	return false;
}

const char *options_given_beside(const struct options *options, const char *const *expected)
{
	for (int i = 0; option_specs[i].name; i++) {
		const char *const *at = expected;
		while (*at && strcmp(*at, option_specs[i].name))
			at++;
		if (!*at && options->given[i])
			return option_specs[i].name;
	}
	return NULL;
}

/* The options of richer models: which of them need which others. */
static int check_terms(const struct options *options)
{
	static const struct {
		const char *name, *needs;
	} pair[] = {{"exponent", "kg"}, {"sigma2", "ks2"}, {"gamma2", "ks2"}, {"ks2", "sigma2"}};
	static const char *const reflectance[F82_PARTS] = {"f0", "f82", "f90"};
	const enum command command = options->command;
	const bool f82 = options->fit.fresnel == FRESNEL_F82;
	for (size_t i = 0; i < sizeof pair / sizeof *pair; i++)
		if (options_given(options, pair[i].name) && !options_given(options, pair[i].needs))
			return options_usage(command, "--%s needs --%s", pair[i].name, pair[i].needs);
	for (int i = 0; i < F82_PARTS; i++)
		if (!f82 && options_given(options, reflectance[i]))
			return options_usage(command, "--%s means nothing without --fresnel f82", reflectance[i]);
	if (f82 && !(options_given(options, "f0") && options_given(options, "f82")))
		return options_usage(command, "--fresnel f82 needs --f0 and --f82");
	if (options_given(options, "ks2") && ndf_has_gamma(options->fit.ndf[0]) != options_given(options, "gamma2"))
		return options_usage(command, "--ndf %s %s", ndf_name(options->fit.ndf[0]),
				     ndf_has_gamma(options->fit.ndf[0]) ? "needs --gamma2" : "has no --gamma2");
	return -1;
}

bool options_index_per_channel(const struct options *options)
{
	return options_given(options, "ior") && isnan(options->fit.ior);
}

/* An option for a term that the model does not have. */
static int check_model(const struct options *options)
{
	static const char *const specular[] = {"sigma", "angle",  "gamma",   "ior",    "k",     "ndf",
					       "gaf",   "lambda", "fresnel", "params", "nodes", "f0",
					       "f82",   "f90",    "ks2",     "sigma2", "gamma2"};
	const enum command command = options->command;
	const struct ndf_class *ndf = options->fit.ndf[0];
	if (options->fit.n_ndf != 1)
		return options_usage(command, "--ndf takes one name here");
	if (!options_given(options, "kd") && !options_given(options, "ks"))
		return options_usage(command, "expected --kd or --ks, or both");
	for (size_t i = 0; i < sizeof specular / sizeof *specular; i++)
		if (!options_given(options, "ks") && options_given(options, specular[i]))
			return options_usage(command, "--%s means nothing without --ks", specular[i]);
	const bool described = options_given(options, "params") || options_given(options, "nodes");
	const bool plain = options_given(options, "ks") && !described && !ndf_is_tabulated(ndf);
	for (size_t i = 0; i < 2 && ndf_is_tabulated(ndf); i++)
		if (options_given(options, i ? "gamma" : "sigma"))
			return options_usage(command, "--%s means nothing for %s", i ? "gamma" : "sigma",
					     ndf_name(ndf));
	if (plain && !options_given(options, "sigma"))
		return options_usage(command, "--ks needs --sigma");
	if (plain && ndf_has_gamma(ndf) != options_given(options, "gamma"))
		return options_usage(command, "--ndf %s %s", ndf_name(ndf),
				     ndf_has_gamma(ndf) ? "needs --gamma" : "has no --gamma");
	if (!fresnel_has_ior(options->fit.fresnel) && options_given(options, "ior"))
		return options_usage(command, "--ior means nothing with --fresnel %s",
				     fresnel_name(options->fit.fresnel));
	if (options->fit.ior < fit_ior_min(options->fit.fresnel))
		return low_index(options);
	if (options->fit.fresnel != FRESNEL_CONDUCTOR && options_index_per_channel(options))
		return options_usage(command, "--ior R,G,B needs --fresnel conductor");
	if (isnan(options->fit.sigma_y) && !described && options_given(options, "angle"))
		return options_usage(command, "--angle needs --sigma SX,SY");
	if (options->fit.fresnel != FRESNEL_CONDUCTOR && options_given(options, "k"))
		return options_usage(command, "--k means nothing without --fresnel conductor");
	const int code = check_lambda(options);
	return code >= 0 ? code : check_terms(options);
}

/* The NDF of the model. */
static enum status make_ndf(const struct options *options, struct distribution *distribution, struct error *error)
{
	const struct fit_options *fit = &options->fit;
	char sigma[CSV_NUMBER_SIZE], sigma_y[CSV_NUMBER_SIZE], angle[CSV_NUMBER_SIZE], gamma[CSV_NUMBER_SIZE];
	const bool specular = options_given(options, "ks");
	const struct distribution_words words = {
		.name = ndf_name(fit->ndf[0]),
		.sigma = specular ? csv_number(sigma, fit->sigma) : "1",
		.sigma_y = specular ? csv_number(sigma_y, fit->sigma_y) : "",
		.angle = csv_number(angle, fit->angle),
		.gamma = specular ? csv_number(gamma, fit->gamma) : "2",
		.params = options->params,
		.nodes = options->nodes,
	};
	enum status status = distribution_make(&words, distribution, error);
	if (status != STATUS_OK)
		return status;
	if (fit->lambda != LAMBDA_EXACT)
		status = ndf_set_lambda_form(&distribution->ndf, fit->lambda);
	if (status == STATUS_OK || status == STATUS_UNSUPPORTED)
		return STATUS_OK;
	distribution_free(distribution);
	return error_set(error, status, "--ndf %s does not allow these parameters", words.name);
}

static int make_second(const struct options *options, struct ndf *second)
{
	const struct ndf_class *class = options->fit.ndf[0];
	const struct shape shape = {.sigma = options->sigma2, .gamma = isnan(options->gamma2) ? 2 : options->gamma2};
	if (!options_given(options, "ks2") || shape_ndf(&shape, class, options->fit.lambda, second) == STATUS_OK)
		return -1;
	return options_usage(options->command, "--ndf %s does not allow these parameters", ndf_name(class));
}

int options_model(const struct options *options, struct cook_torrance *model, struct distribution *distribution)
{
	const struct fit_options *fit = &options->fit;
	struct error why;
	const int wrong = check_model(options);
	*distribution = (struct distribution){0};
	if (wrong >= 0)
		return wrong;
	*model = (struct cook_torrance){.gaf = fit->criterion.gaf,
					.fresnel = fit->fresnel,
					.n = isnan(fit->ior) ? 1.5 : fit->ior,
					.k = options->k[0]};
	model->per_channel_ior =
		options_index_per_channel(options) || options->k[1] != options->k[0] || options->k[2] != options->k[0];
	for (int c = 0; c < MERL_CHANNELS && model->per_channel_ior; c++) {
		model->channel_n[c] = isnan(fit->ior) && options_given(options, "ior") ? options->ior[c] : model->n;
		model->channel_k[c] = options->k[c];
	}
	memcpy(model->kd, options->kd, sizeof model->kd);
	memcpy(model->ks, options->ks, sizeof model->ks);
	for (int c = 0; c < MERL_CHANNELS; c++)
		for (int i = 0; i < F82_PARTS; i++)
			model->reflectance[c][i] = options->f82[i][c];
	memcpy(model->kg, options->kg, sizeof model->kg);
	model->grazing = isnan(fit->grazing_exponent) ? 5 : fit->grazing_exponent;
	memcpy(model->ks_second, options->ks2, sizeof model->ks_second);
	const enum status status = make_ndf(options, distribution, &why);
	if (status == STATUS_DOMAIN)
		return options_usage(options->command, "%s", why.text);
	if (status != STATUS_OK) {
		report_error("%s", why.text);
		return EXIT_FAILED;
	}
	model->ndf = distribution->ndf;
	const int bad_second = make_second(options, &model->second);
	if (bad_second >= 0)
		distribution_free(distribution);
	return bad_second;
}

enum show options_show(const struct options *options)
{
	if (options->json && !options->output)
		return SHOW_JSON;
	if (options->readable || (isatty(STDOUT_FILENO) && !options->to_standard_output))
		return SHOW_READABLE;
	return options->output ? SHOW_NOTHING : SHOW_CSV;
}

int options_end(const struct options *options, enum status status, const struct error *error, struct csv_table *table,
		report_readable *readable)
{
	if (status == STATUS_OK)
		report_output(table, options_show(options), readable);
	else if (status != STATUS_INTERRUPTED)
		report_error("%s", error->text);
	csv_table_free(table);
	if (*options->cancel)
		return EXIT_INTERRUPTED;
	return status != STATUS_OK ? EXIT_FAILED : EXIT_DONE;
}
