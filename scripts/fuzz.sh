#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: fuzz.sh BUILD SECONDS TARGET...
# Runs each fuzz target for so many seconds, from its corpus below tests/corpus/. New inputs that cover more go to
# BUILD/corpus/TARGET/, what fails to BUILD/TARGET-crash-* and the like. Fails if anything did.
set -u

build=$1
seconds=$2
shift 2
failed=
for target; do
	name=${target#fuzz_}
	mkdir -p "$build/corpus/$name"
	echo "== $target, $seconds s"
	# Freed memory need not be kept for long: a table is 18 MB.
	ASAN_OPTIONS=quarantine_size_mb=16 "$build/tests/$target" -max_total_time="$seconds" -timeout=100 \
		-rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="$build/$target-" \
		"$build/corpus/$name" "tests/corpus/$name" 2>"$build/$target.log" || failed="$failed $target"
	# The last line of progress shows coverage (features: ft) and speed.
	grep -aE 'cov: ' "$build/$target.log" | tail -n 1
	grep -aE '^stat::(number_of_executed_units|peak_rss_mb)|ERROR|broken promise|runtime error' "$build/$target.log"
done
[ -z "$failed" ] || { echo "fuzz: findings:$failed; see $build/fuzz_*.log" >&2; exit 1; }
