/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The manual page and the completions: all commands and options, in a form that man, bash and zsh take. */
#include "fit/cli/option_value.h"
#include "run_program.h"

static bool installed(const char *tool)
{
	char command[64];
	snprintf(command, sizeof command, "command -v %s", tool);
	shell(command);
	if (last.code)
		print_message("%s is not installed: not tried\n", tool);
	return !last.code;
}

/* The page without its fonts: from the heading of a command up to the next heading. */
static char *page_section(enum command c)
{
	char command[160];
	snprintf(command, sizeof command,
		 "set -e; \"$STDFIT\" --man >page; sed 's/\\\\f[BIR]//g; s/\\\\-/-/g' page | "
		 "sed -n '/^[.]SS %s$/,/^[.]S[SH]/p'",
		 options_command(c)->name);
	shell(command);
	expect_code(0);
	return strdup(last.out);
}

static void the_page_has_every_command_and_option(void **state)
{
	(void)state;
	for (enum command c = 0; c < COMMAND_COUNT; c++) {
		char *section = page_section(c), line[128];
		int options = 0;
		for (const struct option_spec *spec = option_specs; spec->name; spec++) {
			if (!option_applies(spec, c))
				continue;
			snprintf(line, sizeof line, "--%s%s%s\n", spec->name, spec->argument ? " " : "",
				 spec->argument ? spec->argument : "");
			expect_part(section, line, __LINE__);
			if (spec->letter)
				snprintf(line, sizeof line, ".TP\n-%c, --%s", spec->letter, spec->name);
			else
				snprintf(line, sizeof line, ".TP\n--%s", spec->name);
			expect_part(section, line, __LINE__);
			options++;
		}
		assert_true(options > 0);
		/* What the program's own help says is there, is in the page. */
		snprintf(line, sizeof line, "%s --help", options_command(c)->name);
		stdfit(line);
		expect_code(0);
		for (const char *at = last.out; (at = strstr(at, "--")); at += 2) {
			const size_t length = strspn(at, "-abcdefghijklmnopqrstuvwxyz");
			snprintf(line, sizeof line, "%.*s", (int)length, at);
			expect_part(section, line, __LINE__);
		}
		free(section);
	}
}

static void the_page_is_sound(void **state)
{
	(void)state;
	shell("\"$STDFIT\" --man >page && OMP_NUM_THREADS=3 \"$STDFIT\" --man | cmp - page && test $(wc -l <page) -gt "
	      "100");
	expect_code(0);
	if (installed("mandoc")) {
		shell("mandoc -Tlint -Wwarning page");
		expect_code(0);
		assert_string_equal(last.out, "");
	}
	if (installed("groff")) {
		shell("groff -ww -z -man -Tutf8 page");
		expect_code(0);
		assert_string_equal(last.err, "");
	}
	stdfit("--man >/dev/full");
	expect_error(1, "cannot write standard output");
}

/* A script in which each `try` completes the last of its words and prints what comes out. */
static FILE *bash_script(void)
{
	FILE *script = fopen("try.bash", "w");
	assert_non_null(script);
	fputs("set -u\n. ./stdfit.bash\n"
	      "try() { COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _stdfit; printf '%s|%s\\n' \"$*\" "
	      "\"${COMPREPLY[*]}\"; }\n",
	      script);
	return script;
}

/* The command's options that begin with --name, as the completion gives them. */
static void write_options_like(FILE *file, enum command c, const char *name)
{
	const char *between = "";
	for (const struct option_spec *spec = option_specs; spec->name; spec++) {
		if (!option_applies(spec, c) || strncmp(spec->name, name, strlen(name)))
			continue;
		fprintf(file, "%s--%s", between, spec->name);
		between = " ";
	}
	fputc('\n', file);
}

static void write_choices(FILE *file, const struct option_spec *spec)
{
	for (int i = 0; option_choice(spec->kind, i); i++)
		fprintf(file, "%s%s", i ? " " : "", option_choice(spec->kind, i));
	fputc('\n', file);
}

static void bash_completes_every_option(void **state)
{
	(void)state;
	if (!installed("bash"))
		skip_for_want_of("bash");
	stdfit("--completion bash >stdfit.bash");
	expect_code(0);
	FILE *script = bash_script(), *expected = fopen("expected", "w");
	assert_non_null(expected);
	for (enum command c = 0; c < COMMAND_COUNT; c++) {
		const char *name = options_command(c)->name;
		for (const struct option_spec *spec = option_specs; spec->name; spec++) {
			if (!option_applies(spec, c))
				continue;
			fprintf(script, "try stdfit %s x.binary --%s\n", name, spec->name);
			fprintf(expected, "stdfit %s x.binary --%s|", name, spec->name);
			write_options_like(expected, c, spec->name);
			if (!spec->argument || !option_choice(spec->kind, 0))
				continue;
			fprintf(script, "try stdfit %s --%s ''\n", name, spec->name);
			fprintf(expected, "stdfit %s --%s |", name, spec->name);
			write_choices(expected, spec);
		}
	}
	assert_int_equal(fclose(script) | fclose(expected), 0);
	shell("bash --norc try.bash >found; diff expected found && test -s expected");
	if (last.code)
		fail_msg("%.2000s", last.out);
}

