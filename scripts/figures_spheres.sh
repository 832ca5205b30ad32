#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: figures_spheres.sh STDFIT OUT
# Renders the pictures of the papers' figures: spheres of given models in our own light. For each figure it writes
# OUT/NAME.cells, the pixels of all spheres where they stand (x y red green blue, sRGB; two empty lines after a sphere),
# and OUT/NAME.labels, commands of gnuplot; figures_spheres.gp draws them. What they come to goes to OUT/summary.csv.
set -eu

stdfit=${1:?usage: figures_spheres.sh STDFIT OUT}
out=${2:?usage: figures_spheres.sh STDFIT OUT}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
export LC_ALL=C

size=112 samples=64
gammas='1.51 1.65 2 4 10 50'

found() {
	echo "$1,$2,$3,$4" >>"$out/summary.csv"
}

# sphere NAME OPTION...: renders one sphere into $work/NAME, a line of red green blue for each pixel, from the top. The
# picture's frame is cut off.
sphere() {
	name=$1
	shift
	"$stdfit" render -q --size $size --samples $samples -o "$work/$name.pfm" "$@"
	od -An -v -tf4 -w12 -j "$(head -n 3 "$work/$name.pfm" | wc -c)" "$work/$name.pfm" |
		awk -v size=$size '
		{ x = (NR - 1) % (size + 8); y = int((NR - 1) / (size + 8)) }
		x >= 4 && x < size + 4 && y >= 4 && y < size + 4 { row[y] = row[y] $0 "\n" }
		END { for (y = size + 3; y >= 4; y--) printf "%s", row[y] }' >"$work/$name"
}

# The options of facets of a metal, with n and k of red, green and blue light (about 650, 550 and 450 nm): F by its
# values along the normal and at 82 degrees, which is within 0.033 of the exact one.
metal() {
	awk -v n="$1" -v k="$2" '
	function F(c, n, k,   s2, t, a2b2, a, r_s, r_p) {
		s2 = 1 - c * c
		t = n * n - k * k - s2
		a2b2 = sqrt(t * t + 4 * n * n * k * k)
		a = sqrt((a2b2 + t) / 2)
		r_s = (a2b2 + c * c - 2 * a * c) / (a2b2 + c * c + 2 * a * c)
		r_p = r_s * (c * c * a2b2 + s2 * s2 - 2 * a * c * s2) / (c * c * a2b2 + s2 * s2 + 2 * a * c * s2)
		return (r_s + r_p) / 2
	}
	BEGIN {
		split(n, ns, ",")
		split(k, ks, ",")
		for (i = 1; i <= 3; i++) {
			f0 = f0 (i > 1 ? "," : "") F(1, ns[i], ks[i])
			f82 = f82 (i > 1 ? "," : "") F(1 / 7, ns[i], ks[i])
		}
		print "--fresnel f82 --ks 1 --f0", f0, "--f82", f82
	}'
}
gold=$(metal 0.143,0.375,1.442 3.983,2.386,1.603)
aluminium=$(metal 1.657,0.880,0.521 9.224,6.270,4.837)
copper=$(metal 0.200,0.924,1.102 3.912,2.452,2.142)
plastic='--kd 0.1,0.25,0.5 --ks 1 --ior 1.5'
diamond='--transmission --ior 2.4'
glass='--transmission --ior 1.5'

# begin_sheet NAME [COLUMN]: where the spheres begin, counted from 0.
begin_sheet() {
	sheet=$1 first_column=${2:-0}
	: >"$out/$sheet.cells"
	: >"$out/$sheet.labels"
}

# label X Y TEXT: under the sphere in this column and row, or above it for row 0.
label() {
	x=$((($1 - 1) * (size + 8) + size / 2 + 4)) y=$(($2 * (size + 24) + 10))
	echo "set label \"$3\" at $x,$y center tc rgb \"#dddddd\" noenhanced front" >>"$out/$sheet.labels"
}

# name_row ROW TEXT: at the left of the spheres.
name_row() {
	echo "set label \"$2\" at 4,$((($1 - 1) * (size + 24) + 24 + size / 2)) tc rgb \"#dddddd\" noenhanced front" \
		>>"$out/$sheet.labels"
}

titles() {
	column=$first_column
	for title; do
		column=$((column + 1))
		label $column 0 "$title"
	done
}

# place COLUMN ROW TEXT: sets the pixels on standard input there, and the text below them.
place() {
	label "$1" "$2" "$3"
	awk -v size=$size -v left=$((($1 - 1) * (size + 8) + 4)) -v top=$((($2 - 1) * (size + 24) + 24)) '
	function srgb(v) {
		return v >= 1 ? 255 : v <= 0 ? 0 : 255 * (v < 0.0031308 ? 12.92 * v : 1.055 * v ^ (1 / 2.4) - 0.055)
	}
	{
		printf "%d %d %d %d %d\n", left + (NR - 1) % size, top + int((NR - 1) / size),
		       srgb($1), srgb($2), srgb($3)
		if (NR % size == 0)
			print ""
	}
	END { print "" }' >>"$out/$sheet.cells"
}

