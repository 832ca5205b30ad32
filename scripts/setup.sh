#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: setup.sh [note | lint | tsan | valgrind | compilers | fuzz | deb]
# Installs what building and testing need, or what that target of make needs besides, with apt-get, if anything of it is
# missing. Says nothing if nothing is. `note` installs nothing, and says only what the program will do without.
set -u

target=${1:-}
libraries='nlopt gsl libxxhash jansson cmocka'
packages='gcc make libc6-dev pkg-config libnlopt-dev libgsl-dev libxxhash-dev libjansson-dev libcmocka-dev'
# What the program or a test can do without.
optional='libpng-dev gnuplot-nox'
tools=
case $target in
'' | note) ;;
lint)
	tools='clang clang-tidy clang-format cppcheck shellcheck'
	packages="$packages clang clang-tidy clang-format libomp-dev cppcheck shellcheck"
	;;
tsan | compilers | fuzz) tools='clang' packages="$packages clang libclang-rt-dev libomp-dev" ;;
deb)
	tools='dpkg-buildpackage dh dh_python3 lintian'
	packages="$packages libpng-dev dpkg-dev debhelper dh-python lintian"
	;;
valgrind) tools='valgrind' packages="$packages valgrind" ;;
*)
	echo "setup: no such target: '$target'" >&2
	exit 2
	;;
esac

# Prints the names of what is not there.
missing() {
	for tool in "${CC:-cc}" make "${PKG_CONFIG:-pkg-config}" $tools; do
		# CC may carry options, as in 'ccache gcc'.
		command -v "${tool%% *}" >/dev/null 2>&1 || printf ' %s' "${tool%% *}"
	done
	for library in $libraries; do
		"${PKG_CONFIG:-pkg-config}" --exists "$library" 2>/dev/null || printf ' %s' "$library"
	done
	case $target in
	tsan) links -fsanitize=thread || printf ' ThreadSanitizer of clang' ;;
	fuzz) links -fsanitize=address || printf ' sanitizers of clang' ;;
	compilers) links || printf ' OpenMP of clang' ;;
	esac
}

# Whether clang can link a program with OpenMP and these options.
links() {
	echo 'int main(void) { return 0; }' | clang -fopenmp "$@" -x c - -o /dev/null 2>/dev/null
}

give_up() {
	echo "setup: $1" >&2
	echo "setup: please install a C compiler, make, pkg-config, and the libraries $libraries with their headers" >&2
	echo "setup: (on Debian: apt-get install $packages)" >&2
	exit 1
}

# One line where the program is to be built without something that it can use.
note_optional() {
	without=
	"${PKG_CONFIG:-pkg-config}" --exists libpng 2>/dev/null || without=' libpng-dev (pictures as PNG)'
	command -v gnuplot >/dev/null 2>&1 || without="$without gnuplot-nox (plots)"
	[ -z "$without" ] || echo "setup: going on without$without" >&2
}

[ "$target" != note ] || { note_optional; exit 0; }
lacking=$(missing)
[ -n "$lacking" ] || { [ -n "$target" ] || note_optional; exit 0; }

command -v apt-get >/dev/null 2>&1 || give_up "not found:$lacking; and there is no apt-get to install them with"
if [ "$(id -u)" -eq 0 ]; then
	sudo=
else
	command -v sudo >/dev/null 2>&1 || give_up "not found:$lacking; installing them needs root or sudo"
	sudo=sudo
fi

install() {
	$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@" >&2
}

echo "setup: not found:$lacking; installing with apt-get" >&2
$sudo env DEBIAN_FRONTEND=noninteractive apt-get update >&2 || give_up 'apt-get update failed'
# shellcheck disable=SC2086 # lists of words
install $packages || give_up 'apt-get install failed'
for package in $optional; do
	install "$package" || echo "setup: going on without $package" >&2
done

lacking=$(missing)
[ -z "$lacking" ] || give_up "still not found after installing:$lacking"
