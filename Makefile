# SPDX-License-Identifier: GPL-3.0-or-later
# Targets: all (default), check, check-long, check-docs, demo, bench, figures, tables, stability, asan, ubsan, tsan, lint, architecture,
# valgrind, compilers, fuzz, killtest, export-table, page-tools, install, uninstall, dist, deb, clean. Those that check or show something install what is
# missing first.
VERSION := 0.2.0

CC ?= cc
# Who builds by hand is told first what is missing; the targets that check or show something install it.
ifeq ($(filter-out all library install,$(or $(MAKECMDGOALS),all)),)
ifeq ($(shell command -v $(firstword $(CC)) 2>/dev/null),)
$(error no C compiler '$(firstword $(CC))' here: `make setup` installs what is missing on Debian, README.md names it)
endif
endif
BUILD ?= build
OPT ?= -O2 -g
# Of the library; the program needs more.
PKGS := nlopt gsl libxxhash
PKG_CONFIG ?= pkg-config
WERROR ?= -Werror
# Pictures as PNG where libpng is installed; `make PNG=` does without.
PNG := $(shell $(PKG_CONFIG) --exists libpng 2>/dev/null && echo yes)
PROGRAM_PKGS := jansson $(if $(PNG),libpng)
# Asked once; empty before the set-up has run, when only `setup` is made.
pkg_cflags := $(shell $(PKG_CONFIG) --cflags $(PKGS) $(PROGRAM_PKGS) 2>/dev/null) $(if $(PNG),-DHAVE_LIBPNG)
pkg_libs := $(shell $(PKG_CONFIG) --libs $(PKGS) $(PROGRAM_PKGS) 2>/dev/null)
library_pkg_libs := $(shell $(PKG_CONFIG) --libs $(PKGS) 2>/dev/null)
# make V=1 shows the commands.
quiet = $(if $(V),,@echo '  $(1)	$@';)

warnings := -Wall -Wextra -Wconversion -Wshadow -Wstrict-prototypes -Wmissing-prototypes $(WERROR)
# errno and floating-point traps are not used by the mathematics; without them loops vectorise.
fpflags := -fno-math-errno -fno-trapping-math -ffp-contract=off
# One set of objects for the program and the shared library.
picflags := -fPIC -fno-semantic-interposition
ALL_CFLAGS = -std=c11 -D_GNU_SOURCE $(warnings) $(OPT) -fopenmp $(fpflags) $(picflags) -I. \
	$(pkg_cflags) -DSTDFIT_VERSION='"$(VERSION)"' $(CFLAGS_$(basename $(@F))) $(CFLAGS)
LIBS = $(pkg_libs) -lm
LIBRARY_LIBS = $(library_pkg_libs) -lm

