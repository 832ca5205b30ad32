#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: check_docs.sh [--update] STDFIT [PAGE...]
# Holds README.md and docs/*.md (or the pages given) against the program: runs every session and compares what it prints,
# follows every link, and compares the options of docs/commands.md with those that the program has.
# With --update the sessions' outputs are written into the pages instead.
#
# A session is a fenced block ```console. A line `$ COMMAND` is run (a `\` at its end continues it), what follows is its
# output, standard error included. The sessions of a page run in order, in a directory of the page's own. Two numbers with
# a point or an exponent agree within 1e-3 of themselves or one unit of the last digit printed; all else agrees to the
# letter, but for white space. A line `...` stands for any lines. A comment on the line above the fence changes this:
#   <!-- check: merl -->       needs the measured tables: run where MERL=DIR names them (as merl/), else skipped by name
#   <!-- check: free 9 10 -->  the fields 9 and 10 of each line are times and the like: not compared
#   <!-- check: within R -->   numbers agree within R of themselves
#   <!-- check: python M -->   needs python3 with the module M: run where it is there, else skipped by name
# Other fences are not run; <!-- check: file NAME --> above one keeps its text as that file for the sessions.
set -eu
export LC_ALL=C

update=
[ "${1-}" != --update ] || { update=yes; shift; }
stdfit=${1:?usage: check_docs.sh [--update] STDFIT [PAGE...]}
shift
stdfit=$(cd "$(dirname "$stdfit")" && pwd)/$(basename "$stdfit")
cd "$(dirname "$0")/.."
root=$PWD
merl=
[ -z "${MERL-}" ] || merl=$(cd "$MERL" && pwd)
[ $# -gt 0 ] || set -- README.md CONTRIBUTING.md NEWS.md docs/*.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
trap 'exit 130' INT TERM
mkdir "$work/bin"
ln -s "$stdfit" "$work/bin/stdfit"
PATH=$work/bin:$PATH
export PATH
# The Python module over the library of the same build, by the python3 that Debian's modules are for.
[ ! -x /usr/bin/python3 ] || ln -s /usr/bin/python3 "$work/bin/python3"
PYTHONPATH=$(dirname "$stdfit")/python
STDFIT_LIBRARY=$(find "$(dirname "$stdfit")" -maxdepth 1 -name 'libstdfit.so.*')
export PYTHONPATH STDFIT_LIBRARY
faults=0 run=0 skipped=0

fault() {
	printf 'check_docs: %s\n' "$1"
	faults=$((faults + 1))
}

# Cuts page $1 into $2/N.command, N.expected, N.line and N.check; prints how many there are.
cut_page() {
	awk -v dir="$2" '
	function start(text) {
		n++
		command = dir "/" n ".command"
		expected = dir "/" n ".expected"
		printf "" >expected
		print NR >(dir "/" n ".line")
		print check >(dir "/" n ".check")
		print text >command
		continued = text ~ /\\$/
	}
	/^```/ {
		inside = !inside && /^```console$/
		if (inside)
			check = previous ~ /^<!-- check: .* -->$/ ? substr(previous, 13, length(previous) - 16) : ""
		previous = ""
		continued = 0
		next
	}
	inside && continued { print >command; continued = /\\$/; next }
	inside && /^\$ / { start(substr($0, 3)); next }
	inside && n { print >expected; next }
	{ previous = $0 }
	END { print n + 0 }' "$1"
}

