#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: tables.sh STDFIT MERL [WORK [SOME]]
# Writes docs/tables.md: how fits of all measured tables in the directory MERL look under each weight, and what richer models
# gain on them, or on those of the directory SOME. An hour of two processors. With WORK the tables that it is made from stay
# there, and those that are there already are taken as they are.
set -eu
export LC_ALL=C

usage='usage: tables.sh STDFIT MERL [WORK [SOME]]'
stdfit=${1:?$usage}
merl=${2:?$usage}
some=${4:-$merl}
if [ $# -gt 2 ]; then
	work=$3
	mkdir -p "$work"
else
	work=$(mktemp -d)
	trap 'rm -rf "$work"' EXIT
	trap 'exit 130' INT TERM
fi
weights='none cosine solid-angle'
lights='studio sky lights'
page=$(dirname "$0")/../docs/tables.md

# Makes file $1 from the standard output of the rest of the arguments, unless it is there.
make_once() {
	[ -s "$1" ] || { made=$1; shift; "$@" >"$made.part" && mv "$made.part" "$made"; }
}

for w in $weights; do
	make_once "$work/$w.csv" "$stdfit" fit "$merl" --weight "$w" -q
	for l in $lights; do
		make_once "$work/$w.$l.csv" "$stdfit" render "$work/$w.csv" -e "$l" --size 64 --samples 64 -q
	done
done
for w in none solid-angle; do
	for m in "$some"/*.binary; do
		make_once "$work/models.$w.$(basename "$m" .binary).csv" "$stdfit" compare --models "$m" --weight "$w" -q
	done
done

# A row for each material and light: delta E and SSIM of each NDF under each weight, the least delta E of an NDF in bold.
looks() {
	for w in $weights; do
		for l in $lights; do
			awk -F, -v w="$w" -v l="$l" '
			NR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }
			{ print $1, l, w, $2, $column["delta_e"], $column["ssim"] }' "$work/$w.$l.csv"
		done
	done | awk -v weights="$weights" -v lights="$lights" '
	{
		if (!($1 in seen)) { seen[$1]; material[++n] = $1 }
		delta[$1, $2, $3, $4] = $5
		ssim[$1, $2, $3, $4] = $6
		sum[$2, $3, $4] += $5
		sum_ssim[$2, $3, $4] += $6
	}
	function cells(m, l,   i, j, text, d, s, least, k) {
		text = ""
		for (j = 1; j <= 3; j++) {
			least = 1
			for (i = 2; i <= 3; i++)
				if (delta[m, l, weight[i], ndf[j]] + 0 < delta[m, l, weight[least], ndf[j]] + 0)
					least = i
			for (i = 1; i <= 3; i++) {
				d = sprintf("%.2f", delta[m, l, weight[i], ndf[j]])
				text = text " " (i == least ? "**" d "**" : d) sprintf(" %.3f |", ssim[m, l, weight[i], ndf[j]])
				wins[i] += i == least
			}
		}
		return text
	}
	END {
		split(weights, weight, " ")
		n_lights = split(lights, light, " ")
		split("std ggx beckmann", ndf, " ")
		head = "| material, light |"
		line = "|---|"
		for (j = 1; j <= 3; j++)
			for (i = 1; i <= 3; i++) {
				head = head " " ndf[j] ", " weight[i] " |"
				line = line "---|"
			}
		print head
		print line
		for (k = 1; k <= n; k++)
			for (l = 1; l <= n_lights; l++)
				print "| " material[k] ", " light[l] " |" cells(material[k], light[l])
		for (l = 1; l <= n_lights; l++)
			for (j = 1; j <= 3; j++)
				for (i = 1; i <= 3; i++) {
					delta["mean", light[l], weight[i], ndf[j]] = sum[light[l], weight[i], ndf[j]] / n
					ssim["mean", light[l], weight[i], ndf[j]] = sum_ssim[light[l], weight[i], ndf[j]] / n
				}
		won[1] = wins[1]; won[2] = wins[2]; won[3] = wins[3]
		for (l = 1; l <= n_lights; l++)
			print "| mean, " light[l] " |" cells("mean", light[l])
		printf "\nOf %d cases (material, light and NDF) delta E is least %d times under `none`, %d under `cosine`, %d under " \
		       "`solid-angle`.\n", n * n_lights * 3, won[1], won[2], won[3]
	}'
}

# A row for each material: error and delta E of the paper's model, then by how many percent each other one is below, and its
# delta E; the mean and the time last.
models() {
	for m in "$some"/*.binary; do
		sed 1d "$work/models.$1.$(basename "$m" .binary).csv"
	done | awk -F, '
	{
		if (!($1 in seen)) { seen[$1]; material[++n] = $1 }
		error[$1, $2] = $4
		gain[$1, $2] = $5
		delta[$1, $2] = $6
		seconds[$1, $2] = $8
		sum[$2] += $5
		sum_delta[$2] += $6
	}
	function median(name,   i, j, x, v) {
		for (i = 1; i <= n; i++) {
			x = seconds[material[i], name] / seconds[material[i], "lobe"]
			for (j = i; j > 1 && v[j - 1] > x; j--)
				v[j] = v[j - 1]
			v[j] = x
		}
		return n % 2 ? v[(n + 1) / 2] : (v[n / 2] + v[n / 2 + 1]) / 2
	}
	END {
		count = split("gray-specular burley two-lobes f82 burley+f82", name, " ")
		head = "| material | E | delta E |"
		line = "|---|---|---|"
		for (i = 1; i <= count; i++) {
			head = head " " name[i] " |"
			line = line "---|"
		}
		print head
		print line
		for (k = 1; k <= n; k++) {
			m = material[k]
			text = sprintf("| %s | %.4f | %.2f |", m, error[m, "lobe"], delta[m, "lobe"])
			for (i = 1; i <= count; i++)
				text = text sprintf(" %.1f; %.2f |", gain[m, name[i]], delta[m, name[i]])
			print text
		}
		text = sprintf("| mean | | %.2f |", sum_delta["lobe"] / n)
		for (i = 1; i <= count; i++)
			text = text sprintf(" %.1f; %.2f |", sum[name[i]] / n, sum_delta[name[i]] / n)
		print text
		text = "| time | | |"
		for (i = 1; i <= count; i++)
			text = text sprintf(" %.1f |", median(name[i]))
		print text
	}'
}

count() {
	set -- "$1"/*.binary
	echo $#
}

{
	cat <<'END'
# Tables of measured materials

Written by `scripts/tables.sh`, from the tables described under [Data](formats.md#the-data-of-these-pages).

## How fits look under each weight

Each cell has delta E (mean CIEDE2000) and SSIM of a sphere of the fit against the measured one, 64 pixels wide, 64 samples a
pixel: [Spheres](pictures.md#spheres). The least delta E of the three weights is bold. Three lights, three NDFs:

END
	looks
	cat <<'END'

## What richer models gain

END
	echo "Of $(count "$some") materials, where the table above has $(count "$merl")."
	cat <<'END'
E and delta E (studio light) of STD's lobe, the paper's model; then for each model of `compare --models` by how many percent its
E is below that, and its delta E. The last row is the median time of a fit over that of the paper's model, one thread each.
[What the models are](model.md#richer-models). Under `--weight none`:

END
	models none
	cat <<'END'

Under `--weight solid-angle`:

END
	models solid-angle
} >"$page.part"
mv "$page.part" "$page"
