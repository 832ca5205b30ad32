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

# S3, the STD paper

# Fig. 1
set terminal pngcairo size 1100,720 font "sans,12"
set output drawings."/s3_fig1.png"
file = out."/s3_fig3.csv"
set multiplot title "S3, Fig. 1: gold, σ = 0.3"
set lmargin at screen 0; set rmargin at screen 1; set bmargin at screen 0.62; set tmargin at screen 0.95
unset border; unset tics; unset key; set size ratio -1
set datafile separator whitespace
plot drawings."/s3_fig1_spheres.png" binary filetype=png with rgbimage
set datafile separator ","
set size noratio; set border 3; set xtics nomirror; set ytics nomirror
gammas_6 = "1.51 1.65 2 4 10 50"
hue_6(i) = word("#e6a800 #ee7733 #cc3311 #aa4499 #332288 #0077bb", i)
do for [panel = 1:2] {
	set lmargin at screen (panel == 1 ? 0.08 : 0.5); set rmargin at screen (panel == 1 ? 0.44 : 0.86)
	set bmargin at screen 0.09; set tmargin at screen 0.58
	set xrange [0:90]
	set xtics 15
	set xlabel "θ (degrees)"
	if (panel == 1) { set logscale y; set yrange [1e-4:10]; set format y "10^{%T}"; set ylabel "P_{22}" }
	if (panel == 2) {
		unset logscale y; set yrange [0:1.05]; set format y "%g"; set ylabel "G_1"
		set key at screen 0.87, 0.58 left top
	}
	plot for [i = 1:6] file using 4:(where2(2, "0.3", 3, word(gammas_6, i), column(panel == 1 ? 6 : 7))) lw 2 \
		lc rgb hue_6(i) title gamma_name(word(gammas_6, i))
}
unset multiplot
unset lmargin; unset rmargin; unset tmargin; unset bmargin

# Fig. 3
shapes = "1.51 1.65 2 4 10 40 inf"
shape_hue(i) = i == 7 ? black : word("#e6a800 #ee7733 #cc3311 #aa4499 #332288 #0077bb", i)
set terminal pngcairo size 1500,900 font "sans,12"
set output drawings."/s3_fig3.png"
set multiplot layout 2,3 title "S3, Fig. 3: density of slopes and masking of STD" \
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
		plot for [i = 1:7] file using 4:(where2(2, sigma, 3, word(shapes, i), column(6 + row))) lw 2 \
			dt 1 + (i == 7) lc rgb shape_hue(i) title gamma_name(word(shapes, i))
	}
}
unset multiplot

# Fig. 4
set output drawings."/s3_fig4.png"
file = out."/s3_fig4.csv"
set multiplot layout 2,3 title \
	"S3, Fig. 4: time of one evaluation, on one core of this machine (γ = 2 takes the closed forms of GGX)" \
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

# its second row
set terminal pngcairo size 1200,550 font "sans,12"
set output drawings."/s3_fig4_render.png"
set multiplot layout 1,2 title "S3, Fig. 4, second row: processor time of a picture of a gold sphere" \
	margins 0.07,0.83,0.12,0.86 spacing 0.08
file = out."/s3_fig4_render.csv"
forms = "2f1 half-integer integer rational exact"
unset logscale y
set yrange [0:*]
set title ""
stats file using (strcol(2) eq "0.5" ? where(3, "beckmann", $4) : NaN) skip 1 nooutput
limit = STATS_mean
do for [row = 0:1] {
	set xrange [(row == 0 ? 1.5 : 0):(row == 0 ? 16 : 1.55)]
	set xlabel (row == 0 ? "γ, at σ = 0.5" : "σ, at γ = 5 (half-integer sum: 5.5)")
	set ylabel (row == 0 ? "s" : "")
	unset key
	if (row == 1) { set key at screen 0.84, 0.86 left top title "Λ" }
	in_row(g, s) = row == 0 ? s eq "0.5" : s ne "0.5" && (g eq "5" || g eq "5.5")
	plot for [i = 1:5] file using (row == 0 ? $1 : $2):(in_row(strcol(1), strcol(2)) ? where(3, word(forms, i), $4) : NaN) \
		skip 1 pt 7 ps 0.6 lw 1.5 lc rgb word(hues_2, i) title spaced(word(name_2, i)), \
		(row == 0 ? limit : NaN) with lines lw 1.5 lc rgb black notitle, \
		file using (row == 0 ? NaN : $2):(where(3, "beckmann", $4)) skip 1 \
		pt 7 ps 0.6 lw 1.5 lc rgb black title "Beckmann"
}
unset multiplot
set style data lines
set key title ""

