/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Python module over the shared library: it knows what the header declares, and gives what the program gives. */
#include "run_program.h"

/* python CASE, with the module and the library of this build. */
#define SETTINGS                                                                                                       \
	"build=$(dirname \"$STDFIT\") cc=\"${CC:-cc} ${OPT-}\"\n"                                                      \
	"export LC_ALL=C PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$build/python STDFIT_LIBRARY=$(ls "                      \
	"$build/libstdfit.so.*)\n"                                                                                     \
	"python() { /usr/bin/python3 \"$ROOT/tests/python_module.py\" \"$@\"; }\n"

static void run(const char *command)
{
	char *whole;
	assert_true(asprintf(&whole, SETTINGS "%s", command) > 0);
	shell(whole);
	free(whole);
	if (last.code != 0)
		fail_msg("exit code %d of: %s\n%s%s", last.code, command, last.out, last.err);
}

static void need_numpy(void)
{
	const char *flags = getenv("OPT");
	if (flags && strstr(flags, "sanitize"))
		skip_because("Python cannot load a library that was built with a sanitizer");
	if (system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0)
		skip_for_want_of("python3-numpy");
}

/* Every struct, field, constant and function of the header, as the compiler sees them. */
static void it_knows_what_the_header_declares(void **state)
{
	(void)state;
	need_numpy();
	run("python layout >layout.c && $cc -std=c11 -Wall -Wextra -Werror -I\"$ROOT\" -o layout layout.c && ./layout "
	    ">want\n"
	    "python lines | diff want - && test $(wc -l <want) -gt 80");
	run("$cc -E -P -DSTDFIT_CFFI \"$ROOT/fit/stdfit.h\" >plain.h\n"
	    "awk -f \"$ROOT/tests/declared.awk\" plain.h | sort -u >want && python names functions | diff want -\n"
	    "test $(wc -l <want) -gt 30 || exit 1\n"
	    "grep -o 'STDFIT_[A-Z0-9_]*' plain.h | sort -u >want && python names constants | diff want -\n"
	    "test $(wc -l <want) -gt 15 || exit 1\n"
	    "sed -n 's/^struct \\(stdfit_[a-z_]*\\) *{.*/\\1/p' plain.h | sort >want && python names structs | diff "
	    "want -\n"
	    "test $(wc -l <want) -gt 5");
}

static void it_evaluates_what_the_program_writes(void **state)
{
	(void)state;
	need_numpy();
	stdfit("synth made.binary --ndf std --sigma 0.1 --gamma 1.8 --ior 1.5 --kd 0.35,0.04,0.03 --ks 0.5,0.5,0.25");
	expect_code(0);
	run("python evaluate made.binary");
}

static void arrays_go_as_they_are(void **state)
{
	(void)state;
	need_numpy();
	run("python arrays");
}

static void the_mean_of_samples_is_the_albedo(void **state)
{
	(void)state;
	need_numpy();
	run("python sample");
}

static void what_is_refused_is_raised(void **state)
{
	(void)state;
	need_numpy();
	run("python errors");
}

static void a_fit_stops_at_Ctrl_C_and_when_progress_raises(void **state)
{
	(void)state;
	need_numpy();
	run("python stops");
}

static void it_fits_as_the_program_does(void **state)
{
	(void)state;
	need_numpy();
	stdfit("synth made.binary --sigma 0.1 --gamma 1.8 --ior 1.5 --kd 0.35,0.04,0.03 --ks 0.5");
	expect_code(0);
	stdfit("fit made.binary --ndf ggx,beckmann -q -o fits.csv");
	expect_code(0);
	run("python fit made.binary fits.csv");
}

/* Declarations that the module has not learnt, a library of another version, and none. */
static void it_does_not_load_what_it_does_not_know(void **state)
{
	(void)state;
	need_numpy();
	run("mkdir -p other && sed 's/^_VERSION = .*/_VERSION = \"0.0.1\"/' $build/python/stdfit.py >other/stdfit.py\n"
	    "! PYTHONPATH=other python names structs 2>err && grep -q 'expected version 0.0.1 of the library, found' "
	    "err");
	run("sed 's/^struct stdfit_model *{/&\\nlong double new;/' $build/python/stdfit.py >other/stdfit.py\n"
	    "! PYTHONPATH=other python names structs 2>err && grep -q 'ImportError: stdfit: a variable that is not' "
	    "err");
	run("! STDFIT_LIBRARY=./none.so python names structs 2>err && grep -q 'OSError: ./none.so' err");
}

static int set_up(void **state)
{
	char *root = realpath(".", NULL);
	const int code = !root || setenv("ROOT", root, 1) || enter_directory(state);
	free(root);
	return code;
}

int main(void)
{
	const struct CMUnitTest quick[] = {
		cmocka_unit_test(it_knows_what_the_header_declares),
		cmocka_unit_test(it_evaluates_what_the_program_writes),
		cmocka_unit_test(arrays_go_as_they_are),
		cmocka_unit_test(what_is_refused_is_raised),
		cmocka_unit_test(it_does_not_load_what_it_does_not_know),
	};
	const struct CMUnitTest slow[] = {
		cmocka_unit_test(the_mean_of_samples_is_the_albedo),
		cmocka_unit_test(a_fit_stops_at_Ctrl_C_and_when_progress_raises),
		cmocka_unit_test(it_fits_as_the_program_does),
	};
	return case_step(2) == 1 ? cmocka_run_group_tests(slow, set_up, leave_directory)
				 : cmocka_run_group_tests(quick, set_up, leave_directory);
}