# Each uses only those before it.
folders := src data_readers $(addprefix fit/,error search api results export render cli sources plot page commands)
lib_sources := $(filter-out fit/commands/main.c,$(foreach folder,$(folders),$(wildcard $(folder)/*.c)))
lib_objects := $(lib_sources:%.c=$(BUILD)/%.o)

# The kernel's loops want vectors; on x86-64 it is compiled for AVX2 and AVX-512 too and chosen at run time (AVX2=no: not
# so). No multiply-add in one: all give the same bits, so a fit ends at the same point on any machine.
CFLAGS_kernel := -O3 -Wno-psabi
CFLAGS_kernel_avx2 := $(CFLAGS_kernel) -mavx2 -DKERNEL_NAME=kernel_avx2
CFLAGS_kernel_avx512 := $(CFLAGS_kernel) -mavx512f -mavx512dq -mavx512bw -mavx512vl -mprefer-vector-width=512 \
	-ffp-contract=off -DKERNEL_NAME=kernel_avx512 -DKERNEL_LANES=16
CFLAGS_metrics := -O3
CFLAGS_octave_table := -O3
CFLAGS_bench := -O3
# The mathematics raises no floating-point exception in its domain; the compiler may not speculate one either.
$(BUILD)/src/%.o: fpflags := -fno-math-errno -ftrapping-math -ffp-contract=off
# High precision for `make stability`, where MPFR is installed.
ifneq ($(shell $(PKG_CONFIG) --exists mpfr 2>/dev/null && echo yes),)
CFLAGS_stability := -DHAVE_MPFR
$(BUILD)/tests/stability: LIBS += -lmpfr
endif
ifneq ($(findstring x86_64,$(shell $(CC) -dumpmachine 2>/dev/null)),)
AVX2 ?= yes
endif
ifeq ($(AVX2),yes)
lib_objects += $(BUILD)/fit/error/kernel_avx2.o $(BUILD)/fit/error/kernel_avx512.o
CFLAGS_kernel_pick := -DKERNEL_HAVE_AVX2
endif
test_sources := $(wildcard tests/test_*.c)
test_programs := $(test_sources:tests/%.c=$(BUILD)/tests/%)
# Attacks on inputs, outputs and memory, and fits of hard tables: half of the time of all tests.
only_long := alloc convert export export_axes fetch free_form hostile hostile_names hostile_outputs outputs plot resample richer slurm stiff suspects terminal
# Some cases in check, all in check-long: check.h, case_step().
with_long_cases := anisotropic conductor dielectric fit given_ndf interval objective python random_walk report scattered_fit
short_programs := $(filter-out $(only_long:%=$(BUILD)/tests/test_%),$(test_programs))
long_programs := $(foreach t,$(only_long) $(with_long_cases),$(BUILD)/tests/test_$(t))

# Made by the program from its own tables; RUN runs it where it is built for another machine, as in RUN=qemu-aarch64.
manuals := $(BUILD)/stdfit.1 $(BUILD)/completions/stdfit.bash $(BUILD)/completions/_stdfit

# By hand, where no set-up has said so: what is left out, and the package that brings it.
all: $(BUILD)/stdfit $(manuals)
	$(if $(filter 0,$(MAKELEVEL)),@scripts/setup.sh note,@:)

$(BUILD)/stdfit: $(BUILD)/fit/commands/main.o $(lib_objects)
	$(call quiet,LD)$(CC) $(ALL_CFLAGS) $(LDFLAGS) -o $@ $^ $(LIBS)

$(BUILD)/stdfit.1: print := --man
$(BUILD)/completions/stdfit.bash: print := --completion bash
$(BUILD)/completions/_stdfit: print := --completion zsh
$(manuals): $(BUILD)/stdfit
	@mkdir -p $(@D)
	$(call quiet,PRINT)$(RUN) $(BUILD)/stdfit $(print) >$@.part && mv -f $@.part $@

$(BUILD)/%.o: %.c Makefile
	@mkdir -p $(@D)
	$(call quiet,CC)$(CC) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/fit/error/kernel_avx2.o $(BUILD)/fit/error/kernel_avx512.o: fit/error/kernel.c Makefile
	@mkdir -p $(@D)
	$(call quiet,CC)$(CC) $(ALL_CFLAGS) -MMD -MP -c -o $@ $<

$(BUILD)/tests/%: $(BUILD)/tests/%.o $(lib_objects)
	$(call quiet,LD)$(CC) $(ALL_CFLAGS) $(LDFLAGS) -o $@ $^ -lcmocka $(LIBS)

.SECONDARY:

setup:
	@scripts/setup.sh

# Recursive, so that pkg-config is asked only after the set-up has run. check is what one runs after every change; check-long
# has the slow programs, and all cases of those of which check runs a part.
check check-long: setup
	@$(MAKE) --no-print-directory $(if $(filter check,$@),run-tests,run-long-tests)

run-tests: check-includes all library $(short_programs)
	@CC='$(CC)' OPT='$(OPT)' scripts/run_tests.sh $(BUILD) $(short_programs)

run-long-tests: all library $(long_programs)
	@CC='$(CC)' OPT='$(OPT)' STDFIT_LONG=1 scripts/run_tests.sh $(BUILD) $(long_programs)

run-all-tests: all library $(test_programs)
	@CC='$(CC)' OPT='$(OPT)' STDFIT_LONG=1 scripts/run_tests.sh $(BUILD) $(test_programs)

# The whole suite under sanitizers, each in a build of its own. ThreadSanitizer needs clang, whose OpenMP reports its
# synchronisation through Archer. It cannot judge libraries that were not built for it: they are ignored.
asan ubsan tsan: setup
	@$(environment_$@) $(MAKE) --no-print-directory BUILD=$(BUILD)-$@ OPT='-O1 -g -fno-omit-frame-pointer $(sanitize_$@)' \
		$(if $(filter tsan,$@),CC=clang) run-all-tests
sanitize_asan := -fsanitize=address
sanitize_ubsan := -fsanitize=undefined,float-cast-overflow -fno-sanitize-recover=all
sanitize_tsan := -fsanitize=thread
environment_tsan = OMP_TOOL_LIBRARIES="$$(clang -print-resource-dir)/../../libarcher.so" \
	TSAN_OPTIONS="ignore_noninstrumented_modules=1 $$TSAN_OPTIONS"

# The order of the rooms; clang-tidy, cppcheck, clang-format and shellcheck over the whole tree; what they leave out is
# listed in .clang-tidy and .cppcheck.
lint: check-includes
	@scripts/architecture.sh current docs/architecture.md $(folders)
	@scripts/setup.sh $@
	@mkdir -p $(BUILD)/include/stdfit && cp $(public_headers) $(BUILD)/include/stdfit
	@scripts/lint.sh $(filter -D% -I%,$(ALL_CFLAGS)) -I$(BUILD)/include

# Includes go from a room to those before it in `folders`, and never in a circle.
check-includes:
	@scripts/architecture.sh check $(folders)

# The include graph in docs/architecture.md, anew; with its numbers on standard output.
architecture:
	@scripts/architecture.sh write docs/architecture.md $(folders)
	@scripts/architecture.sh graph $(folders)

# The program under valgrind: no leak, no wrong access.
valgrind:
	@scripts/setup.sh $@
	@$(MAKE) --no-print-directory all
	@scripts/valgrind.sh $(BUILD)/stdfit

# gcc and clang, without and with optimisation and AVX2, fit the tables of MERL=DIR or synthetic ones, and are compared.
compilers:
	@scripts/setup.sh $@
	@MERL='$(MERL)' scripts/compilers.sh $(BUILD)

# Each target for so many seconds under libFuzzer, which is clang's.
FUZZ_SECONDS ?= 10
fuzz_targets := $(patsubst tests/%.c,%,$(filter-out tests/fuzz_main.c,$(wildcard tests/fuzz_*.c)))
fuzz:
	@scripts/setup.sh $@
	@$(MAKE) --no-print-directory CC='$(FUZZ_CC)' BUILD=$(BUILD)-$@ \
		OPT='-O2 -g -fno-omit-frame-pointer -Wno-pass-failed $(sanitize_fuzz)' run-fuzz
FUZZ_CC ?= clang
sanitize_fuzz := -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow -fno-sanitize-recover=all

# A batch killed so many times at random moments, and resumed.
KILLS ?= 200
killtest: setup
	@$(MAKE) --no-print-directory all
	@scripts/kill_test.sh $(BUILD)/stdfit $(KILLS)

run-fuzz: $(fuzz_targets:%=$(BUILD)/tests/%)
	@scripts/fuzz.sh $(BUILD) $(FUZZ_SECONDS) $(fuzz_targets)

# The same targets, by their own names, are called by test_corpus.
$(BUILD)/tests/test_corpus: $(fuzz_targets:%=$(BUILD)/tests/%.o)
$(fuzz_targets:%=$(BUILD)/tests/%): $(BUILD)/tests/fuzz_%: $(BUILD)/tests/fuzz_%.o $(BUILD)/tests/fuzz_main_%.o \
		$(lib_objects)
	$(call quiet,LD)$(CC) $(ALL_CFLAGS) -fsanitize=fuzzer $(LDFLAGS) -o $@ $^ $(LIBS)

$(BUILD)/tests/fuzz_main_%.o: tests/fuzz_main.c Makefile
	@mkdir -p $(@D)
	$(call quiet,CC)$(CC) $(ALL_CFLAGS) -DFUZZ_TARGET=fuzz_$* -MMD -MP -c -o $@ $<

bench: setup
	@$(MAKE) --no-print-directory $(BUILD)/tests/bench
	$(BUILD)/tests/bench $(BUILD)/bench.csv

# The figures of the five papers; Fig. 11 of the STD paper of the fits in FITS=FILE.csv, or of the files in MERL=DIR, or of synthetic tables.
figures: setup
	@$(MAKE) --no-print-directory all $(BUILD)/tests/figures
	@FITS='$(FITS)' MERL='$(MERL)' scripts/figures.sh $(BUILD)

# docs/tables.md from the measured tables in MERL=DIR: an hour. WORK=DIR keeps what it is made from; SOME=DIR has those tables that
# richer models are fitted to, where not all are.
tables: setup
	@$(MAKE) --no-print-directory all
	@scripts/tables.sh $(BUILD)/stdfit '$(MERL)' $(if $(WORK),'$(WORK)' $(if $(SOME),'$(SOME)'))

# The mathematics over the extremes of its domain: BUILD/stability.csv and a summary; then fits of hard tables. Fails where
# it finds something.
stability: setup
	@$(MAKE) --no-print-directory $(BUILD)/tests/stability $(BUILD)/tests/test_stiff
	@$(BUILD)/tests/stability $(BUILD)/stability.csv
	@STDFIT_STABILITY=1 $(BUILD)/tests/test_stiff

demo: setup
	@$(MAKE) --no-print-directory all
	@scripts/demo.sh $(BUILD)/stdfit

# The STD fits of the files in MERL=DIR, exported in every format: BUILD/export_table.csv, and the tables of docs/export.md.
export-table: setup
	@$(MAKE) --no-print-directory all
	@$(BUILD)/stdfit fit '$(MERL)' -q --ndf std --weight solid-angle -o $(BUILD)/export_fits.csv
	@scripts/export_table.sh $(BUILD)/stdfit $(BUILD)/export_fits.csv >$(BUILD)/export_table.csv
	@awk -f scripts/export_table.awk $(BUILD)/export_table.csv

# The sessions, links and options of README.md and docs/ against the program; sessions of measured tables with MERL=DIR.
check-docs: setup
	@$(MAKE) --no-print-directory all library
	@MERL='$(MERL)' scripts/check_docs.sh $(BUILD)/stdfit

# What the tests hold the page of a report and glTF exports against, beside their own eyes.
page-tools:
	npm install --no-audit --no-fund --prefix $(BUILD)/npm axe-core html-validate gltf-validator

clean:
	rm -rf $(BUILD)

include scripts/install.mk

.PHONY: all setup check check-long check-docs check-includes architecture run-tests run-long-tests run-all-tests asan ubsan tsan lint valgrind compilers fuzz run-fuzz killtest bench figures tables stability demo export-table page-tools clean

-include $(lib_objects:.o=.d) $(BUILD)/fit/commands/main.d $(patsubst %.c,$(BUILD)/%.d,$(wildcard tests/*.c))
