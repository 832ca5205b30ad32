#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: figures.sh BUILD
# Makes the figures of the STD paper in BUILD/figures, each as CSV and PNG. Fig. 11 shows the fits in the file $FITS,
# the CSV of an earlier `stdfit fit`; or else fits every file of the directory $MERL; or else a few synthetic tables.
set -eu

build=${1:?usage: figures.sh BUILD}
out=$build/figures
mkdir -p "$out"
out=$(cd "$out" && pwd)
stdfit=$(cd "$build" && pwd)/stdfit
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
export LC_ALL=C.UTF-8

say() {
	echo "figures.sh: $1" >&2
}

# synth NAME OPTION...: a table such as a measurement might give it.
synth() {
	name=$1
	shift
	"$stdfit" synth "$work/$name.binary" --kd 0.2,0.1,0.05 --noise 0.1 "$@"
}

make_tables() {
	synth std-1.7 --sigma 0.3 --gamma 1.7 --ks 0.8,0.7,0.5
	synth std-4 --sigma 0.15 --gamma 4 --ks 0.5,0.5,0.5
	synth ggx-correlated --ndf ggx --gaf correlated --sigma 0.1 --ks 0.4,0.4,0.4
	synth beckmann-conductor --ndf beckmann --fresnel conductor --ior 1.2 --k 4 --sigma 0.2 --ks 0.9,0.6,0.3
	synth gtr-1.5 --ndf gtr --sigma 0.05 --gamma 1.5 --ks 0.6,0.6,0.6
	synth low-1.2 --ndf low --gaf v-groove --sigma 0.1 --gamma 1.2 --ks 0.5,0.5,0.5
}

# fit FILE OPTION...: goes on with what could be fitted when some file could not.
fit() {
	file=$1
	shift
	status=0
	rm -f "$file"
	"$stdfit" fit -q -o "$file" "$@" || status=$?
	[ $status -le 1 ] || exit $status
	[ -s "$file" ] || { say 'nothing was fitted'; exit 1; }
}

# The paper uses low with the V-groove G; here it is fitted with Smith's G, too.
fit_all() {
	fit "$out/fig11_fits.csv" --ndf std,ggx,beckmann,low "$1"
	fit "$out/fig11_fits_v_groove.csv" --ndf low --gaf v-groove "$1"
	tabulate "$out/fig11_fits.csv" "$out/fig11_fits_v_groove.csv"
}

# tabulate FITS.csv...: one row a material, in order of the error of STD, one column an NDF, and G unless
# it is the default; empty where there is no fit.
tabulate() {
	awk -F, '
	# Takes the first field of the line off; RFC 4180.
	function next_field(   field, end) {
		if ($0 !~ /^"/) {
			end = index($0 ",", ",")
			field = substr($0, 1, end - 1)
		} else {
			match($0, /^"([^"]|"")*"/)
			end = RLENGTH + 1
			field = substr($0, 2, RLENGTH - 2)
			gsub(/""/, "\"", field)
		}
		$0 = substr($0, end + 1)
		return field
	}
	FNR == 1 {
		if ($0 !~ /^material,ndf,error,.*,gaf,/) {
			print "figures.sh: \"" FILENAME "\" is no result of stdfit fit" >"/dev/stderr"
			exit failed = 1
		}
		n_fields = NF
		for (k = 1; k <= NF; k++)
			header[k] = $k
		next
	}
	{
		for (k = 1; k <= n_fields; k++)
			value[header[k]] = next_field()
		if (value["error"] !~ /^[0-9]/)
			next
		material = value["material"]
		gsub(/[^A-Za-z0-9 .+-]/, "_", material)
		ndf = value["ndf"] (value["gaf"] == "uncorrelated" ? "" : "/" value["gaf"])
		if (!(ndf in known)) {
			known[ndf]
			ndfs[++n_ndfs] = ndf
		}
		if (!(material in seen)) {
			seen[material]
			order[++n] = material
		}
		error[material, ndf] = value["error"]
	}
	function rank(m) {
		return ((m, "std") in error) ? error[m, "std"] : 1e9
	}
	END {
		if (failed)
			exit 1
		for (i = 2; i <= n; i++) {
			m = order[i]
			for (j = i; j > 1 && rank(order[j - 1]) > rank(m); j--)
				order[j] = order[j - 1]
			order[j] = m
		}
		printf "material"
		for (k = 1; k <= n_ndfs; k++)
			printf ",%s", ndfs[k]
		print ""
		for (i = 1; i <= n; i++) {
			printf "%s", order[i]
			for (k = 1; k <= n_ndfs; k++)
				printf ",%s", error[order[i], ndfs[k]]
			print ""
		}
	}' "$@" >"$work/errors.csv"
	[ "$(wc -l <"$work/errors.csv")" -gt 1 ] || { say 'no fits to show'; exit 1; }
	mv -f "$work/errors.csv" "$out/fig11_errors.csv"
}

# How often each of the others has a lower error than STD, for the summary.
count_below_std() {
	awk -F, '
	NR == 1 {
		for (k = 2; k <= NF; k++) {
			name[k] = $k
			if ($k == "std")
				std = k
		}
		next
	}
	std && $std != "" {
		for (k = 2; k <= NF; k++)
			if (k != std && $k != "") {
				n[k]++
				below[k] += $k + 0 < $std + 0
			}
	}
	END {
		for (k = 2; k in name; k++)
			if (n[k])
				printf "11,materials of %d whose error is lower with %s than with std,%d,%s\n", n[k],
				       name[k], below[k],
				       name[k] ~ /^low/ ? "some" : name[k] ~ /^(ggx|beckmann)$/ ? "0" : ""
	}' "$out/fig11_errors.csv" >>"$out/summary.csv"
}

[ -z "${FITS:-}" ] || [ -r "$FITS" ] || { say "cannot read '$FITS'"; exit 1; }
[ -z "${MERL:-}" ] || [ -d "$MERL" ] || { say "'$MERL' is no directory"; exit 1; }
"$build/tests/figures" "$out"
if [ -n "${FITS:-}" ]; then
	source="the fits of $(basename "$FITS")"
	tabulate "$FITS"
elif [ -n "${MERL:-}" ]; then
	source="the files of $(basename "$MERL")"
	fit_all "$MERL"
else
	source='synthetic tables with 10 % noise, not measured materials'
	say "Fig. 11 is made from $source; for measured ones: make figures MERL=DIR"
	make_tables
	fit_all "$work"
fi
count_below_std
awk -F, '{ printf "%-7s %-70s %10s  %s\n", $1, $2, $3, $4 }' "$out/summary.csv"

if ! command -v gnuplot >/dev/null; then
	say "gnuplot is not installed (on Debian: apt install gnuplot-nox): the CSV files are in $out, no PNG was drawn"
	exit 1
fi
FIGURES=$out DRAWINGS=$work SOURCE=$source gnuplot "$(dirname "$0")/figures.gp"
mv -f "$work"/fig*.png "$out"
echo "Written to $out: $(cd "$out" && echo *.png *.csv)"
