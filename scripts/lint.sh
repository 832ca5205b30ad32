#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: lint.sh FLAG...
# Runs clang-tidy and cppcheck over all C files, with the flags -D and -I of the build, clang-format, which changes nothing,
# over these and the headers, and shellcheck over the scripts. Fails if any of them finds something.
set -eu

files=$(find src data_readers fit tests -name '*.c')
jobs=$(nproc 2>/dev/null || echo 1)
status=0
# One file a process: clang-tidy's analysis of one file may mislead it in the next.
# shellcheck disable=SC2086 # a list of words
printf '%s\n' $files | grep -v -x src/status.c |
	xargs -P "$jobs" -I FILE clang-tidy --quiet FILE -- -std=c11 -fopenmp -Itests "$@" -include tests/lint.h || status=1
clang-tidy --quiet src/status.c -- -std=c11 "$@" || status=1
# shellcheck disable=SC2086
cppcheck --quiet --std=c11 --error-exitcode=1 --enable=warning,style,performance,portability --inline-suppr \
	--suppressions-list=.cppcheck -j "$jobs" -Itests "$@" $files || status=1
find src data_readers fit tests -name '*.[ch]' -exec clang-format --dry-run -Werror {} + || status=1
shellcheck scripts/*.sh tests/*.sh || status=1
exit $status
