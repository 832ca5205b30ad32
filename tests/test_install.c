/* SPDX-License-Identifier: GPL-3.0-or-later */
/* An installed copy: what is there, what the libraries export, programs built against it as others would build them. */
#include "run_program.h"

/* $make, $cc and $lib, for the commands below. */
#define SETTINGS                                                                                                       \
	"make=\"${MAKE:-make} -s --no-print-directory -C $ROOT BUILD=$(dirname \"$STDFIT\") PREFIX=$PWD/usr\"\n"       \
	"cc=\"${CC:-cc} ${OPT-}\" cxx=\"$(echo ${CC:-c++} | sed 's/gcc/g++/; s/clang/clang++/; s/cc$/c++/') "          \
	"${OPT-}\"\n"                                                                                                  \
	"export LD_LIBRARY_PATH=$PWD/usr/lib PKG_CONFIG_PATH=$PWD/usr/lib/pkgconfig LC_ALL=C\n"

static void run(const char *command, int code)
{
	char *whole;
	assert_true(asprintf(&whole, SETTINGS "%s", command) > 0);
	shell(whole);
	free(whole);
	if (last.code != code)
		fail_msg("exit code %d, expected %d, of: %s\n%s%s", last.code, code, command, last.out, last.err);
}

static void all_is_there(void **state)
{
	(void)state;
	run("cd usr && find . -type f -o -type l | grep -v '^./include/' | sort", 0);
	expect_out("./bin/stdfit\n./lib/libstdfit.a\n./lib/libstdfit.so\n./lib/libstdfit.so.");
	expect_out("./lib/pkgconfig/stdfit.pc\n./share/bash-completion/completions/stdfit\n./share/man/man1/stdfit.1\n"
		   "./share/stdfit/stdfit.py\n./share/zsh/site-functions/_stdfit\n");
	assert_int_equal(count_lines(last.out), 10);
	run("usr/bin/stdfit --version && pkg-config --modversion stdfit && readelf -d usr/lib/libstdfit.so", 0);
	expect_out("soname: [libstdfit.so.0]");
	run("usr/bin/stdfit --version | grep -q \"^stdfit $(pkg-config --modversion stdfit) \"", 0);
}

/* Nothing but what the installed header declares, and all of it. (The names of OpenMP's locks begin with a dot.) */
static void only_public_symbols(void **state)
{
	(void)state;
	run("$cc -E -P -DSTDFIT_CFFI usr/include/stdfit/stdfit.h | awk -f \"$ROOT/tests/declared.awk\" | sort -u "
	    ">declared\n"
	    "test $(wc -l <declared) -gt 30 && grep -q -x stdfit_fit declared && ! grep -v '^stdfit_' declared",
	    0);
	run("nm -D --defined-only usr/lib/libstdfit.so | awk '{ print $3 }' | grep -v '^__' | sort | diff declared -",
	    0);
	run("nm -g --defined-only usr/lib/libstdfit.a | awk 'NF == 3 { print $3 }' | grep -v '^[.]' | sort | diff "
	    "declared -",
	    0);
}

static void headers_stand_alone(void **state)
{
	(void)state;
	run("for h in usr/include/stdfit/*.h; do echo \"#include <stdfit/${h##*/}>\" |"
	    " $cc -std=c11 -Wall -Wextra -Wpedantic -Werror -Iusr/include -fsyntax-only -x c - || exit 1; done",
	    0);
	run("command -v ${cxx%% *} || exit 0\n"
	    "for h in usr/include/stdfit/*.h; do echo \"#include <stdfit/${h##*/}>\" |"
	    " $cxx -std=c++11 -Wall -Wextra -Wpedantic -Werror -Iusr/include -fsyntax-only -x c++ - || exit 1; done\n"
	    "echo '#include <stdfit/stdfit.h>\nint main() { return !stdfit_version(); }' >a.cc\n"
	    "$cxx -o a a.cc $(pkg-config --cflags --libs stdfit) && ./a",
	    0);
}

/* One header, which includes what the C standard has, and libraries that are used. */
static void nothing_else_is_needed(void **state)
{
	(void)state;
	run("ls usr/include/stdfit && grep '#include' usr/include/stdfit/stdfit.h", 0);
	assert_string_equal(last.out, "stdfit.h\n#include <stddef.h>\n#include <stdint.h>\n");
	run("readelf -d usr/lib/libstdfit.so | grep NEEDED", 0);
	assert_null(strstr(last.out, "libpng"));
	assert_null(strstr(last.out, "jansson"));
	run("cat usr/lib/pkgconfig/stdfit.pc", 0);
	assert_null(strstr(last.out, "libpng"));
}

