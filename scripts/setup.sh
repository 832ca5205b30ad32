#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Installs what building and testing need, with apt-get, if anything is missing. Says nothing if nothing is.
set -u

libraries='nlopt gsl libxxhash cmocka'
packages='gcc make libc6-dev pkg-config libnlopt-dev libgsl-dev libxxhash-dev libcmocka-dev'

# Prints the names of what is not there.
missing() {
	for tool in "${CC:-cc}" make "${PKG_CONFIG:-pkg-config}"; do
		# CC may carry options, as in 'ccache gcc'.
		command -v "${tool%% *}" >/dev/null 2>&1 || printf ' %s' "${tool%% *}"
	done
	for library in $libraries; do
		"${PKG_CONFIG:-pkg-config}" --exists "$library" 2>/dev/null || printf ' %s' "$library"
	done
}

give_up() {
	echo "setup: $1" >&2
	echo "setup: please install a C compiler, make, pkg-config, and the libraries $libraries with their headers" >&2
	echo "setup: (on Debian: apt-get install $packages)" >&2
	exit 1
}

lacking=$(missing)
[ -n "$lacking" ] || exit 0

command -v apt-get >/dev/null 2>&1 || give_up "not found:$lacking; and there is no apt-get to install them with"
if [ "$(id -u)" -eq 0 ]; then
	sudo=
else
	command -v sudo >/dev/null 2>&1 || give_up "not found:$lacking; installing them needs root or sudo"
	sudo=sudo
fi

echo "setup: not found:$lacking; installing with apt-get" >&2
$sudo env DEBIAN_FRONTEND=noninteractive apt-get update >&2 || give_up 'apt-get update failed'
# shellcheck disable=SC2086 # a list of words
$sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends $packages >&2 ||
	give_up 'apt-get install failed'

lacking=$(missing)
[ -z "$lacking" ] || give_up "still not found after installing:$lacking"
