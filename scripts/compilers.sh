#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: compilers.sh BUILD
# Do the compilers agree? Builds stdfit with gcc and clang, without and with optimisation, without and with AVX2 where
# the machine has it; each build fits the same tables, and its parameters are evaluated by every other. Prints the worst
# differences, of an error as a fraction of it; fails if one exceeds $TOLERANCE (1e-6). The tables are synthetic, or the
# *.binary of the directory $MERL; $OPTIONS are further options of the fits.
set -eu

build=${1:?usage: compilers.sh BUILD}/compilers
tolerance=${TOLERANCE:-1e-6}
ndfs=std,ggx,beckmann
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
export LC_ALL=C

avx2=no
grep -q -w avx2 /proc/cpuinfo 2>/dev/null && avx2='no yes'
builds=
for compiler in gcc clang; do
	for level in -O0 -O3; do
		for vectors in $avx2; do
			name=$compiler$level-avx2-$vectors
			"${MAKE:-make}" --no-print-directory CC="${CCACHE:+$CCACHE }$compiler" CFLAGS=$level AVX2="$vectors" \
				BUILD="$build/$name" "$build/$name/stdfit" >&2
			builds="$builds $name"
		done
	done
done
first=${builds# }
first=$build/${first%% *}/stdfit

tables=${MERL:-$work/tables}
if [ -z "${MERL:-}" ]; then
	mkdir "$tables"
	"$first" synth "$tables/metal.binary" --sigma 0.2 --gamma 1.8 --ior 15 --ks 0.9,0.6,0.3 --noise 0.1
	"$first" synth "$tables/plastic.binary" --ndf ggx --sigma 0.06 --ks 0.8 --kd 0.3,0.1,0.05 --noise 0.1 --seed 1
	"$first" synth "$tables/cloth.binary" --ndf beckmann --sigma 0.5 --ks 0.4 --kd 0.1,0.2,0.3 --noise 0.3 --seed 2
fi

for name in $builds; do
	echo "compilers.sh: $name fits" >&2
	# shellcheck disable=SC2086 # a list of words
	"$build/$name/stdfit" fit "$tables" --ndf "$ndfs" -q -o "$work/$name.csv" ${OPTIONS:-}
done

for own in $builds; do
	for other in $builds; do
		[ "$own" != "$other" ] || continue
		for table in "$tables"/*.binary; do
			material=$(basename "$table" .binary)
			"$build/$other/stdfit" eval "$table" --from "$work/$own.csv" |
				awk -F, -v head="$material,$own,$other" '
				NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
				{ print head "," $column["ndf"] "," $column["error_none"] }' >>"$work/evaluated.csv"
		done
	done
	awk -F, -v build="$own" '
		NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
		{ print $1 "," build "," $column["ndf"] "," $column["error_none"] "," $column["evaluations"] }' \
		"$work/$own.csv" >>"$work/fitted.csv"
done

awk -F, -v tolerance="$tolerance" '
function apart(a, b) {
	return a == b ? 0 : (a > b ? a - b : b - a) / (b > 0 ? b : 1e-300)
}
function record(kind, difference, what) {
	n[kind]++
	if (!(difference <= worst[kind])) {
		worst[kind] = difference
		of[kind] = what
	}
}
NR == FNR {
	fitted[$1, $2, $3] = $4
	if (!(($1, $3) in least) || $4 < least[$1, $3])
		least[$1, $3] = $4
	builds[$2]
	next
}
{ record("evaluated", apart($5, fitted[$1, $2, $4]), $1 " " $4 ", fitted by " $2 ", evaluated by " $3) }
END {
	for (key in fitted) {
		split(key, k, SUBSEP)
		record("fitted", apart(fitted[key], least[k[1], k[3]]), k[1] " " k[3] ", " k[2] " above the best build")
	}
	for (kind in n) {
		printf "%-10s %6d errors, worst difference %.3g%s\n", kind, n[kind], worst[kind],
		       of[kind] == "" ? "" : ": " of[kind]
		if (!(worst[kind] <= tolerance))
			failed = 1
	}
	exit failed || !n["fitted"] || !n["evaluated"]
}' "$work/fitted.csv" "$work/evaluated.csv"
