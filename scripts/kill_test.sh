#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: kill_test.sh STDFIT [KILLS [SEED]]
# Kills a batch with SIGKILL at random moments and resumes it each time, until it has been killed KILLS times (200)
# and come to its end. The table must then be that of an undisturbed run, `seconds` aside; rows that were finished must
# never be made again or get lost. A batch that ends before it is killed begins anew. Then half as many kills of a batch
# that replaces an older table: that is there still, under its name or as the backup. Works in a temporary directory.
set -u

stdfit=$(realpath "$1") || exit 1
kills=${2:-200}
seed=${3:-$$}
fit='--ndf ggx,beckmann --max-theta 20 --sigma 0.2 --quiet'

directory=$(mktemp -d) || exit 1
trap 'rm -rf "$directory"' EXIT
trap 'exit 130' INT TERM
cd "$directory" || exit 1

fail() {
	echo "kill_test: $* (kill $n, seed $seed)" >&2
	exit 1
}

# A number from 0 to $1 - 1: a linear congruential generator's upper bits.
random() {
	state=$(((state * 1103515245 + 12345) % 2147483648))
	random=$((state / 65536 % $1))
}

# The table without `seconds`; the cells of the columns behind it hold no comma here.
without_seconds() {
	behind=$(head -n 1 "$1" | sed 's/.*,seconds//' | tr -cd , | wc -c)
	sed 's/,[^,]*\(\(,[^,]*\)\{'"$behind"'\}\)$/\1/' "$1"
}

# Files of 33 MB: two that differ, under five names.
mkdir files
"$stdfit" synth files/a.binary --ndf ggx --sigma 0.2 --ior 1.5 --kd 0.3,0.2,0.1 --ks 0.5 &&
	"$stdfit" synth files/b.binary --ndf std --gamma 2 --sigma 0.3 --ior 1.4 --kd 0.1 --ks 0.9 &&
	ln files/a.binary files/c.binary && ln files/b.binary files/d.binary && ln files/a.binary files/e.binary ||
	exit 1

state=$seed n=0 ends=0 torn=0 temporary=0
start=$(date +%s%N)
# shellcheck disable=SC2086 # a list of words
"$stdfit" files $fit -o whole.csv || exit 1
length=$((($(date +%s%N) - start) / 1000000 + 1)) # of a whole run, in ms
without_seconds whole.csv >whole
: >finished

while [ "$n" -lt "$kills" ]; do
	random $((length + length / 4))
	# shellcheck disable=SC2086
	timeout -s KILL "$((random / 1000)).$(printf '%03d' $((random % 1000)))" \
		"$stdfit" files $fit --resume -o cut.csv 2>/dev/null
	code=$?
	if [ "$code" -eq 0 ]; then
		# It ended before it could be killed.
		ends=$((ends + 1)) length=$((length * 3 / 4 + 1))
		without_seconds cut.csv | cmp -s - whole || fail 'the table differs'
		rm -f cut.csv cut.csv~
		: >finished
		continue
	fi
	[ "$code" -eq 137 ] || fail "exit code $code"
	n=$((n + 1)) length=$((length + length / 16 + 1)) # a machine is now faster, now slower
	for file in .stdfit-*.tmp; do
		[ ! -e "$file" ] || temporary=$((temporary + 1))
	done
	rm -f .stdfit-*.tmp
	[ -e cut.csv ] || : >cut.csv
	[ -z "$(tail -c 1 cut.csv)" ] || torn=$((torn + 1))
	# Every whole row is still there, with the seconds it had: it was neither lost nor made again.
	grep -v '^material,' cut.csv >rows
	while IFS= read -r row; do
		grep -q -x -F -e "$row" rows || fail "a finished row is gone: $row"
	done <finished
	head -n "$(wc -l <rows)" rows >finished
done
# shellcheck disable=SC2086
"$stdfit" files $fit --resume -o cut.csv || fail "the last run failed"
without_seconds cut.csv | cmp -s - whole || fail 'the table differs in the end'
[ ! -e cut.csv~ ] || fail 'there are rows that were made again'

n=0 replaced=0
sed 's/,ggx,/,old,/' whole.csv >old.csv
while [ "$n" -lt $((kills / 2)) ]; do
	rm -f new.csv new.csv~ .stdfit-*.tmp
	cp old.csv new.csv
	random "$length"
	# shellcheck disable=SC2086
	timeout -s KILL "$((random / 1000)).$(printf '%03d' $((random % 1000)))" \
		"$stdfit" files $fit -o new.csv 2>/dev/null
	code=$? n=$((n + 1))
	[ "$code" -eq 137 ] || [ "$code" -eq 0 ] || fail "exit code $code"
	[ -e new.csv ] || fail 'the table is gone'
	cmp -s new.csv old.csv && continue
	replaced=$((replaced + 1))
	cmp -s new.csv~ old.csv || fail 'the older table is lost'
	[ "$(grep -c '^material,' new.csv)" -eq 1 ] || fail 'the new table has not one header'
done
n=$kills
echo "kill_test: $n kills; the batch ended $((ends + 1)) times, each time with the same table;" \
	"$torn torn rows cut off, $temporary temporary files left behind;" \
	"then $((kills / 2)) older tables to be replaced, $replaced of them were, none lost (seed $seed)"
