#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: export_table.sh STDFIT FITS.csv [FORMAT...]
# Exports the STD rows of a result table, whose files have to be there, in each format (all by default), and prints a CSV:
# size of the file, E of what stands there under each weight, delta E and SSIM of its sphere, all against the measurement;
# of the model itself as the format `model`, from the header of its Mitsuba export. Where a format has the model itself
# these cells are empty: they are the model's. `bsdf` has one more, its L1 error against the model in percent.
set -eu
export LC_ALL=C

stdfit=${1:?usage: export_table.sh STDFIT FITS.csv [FORMAT...]}
fits=${2:?usage: export_table.sh STDFIT FITS.csv [FORMAT...]}
shift 2
[ $# -gt 0 ] || set -- brdf merl bsdf mitsuba pbrt gltf materialx
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The numbers of a header: `before` or `after` of each pair.
numbers() {
	awk -v which="$1" '
		function pair(text, after, n) {
			n = match(text, after) ? substr(text, RSTART + RLENGTH) : ""
			sub(/[^-0-9.e+].*/, "", n)
			return n
		}
		/error of the model / && /weight/ {
			line = $0
			w = line; sub(/.*\(weight /, "", w); sub(/[,)].*/, "", w)
			E["before", w] = pair(line, "error of the model ")
			E["after", w] = pair(line, "of what stands here ")
			while (match(line, /; weight [a-z-]*: /)) {
				v = substr(line, RSTART + 9, RLENGTH - 11)
				line = substr(line, RSTART + RLENGTH)
				E["before", v] = pair(line, "^")
				rest = line; sub(/^[^ ]* /, "", rest)
				E["after", v] = pair(rest, "^")
			}
		}
		/spheres in studio light/ {
			dE["before"] = pair($0, "delta E of the model ")
			dE["after"] = pair($0, "of what stands here ")
			S["before"] = pair($0, "SSIM ")
			S["after"] = pair($0, "SSIM [0-9.]*, ")
		}
		END {
			printf "%s,%s,%s,%s,%s", E[which, "none"], E[which, "cosine"], E[which, "solid-angle"], dE[which],
				S[which]
		}' "$2"
}

echo material,format,bytes,error_none,error_cosine,error_solid_angle,delta_e,ssim,l1_percent
"$stdfit" merge "$fits" --json -o - 2>/dev/null |
	sed -n 's/.*"ndf": "std".*"path": "\([^"]*\)".*/\1/p' >"$work/paths"
while read -r path; do
	name=$(basename "$path" .binary)
	for format in "$@"; do
		out=$work/out.$format
		l1=
		if ! "$stdfit" export "$path" --from "$fits" --ndf std --format "$format" -o "$out" 2>"$work/told"; then
			echo "$name,$format,refused,,,,,,"
			continue
		fi
		if [ "$format" = bsdf ]; then
			l1=$(sed -n 's/.*error against the model \([0-9.]*\) %.*/\1/p' "$work/told")
		fi
		case $format in
		mitsuba | pbrt | gltf | materialx)
			head -c 4000 "$out" >"$work/header"
			[ "$format" != mitsuba ] || echo "$name,model,,$(numbers before "$work/header"),"
			;;
		*) : >"$work/header" ;;
		esac
		echo "$name,$format,$(($(wc -c <"$out"))),$(numbers after "$work/header"),$l1"
		rm -f "$out"
	done
done <"$work/paths"