/* Declarations as the preprocessor leaves them are all that Python's cffi has to know. */
static void cffi_reads_the_header(void **state)
{
	(void)state;
	const char *flags = getenv("OPT");
	if (flags && strstr(flags, "sanitize"))
		skip_because("Python cannot load a library that was built with a sanitizer");
	run("python3 -c 'import cffi' 2>/dev/null && echo there || true", 0);
	if (!strstr(last.out, "there"))
		skip_for_want_of("python3-cffi");
	run("$cc -E -P -DSTDFIT_CFFI usr/include/stdfit/stdfit.h >plain.h\ncat >use.py <<'END'\n"
	    "import cffi\n"
	    "ffi = cffi.FFI()\n"
	    "ffi.cdef(open('plain.h').read())\n"
	    "lib = ffi.dlopen('usr/lib/libstdfit.so')\n"
	    "ndf = ffi.new('stdfit_ndf **')\n"
	    "error = ffi.new('struct stdfit_error *')\n"
	    "assert lib.stdfit_ndf_new(ndf, b'beckmann', 0.5, 0.5, 0, ffi.NULL, error) == lib.STDFIT_OK\n"
	    "D = ffi.new('double *')\n"
	    "assert lib.stdfit_ndf_evaluate(ndf[0], lib.STDFIT_D, 1, [0, 0, 1], D, error) == lib.STDFIT_OK\n"
	    "print('%.6f' % D[0])\n"
	    "options = ffi.new('struct stdfit_options *', lib.stdfit_options_default())\n"
	    "options.threads = 0\n"
	    "context = ffi.new('stdfit_context **')\n"
	    "assert lib.stdfit_context_new(context, 180, options, error) == lib.STDFIT_DOMAIN\n"
	    "print(ffi.string(error.text).decode())\n"
	    "END\npython3 use.py",
	    0);
	assert_string_equal(last.out, "1.273240\nexpected threads in 1 .. 1024, found 0\n");
}

/* The Python module finds the library beside which it was installed. */
static void python_reads_the_library(void **state)
{
	(void)state;
	const char *flags = getenv("OPT");
	if (flags && strstr(flags, "sanitize"))
		skip_because("Python cannot load a library that was built with a sanitizer");
	if (system("/usr/bin/python3 -c 'import numpy' 2>/dev/null") != 0)
		skip_for_want_of("python3-numpy");
	run("unset LD_LIBRARY_PATH\n"
	    "PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=usr/share/stdfit /usr/bin/python3 -c 'import stdfit; "
	    "print(stdfit._lib._name, \"%.6f\" % stdfit.Distribution(\"beckmann\", 0.5).D((0, 0, 1)))'",
	    0);
	expect_out("/usr/lib/libstdfit.so.0 1.273240\n");
}

/* What the examples print and how they end. */
static void expect_examples(void)
{
	run("./sample_ndf", 0);
	expect_out("D ");
	const char *by_samples = strstr(last.out, "albedo "), *exact = strstr(last.out, "by quadrature ");
	assert_true(by_samples && exact);
	const double albedo = strtod(exact + strlen("by quadrature "), NULL);
	assert_true(albedo > 0.5 && albedo < 1);
	check_rel(strtod(by_samples + strlen("albedo "), NULL), albedo, 1e-3, "albedo");
	run("./fit_table", 0);
	assert_string_equal(last.out, "sigma 0.2500, n 1.5000\n");
	expect_part(last.err, "full: ", __LINE__);
	run("./fit_table 100", 1);
	assert_string_equal(last.out, "interrupted\n");
}

#define BUILD_EXAMPLES(flags)                                                                                          \
	"for e in sample_ndf fit_table; do $cc -std=c11 -Wall -Wextra -Werror -o $e "                                  \
	"\"$ROOT/tests/examples/$e.c\" " flags " || exit 1; done\n"

static void examples_with_the_shared_library(void **state)
{
	(void)state;
	run(BUILD_EXAMPLES("$(pkg-config --cflags --libs stdfit)") "readelf -d fit_table | grep 'libstdfit.so.0'", 0);
	expect_examples();
}

static void examples_with_the_static_library(void **state)
{
	(void)state;
	run("mkdir shared && mv usr/lib/libstdfit.so* shared\n" BUILD_EXAMPLES(
		    "$(pkg-config --static --cflags --libs stdfit)") "! readelf -d fit_table | grep libstdfit",
	    0);
	expect_examples();
	run("mv shared/* usr/lib", 0);
}

