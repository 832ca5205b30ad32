#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: plot_trace.sh TRACE.csv OUT
# Draws the error against the time of every curve in a trace (stdfit bench --trace, stdfit fit --trace): OUT.png and
# OUT.svg, time to a logarithmic scale, each curve labelled at its end. Curves that end early go on flat.
set -eu

[ $# -eq 2 ] || { echo 'usage: plot_trace.sh TRACE.csv OUT' >&2; exit 2; }
trace=$1
out=$2
command -v gnuplot >/dev/null || { echo 'plot_trace.sh: gnuplot is not installed (on Debian: apt install gnuplot-nox)' >&2; exit 1; }
[ -r "$trace" ] || { echo "plot_trace.sh: cannot read '$trace'" >&2; exit 1; }
[ "$(head -n 1 "$trace")" = material,ndf,algorithm,stage,evaluations,seconds,error ] ||
	{ echo "plot_trace.sh: '$trace' is no trace: expected columns material,ndf,algorithm,stage,evaluations,seconds,error" >&2; exit 1; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM

# One file a curve, and the commands that draw them. The fields are counted from the end: a material may have commas.
LC_ALL=C awk -F, -v work="$work" '
function curve_of(   i, m) {
	m = $1
	for (i = 2; i <= NF - 6; i++)
		m = m "," $i
	material[m]
	ndf[$(NF - 5)]
	return m SUBSEP $(NF - 5) SUBSEP $(NF - 4)
}
# What tells the curves apart.
function label(c,   part, text) {
	split(c, part, SUBSEP)
	text = part[3]
	if (n_ndfs > 1)
		text = part[2] (n_algorithms > 1 ? ", " text : "")
	if (n_materials > 1)
		text = part[1] (n_ndfs > 1 || n_algorithms > 1 ? ", " text : "")
	gsub(/[^A-Za-z0-9 ,.+-]/, "_", text)
	return text
}
NR == 1 || $NF == "" || $(NF - 1) <= 0 { next }
{
	c = curve_of()
	if (!(c in last)) {
		curve[++n] = c
		algorithm[$(NF - 4)]
	}
	t = $(NF - 1) + 0
	e = $NF + 0
	file = work "/" n ".dat"
	# A stage begins on another table: its errors count from there.
	printf "%.9g %.9g\n", t, e >file
	last[c] = e
	if (n == 1 && !(c in points) || t < t_min)
		t_min = t
	points[c]++
	if (t > t_max)
		t_max = t
	if (best == "" || e < best)
		best = e
}
END {
	if (!n)
		exit 3
	for (m in material) n_materials++
	for (m in ndf) n_ndfs++
	for (m in algorithm) n_algorithms++
	if (t_max <= t_min)
		t_max = 2 * t_min
	# Where all ends lie, and some of the way there.
	top = best
	for (i = 1; i <= n; i++) {
		printf "%.9g %.9g\n", t_max, last[curve[i]] >(work "/" i ".dat")
		if (last[curve[i]] > top && last[curve[i]] <= 3 * best)
			top = last[curve[i]]
	}
	span = 1.6 * (top - best)
	if (span < 0.25 * best)
		span = 0.25 * best
	low = best - 0.06 * span
	high = best + span
	# Labels from the lowest up, kept apart.
	gap = (high - low) / (n > 24 ? n + 2 : 26)
	for (i = 1; i <= n; i++)
		order[i] = i
	for (i = 2; i <= n; i++) {
		o = order[i]
		for (j = i; j > 1 && last[curve[order[j - 1]]] > last[curve[o]]; j--)
			order[j] = order[j - 1]
		order[j] = o
	}
	at = low - gap
	for (i = 1; i <= n; i++) {
		y = last[curve[order[i]]]
		at = y > at + gap ? y : at + gap
		where[order[i]] = at
	}
	limit = high
	for (i = n; i >= 1; i--) {
		if (where[order[i]] > limit)
			where[order[i]] = limit
		limit = where[order[i]] - gap
	}
	split("#000000 #d55e00 #0072b2 #009e73 #cc79a7 #e69f00 #56b4e9 #8a5a2b #6a3d9a #808000", colour, " ")
	printf "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n", t_min, t_max, low, high
	for (i = 1; i <= n; i++) {
		base = curve[i]
		joint = sub(/-joint$/, "", base)
		if (!(base in hue))
			hue[base] = n_hues++ % 10 + 1
		rgb = colour[hue[base]]
		mark = last[curve[i]]
		away = mark > high
		name = label(curve[i]) (away ? sprintf(" (%.3g)", mark) : "")
		if (!away)
			printf "set arrow from graph 1, first %.9g to graph 1.03, first %.9g nohead lw 0.7 lc rgb \"%s\"\n", mark, where[i], rgb
		printf "set label \"%s\" at graph 1.035, first %.9g left noenhanced tc rgb \"%s\"\n", name, where[i], rgb
		plots = plots (i > 1 ? ", " : "plot ") sprintf("\"%s/%d.dat\" using 1:2 with steps lw %s dt %s lc rgb \"%s\" notitle", work, i, i == 1 ? 3 : 1.6, joint ? 2 : 1, rgb)
	}
	title = ""
	for (m in material)
		title = n_materials > 1 ? n_materials " materials" : m
	for (m in ndf)
		title = title (n_ndfs > 1 ? "" : ", " m)
	gsub(/["\\]/, "_", title)
	printf "set title \"%s\" noenhanced\n%s\n", title, plots
}' "$trace" >"$work/curves.gp" || { echo "plot_trace.sh: '$trace' has no points" >&2; exit 1; }

draw() {
	{
		echo "set terminal $1"
		echo "set output '$work/drawing'"
		cat <<'COMMANDS'
set logscale x
set format x "%g"
set xlabel "seconds"
set ylabel "error E"
set grid x y lc rgb "#dddddd" lt 1
set tics nomirror
set border 3
set rmargin at screen 0.78
COMMANDS
		cat "$work/curves.gp"
	} >"$work/plot.gp"
	gnuplot "$work/plot.gp"
	cp "$work/drawing" "$2.part"
	mv -f "$2.part" "$2"
}

draw "pngcairo size 1200,800 font 'sans,13'" "$out.png"
draw "svg size 1200,800 dynamic font 'sans,16' background 'white'" "$out.svg"
