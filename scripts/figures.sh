#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: figures.sh BUILD
# Makes the figures and tables of the five papers in BUILD/figures, as CSV and PNG, named as in docs/papers.md. S3's
# Fig. 11 shows the fits in the file $FITS, the CSV of an earlier `stdfit fit`; or else fits every file of the directory
# $MERL; or else a few synthetic tables.
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
	fit "$out/s3_fig11_fits.csv" --ndf std,ggx,beckmann,low "$1"
	fit "$out/s3_fig11_fits_v_groove.csv" --ndf low --gaf v-groove "$1"
	tabulate "$out/s3_fig11_fits.csv" "$out/s3_fig11_fits_v_groove.csv"
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
	mv -f "$work/errors.csv" "$out/s3_fig11.csv"
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
				printf "S3 11,materials of %d whose error is lower with %s than with std,%d,%s\n", n[k],
				       name[k], below[k],
				       name[k] ~ /^low/ ? "some" : name[k] ~ /^(ggx|beckmann)$/ ? "0" : ""
	}' "$out/s3_fig11.csv" >>"$out/summary.csv"
}

# curves FILE NDF SIGMA GAMMA...: D, P22 and G1 against the polar angle, added to FILE.
curves() {
	file=$out/$1 ndf=$2 sigma=$3
	shift 3
	[ -s "$file" ] || echo 'ndf,sigma,gamma,theta_deg,D,P22,G1' >"$file"
	for gamma; do
		"$stdfit" ndf "$ndf" --sigma "$sigma" --gamma "$gamma" --theta 0:89.5:0.5 | columns theta D P22 G1 |
			sed "s/^/$ndf,$sigma,$gamma,/"
	done >>"$file"
}

# columns NAME...: those columns of the CSV on standard input, without its header.
columns() {
	awk -F, -v names="$*" '
	NR == 1 { n = split(names, name, " "); for (i = 1; i <= NF; i++) at[$i] = i; next }
	{ for (k = 1; k <= n; k++) printf "%s%s", $at[name[k]], k < n ? "," : "\n" }'
}

# S1's Figs 1 and 3: two tables of random values, and both blended.
piecewise() {
	awk 'function uniform() { x = x * 16807 % 2147483647; return x / 2147483647 }
	BEGIN {
		x = 2017
		print "theta,Dx,Dy"
		for (i = 0; i <= 12; i++) {
			Dx = uniform()
			print 7.5 * i "," Dx "," uniform()
		}
	}' >"$work/both.csv"
	for k in 2 3; do
		cut -d, -f1,$k "$work/both.csv" | sed '1s/D./D/' >"$work/$k.csv"
		"$stdfit" ndf pl --nodes "$work/$k.csv" --theta 0:90:7.5 | columns D >"$work/$k.D"
	done
	{
		echo theta_deg,Dx,Dy
		sed 1d "$work/both.csv" | cut -d, -f1 | paste -d, - "$work/2.D" "$work/3.D"
	} >"$out/s1_fig1.csv"
	{
		echo phi_deg,cdf
		"$stdfit" ndf pl --nodes "$work/both.csv" --theta 45 --phi 0:360:2 | columns phi cdf_phi
	} >"$out/s1_fig1_cdf.csv"
	echo kind,phi_deg,theta_deg,G1,trapezoids >"$out/s1_fig3.csv"
	for kind in isotropic anisotropic; do
		nodes=$work/both.csv
		[ $kind = anisotropic ] || nodes=$work/2.csv
		"$stdfit" ndf pl --nodes "$nodes" --theta 0:89.5:0.5 --phi 0:90:45 --lambda trapezoid | columns G1 >"$work/rough"
		"$stdfit" ndf pl --nodes "$nodes" --theta 0:89.5:0.5 --phi 0:90:45 | columns phi theta G1 |
			paste -d, - "$work/rough" | sed "s/^/$kind,/"
	done >>"$out/s1_fig3.csv"
	awk -F, '
	function size(x) { return x < 0 ? -x : x }
	FNR == 1 { file++; next }
	file == 1 { d = size($2 - $1 / 360); if (d > wave) wave = d; next }
	{ d = 100 * size($5 / $4 - 1); if (d > worst[$1]) worst[$1] = d }
	END {
		printf "S1 1,largest distance of the CDF of the azimuth from a straight line,%.3g,close to linear\n", wave
		for (kind in worst)
			printf "S1 3,largest error of G1 by trapezoids of 12 random segments in %% (%s),%.3g,\n", kind, worst[kind]
	}' "$out/s1_fig1_cdf.csv" "$out/s1_fig3.csv" | sort >>"$out/summary.csv"
}

