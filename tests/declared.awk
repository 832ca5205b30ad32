# SPDX-License-Identifier: GPL-3.0-or-later
# Prints the functions that C headers declare without a body, and the arrays, one name a line. Comments must have been
# removed.
/^[ \t]*#/ { next }
{
	n = split($0 "\n", c, "")
	for (i = 1; i <= n; i++) {
		if (c[i] == "{")
			depth++
		if (!depth)
			text = text c[i]
		if (c[i] == ";" && !depth) {
			gsub(/__attribute__ *\(\([^)]*\)\)/, "", text)
			if (match(text, /[A-Za-z_][A-Za-z_0-9]* *\(/) && text !~ /typedef/) {
				name = substr(text, RSTART, RLENGTH - 1)
				sub(/ +$/, "", name)
				print name
			}
			while (text ~ /^[ \t\n]*extern/ && match(text, /[A-Za-z_][A-Za-z_0-9]* *\[/)) {
				print substr(text, RSTART, RLENGTH - 1)
				text = "extern" substr(text, RSTART + RLENGTH)
			}
			text = ""
		}
		# A body ends a function, but the braces of a struct or an enum stand before a ";".
		if (c[i] == "}" && !--depth && text ~ /\)[ \t\n]*$/)
			text = ""
	}
}
