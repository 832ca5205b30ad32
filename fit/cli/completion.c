/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/cli/completion.h"
#include "fit/cli/option_value.h"

#include <string.h>

/* What can follow an option. */
enum value { VALUE_NONE, VALUE_CHOICE, VALUE_LIST, VALUE_FILE, VALUE_OTHER, VALUE_COUNT };

static enum value value_of(const struct option_spec *spec)
{
	if (!spec->argument)
		return VALUE_NONE;
	if (option_choice(spec->kind, 0))
		return spec->kind == KIND_NDFS || spec->kind == KIND_ALGORITHMS ? VALUE_LIST : VALUE_CHOICE;
	return spec->kind == KIND_TEXT ? VALUE_FILE : VALUE_OTHER;
}

static void write_choices(FILE *file, const struct option_spec *spec)
{
	for (int i = 0; option_choice(spec->kind, i); i++)
		fprintf(file, "%s%s", i ? " " : "", option_choice(spec->kind, i));
}

static void write_commands(FILE *file, const char *between)
{
	for (enum command c = 0; c < COMMAND_COUNT; c++)
		fprintf(file, "%s%s", c ? between : "", options_command(c)->name);
}

/* bash */

/* The pattern of an option in a `case`. */
static void bash_pattern(FILE *file, const struct option_spec *spec)
{
	if (spec->letter)
		fprintf(file, "-%c | ", spec->letter);
	fprintf(file, "--%s", spec->name);
}

/* One branch for all options of a kind whose completion depends on the kind alone. */
static void bash_branch(FILE *file, enum command c, enum value value, const char *what)
{
	bool any = false;
	for (const struct option_spec *spec = option_specs; spec->name; spec++) {
		if (!option_applies(spec, c) || value_of(spec) != value)
			continue;
		fputs(any ? " | " : "\t\t", file);
		bash_pattern(file, spec);
		any = true;
	}
	if (any)
		fprintf(file, ") %s ;;\n", what);
}

/* The commands whose first word is the name of a distribution. */
static bool takes_ndf(enum command c)
{
	return c == COMMAND_NDF || c == COMMAND_SAMPLE;
}

static void write_ndfs(FILE *file)
{
	for (int i = 0; ndf_at(i); i++)
		fprintf(file, "%s%s", i ? " " : "", ndf_name(ndf_at(i)));
}

static void bash_command(FILE *file, enum command c)
{
	fprintf(file, "\t%s)\n\t\toptions='--help", options_command(c)->name);
	for (const struct option_spec *spec = option_specs; spec->name; spec++)
		if (option_applies(spec, c))
			fprintf(file, " --%s", spec->name);
	fputs("'\n\t\tcase $previous in\n", file);
	for (const struct option_spec *spec = option_specs; spec->name; spec++) {
		const enum value value = value_of(spec);
		if (!option_applies(spec, c) || (value != VALUE_CHOICE && value != VALUE_LIST))
			continue;
		fputs("\t\t", file);
		bash_pattern(file, spec);
		fputs(") words='", file);
		write_choices(file, spec);
		fprintf(file, "'%s ;;\n", value == VALUE_LIST ? " before=${current%\"${current##*,}\"}" : "");
	}
	bash_branch(file, c, VALUE_FILE, "return");
	bash_branch(file, c, VALUE_OTHER, "compopt +o default +o bashdefault 2>/dev/null; return");
	if (takes_ndf(c)) {
		fputs("\t\t*) [[ $current == -* ]] || words='", file);
		write_ndfs(file);
		fputs("' ;;\n", file);
	}
	fputs("\t\tesac\n\t\t;;\n", file);
}

static void write_bash(FILE *file)
{
	fputs("# bash completion of stdfit, as written by stdfit --completion bash\n"
	      "_stdfit()\n"
	      "{\n"
	      "\tlocal command=fit options words='' before=''\n"
	      "\tlocal current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]}\n"
	      "\tCOMPREPLY=()\n"
	      "\t# --name=value comes as three words.\n"
	      "\tif [ \"$current\" = = ]; then\n"
	      "\t\tcurrent=''\n"
	      "\telif [ \"$previous\" = = ]; then\n"
	      "\t\tprevious=${COMP_WORDS[COMP_CWORD - 2]}\n"
	      "\tfi\n"
	      "\tif [ \"$COMP_CWORD\" -gt 1 ]; then\n"
	      "\t\tcase ${COMP_WORDS[1]} in\n\t\t",
	      file);
	write_commands(file, " | ");
	fputs(") command=${COMP_WORDS[1]} ;;\n"
	      "\t\tesac\n"
	      "\tfi\n"
	      "\tcase $command in\n",
	      file);
	for (enum command c = 0; c < COMMAND_COUNT; c++)
		bash_command(file, c);
	fputs("\tesac\n"
	      "\t# Where nothing is found, bash goes on to names of files.\n"
	      "\tif [ -n \"$words\" ]; then\n"
	      "\t\tmapfile -t COMPREPLY < <(compgen -P \"$before\" -W \"$words\" -- \"${current#\"$before\"}\")\n"
	      "\telif [[ $current == -* ]]; then\n"
	      "\t\t[ \"$COMP_CWORD\" -gt 1 ] || options+=' --version --man --completion'\n"
	      "\t\tmapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$current\")\n"
	      "\telif [ \"$previous\" = --completion ]; then\n"
	      "\t\tmapfile -t COMPREPLY < <(compgen -W 'bash zsh' -- \"$current\")\n"
	      "\telif [ \"$COMP_CWORD\" -eq 1 ]; then\n"
	      "\t\tcompopt -o filenames 2>/dev/null\n"
	      "\t\tmapfile -t COMPREPLY < <(compgen -W '",
	      file);
	write_commands(file, " ");
	fputs("' -- \"$current\"; compgen -f -- \"$current\")\n"
	      "\tfi\n"
	      "}\n"
	      "complete -o default -o bashdefault -F _stdfit stdfit\n",
	      file);
}