# Fig. 5
set terminal pngcairo size 1400,600 font "sans,12"
set output drawings."/s3_fig5.png"
set multiplot layout 1,2 title "S3, Fig. 5: relative error of the rational approximation of G_1" \
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
plot for [i = 1:words(gammas)] out."/s3_fig5.csv" using 1:(where(2, word(gammas, i), $3)) lw 2 \
	lc rgb word(hues, i) title gamma_name(word(gammas, i))
set title "the largest at any σ"
set key inside right bottom
set xlabel "γ"
set logscale x
set xrange [1.5:120]
set xtics (1.5, 2, 3, 5, 10, 20, 50, 100)
plot out."/s3_fig5_worst.csv" using 1:3 lw 2 lc rgb "#cc3311" title "at one direction", \
	"" using 1:2 lw 2 lc rgb "#0077bb" title "integrated over the hemisphere"
unset multiplot
unset logscale x

# Fig. 9
set output drawings."/s3_fig9.png"
set multiplot layout 1,2 title "S3, Fig. 9: light that comes back after single scattering between mirror facets" \
	margins 0.06,0.84,0.11,0.85 spacing 0.06
set yrange [0:105]
set xtics autofreq
set ylabel "energy (%)"
set title "all directions of incidence (eq. 24 over π)"
set xlabel "σ"
set xrange [0:1.5]
unset key
plot for [i = 1:7] out."/s3_fig9.csv" using 1:(where(2, word(shapes, i), $3)) lw 2 lc rgb shape_hue(i) notitle, \
	for [i = 1:7] "" using 1:(where(2, word(shapes, i), $4)) lw 1.5 dt 3 lc rgb shape_hue(i) notitle
set title "one direction of incidence, σ = 0.5"
set xlabel "θ_i (degrees)"
set ylabel ""
set xrange [0:90]
set xtics 15
set key at screen 0.855, 0.85 left top
plot for [i = 1:7] out."/s3_fig9_direction.csv" using 1:(where(2, word(shapes, i), $3)) lw 2 lc rgb shape_hue(i) \
	title gamma_name(word(shapes, i)), \
	for [i = 1:7] "" using 1:(where(2, word(shapes, i), $4)) lw 1.5 dt 3 lc rgb shape_hue(i) notitle, \
	NaN lw 2 lc rgb "#777777" title "G uncorrelated", NaN lw 1.5 dt 3 lc rgb "#777777" title "G correlated"
unset multiplot

# beside it: light that meets several facets
set terminal pngcairo size 1500,600 font "sans,12"
set output drawings."/s3_fig9_walks.png"
file = out."/s3_fig9_walks.csv"
set multiplot layout 1,3 title \
	"S3, Fig. 9, with multiple scattering: light from everywhere that has come back after so many facets" \
	margins 0.05,0.88,0.11,0.85 spacing 0.04
panels = "1.51 2 inf"
names = "1 2 3 5 10 any"
set xlabel "σ"
set xrange [0:2]
set xtics autofreq
do for [panel = 1:3] {
	set title gamma_name(word(panels, panel)).(panel == 1 ? ", where f has an infinite variance" : "")
	set ylabel (panel == 1 ? "energy (%)" : "")
	unset key
	if (panel == 3) { set key at screen 0.89, 0.85 left top title "facets, at most" }
	plot for [k = 1:6] file using 1:(where(2, word(panels, panel), column(2 + k))) lw 2 \
		lc rgb word("#cc3311 #ee7733 #e6a800 #009988 #0077bb #000000", k) title word(names, k), \
		file using 1:(where(2, word(panels, panel), $9)):($10) with yerrorbars pt 6 ps 0.7 lc rgb "#777777" \
		title "any, by f"
}
unset multiplot
set key title ""

# Fig. 10
set terminal pngcairo size 1500,600 font "sans,12"
set output drawings."/s3_fig10.png"
file = out."/s3_fig10.csv"
set multiplot layout 1,3 title "S3, Fig. 10: relative difference of STD from Beckmann" \
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
file = out."/s3_fig11.csv"
heading = system(sprintf("head -n 1 '%s' | tr ',' ' '", file))
materials = int(system(sprintf("wc -l <'%s'", file))) - 1
set terminal pngcairo size (materials > 40 ? 1800 : 1200),800 font "sans,12"
set output drawings."/s3_fig11.png"
set title "S3, Fig. 11: error of the best fit, in order of that of STD\n{/*0.85 ".materials." materials: ".source."}"
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

# S0, the supplement

# Fig. 1
set terminal pngcairo size 1300,600 font "sans,12"
set output drawings."/s0_fig1.png"
set multiplot layout 1,2 title "S0, Fig. 1: D of STD and of Hyper-Cauchy, σ = 0.3" \
	margins 0.07,0.86,0.11,0.85 spacing 0.06