# luminance NAME: its mean over the picture.
luminance() {
	awk '{ sum += 0.2126 * $1 + 0.7152 * $2 + 0.0722 * $3 } END { printf "%.4g\n", sum / NR }' "$work/$1"
}

# rmse NAME NAME: of all values, over the mean of the second, in per cent.
rmse() {
	paste -d ' ' "$work/$1" "$work/$2" | awk '
	{ for (c = 1; c <= 3; c++) { square += ($c - $(c + 3)) ^ 2; sum += $(c + 3) } }
	END { printf "%.3g\n", 100 * sqrt(square / (3 * NR)) / (sum / (3 * NR)) }'
}

# noise NAME NAME: of two pictures that differ by their seed only, likewise; the standard deviation of normal noise that
# makes their values differ by as much on average. A few spikes would decide what squares add up to.
noise() {
	paste -d ' ' "$work/$1" "$work/$2" | awk '
	{ for (c = 1; c <= 3; c++) { d = $c - $(c + 3); distance += d < 0 ? -d : d; sum += $c + $(c + 3) } }
	END { printf "%.3g\n", 100 * sqrt(atan2(0, -1)) / 2 * distance / (sum / 2) }'
}

ratio() {
	awk -v a="$1" -v b="$2" 'BEGIN { printf "%.3g\n", a / b }'
}

# difference NAME NAME MOST: pixels, black to white, of the relative difference of luminance from 0 to MOST.
difference() {
	paste -d ' ' "$work/$1" "$work/$2" | awk -v most="$3" '
	function ramp(t, c,   i, at) { # colours of a flame, in linear light
		t = t > 1 ? 4 : 4 * t
		i = t >= 4 ? 3 : int(t)
		at = t - i
		return flame[i, c] * (1 - at) + flame[i + 1, c] * at
	}
	BEGIN {
		split("0 0 0 0.08 0.01 0.2 0.6 0.03 0.08 0.95 0.4 0.01 1 1 0.8", f, " ")
		for (i = 0; i < 5; i++)
			for (c = 1; c <= 3; c++)
				flame[i, c] = f[3 * i + c]
	}
	{
		a = 0.2126 * $1 + 0.7152 * $2 + 0.0722 * $3
		b = 0.2126 * $4 + 0.7152 * $5 + 0.0722 * $6
		t = b > 1e-3 ? (a > b ? a - b : b - a) / b / most : 0
		print ramp(t, 1), ramp(t, 2), ramp(t, 3)
	}'
}

# shellcheck disable=SC2086 # options are lists of words
# row ROW LABEL OPTION...: one sphere for each gamma; they stay as g1, g2, ...
row() {
	row=$1 text=$2
	shift 2
	column=0
	for gamma in $gammas; do
		column=$((column + 1))
		sphere g$column --ndf std --gamma "$gamma" "$@"
		place $column "$row" "$text" <"$work/g$column"
	done
}

title_gammas() {
	set --
	for gamma in $gammas; do
		set -- "$@" "γ=$gamma"
	done
	titles "$@"
}

# shellcheck disable=SC2086
appearance() {
	begin_sheet s3_fig1_spheres
	title_gammas
	row 1 'gold' --sigma 0.3 $gold
	begin_sheet s3_fig8
	title_gammas
	row 1 'gold' --sigma 0.3 $gold
	row 2 'plastic' --sigma 0.3 $plastic
	row 3 'diamond' --sigma 0.3 $diamond
	row 4 'aluminium 0.7/0.3' --sigma 0.7,0.3 $aluminium
	begin_sheet s3_fig7
	title_gammas
	row=0
	for sigma in 0.1 0.3 0.6 1; do
		row $((row + 1)) "σ=$sigma" --sigma $sigma $aluminium
		found 'S3 7' "light of the sphere of gamma 1.51 at sigma $sigma in % of that of gamma 50" \
			"$(ratio "$(luminance g1)e2" "$(luminance g6)")" darker
	done
	begin_sheet s0_fig2
	title_gammas
	row 1 'uncorrelated' --sigma 0.6 $gold
	uncorrelated=$(luminance g1)
	row 2 'correlated' --sigma 0.6 --gaf correlated $gold
	found 'S0 2' 'light of the sphere of gamma 1.51 and sigma 0.6 with correlated by that with uncorrelated G' \
		"$(ratio "$(luminance g1)" "$uncorrelated")" 'limits the darkening'
	found 'S0 2' 'the same with correlated G in % of gamma 50' "$(ratio "$(luminance g1)e2" "$(luminance g6)")" \
		'still dark'
}

