#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# usage: exports.sh OBJECT... <HEADER
# Prints the names that the objects define and that a header, given as the preprocessor prints it, declares: what a
# library made of the objects is to export.
set -eu
export LC_ALL=C

names=$(mktemp)
trap 'rm -f "$names"' EXIT
# Lines like: # 12 "src/ndf.h" 2. Only what comes from our own files counts, which have no absolute path.
awk '/^# [0-9]/ { ours = $3 !~ /^"[\/<]/; next } ours' | grep -o '[A-Za-z_][A-Za-z_0-9]*' | sort -u >"$names"
nm --defined-only --extern-only "$@" | awk 'NF == 3 { print $3 }' | sort -u | comm -12 - "$names"
