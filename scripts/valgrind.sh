#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: valgrind.sh STDFIT
# Runs a few small commands under valgrind, which is slow. Fails at the first invalid or uninitialised access, and if
# memory is not freed at the end, even if it is still reachable; only the OpenMP runtime may keep some.
set -eu

stdfit=$(cd "$(dirname "${1:?usage: valgrind.sh STDFIT}")" && pwd)/$(basename "$1")
suppressions=$(cd "$(dirname "$0")/../tests" && pwd)/valgrind.supp
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
cd "$work"

# check CODE ARGUMENT...: runs the program, which must end with CODE.
check() {
	want=$1
	shift
	echo "valgrind: stdfit $*" >&2
	code=0
	valgrind --quiet --num-callers=40 --error-exitcode=99 --leak-check=full --show-leak-kinds=all --errors-for-leak-kinds=all \
		--suppressions="$suppressions" "$stdfit" "$@" >out 2>err || code=$?
	[ "$code" -eq "$want" ] || {
		cat err >&2
		echo "valgrind.sh: stdfit $*: exit code $code, expected $want" >&2
		exit 1
	}
}

# Under valgrind one thread runs at a time: those that wait should sleep.
export OMP_WAIT_POLICY=passive
cheap='--sigma 0.3 --ior 1.5 --max-theta 15 --threads 2'
check 0 synth a.binary --sigma 0.3 --gamma 2.5 --ks 0.5 --kd 0.2 --threads 2
: >broken.binary
# shellcheck disable=SC2086 # a list of words
{
	check 0 fit a.binary --ndf std,ggx,beckmann --gamma 2.5 -q -o fits.csv $cheap
	check 1 fit a.binary broken.binary missing.binary --ndf std,ggx,beckmann --gamma 2.5 --resume -o fits.csv $cheap
	check 0 fit a.binary --ndf gtr,low,hyper-cauchy --gamma 2 --json -q $cheap
	check 0 fit a.binary --ndf ggx --within 5% -q $cheap
	check 0 compare fits.csv --table
	check 0 eval a.binary --from fits.csv --ndf std --threads 2
	check 0 info a.binary
	check 0 bench a.binary --algorithm crs2 --time 0.1 --trace trace.csv $cheap
	check 2 fit --sigma nonsense a.binary
	check 0 --help
}