# The rational form of Lambda in a picture: both forms with the same random numbers.
# shellcheck disable=SC2086
approximation() {
	begin_sheet s3_fig6
	title_gammas
	top=0 worst=0
	for sigma in 0.1 0.3 0.6; do
		column=0
		for gamma in $gammas; do
			column=$((column + 1))
			sphere exact --ndf std --sigma $sigma --gamma "$gamma" $copper
			sphere rational --ndf std --sigma $sigma --gamma "$gamma" --lambda rational $copper
			rmse=$(rmse rational exact)
			place $column $((top + 1)) "σ=$sigma, exact" <"$work/exact"
			place $column $((top + 2)) rational <"$work/rational"
			difference rational exact 0.02 >"$work/difference"
			place $column $((top + 3)) "$rmse %" <"$work/difference"
			worst=$(awk -v a="$worst" -v b="$rmse" 'BEGIN { print (a > b ? a : b) }')
		done
		top=$((top + 3))
	done
	found 'S3 6' 'largest RMSE of a sphere with the rational form in % of its mean' "$worst" 'difficult to distinguish'
}

# STD beside Beckmann, likewise; all normals are drawn, as the numbers that draw visible ones do not go together.
# shellcheck disable=SC2086
beckmann() {
	begin_sheet s3_fig10_spheres
	titles γ=30 γ=40 γ=50 γ=100
	top=0
	for sigma in 0.1 0.3 1; do
		sphere limit --ndf beckmann --sigma $sigma --sampling ndf $gold
		column=0
		for gamma in 30 40 50 100; do
			column=$((column + 1))
			sphere std --ndf std --sigma $sigma --gamma $gamma --sampling ndf $gold
			rmse=$(rmse std limit)
			place $column $((top + 1)) "σ=$sigma" <"$work/std"
			difference std limit 0.05 >"$work/difference"
			place $column $((top + 2)) "$rmse %" <"$work/difference"
			[ $gamma != 40 ] || found 'S3 10' "RMSE of a sphere of gamma 40 and sigma $sigma against Beckmann in % of its mean" \
				"$rmse" 'not visible'
		done
		top=$((top + 2))
	done
}

# noisy ROW COLUMN OPTION...: a sphere with its noise, which goes to $level, too.
noisy() {
	row=$1 column=$2
	shift 2
	sphere one --seed 1 "$@"
	sphere other --seed 2 "$@"
	level=$(noise one other)
	place "$column" "$row" "$level %" <"$work/one"
}

# Rough glass, as the supplement has it: how much noise is left of as many samples as its pictures have.
# shellcheck disable=SC2086
masked_noise() {
	size=64
	begin_sheet s0_fig3 2
	gammas='1.51 1.65 1.8 2 4'
	title_gammas
	row=0
	echo 'gamma,sampling,gaf,noise_percent' >"$out/s0_fig3.csv"
	for normals in ndf visible; do
		for gaf in uncorrelated correlated; do
			row=$((row + 1)) column=2
			name_row $row "$normals, $gaf"
			for gamma in $gammas; do
				noisy $row $((column + 1)) $glass --ndf std --sigma 0.3 --gamma "$gamma" --gaf $gaf --sampling $normals
				echo "$gamma,$normals,$gaf,$level" >>"$out/s0_fig3.csv"
			done
		done
	done
	size=112
}

# shellcheck disable=SC2086
visible_noise() {
	size=64
	begin_sheet s0_fig4 2
	titles σ=0.01 σ=0.1 σ=0.3 σ=0.6
	row=0
	echo 'ndf,sigma,sampling,noise_percent' >"$out/s0_fig4.csv"
	for ndf in beckmann ggx; do
		for normals in ndf visible; do
			row=$((row + 1)) column=2
			name_row $row "$ndf, $normals"
			for sigma in 0.01 0.1 0.3 0.6; do
				noisy $row $((column + 1)) $glass --ndf $ndf --sigma $sigma --sampling $normals
				echo "$ndf,$sigma,$normals,$level" >>"$out/s0_fig4.csv"
			done
		done
	done
	size=112
}

# shellcheck disable=SC2086
pseudo_noise() {
	size=64
	begin_sheet s0_fig5 2
	gammas='1.51 1.65 2 4 7'
	title_gammas
	row=0
	echo 'gamma,sigma,sampling,noise_percent' >"$out/s0_fig5.csv"
	for sigma in 0.1 0.5; do
		for normals in ndf pseudo visible; do
			row=$((row + 1)) column=2
			name_row $row "σ=$sigma, $normals"
			for gamma in $gammas; do
				noisy $row $((column + 1)) $glass --ndf std --sigma $sigma --gamma "$gamma" --sampling $normals
				echo "$gamma,$sigma,$normals,$level" >>"$out/s0_fig5.csv"
			done
		done
	done
	size=112
}