set xrange [0:90]
set xtics norotate 15 font ""
set xlabel "θ (degrees)"
set logscale y
set yrange [1e-6:1e3]
set format y "10^{%T}"
do for [panel = 1:2] {
	name = word("std hyper-cauchy", panel)
	set title (panel == 1 ? "STD" : "Hyper-Cauchy")
	set ylabel (panel == 1 ? "D (1/sr)" : "")
	unset key
	if (panel == 2) { set key at screen 0.87, 0.85 left top }
	plot for [i = 1:6] out."/s0_fig1.csv" using 4:(where2(1, name, 3, word(gammas_6, i), $5)) lw 2 \
		lc rgb hue_6(i) title gamma_name(word(gammas_6, i))
}
unset multiplot

# Figs 3 to 5: noise
set terminal pngcairo size 1500,550 font "sans,12"
set output drawings."/s0_noise.png"
set multiplot layout 1,3 title "S0, Figs 3 to 5: noise of rough glass, 64 samples a pixel" \
	margins 0.05,0.97,0.13,0.85 spacing 0.06
set style data linespoints
set format y "%g"
unset logscale y
set yrange [0:*]
set logscale x
set ylabel "noise (% of the mean)"
set key inside right top
set xlabel "γ"
set xrange [1.45:8]
set xtics (1.5, 2, 3, 4, 7)
set title "Fig. 3: G, σ = 0.3"
plot for [i = 0:3] out."/s0_fig3.csv" using 1:(where2(2, word("ndf visible", i / 2 + 1), 3, \
	word("uncorrelated correlated", i % 2 + 1), $4)) pt 7 lw 1.5 dt 1 + 2 * (i % 2) \
	lc rgb word("#cc3311 #0077bb", i / 2 + 1) \
	title word("all visible", i / 2 + 1)." normals, ".word("uncorrelated correlated", i % 2 + 1)
set ylabel ""
set title "Fig. 4: visible normals"
set xlabel "σ"
set xrange [0.008:0.8]
set xtics (0.01, 0.03, 0.1, 0.3, 0.6)
set key inside left top
plot for [i = 0:3] out."/s0_fig4.csv" using 2:(where2(3, word("ndf visible", i / 2 + 1), 1, \
	word("beckmann ggx", i % 2 + 1), $4)) pt 7 lw 1.5 dt 1 + 2 * (i % 2) lc rgb word("#cc3311 #0077bb", i / 2 + 1) \
	title word("all visible", i / 2 + 1).", ".word("Beckmann GGX", i % 2 + 1)
set xlabel "γ"
set xrange [1.45:8]
set xtics (1.5, 2, 3, 4, 7)
set key inside right top
set title "Fig. 5: normals of STD, solid σ = 0.1, dotted 0.5"
plot for [i = 0:5] out."/s0_fig5.csv" using 1:(where2(3, word("ndf pseudo visible", i % 3 + 1), 2, \
	word("0.1 0.5", i / 3 + 1), $4)) pt 7 lw 1.5 dt 1 + 2 * (i / 3) lc rgb word("#cc3311 #009988 #0077bb", i % 3 + 1) \
	title (i < 3 ? word("all pseudo-visible visible", i % 3 + 1) : "")
unset multiplot
unset logscale x
set style data lines

# S1, the piecewise-linear NDF

# Fig. 1
set terminal pngcairo size 1200,550 font "sans,12"
set output drawings."/s1_fig1.png"
set multiplot layout 1,2 title "S1, Fig. 1: two random distributions, and the azimuths of both together" \
	margins 0.07,0.97,0.12,0.86 spacing 0.09
set key inside right bottom
set title ""
set xrange [0:90]
set xtics 15
set yrange [0:*]
set xlabel "θ (degrees)"
set ylabel "D (1/sr)"
plot out."/s1_fig1.csv" using 1:2 with linespoints pt 7 lw 2 lc rgb "#cc3311" title "D_x", \
	"" using 1:3 with linespoints pt 7 lw 2 lc rgb "#0077bb" title "D_y"
set xrange [0:360]
set xtics 90
set yrange [0:1]
set xlabel "φ (degrees)"
set ylabel "CDF"
plot out."/s1_fig1_cdf.csv" using 1:2 lw 2 lc rgb "#cc3311" title "CDF", x / 360 dt 3 lc rgb black title "φ/2π"
unset multiplot

# Fig. 2: what o sees of the facets at θ_m, φ_m, for three θ_o. Facets between the arcs at C and 2π - C are turned away.
set terminal pngcairo size 1500,500 font "sans,12"
set output drawings."/s1_fig2.png"
set multiplot layout 1,3 title "S1, Fig. 2: domains of the integral behind G_1, θ_m outwards, φ_m around; o to the right" \
	margins 0.01,0.78,0.03,0.85 spacing 0.02