# S0's Table 1, sigma 0.5 and along y 0.2: what its formulas are held against.
table_1() {
	for gamma in 2 2.5 3 3.5 4 inf; do
		"$stdfit" ndf std --sigma 0.5,0.2 --gamma $gamma --theta 5:85:5 --phi 30 | columns D >"$work/anisotropic"
		"$stdfit" ndf std --sigma 0.5 --gamma $gamma --theta 5:85:5 | columns theta D G1 |
			paste -d, - "$work/anisotropic" | sed "s/^/$gamma,/"
	done >"$work/table_1.csv"
	FILE=$work/table_1.csv gnuplot "$(dirname "$0")/figures_table.gp" >"$out/s0_table1.csv"
	awk -F, '
	NR > 1 { if ($2 == "Lambda as printed") printed = $3; else if ($3 > worst) worst = $3 }
	END {
		printf "S0 T1,largest difference of D (relative) and G1 from the closed forms,%.3g,equal\n", worst
		printf "S0 T1,the same of Lambda of 7/2 as printed,%.3g,equal\n", printed
	}' "$out/s0_table1.csv" >>"$out/summary.csv"
}

# fitted_spheres FILE...: at most three of them, and how they differ from their fits.
fitted_spheres() {
	[ -e "$1" ] || return 0
	while [ $# -gt 3 ]; do
		shift
	done
	"$stdfit" render -q "$@" --from "$out/s3_fig11_fits.csv" --ndf ggx,beckmann,std --weight none --difference --size 128 \
		-o "$work/s3_fig11_spheres.png" >"$out/s3_fig11_spheres.csv"
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
	fitted_spheres "$MERL"/*.binary
else
	source='synthetic tables with 10 % noise, not measured materials'
	say "Fig. 11 is made from $source; for measured ones: make figures MERL=DIR"
	make_tables
	fit_all "$work"
	fitted_spheres "$work"/*.binary
fi
count_below_std
rm -f "$out/s3_fig3.csv" "$out/s0_fig1.csv"
for sigma in 0.1 0.3 1; do
	curves s3_fig3.csv std $sigma 1.51 1.65 2 4 10 40 50 inf
done
curves s0_fig1.csv std 0.3 1.51 1.65 2 4 10 50
curves s0_fig1.csv hyper-cauchy 0.3 1.51 1.65 2 4 10 50
piecewise
scripts=$(dirname "$0")
"$scripts/figures_spheres.sh" "$stdfit" "$out"
drawn=
if command -v gnuplot >/dev/null; then
	table_1
	FIGURES=$out DRAWINGS=$work gnuplot "$scripts/figures_spheres.gp"
	FIGURES=$out DRAWINGS=$work SOURCE=$source gnuplot "$scripts/figures.gp"
	rm -f "$work/s3_fig1_spheres.png"
	mv -f "$work"/s[0-4]_*.png "$out"
	rm -f "$out"/*.cells "$out"/*.labels
	drawn=yes
fi
awk -F, '{ printf "%-6s %-95s %10s  %s\n", $1, $2, $3, $4 }' "$out/summary.csv"
echo "Written to $out: $(cd "$out" && echo *.png *.csv)"
[ "$drawn" ] || {
	say "gnuplot is not installed (on Debian: apt install gnuplot-nox): the CSV files are in $out, no PNG was drawn"
	exit 1
}
