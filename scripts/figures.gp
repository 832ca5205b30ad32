# SPDX-License-Identifier: GPL-3.0-or-later
# Draws the CSV files of scripts/figures.sh. From the environment: FIGURES, their directory; DRAWINGS, where the PNG
# files go; SOURCE, what was fitted for Fig. 11.
out = system("printenv FIGURES")
drawings = system("printenv DRAWINGS")
source = system("printenv SOURCE")

set encoding utf8
set datafile separator ","
set datafile missing NaN
set grid lc rgb "#dddddd" lt 1
set tics nomirror
set border 3
set style data lines
set key noenhanced samplen 2 Left reverse

# From a low gamma to a high one, yellow to blue; Beckmann, the limit, black and dashed.
hues = "#e6a800 #ee7733 #cc3311 #aa4499 #882255 #332288 #0077bb #33bbee #009988"
black = "#000000"
gamma_name(g) = "γ = ".(g eq "inf" ? "∞ (Beckmann)" : g eq "2" ? "2 (GGX)" : g)
# The value in the rows whose columns a (and b, c) read so.
where(a, is_a, value) = strcol(a) eq is_a ? value : NaN
where2(a, is_a, b, is_b, value) = strcol(a) eq is_a ? where(b, is_b, value) : NaN
where3(a, is_a, b, is_b, c, is_c, value) = strcol(a) eq is_a ? where2(b, is_b, c, is_c, value) : NaN

# Fig. 3
shapes = "1.51 1.65 2 4 10 40 inf"
shape_hue(i) = i == 7 ? black : word("#e6a800 #ee7733 #cc3311 #aa4499 #332288 #0077bb", i)
set terminal pngcairo size 1500,900 font "sans,12"
set output drawings."/fig3.png"
file = out."/fig3_slopes.csv"
set multiplot layout 2,3 title "Fig. 3: density of slopes and masking of STD" \
	margins 0.06,0.85,0.07,0.9 spacing 0.05,0.13
set xrange [0:90]
set xtics 15
set xlabel "θ (degrees)"
do for [row = 0:1] {
	if (row == 0) { set logscale y; set yrange [1e-4:100]; set format y "10^{%T}" }
	if (row == 1) { unset logscale y; set yrange [0:1.05]; set format y "%g" }
	do for [panel = 1:3] {
		sigma = word("0.1 0.3 1", panel)
		set title "σ = ".sigma
		set ylabel (panel > 1 ? "" : row == 0 ? "P_{22}, per unit slope squared" : "G_1")
		unset key
		if (row == 0 && panel == 3) { set key at screen 0.86, 0.9 left top }
		plot for [i = 1:7] file using 3:(where2(1, sigma, 2, word(shapes, i), column(4 + row))) lw 2 \
			dt 1 + (i == 7) lc rgb shape_hue(i) title gamma_name(word(shapes, i))
	}
}
unset multiplot

# Fig. 4
set output drawings."/fig4.png"
file = out."/fig4_time.csv"
set multiplot layout 2,3 title \
	"Fig. 4: time of one evaluation, on one core of this machine (γ = 2 takes the closed forms of GGX)" \
	margins 0.06,0.83,0.07,0.9 spacing 0.05,0.13
set style data linespoints
set logscale y
set yrange [5:3000]
set xtics autofreq
# quantity/form, and how it is called
panel_1 = "D/std D/beckmann"
panel_2 = "lambda/2f1 lambda/half-integer lambda/integer lambda/rational lambda/exact lambda/beckmann"
panel_3 = "visible/std visible/beckmann sample/std sample/beckmann"
name_1 = "STD Beckmann"
name_2 = "2F1,_the_paper's half-integer_sum integer_sum rational exact,_ours Beckmann"
name_3 = "visible,_STD visible,_Beckmann all,_STD all,_Beckmann"
hues_1 = "#0077bb #000000"
hues_2 = "#cc3311 #aa4499 #ee7733 #009988 #0077bb #000000"
hues_3 = "#ee7733 #cc3311 #0077bb #000000"
before(s, mark) = substr(s, 1, strstrt(s, mark) - 1)
after(s, mark) = substr(s, strstrt(s, mark) + 1, strlen(s))
spaced(s) = strstrt(s, "_") ? spaced(before(s, "_")." ".after(s, "_")) : s
do for [row = 0:1] {
	against = word("gamma sigma", row + 1)
	set xrange [(row == 0 ? 1.5 : 0):(row == 0 ? 16 : 1.55)]
	set xlabel (row == 0 ? "γ, at σ = 0.5" : "σ, at γ = 5 (half-integer sum: 5.5)")
	do for [panel = 1:3] {
		curves = value(sprintf("panel_%d", panel))
		names = value(sprintf("name_%d", panel))
		colours = value(sprintf("hues_%d", panel))
		set title word("D Λ Sampling", panel)
		set ylabel (panel == 1 ? "ns" : "")
		unset key
		if (row == 0) {
			set key at screen 0.85, word("0.9 0.8 0.6", panel) left top title word("D Λ Sampling", panel)
		}
		plot for [i = 1:words(curves)] file using 2:(where3(1, against, 3, before(word(curves, i), "/"), \
			4, after(word(curves, i), "/"), $5)) pt 7 ps 0.6 lw 1.5 lc rgb word(colours, i) \
			title spaced(word(names, i))
	}
}
unset multiplot
set style data lines
set key title ""

# Fig. 5
set terminal pngcairo size 1400,600 font "sans,12"
set output drawings."/fig5.png"
set multiplot layout 1,2 title "Fig. 5: relative error of the rational approximation of G_1" \
	margins 0.06,0.97,0.11,0.85 spacing 0.17