noise_ratios() {
	awk -F, '
	FNR == 1 { file++; next }
	file == 1 { noise["3", $2, $3, $1] = $4 }
	file == 2 { noise["4", $1, $2, $3] = $4 }
	file == 3 { noise["5", $2, $3, $1] = $4 }
	function line(figure, quantity, a, b, paper) {
		printf "S0 %s,noise of %s,%.3g,%s\n", figure, quantity, a / b, paper
	}
	END {
		line(3, "all normals with correlated by that with uncorrelated G at gamma 1.65",
		     noise["3", "ndf", "correlated", "1.65"], noise["3", "ndf", "uncorrelated", "1.65"],
		     "slightly more below 1.8")
		line(3, "visible by that of all normals at gamma 1.65", noise["3", "visible", "uncorrelated", "1.65"],
		     noise["3", "ndf", "uncorrelated", "1.65"], "should remove spikes")
		for (i = 1; i <= 2; i++) {
			ndf = i == 1 ? "beckmann" : "ggx"
			for (k = 1; k <= 4; k++) {
				sigma = k == 1 ? "0.01" : k == 2 ? "0.1" : k == 3 ? "0.3" : "0.6"
				line(4, "visible by that of all normals of " ndf " at sigma " sigma, noise["4", ndf, sigma, "visible"],
				     noise["4", ndf, sigma, "ndf"], k == 1 ? "nearly 1" : "less with sigma")
			}
		}
		for (k = 1; k <= 4; k++) {
			gamma = k == 1 ? "1.65" : k == 2 ? "2" : k == 3 ? "4" : "7"
			line(5, "pseudo-visible by that of all normals at sigma 0.5 and gamma " gamma, noise["5", "0.5", "pseudo", gamma],
			     noise["5", "0.5", "ndf", gamma], "good")
		}
	}' "$out/s0_fig3.csv" "$out/s0_fig4.csv" "$out/s0_fig5.csv" >>"$out/summary.csv"
}

# The second row of Fig. 4: processor time of one picture by the form of Lambda, all normals being drawn as in the paper.
# timed OPTION...: the least of three, seconds to 10 ms.
timed() {
	for _ in 1 2 3; do
		sh -c '"$@" && times' timed "$stdfit" render -q --threads 1 --size 64 --samples $samples --sampling ndf \
			-o "$work/timed.pfm" "$@"
	done | awk '
	NR % 2 == 0 { sub("m", " "); t = 60 * $1 + $2; if (NR == 2 || t < least) least = t }
	END { print least }'
}

# shellcheck disable=SC2086
time_forms() {
	gamma=$1 sigma=$2
	shift 2
	for form; do
		echo "$gamma,$sigma,$form,$(timed --ndf std --gamma $gamma --sigma $sigma --lambda $form $gold)" \
			>>"$out/s3_fig4_render.csv"
	done
}

# shellcheck disable=SC2086
rendering_times() {
	echo 'gamma,sigma,form,seconds' >"$out/s3_fig4_render.csv"
	for gamma in 2 3 5 8 11 15; do
		time_forms $gamma 0.5 exact 2f1 integer rational
		time_forms $gamma.5 0.5 half-integer
	done
	for sigma in 0.1 0.4 0.7 1 1.5; do
		time_forms 5 $sigma exact 2f1 integer rational
		time_forms 5.5 $sigma half-integer
	done
	for sigma in 0.1 0.4 0.5 0.7 1 1.5; do
		echo "inf,$sigma,beckmann,$(timed --ndf beckmann --sigma $sigma $gold)" >>"$out/s3_fig4_render.csv"
	done
	awk -F, '
	NR > 1 && $2 == 0.5 { seconds[$3, $1] = $4 }
	END {
		for (gamma = 3; gamma <= 15; gamma += 12) {
			limit = seconds["beckmann", "inf"]
			printf "S3 4,time of a picture at gamma %g with the integer sum by that of Beckmann,%.3g,slightly higher\n",
			       gamma, seconds["integer", gamma] / limit
			printf "S3 4,the same with the rational form,%.3g,slightly higher\n", seconds["rational", gamma] / limit
			printf "S3 4,the same with the half-integer sum by 2F1,%.3g,can be above 1\n",
			       seconds["half-integer", gamma + 0.5] / seconds["2f1", gamma]
		}
	}' "$out/s3_fig4_render.csv" >>"$out/summary.csv"
}

appearance
approximation
beckmann
masked_noise
visible_noise
pseudo_noise
noise_ratios
rendering_times