# Writes the fences of page $1 that are files into $2.
keep_files() {
	awk -v dir="$2" '
	/^```/ { name = !inside && previous ~ /^<!-- check: file .* -->$/ ? substr(previous, 18, length(previous) - 21) : ""
		inside = !inside; previous = ""; next }
	name { print >(dir "/" name) }
	{ previous = $0 }' "$1"
}

# Compares files $1 (expected) and $2 (printed) as the head of this file says; $3 are the marks of the session.
same_output() {
	awk -v marks="$3" '
	function number(text) { return text ~ /^[-+]?([0-9]+[.]?[0-9]*|[.][0-9]+)([eE][-+]?[0-9]+)?$/ }
	function unit(text) {
		exponent = match(text, /[eE]/) ? substr(text, RSTART + 1) + 0 : 0
		sub(/[eE].*/, "", text)
		return 10 ^ (exponent - (match(text, /[.]/) ? length(text) - RSTART : 0))
	}
	function size(x) { return x < 0 ? -x : x }
	function numbers_agree(a, b) {
		if (a == b)
			return 1
		if (a !~ /[.eE]/ && b !~ /[.eE]/)
			return 0
		big = size(a + 0) > size(b + 0) ? size(a + 0) : size(b + 0)
		slack = within * big
		if (unit(a) > slack)
			slack = unit(a)
		return size(a - b) <= slack * (1 + 1e-9)
	}
	# Words agree if the numbers between the same signs do; a digit beside a letter is part of a name.
	function words_agree(a, b,   na, nb, i, pa, pb) {
		if (a == b)
			return 1
		if (number(a) && number(b))
			return numbers_agree(a, b)
		na = split(a, pa, /[];:=,()%"\047<>[\/]/)
		nb = split(b, pb, /[];:=,()%"\047<>[\/]/)
		if (na < 2 || na != nb)
			return 0
		for (i = 1; i <= na; i++)
			if (pa[i] != pb[i] && !(number(pa[i]) && number(pb[i]) && numbers_agree(pa[i], pb[i])))
				return 0
		return 1
	}
	function lines_agree(a, b,   na, nb, i, fa, fb) {
		na = split(a, fa)
		nb = split(b, fb)
		if (na != nb)
			return 0
		for (i = 1; i <= na; i++)
			if (!(i in free) && !words_agree(fa[i], fb[i]))
				return 0
		return 1
	}
	BEGIN {
		within = 1e-3
		n = split(marks, mark)
		for (i = 1; i <= n; i++)
			if (mark[i] == "within")
				within = mark[++i] + 0
			else if (mark[i] == "free")
				while (i < n && mark[i + 1] + 0 > 0)
					free[mark[++i] + 0]
	}
	FILENAME == ARGV[1] { want[++wants] = $0; next }
	{ got[++gots] = $0 }
	END {
		j = 1
		for (i = 1; i <= wants; i++) {
			if (want[i] == "...") {
				if (i == wants)
					exit 0
				while (j <= gots && !lines_agree(want[i + 1], got[j]))
					j++
				continue
			}
			if (j > gots || !lines_agree(want[i], got[j])) {
				print "  documented: " want[i]
				print "  printed:    " (j > gots ? "(nothing)" : got[j])
				exit 1
			}
			j++
		}
		if (j <= gots) {
			print "  documented: (nothing)"
			print "  printed:    " got[j]
			exit 1
		}
	}' "$1" "$2"
}

# Page $1 with the outputs in $2/N.printed instead of its own; an elision keeps as many lines before and after it.
rewrite_page() {
	awk -v dir="$2" '
	function flush(   i, lines, text, printed, dots) {
		if (!held)
			return
		printed = dir "/" n ".printed"
		lines = 0
		while ((status = (getline text <printed)) > 0) {
			sub(/[ \t]+$/, "", text)
			new[++lines] = text
		}
		if (status < 0) { # not run
			for (i = 1; i <= count; i++)
				print old[i]
		} else {
			close(printed)
			dots = 0
			for (i = 1; i <= count; i++)
				if (old[i] == "...")
					dots = i
			for (i = 1; i <= lines; i++)
				if (!dots || i < dots || i > lines - (count - dots))
					print new[i]
				else if (i == dots)
					print "..."
		}
		held = 0
	}
	/^```/ { flush(); inside = !inside && /^```console$/; continued = 0; print; next }
	inside && continued { print; continued = /\\$/; next }
	inside && /^\$ / { flush(); n++; held = 1; count = 0; print; continued = /\\$/; next }
	inside && held { old[++count] = $0; next }
	{ print }' "$1"
}

check_sessions() {
	page=$1
	steps=$work/steps place=$work/place
	rm -rf "$steps" "$place"
	mkdir "$steps" "$place"
	[ -z "$merl" ] || ln -s "$merl" "$place/merl"
	keep_files "$page" "$place"
	count=$(cut_page "$page" "$steps")
	i=0
	while [ $i -lt "$count" ]; do
		i=$((i + 1))
		line=$(cat "$steps/$i.line") check=$(cat "$steps/$i.check")
		case " $check " in
		*' merl '*)
			if [ -z "$merl" ]; then
				echo "check_docs: skipped, needs MERL=DIR: $page:$line: $(head -n 1 "$steps/$i.command")"
				skipped=$((skipped + 1))
				continue
			fi
			;;
		*' python '*)
			module=${check#*python }
			if ! python3 -c "import ${module%% *}" 2>/dev/null; then
				echo "check_docs: skipped, needs python3-${module%% *}: $page:$line: $(head -n 1 "$steps/$i.command")"
				skipped=$((skipped + 1))
				continue
			fi
			;;
		esac
		(cd "$place" && sh "$steps/$i.command") >"$steps/$i.printed" 2>&1 </dev/null || :
		run=$((run + 1))
		if [ -z "$update" ] && ! same_output "$steps/$i.expected" "$steps/$i.printed" "$check" >"$work/difference"; then
			fault "$page:$line: $(head -n 1 "$steps/$i.command")"
			cat "$work/difference"
		fi
	done
	if [ -n "$update" ]; then
		rewrite_page "$page" "$steps" >"$work/page"
		cmp -s "$work/page" "$page" || { cat "$work/page" >"$page"; echo "check_docs: $page written anew"; }
	fi
}

# The anchors that page $1 offers: its headings as GitHub names them.
anchors() {
	awk '/^```/ { inside = !inside } !inside && /^#+ / {
		sub(/^#+ /, "")
		text = tolower($0)
		gsub(/[^a-z0-9 _-]/, "", text)
		gsub(/ /, "-", text)
		print text
	}' "$1"
}

check_links() {
	awk '/^```/ { inside = !inside } !inside' "$1" | grep -o ']([^) ]*)' | sed 's/^](//; s/)$//' | sort -u |
		grep -v -E '^(https?|mailto):' >"$work/links" || :
	while read -r link; do
		file=${link%%#*} anchor=
		case $link in *'#'*) anchor=${link#*#} ;; esac
		target=$1
		[ -z "$file" ] || target=$(dirname "$1")/$file
		if [ ! -e "$target" ]; then
			fault "$1: no file behind the link $link"
		elif [ -n "$anchor" ] && ! anchors "$target" | grep -q -x -F -e "$anchor"; then
			fault "$1: no heading behind the link $link"
		fi
	done <"$work/links"
}

# Every `make TARGET`, scripts/FILE and case of a test, `test_FILE: CASE`, that page $1 names is there.
check_names() {
	grep -o -E '(`|^ *)make [a-z][a-z-]+' "$1" | sed 's/.*make //' | sort -u >"$work/names" || :
	while read -r name; do
		grep -q -E "^([a-z -]+ )?$name( [a-z -]+)?:" Makefile scripts/install.mk || fault "$1: no make target $name"
	done <"$work/names"
	grep -o -E '(^|[ `("])(scripts|tests|fit|src|data_readers)/[A-Za-z0-9_/.-]*[A-Za-z0-9_]' "$1" | sed 's/^[ `("]//' |
		sort -u >"$work/names" || :
	while read -r name; do
		[ -e "$name" ] || fault "$1: no file $name"
	done <"$work/names"
	grep -o '`test_[a-z_]*: [A-Za-z0-9_]*' "$1" | tr -d '`:' | sort -u >"$work/names" || :
	while read -r file name; do
		grep -q -s -w -e "$name" "tests/$file.c" || fault "$1: no case $name in tests/$file.c"
	done <"$work/names"
}

# Lines `COMMAND --OPTION`, of the program and of the first two columns of the tables in docs/commands.md.
check_options() {
	stdfit --help | sed -n 's/^  stdfit \[*\([a-z]*\)]* .*/\1/p' | while read -r command; do
		stdfit "$command" --help | sed -n 's/^ \{2,6\}\(-[a-zA-Z], \)*\(--[a-z][a-z0-9-]*\).*/\2/p' | sed "s/^/$command /"
	done | sort -u >"$work/options.program"
	awk -F ' *[|] *' '/^[|] `-/ {
		gsub(/\\[|]/, "/")
		n = split($3, command, " ")
		text = $2
		while (match(text, /--[a-z][a-z0-9-]*/)) {
			for (i = 1; i <= n; i++)
				print command[i], substr(text, RSTART, RLENGTH)
			text = substr(text, RSTART + RLENGTH)
		}
	}' docs/commands.md | sort -u >"$work/options.page"
	comm -23 "$work/options.program" "$work/options.page" >"$work/missing"
	comm -13 "$work/options.program" "$work/options.page" >"$work/extra"
	while read -r option; do fault "docs/commands.md: lacks $option"; done <"$work/missing"
	while read -r option; do fault "docs/commands.md: the program has no $option"; done <"$work/extra"
	[ -s "$work/options.program" ] || fault 'the program names no options'
}

for page; do
	check_sessions "$page"
	check_links "$page"
	check_names "$page"
done
check_options
cd "$root"
echo "check_docs: $# pages, $run commands run, $skipped skipped, $faults faults"
[ $faults -eq 0 ]