unset logscale
set format "%g"
set key at screen 0.445, 0.85 left top
gammas = "1.6 2 2.2 2.5 3 5 10 40 100"
set title "integrated over the hemisphere; the paper: below 0.7 %"
set xlabel "σ"
set ylabel "error (%)"
set xrange [0:2]
set yrange [0:0.75]
plot for [i = 1:words(gammas)] out."/fig5_rational.csv" using 1:(where(2, word(gammas, i), $3)) lw 2 \
	lc rgb word(hues, i) title gamma_name(word(gammas, i))
set title "the largest at any σ"
set key inside right bottom
set xlabel "γ"
set logscale x
set xrange [1.5:120]
set xtics (1.5, 2, 3, 5, 10, 20, 50, 100)
plot out."/fig5_worst.csv" using 1:3 lw 2 lc rgb "#cc3311" title "at one direction", \
	"" using 1:2 lw 2 lc rgb "#0077bb" title "integrated over the hemisphere"
unset multiplot
unset logscale x

# Fig. 9
set output drawings."/fig9.png"
set multiplot layout 1,2 title "Fig. 9: light that comes back after single scattering between mirror facets" \
	margins 0.06,0.84,0.11,0.85 spacing 0.06
set yrange [0:105]
set xtics autofreq
set ylabel "energy (%)"
set title "all directions of incidence (eq. 24 over π)"
set xlabel "σ"
set xrange [0:1.5]
unset key
plot for [i = 1:7] out."/fig9_energy.csv" using 1:(where(2, word(shapes, i), $3)) lw 2 lc rgb shape_hue(i) notitle, \
	for [i = 1:7] "" using 1:(where(2, word(shapes, i), $4)) lw 1.5 dt 3 lc rgb shape_hue(i) notitle
set title "one direction of incidence, σ = 0.5"
set xlabel "θ_i (degrees)"
set ylabel ""
set xrange [0:90]
set xtics 15
set key at screen 0.855, 0.85 left top
plot for [i = 1:7] out."/fig9_direction.csv" using 1:(where(2, word(shapes, i), $3)) lw 2 lc rgb shape_hue(i) \
	title gamma_name(word(shapes, i)), \
	for [i = 1:7] "" using 1:(where(2, word(shapes, i), $4)) lw 1.5 dt 3 lc rgb shape_hue(i) notitle, \
	NaN lw 2 lc rgb "#777777" title "G uncorrelated", NaN lw 1.5 dt 3 lc rgb "#777777" title "G correlated"
unset multiplot

# Fig. 10
set terminal pngcairo size 1500,600 font "sans,12"
set output drawings."/fig10.png"
file = out."/fig10_beckmann.csv"
set multiplot layout 1,3 title "Fig. 10: relative difference of STD from Beckmann" \
	margins 0.05,0.88,0.11,0.85 spacing 0.05
gammas = "30 40 50 100"
set xlabel "σ"
set xrange [0:1.5]
set xtics autofreq
unset key
gamma_hue(i) = word("#cc3311 #ee7733 #332288 #0077bb", i)
set ylabel "difference (%)"
set title "D; solid: with the cosine, dotted: without"
set yrange [0:3]
plot for [i = 1:4] file using 1:(where(2, word(gammas, i), $3)) lw 2 \
	lc rgb gamma_hue(i) title gamma_name(word(gammas, i)), \
	for [i = 1:4] "" using 1:(where(2, word(gammas, i), $4)) lw 1.5 dt 3 lc rgb gamma_hue(i) notitle
set ylabel ""
set title "G_1, over the hemisphere"
set yrange [0:0.6]
plot for [i = 1:4] file using 1:(where(2, word(gammas, i), $5)) lw 2 \
	lc rgb gamma_hue(i) title gamma_name(word(gammas, i))
set title "energy conservation"
set key at screen 0.89, 0.85 left top
set yrange [0:2]
plot for [i = 1:4] file using 1:(where(2, word(gammas, i), $6)) lw 2 \
	lc rgb gamma_hue(i) title gamma_name(word(gammas, i))
unset multiplot

# Fig. 11
file = out."/fig11_errors.csv"
heading = system(sprintf("head -n 1 '%s' | tr ',' ' '", file))
materials = int(system(sprintf("wc -l <'%s'", file))) - 1
set terminal pngcairo size (materials > 40 ? 1800 : 1200),800 font "sans,12"
set output drawings."/fig11.png"
set title "Fig. 11: error of the best fit, in order of that of STD\n{/*0.85 ".materials." materials: ".source."}"
set key outside right top
set xlabel ""
set ylabel "error E"
set xrange [-0.5:materials - 0.5]
set yrange [0:*]
set xtics rotate by 60 right noenhanced font "sans,10"
ndf_name(n) = n eq "std" ? "STD" : n eq "ggx" ? "GGX" : n eq "beckmann" ? "Beckmann" : \
	n eq "low" ? "Löw, Smith G" : n eq "low/v-groove" ? "Löw, V-groove G" : n
ndf_hue(n, i) = n eq "std" ? "#0077bb" : n eq "ggx" ? "#cc3311" : n eq "beckmann" ? black : \
	word("#ee7733 #009988 #aa4499 #882255", i % 4 + 1)
plot for [i = 2:words(heading)] file using 0:(column(i)):xtic(1) skip 1 with linespoints pt 7 ps 0.8 lw 1.5 \
	lc rgb ndf_hue(word(heading, i), i) title ndf_name(word(heading, i))
