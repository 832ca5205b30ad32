#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: run_tests.sh BUILD PROGRAM...
# Runs every test program and shows what each printed; then one line that sums up and names what was skipped and why; last,
# cmocka's summaries of all. Fails if a test failed, a program crashed, or a test was skipped without a reason.
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
: >"$output/reasons"
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
	# check.h: skip_for_want_of(), skip_because(). A test that is skipped otherwise needs nothing but the repository.
	grep -a -E '^skipped (for want of|because) ' "$output/all" >"$output/why"
	cat "$output/why" >>"$output/reasons"
	[ "$(grep -a '^\[  SKIPPED \] [^0-9]' "$output/all" | sort -u | wc -l)" -le "$(wc -l <"$output/why")" ] ||
		failed="$failed $program (a test was skipped without a reason)"
done

[ -z "$failed" ] || echo "run_tests: failed:$failed"
awk '/ run\.$/ { run += $2 } /PASSED/ { passed += $4 } END { printf "run_tests: %d tests run, %d passed", run, passed }' "$output/summaries"
sort "$output/reasons" | uniq -c | awk '
{
	n = $1
	sub(/^ *[0-9]+ skipped /, "")
	total += n
	why = why (NR == 1 ? "" : ", ") n " " $0
}
END { print total ? "; " total " skipped: " why : "; none skipped" }'
cat "$output/summaries"
[ -z "$failed" ]
