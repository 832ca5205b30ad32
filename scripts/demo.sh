#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: demo.sh STDFIT
# Makes three sample materials, fits them with all three NDFs, and shows the true parameters beside the fitted ones.
set -eu

stdfit=${1:?usage: demo.sh STDFIT}
case $stdfit in
*/*) stdfit=$(cd "$(dirname "$stdfit")" && pwd)/$(basename "$stdfit") ;;
esac
directory=$(mktemp -d)
trap 'rm -rf "$directory"' EXIT
trap 'exit 130' INT TERM
cd "$directory"

# make_material NAME SIGMA GAMMA IOR KD KS [OPTION]...: an STD material; its parameters go to true.csv.
make_material() {
	name=$1 sigma=$2 gamma=$3 ior=$4 kd=$5 ks=$6
	shift 6
	"$stdfit" synth "$name.binary" --ndf std --sigma "$sigma" --gamma "$gamma" --ior "$ior" --kd "$kd" --ks "$ks" "$@"
	echo "$name,$kd,$ks,$sigma,$gamma,$ior" >>true.csv
}

echo 'Three materials: a rough metal, a plastic, and a fabric measured with 10 % noise.'
echo
make_material metal 0.25 1.9 20 0.02,0.015,0.005 0.95,0.7,0.3
make_material plastic 0.08 3 1.5 0.35,0.04,0.03 0.9,0.9,0.9
make_material fabric 0.6 inf 1.6 0.2,0.15,0.4 0.5,0.5,0.5 --noise 0.1

"$stdfit" fit . --table -q -o fits.csv

echo
echo 'What was put in, and what the STD fit got back:'
echo
awk -F, '
NR == FNR {
	for (i = 2; i <= 10; i++)
		truth[$1, i] = $i
	next
}
FNR == 1 {
	for (i = 1; i <= NF; i++)
		column[$i] = i
	split("kd_r kd_g kd_b ks_r ks_g ks_b sigma gamma ior", name, " ")
	printf "%-8s %-8s", "material", ""
	for (i = 1; i <= 9; i++)
		printf " %7s", name[i]
	print ""
}
$column["ndf"] == "std" {
	printf "%-8s %-8s", $1, "put in"
	for (i = 1; i <= 9; i++)
		printf " %7s", truth[$1, i + 1]
	printf "\n%-8s %-8s", "", "got back"
	for (i = 1; i <= 9; i++)
		printf " %7.4g", $column[name[i]]
	print ""
}' true.csv fits.csv
