# SPDX-License-Identifier: GPL-3.0-or-later
# Draws the sheets of scripts/figures_spheres.sh. From the environment: FIGURES, their directory; DRAWINGS, where the PNG
# files go.
out = system("printenv FIGURES")
drawings = system("printenv DRAWINGS")
set encoding utf8
set datafile separator whitespace
unset border
unset tics
unset key
unset colorbox
set margins 0, 0, 0, 0
do for [sheet in system(sprintf("cd '%s' && ls *.cells | sed 's/\\.cells$//'", out))] {
	cells = sprintf("%s/%s.cells", out, sheet)
	width = int(system(sprintf("awk 'NF && $1 > x { x = $1 } END { print x + 5 }' '%s'", cells)))
	height = int(system(sprintf("awk 'NF && $2 > y { y = $2 } END { print y + 21 }' '%s'", cells)))
	spheres = int(system(sprintf("awk '!NF { n += !before } { before = NF } END { print n + 0 }' '%s'", cells)))
	set terminal pngcairo size width, height font "sans,9" background "#1d1d1e"
	set output sprintf("%s/%s.png", drawings, sheet)
	set xrange [0:width]
	set yrange [height:0]
	unset label
	load sprintf("%s/%s.labels", out, sheet)
	plot for [i = 0:spheres - 1] cells index i using ($1 + 0.5):($2 + 0.5):3:4:5 with rgbimage
}