static void bash_completes(const char *words, const char *wanted)
{
	FILE *script = bash_script();
	fprintf(script, "try %s\n", words);
	assert_int_equal(fclose(script), 0);
	shell("bash --norc try.bash");
	expect_code(0);
	assert_string_equal(last.err, "");
	const char *found = strchr(last.out, '|');
	assert_non_null(found);
	if (strncmp(found + 1, wanted, strlen(wanted)) || strcmp(found + 1 + strlen(wanted), "\n"))
		fail_msg("bash: %s: found %s, expected %s", words, found + 1, wanted);
}

static void bash_completes_as_typed(void **state)
{
	(void)state;
	if (!installed("bash"))
		skip_for_want_of("bash");
	stdfit("--completion bash >stdfit.bash");
	write_text("compass.binary", "");
	bash_completes("stdfit comp", "compare compass.binary");
	bash_completes("stdfit compare co", ""); /* no command any more: names of files, which bash adds */
	bash_completes("stdfit --ver", "--version");
	bash_completes("stdfit --completion ''", "bash zsh");
	bash_completes("stdfit x.binary --gaf = un", "uncorrelated");
	bash_completes("stdfit x.binary --gaf =", "uncorrelated correlated v-groove");
	bash_completes("stdfit x.binary --ndf std,gg", "std,ggx");
	bash_completes("stdfit x.binary --ndf = std,ggx,beck", "std,ggx,beckmann");
	bash_completes("stdfit x.binary --threads ''", "");
	bash_completes("stdfit x.binary -o ''", "");
	bash_completes("stdfit merge --sh", "");
	bash_completes("stdfit fit --sh", "--shard");
	bash_completes("stdfit ndf hyp", "hyper-cauchy");
	bash_completes("stdfit sample ell", "ellipsoid");
	unlink("compass.binary");
}

/* Types into an interactive zsh, in a terminal of its own, whose `stdfit` tells what it was called with. */
static void zsh_completes(const char *typed, const char *wanted)
{
	char command[1024];
	write_text("setup.zsh", "fpath=($PWD $fpath)\nautoload -Uz compinit\ncompinit -u -D\n"
				"stdfit() { print -r \"GOT:$*:END\" }\n"
				"print READY\n");
	write_text("drive.zsh", "zmodload zsh/zpty\n"
				"zpty z zsh -f -i\n"
				"zpty -w z '. ./setup.zsh'\n"
				"zpty -r z out '*READY*'\n"
				"zpty -w z \"$1\"\n"
				"zpty -r z out '*GOT:*:END*'\n"
				"out=${out##*GOT:}\n"
				"print -r -- \"${out%%:END*}\"\n"
				"zpty -d z\n");
	snprintf(command, sizeof command, "timeout 60 zsh -f drive.zsh \"$(printf '%s')\"", typed);
	shell(command);
	expect_code(0);
	char line[256];
	snprintf(line, sizeof line, "%s\n", wanted);
	assert_string_equal(last.out, line);
}

static void zsh_completes_as_typed(void **state)
{
	(void)state;
	if (!installed("zsh"))
		skip_for_want_of("zsh");
	stdfit("--completion zsh >_stdfit");
	expect_code(0);
	shell("zsh -f -n _stdfit");
	expect_code(0);
	assert_string_equal(last.err, "");
	zsh_completes("stdfit comp\\t", "compare");
	zsh_completes("stdfit merge --out\\tx.csv", "merge --output=x.csv");
	zsh_completes("stdfit fit --ndf=std,gg\\t --sha\\t1/2", "fit --ndf=std,ggx --shard=1/2");
	zsh_completes("stdfit synth --ph\\t36\\t --bins ce\\t", "synth --phi=360 --bins centre");
	zsh_completes("stdfit --gaf v\\t", "--gaf v-groove");
}

static void other_shells_are_refused(void **state)
{
	(void)state;
	stdfit("--completion fish");
	expect_error(2, "expected --completion bash or --completion zsh");
	assert_string_equal(last.out, "");
	stdfit("--completion");
	expect_error(2, "expected --completion bash");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(the_page_has_every_command_and_option),
		cmocka_unit_test(the_page_is_sound),
		cmocka_unit_test(bash_completes_every_option),
		cmocka_unit_test(bash_completes_as_typed),
		cmocka_unit_test(zsh_completes_as_typed),
		cmocka_unit_test(other_shells_are_refused),
	};
	return cmocka_run_group_tests(tests, enter_directory, leave_directory);
}
