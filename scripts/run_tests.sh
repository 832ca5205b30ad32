#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: run_tests.sh BUILD PROGRAM...
# Runs every test program, shows what each printed and, last, cmocka's summaries of all. Fails if any failed or crashed.
set -u

build=$1
shift
[ $# -gt 0 ] || { echo 'run_tests: no test programs' >&2; exit 1; }

STDFIT=$(cd "$build" && pwd)/stdfit
export STDFIT
output=$(mktemp -d) || exit 1
trap 'rm -rf "$output"' EXIT
trap 'exit 130' INT TERM

# cmocka's lines '[==========] 3 test(s) run.', '[  PASSED  ] 3 test(s).' and the like
summary='^\[[ =A-Z]*\] .*test\(s\)( run)?[.,]'

failed=
for program; do
	echo "== $program"
	"$program" >"$output/all" 2>&1
	code=$?
	grep -a -E "$summary" "$output/all" | grep -a -v 'Running' >"$output/summary"
	grep -a -v -x -F -f "$output/summary" "$output/all"
	cat "$output/summary" >>"$output/summaries"
	if [ "$code" -ne 0 ]; then
		failed="$failed $program (exit code $code)"
	elif [ ! -s "$output/summary" ]; then
		failed="$failed $program (left before its tests were through)"
	fi
done

[ -z "$failed" ] || echo "run_tests: failed:$failed"
cat "$output/summaries"
[ -z "$failed" ]