static void it_installs_below_another_root(void **state)
{
	(void)state;
	run("$make install PREFIX=/opt/stdfit DESTDIR=$PWD/stage && find stage -maxdepth 3 && cat "
	    "stage/opt/stdfit/lib/pkgconfig/*",
	    0);
	expect_out("stage/opt/stdfit/bin\n");
	expect_out("prefix=/opt/stdfit\nlibdir=/opt/stdfit/lib\nincludedir=/opt/stdfit/include\n");
	assert_null(strstr(last.out, test_directory));
	run("$make uninstall PREFIX=/opt/stdfit DESTDIR=$PWD/stage && find stage ! -type d", 0);
	assert_string_equal(last.out, "");
}

/* The last test: takes away what was installed and leaves what was not. */
static void uninstalling_leaves_what_was_not_installed(void **state)
{
	(void)state;
	run("touch usr/include/stdfit/other.h usr/lib/libother.a\n$make uninstall && find usr ! -type d | sort", 0);
	assert_string_equal(last.out, "usr/include/stdfit/other.h\nusr/lib/libother.a\n");
	run("rm usr/include/stdfit/other.h; $make install && $make uninstall && find usr ! -type d && test ! -e "
	    "usr/include/stdfit",
	    0);
	assert_string_equal(last.out, "usr/lib/libother.a\n");
}

/* All that git knows is in the tarball, where this is a clone; what it holds can be made from. */
static void the_tarball_holds_what_git_knows(void **state)
{
	(void)state;
	run("$make dist && tar -xzf \"$(dirname \"$STDFIT\")/stdfit-$(pkg-config --modversion stdfit).tar.gz\" && ls "
	    "-d stdfit-* && cd stdfit-* &&"
	    " ${MAKE:-make} -n all >/dev/null",
	    0);
	assert_int_equal(count_lines(last.out), 1);
	run("git -C \"$ROOT\" ls-files >known 2>/dev/null || exit 0\n"
	    "(cd stdfit-* && find . ! -type d | sed 's,^./,,') | sort >packed; sort known | comm -23 - packed",
	    0);
	assert_string_equal(last.out, "");
	/* Nothing that lies beside the project. */
	run("test -s known || exit 0; for f in known packed; do cut -d / -f 1 $f | sort -u >$f.top; done\n"
	    "diff known.top packed.top",
	    0);
	assert_string_equal(last.out, "");
}

/* By hand, without some of what the program can use: one line names the packages; with all of it, none. */
static void what_is_left_out_is_told(void **state)
{
	(void)state;
	run("mkdir -p tools; for t in pkg-config gnuplot; do printf '#!/bin/sh\nexit 0\n' >tools/$t; chmod +x "
	    "tools/$t; done\n"
	    "PATH=$PWD/tools:$PATH PKG_CONFIG=pkg-config \"$ROOT/scripts/setup.sh\" note",
	    0);
	assert_string_equal(last.err, "");
	run("printf '#!/bin/sh\nexit 1\n' >tools/pkg-config\n"
	    "PATH=$PWD/tools:$PATH PKG_CONFIG=pkg-config \"$ROOT/scripts/setup.sh\" note",
	    0);
	assert_string_equal(last.err, "setup: going on without libpng-dev (pictures as PNG)\n");
	/* make says it as well. */
	run("make -n -s -C \"$ROOT\" BUILD=$(dirname \"$STDFIT\") MAKELEVEL=0 all | grep -c 'setup.sh note'", 0);
}

static int set_up(void **state)
{
	char *root = realpath(".", NULL);
	if (!root || setenv("ROOT", root, 1) || enter_directory(state))
		return 1;
	free(root);
	alarm(900);
	shell(SETTINGS "$make install");
	if (last.code)
		print_error("make install: %s\n", last.err);
	return last.code;
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(all_is_there),
		cmocka_unit_test(only_public_symbols),
		cmocka_unit_test(headers_stand_alone),
		cmocka_unit_test(nothing_else_is_needed),
		cmocka_unit_test(cffi_reads_the_header),
		cmocka_unit_test(python_reads_the_library),
		cmocka_unit_test(examples_with_the_shared_library),
		cmocka_unit_test(examples_with_the_static_library),
		cmocka_unit_test(it_installs_below_another_root),
		cmocka_unit_test(the_tarball_holds_what_git_knows),
		cmocka_unit_test(what_is_left_out_is_told),
		cmocka_unit_test(uninstalling_leaves_what_was_not_installed),
	};
	return cmocka_run_group_tests(tests, set_up, leave_directory);
}
