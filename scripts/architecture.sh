#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: architecture.sh check ROOM...     fails if an include goes against the order of the rooms, or in a circle
#        architecture.sh graph ROOM...     prints the rooms: files, lines, and how many includes of which other room
#        architecture.sh outline ROOM...   prints the rooms and their arrows alone, which change rarely
#        architecture.sh write FILE ROOM...    puts the outline between the markers of FILE
#        architecture.sh current FILE ROOM...  fails if the outline between the markers of FILE is another
# Each room is a folder. A room may include itself and the rooms before it.
set -eu

usage() {
	sed -n 's/^# usage: /usage: /p; s/^#        architecture/       architecture/p' "$0" >&2
	exit 2
}

[ $# -ge 2 ] || usage
action=$1
shift
page=
case $action in
check | graph | outline) ;;
write | current)
	page=$1
	shift
	[ $# -ge 1 ] || usage
	;;
*) usage ;;
esac
rooms=$*
begin='<!-- include graph: begin -->'
end='<!-- include graph: end -->'

# All lines of all files pass through one awk, which knows what is included by whom.
scan() {
	# shellcheck disable=SC2016,SC2086 # an awk program; a list of words
	find $rooms -maxdepth 1 -name '*.[ch]' | LC_ALL=C sort | xargs awk -v rooms="$rooms" -v action="$1" '
	BEGIN {
		n = split(rooms, room, " ")
		for (i = 1; i <= n; i++)
			rank[room[i]] = i
	}
	function folder(name) {
		return match(name, /\/[^\/]*$/) ? substr(name, 1, RSTART - 1) : ""
	}
	function wrong(text) {
		if (action == "check")
			print "architecture: " text | "cat >&2"
		failed = 1
	}
	# Depth first; a file that is met again on the way to it closes a circle.
	function follow(name, way, part, i, count) {
		state[name] = 1
		count = split(includes[name], part, " ")
		for (i = 1; i <= count; i++) {
			if (state[part[i]] == 1)
				wrong("a circle: " way " -> " part[i])
			else if (!state[part[i]])
				follow(part[i], way " -> " part[i])
		}
		state[name] = 2
	}
	FNR == 1 {
		here = folder(FILENAME)
		files[here]++
		file[++n_files] = FILENAME
	}
	{ lines[here]++ }
	/^[ \t]*#[ \t]*include[ \t]*"/ {
		split($0, quoted, "\"")
		# The public header stands above the rooms; fit/api is what is behind it.
		if (quoted[2] == "fit/stdfit.h" && here == "fit/api")
			next
		there = folder(quoted[2])
		includes[FILENAME] = includes[FILENAME] " " quoted[2]
		if (!(there in rank))
			wrong(FILENAME ":" FNR ": \"" quoted[2] "\" is in no room")
		else if (rank[there] > rank[here])
			wrong(FILENAME ":" FNR ": " here " may not include " quoted[2])
		arrows[here, there]++
	}
	END {
		if (action == "check") {
			for (i = 1; i <= n_files; i++)
				if (!state[file[i]])
					follow(file[i], file[i])
			close("cat >&2")
			exit failed
		}
		for (i = 1; i <= n; i++) {
			line = room[i]
			if (action == "graph")
				line = line " (" files[room[i]] + 0 " files, " lines[room[i]] + 0 " lines)"
			line = line " ->"
			none = 1
			for (j = 1; j <= n; j++)
				if (j != i && arrows[room[i], room[j]]) {
					line = line " " room[j]
					if (action == "graph")
						line = line " (" arrows[room[i], room[j]] ")"
					none = 0
				}
			print line (none ? " nothing" : "")
		}
	}'
}

# The page with the outline of today between its markers.
renewed() {
	outline=$(scan outline)
	awk -v begin="$begin" -v end="$end" -v outline="$outline" '
	$0 == end { inside = 0 }
	!inside { print }
	$0 == begin { inside = 1; print "```"; print outline; print "```" }' "$page"
}

if [ -n "$page" ]; then
	{ [ -f "$page" ] && [ "$(grep -c -x -e "$begin" "$page")" = 1 ] && [ "$(grep -c -x -e "$end" "$page")" = 1 ] &&
		[ "$(grep -n -x -e "$begin" "$page" | cut -d: -f1)" -lt "$(grep -n -x -e "$end" "$page" | cut -d: -f1)" ]; } || {
		echo "architecture: expected a page '$page' with the lines '$begin' and, after it, '$end'" >&2
		exit 1
	}
fi
case $action in
write)
	renewed >"$page.part"
	mv -f "$page.part" "$page"
	;;
current)
	renewed | cmp -s - "$page" || {
		echo "architecture: the include graph in '$page' is out of date; please run make architecture" >&2
		exit 1
	}
	;;
*) scan "$action" ;;
esac