unset border; unset tics; unset xlabel; unset ylabel
set size ratio -1
set angles degrees
set xrange [-95:95]
set yrange [-95:95]
limit(o, t) = t > 90 - o ? acos(-1 / (tan(o) * tan(t * 0.99999))) : 180
do for [o in "20 50 80"] {
	theta_o = real(o)
	set title "θ_o = ".o."°"
	unset key
	if (o eq "80") { set key at screen 0.79, 0.75 left top invert enhanced }
	set parametric
	set trange [0:1]
	set samples 400
	set style fill solid 0.9 noborder
	# From the outside in: all, what is seen beyond E, what is seen within E, what is seen whatever θ_m.
	plot 90 * cos(360 * t), 90 * sin(360 * t) with filledcurves closed lc rgb "#dddddd" title "turned away", \
		"+" using ((s = $1, r = 90 - theta_o + theta_o * (s < 0.5 ? 2 * s : 2 - 2 * s), \
		r * cos((s < 0.5 ? 1 : -1) * limit(theta_o, r)))):(r * sin((s < 0.5 ? 1 : -1) * limit(theta_o, r))) \
		with filledcurves closed lc rgb "#ee7733" title "I_2, θ_m > E: |φ_m - φ_o| < C", \
		(90 - theta_o) * cos(360 * t), (90 - theta_o) * sin(360 * t) with filledcurves closed lc rgb "#e6a800" \
		title "I_2, θ_m < E = 90° - θ_o", \
		90 * cos(180 * t - 90), 90 * sin(180 * t - 90) with filledcurves closed lc rgb "#0077bb" \
		title "I_1: |φ_m - φ_o| < 90°"
	unset parametric
}
unset multiplot
set angles radians
set size noratio
set border 3
set xtics nomirror
set ytics nomirror

# Fig. 3
set terminal pngcairo size 1200,550 font "sans,12"
set output drawings."/s1_fig3.png"
set multiplot layout 1,2 title "S1, Fig. 3: G_1 of the random distributions; dotted: by trapezoids" \
	margins 0.07,0.97,0.12,0.86 spacing 0.08
set key inside left bottom noinvert noenhanced
set xrange [0:90]
set xtics 15
set yrange [0:1.05]
set xlabel "θ (degrees)"
do for [kind in "isotropic anisotropic"] {
	set title kind
	set ylabel (kind eq "isotropic" ? "G_1" : "")
	plot for [i = 1:(kind eq "isotropic" ? 1 : 3)] out."/s1_fig3.csv" using 3:(where2(1, kind, 2, word("0 45 90", i), $4)) \
		lw 2 lc rgb word("#cc3311 #aa4499 #0077bb", i) title "φ = ".word("0 45 90", i)."°", \
		for [i = 1:(kind eq "isotropic" ? 1 : 3)] "" using 3:(where2(1, kind, 2, word("0 45 90", i), $5)) \
		lw 2 dt 3 lc rgb black notitle
}
unset multiplot

# S2, visible normals

# Fig. 2
set terminal pngcairo size 700,550 font "sans,12"
set output drawings."/s2_fig2.png"
set title "S2, Fig. 2: the inverse CDF of the slope across, and its fit"
set key inside left top
set xrange [0:1]
set xtics 0.2
set yrange [-6:6]
set xlabel "U"
set ylabel "z"
plot out."/s2_fig2.csv" using 1:2 lw 3 lc rgb "#0077bb" title "exact", "" using 1:3 lw 2 dt 2 lc rgb black title "rational fit"

# Figs 1 and 3
set style data points
set size ratio 1
unset key
unset colorbox
unset xlabel
unset tics
set border 31
set palette rgb 21, 22, 23
set xrange [-5:5]
set yrange [-5:5]
do for [n = 1:3:2] {
	name = n == 1 ? "Beckmann" : "GGX"
	file = sprintf("%s/s2_fig%d.csv", out, n)
	set terminal pngcairo size 900,960 font "sans,12"
	set output sprintf("%s/s2_fig%d.png", drawings, n)
	set multiplot layout 4,4 title sprintf("S2, Fig. %d: visible slopes of %s, α_x = 2, α_y = 1, φ_i = 45°", n, name) \
		margins 0.07,0.98,0.02,0.91 spacing 0.01
	do for [theta_i = 0:90:30] {
		stats file using (int($1) == theta_i ? $7 : NaN) nooutput
		set cbrange [0:sqrt(STATS_max)]
		do for [k = 4:7] {
			set title (theta_i > 0 ? "" : spaced(word("10^3_samples 10^5_samples 10^7_samples density", k - 3))) offset 0,-0.8
			set ylabel (k > 4 ? "" : sprintf("θ_i = %d°", theta_i))
			plot file using 2:3:(int($1) == theta_i ? sqrt(column(k)) : NaN) with image
		}
	}
	unset multiplot
}