/* zsh */

/* Text inside '...[...]...' of an _arguments specification. */
static void zsh_text(FILE *file, const char *text)
{
	for (; *text; text++) {
		if (*text == '\'')
			fputs("'\\'", file);
		else if (strchr("[]:\\", *text))
			fputc('\\', file);
		fputc(*text, file);
	}
}

static void zsh_option(FILE *file, const struct option_spec *spec)
{
	const enum value value = value_of(spec);
	const char *behind = value == VALUE_NONE ? "" : "=";
	if (spec->letter)
		fprintf(file, "\t\t\t'(-%c --%s)'{-%c,--%s%s}'[", spec->letter, spec->name, spec->letter, spec->name,
			behind);
	else
		fprintf(file, "\t\t\t'--%s%s[", spec->name, behind);
	zsh_text(file, spec->help);
	fputc(']', file);
	if (value != VALUE_NONE) {
		fputc(':', file);
		zsh_text(file, spec->argument);
		fputc(':', file);
	}
	if (value == VALUE_CHOICE) {
		fputc('(', file);
		write_choices(file, spec);
		fputc(')', file);
	} else if (value == VALUE_LIST) {
		fprintf(file, "_values -s , %s ", spec->argument);
		write_choices(file, spec);
	} else if (value != VALUE_NONE) {
		fputs(value == VALUE_FILE ? "_files" : " ", file);
	}
	fputs("'\n", file);
}

static void zsh_command(FILE *file, enum command c)
{
	fprintf(file, "\t%s)\n\t\toptions=(\n\t\t\t'(-h --help)'{-h,--help}'[its options]'\n",
		options_command(c)->name);
	for (const struct option_spec *spec = option_specs; spec->name; spec++)
		if (option_applies(spec, c))
			zsh_option(file, spec);
	fputs("\t\t)\n", file);
	if (takes_ndf(c)) {
		fputs("\t\targuments=('1:distribution:(", file);
		write_ndfs(file);
		fputs(")')\n", file);
	}
	fputs("\t\t;;\n", file);
}

static void write_zsh(FILE *file)
{
	fputs("#compdef stdfit\n"
	      "# zsh completion of stdfit, as written by stdfit --completion zsh\n"
	      "_stdfit() {\n"
	      "\tlocal command=fit first=$(( CURRENT == 2 )) ret=1\n"
	      "\tlocal -a options commands arguments=('*:file:_files')\n"
	      "\tcommands=(\n",
	      file);
	for (enum command c = 0; c < COMMAND_COUNT; c++) {
		fprintf(file, "\t\t'%s:", options_command(c)->name);
		zsh_text(file, options_command(c)->summary);
		fputs("'\n", file);
	}
	fputs("\t)\n"
	      "\tif (( CURRENT > 2 )); then\n"
	      "\t\tcase $words[2] in\n\t\t(",
	      file);
	write_commands(file, "|");
	fputs(")\n"
	      "\t\t\tcommand=$words[2]\n"
	      "\t\t\tshift words\n"
	      "\t\t\t(( CURRENT-- ))\n"
	      "\t\t\t;;\n"
	      "\t\tesac\n"
	      "\tfi\n"
	      "\tcase $command in\n",
	      file);
	for (enum command c = 0; c < COMMAND_COUNT; c++)
		zsh_command(file, c);
	fputs("\tesac\n"
	      "\tif (( first )); then\n"
	      "\t\t_describe -t commands command commands && ret=0\n"
	      "\t\toptions+=(--version'[versions of program and libraries]' --man'[the manual page]'\n"
	      "\t\t\t'--completion[completion for a shell]:shell:(bash zsh)')\n"
	      "\tfi\n"
	      "\t_arguments -s -S : $options $arguments && ret=0\n"
	      "\treturn ret\n"
	      "}\n"
	      "_stdfit \"$@\"\n",
	      file);
}

bool completion_write(FILE *file, const char *shell)
{
	const bool bash = !strcmp(shell, "bash"), zsh = !strcmp(shell, "zsh");
	if (bash)
		write_bash(file);
	if (zsh)
		write_zsh(file);
	return bash || zsh;
}
