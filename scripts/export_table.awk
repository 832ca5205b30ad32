# SPDX-License-Identifier: GPL-3.0-or-later
# usage: awk -f export_table.awk TABLE.csv
# The table of export_table.sh in Markdown: medians and the worst of each format, then a row for each material.

# The median of the numbers n[1] to n[count], which are sorted.
function median(n, count) {
	return count % 2 ? n[(count + 1) / 2] : (n[count / 2] + n[count / 2 + 1]) / 2
}

# "median (worst)" of a column; low: the smallest is the worst.
function summary(format, column, digits, low,    n, count, i, j, x) {
	count = 0
	for (i = 1; i <= materials; i++)
		if (value[name[i], format, column] != "") {
			x = value[name[i], format, column] + 0
			for (j = count++; j > 0 && n[j] > x; j--)
				n[j + 1] = n[j]
			n[j + 1] = x
		}
	return count ? sprintf("%." digits "f (%." digits "f)", median(n, count), low ? n[1] : n[count]) : "the model's"
}

BEGIN { FS = "," }
NR == 1 { next }
!($1 in seen) { name[++materials] = $1; seen[$1] }
!($2 in known) { format[++formats] = $2; known[$2] }
{
	value[$1, $2, "size"] = $3 == "" ? "" : $3 / 1e6
	for (i = 4; i <= NF; i++)
		value[$1, $2, i] = $i
}
END {
	print "| export | MB | E, weight none | cosine | solid-angle | delta E | SSIM |"
	print "|---|---|---|---|---|---|---|"
	for (f = 1; f <= formats; f++) {
		own = format[f] == "model"
		printf "| %s | %s | %s | %s | %s | %s | %s |\n", own ? "the model" : "`" format[f] "`",
			own ? "" : summary(format[f], "size", format[f] ~ /merl|bsdf/ ? 1 : 3),
			summary(format[f], 4, 2), summary(format[f], 5, 3), summary(format[f], 6, 3),
			summary(format[f], 7, 2), summary(format[f], 8, 3, 1)
	}
	print ""
	print "| material | model | `mitsuba` | `pbrt` | `gltf` | `materialx` | `bsdf`: L1, MB |"
	print "|---|---|---|---|---|---|---|"
	for (i = 1; i <= materials; i++) {
		printf "| %s |", name[i]
		split("model mitsuba pbrt gltf materialx", shown, " ")
		for (f = 1; f <= 5; f++)
			printf " %.3f, %.2f |", value[name[i], shown[f], 6], value[name[i], shown[f], 7]
		printf " %s %%, %.1f |\n", value[name[i], "bsdf", 9], value[name[i], "bsdf", "size"]
	}
}
