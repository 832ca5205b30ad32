#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Gets the MERL BRDF database, or says how to get it by hand. Needs curl or wget, and unzip for the archive.
set -u

default_address='https://zenodo.org/records/8101681/files/BRDFDatabase.zip'
file_size=34992012             # 3 int32 and 3 planes of 90 x 90 x 180 float64
file_start='5a0000005a000000b4000000' # 90, 90, 180, little-endian
archive_limit=4294967296       # what is longer is no archive of 1.25 GB
tries=3                        # without a byte more
rows_of_failures=3             # files without a byte one after the other: the network is away

materials='
alum-bronze alumina-oxide aluminium aventurnine beige-fabric black-fabric black-obsidian black-oxidized-steel
black-phenolic black-soft-plastic blue-acrylic blue-fabric blue-metallic-paint blue-metallic-paint2 blue-rubber brass
cherry-235 chrome chrome-steel colonial-maple-223 color-changing-paint1 color-changing-paint2 color-changing-paint3
dark-blue-paint dark-red-paint dark-specular-fabric delrin fruitwood-241 gold-metallic-paint gold-metallic-paint2
gold-metallic-paint3 gold-paint gray-plastic grease-covered-steel green-acrylic green-fabric green-latex
green-metallic-paint green-metallic-paint2 green-plastic hematite ipswich-pine-221 light-brown-fabric light-red-paint
maroon-plastic natural-209 neoprene-rubber nickel nylon orange-paint pearl-paint pickled-oak-260 pink-fabric
pink-fabric2 pink-felt pink-jasper pink-plastic polyethylene polyurethane-foam pure-rubber purple-paint pvc red-fabric
red-fabric2 red-metallic-paint red-phenolic red-plastic red-specular-plastic silicon-nitrade silver-metallic-paint
silver-metallic-paint2 silver-paint special-walnut-224 specular-black-phenolic specular-blue-phenolic
specular-green-phenolic specular-maroon-phenolic specular-orange-phenolic specular-red-phenolic
specular-violet-phenolic specular-white-phenolic specular-yellow-phenolic ss440 steel teflon tungsten-carbide
two-layer-gold two-layer-silver violet-acrylic violet-rubber white-acrylic white-diffuse-bball white-fabric
white-fabric2 white-marble white-paint yellow-matte-plastic yellow-paint yellow-phenolic yellow-plastic
'
# shellcheck disable=SC2086,SC2116 # a list of words, on one line
materials=$(echo $materials)

usage() {
	cat <<TEXT
usage: fetch_merl.sh [-c] [-l] [-t SECONDS] [-u ADDRESS] [DIR [MATERIAL...]]

Gets the 100 files of the MERL BRDF database, or the materials named, into DIR (default: merl), each as
MATERIAL.binary once it is whole, checked for its size and its first bytes. What is there already stays; run again
after an interruption, it goes on where it stopped.

  -u ADDRESS  of the archive (ends in .zip), or of a directory with the files MATERIAL.binary
              (default: \$MERL_ADDRESS, or $default_address)
  -t SECONDS  give a silent server that long (default: 60)
  -c          check what is in DIR, fetch nothing
  -l          list the names of the materials
TEXT
}

say() {
	printf 'fetch_merl.sh: %s\n' "$1" >&2
}

by_hand() {
	cat >&2 <<TEXT
fetch_merl.sh: to get the database by hand: open https://www.merl.com/research/downloads/BRDF (or
fetch_merl.sh: https://zenodo.org/records/8101681), download BRDFDatabase.zip (1.25 GB) into '$directory', and run this
fetch_merl.sh: again; or unpack it yourself and put the files brdfs/*.binary, $file_size bytes each, into '$directory'.
TEXT
}

wrong_usage() {
	say "$1 (see fetch_merl.sh -h)"
	exit 2
}

size_of() {
	if [ -f "$1" ]; then
		wc -c <"$1" | tr -d ' '
	else
		echo 0
	fi
}

# What is wrong with a file, on standard output; nothing if it is a MERL table.
flaw_of() {
	size=$(size_of "$1")
	if [ "$size" != $file_size ]; then
		echo "$size bytes, expected $file_size"
	elif [ "$(od -An -v -tx1 -N12 "$1" | tr -d ' \n')" != $file_start ]; then
		echo 'no MERL table: expected 90, 90, 180 in the first 12 bytes'
	fi
}

# One attempt to get what is missing of $1 into $2, $3 bytes at most. Sets $end: complete, broken, refused (the server
# has no such file), restart (it does not go on in the middle), away (there is no server), unwritable; and $why.
attempt() {
	blocks=$(($3 / 512 + 1))
	size=$(size_of "$2")
	if [ "$tool" = curl ]; then
		from='' quiet=-s
		[ "$size" -eq 0 ] || from="-C $size"
		[ ! -t 2 ] || quiet=-\#
		# shellcheck disable=SC2086 # options or nothing
		http=$(
			ulimit -f $blocks 2>/dev/null
			trap '' XFSZ
			curl $quiet -f -g -L --proto '=http,https' --connect-timeout "$timeout" --speed-limit 1 \
				--speed-time "$timeout" $from -o "$2" -w '%{http_code}' --url "$1"
		)
		code=$?
		why="curl ended with code $code"
		case $code:$http in
		0:*) end=complete ;;
		22:416 | 33:* | 36:*) end=restart ;;
		22:5* | 22:429 | 22:408) end=broken why="HTTP $http" ;;
		22:*) end=refused why="HTTP $http" ;;
		5:* | 6:*) end=away why="unknown host" ;;
		7:*) end=away why="no connection" ;;
		23:*) end=unwritable why="cannot write '$2'" ;;
		28:*) end=broken why="no byte for $timeout s" ;;
		1:* | 3:* | 35:* | 51:* | 58:* | 59:* | 60:* | 77:*) end=away ;;
		*) end=broken ;;
		esac
		return
	fi
	words=$(
		ulimit -f $blocks 2>/dev/null
		trap '' XFSZ
		LC_ALL=C wget -nv -S -c --tries=1 --timeout="$timeout" -O "$2" "$1" 2>&1
	)
	code=$?
	http=$(printf '%s\n' "$words" | sed -n 's,^ *HTTP/[0-9.]* \([0-9][0-9][0-9]\).*,\1,p' | tail -n 1)
	why="wget ended with code $code"
	case $code:$http in
	0:*) end=complete ;;
	*:416) end=restart ;;
	*:5* | *:429 | *:408) end=broken why="HTTP $http" ;;
	*:4*) end=refused why="HTTP $http" ;;
	3:*) end=unwritable why="cannot write '$2'" ;;
	4:) end=away why="no connection" ;;
	*) end=broken ;;
	esac
	case $words in
	*'Refusing to truncate'*) end=restart ;;
	esac
}

# Gets $1 into $2, $3 bytes at most, and tries again as long as an attempt gets further. Sets $end and $why as attempt() does,
# and $progress to yes if there was any.
get() {
	progress=no failures=0 restarted=no
	while :; do
		before=$(size_of "$2")
		attempt "$1" "$2" "$3"
		after=$(size_of "$2")
		if [ "$after" -gt "$3" ]; then
			end=refused why="more than $3 bytes came"
		fi
		case $end in
		complete | refused | away | unwritable) return ;;
		restart)
			# Once: a server that says so of an empty file will never send any.
			[ $restarted = no ] || return
			restarted=yes
			rm -f "$2"
			continue
			;;
		esac
		[ "$after" -lt "$3" ] || return
		if [ "$after" -gt "$before" ]; then
			progress=yes failures=0
		else
			failures=$((failures + 1))
			[ $failures -lt $tries ] || return
			sleep 1
		fi
	done
}

# Sets $flaw to what keeps $1 from being there, nothing if it is.
fetch_file() {
	part=$directory/$1.binary.part
	[ -z "$(flaw_of "$part")" ] || [ "$(size_of "$part")" -lt $file_size ] || rm -f "$part"
	flaw=$(flaw_of "$part")
	if [ -n "$flaw" ]; then
		get "$address/$1.binary" "$part" $file_size
		flaw=$(flaw_of "$part")
	fi
	if [ -z "$flaw" ]; then
		mv -f "$part" "$directory/$1.binary" || give_up "cannot write '$directory/$1.binary'"
		return
	fi
	size=$(size_of "$part")
	case $end in
	complete) flaw="what the server has is $flaw" ;;
	broken | away | unwritable)
		flaw="$why; $size of $file_size bytes are there; run again to go on"
		[ "$size" -eq 0 ] || [ "$size" -ge $file_size ] || return
		;;
	*) flaw=$why ;;
	esac
	rm -f "$part"
}

# Gets the archive into $archive, unless it is there.
fetch_archive() {
	if [ -e "$archive" ]; then
		unzip -Z1 "$archive" >/dev/null 2>&1 && return 0
		say "$archive: no whole zip archive; left alone: move it away to have it fetched"
		return 1
	fi
	say "fetching $address"
	get "$address" "$archive.part" $archive_limit
	if unzip -Z1 "$archive.part" >/dev/null 2>&1; then
		mv -f "$archive.part" "$archive" || give_up "cannot write '$archive'"
		return 0
	fi
	size=$(size_of "$archive.part")
	case $end in
	broken | away | unwritable)
		[ "$size" -gt 0 ] || rm -f "$archive.part"
		say "$archive: $why; $size bytes are there; run again to go on"
		;;
	complete)
		rm -f "$archive.part"
		say "$archive: what the server has, $size bytes, is no zip archive"
		;;
	*)
		rm -f "$archive.part"
		say "$archive: $why"
		;;
	esac
	return 1
}

# As fetch_file(), out of the archive.
extract_file() {
	part=$directory/$1.binary.part
	member=$(unzip -Z1 "$archive" 2>/dev/null | grep -e "^$1[.]binary\$" -e "/$1[.]binary\$" | head -n 1)
	if [ -z "$member" ]; then
		flaw="not in '$archive'"
		return
	fi
	if (
		ulimit -f $((file_size / 512 + 1)) 2>/dev/null
		trap '' XFSZ
		unzip -p "$archive" "$member" >"$part" 2>/dev/null
	); then
		flaw=$(flaw_of "$part")
	else
		flaw="damaged in '$archive', or the disk is full"
	fi
	if [ -n "$flaw" ]; then
		rm -f "$part"
	else
		mv -f "$part" "$directory/$1.binary" || give_up "cannot write '$directory/$1.binary'"
	fi
}

give_up() {
	say "$1"
	exit 1
}

address=${MERL_ADDRESS:-$default_address}
timeout=60
check=no
while getopts :chlt:u: option; do
	case $option in
	c) check=yes ;;
	h)
		usage
		exit 0
		;;
	l)
		# shellcheck disable=SC2086 # a list of words
		printf '%s\n' $materials
		exit 0
		;;
	t) timeout=$OPTARG ;;
	u) address=$OPTARG ;;
	:) wrong_usage "expected an argument behind -$OPTARG" ;;
	*) wrong_usage "unknown option -$OPTARG" ;;
	esac
done
shift $((OPTIND - 1))
case $timeout in
'' | *[!0-9]* | 0*) wrong_usage "expected whole seconds behind -t, found '$timeout'" ;;
esac
case $address in
http://?* | https://?*) ;;
*) wrong_usage "expected an address that begins with http:// or https://, found '$address'" ;;
esac
directory=${1:-merl}
case $directory in
?*/) directory=${directory%/} ;;
esac
[ $# -eq 0 ] || shift
for material; do
	case " $materials " in
	*" $material "*) ;;
	*) wrong_usage "no material of the database: '$material'" ;;
	esac
done
# shellcheck disable=SC2086 # a list of words
[ $# -gt 0 ] || set -- $materials

trap 'exit 130' INT TERM
if command -v curl >/dev/null; then
	tool=curl
elif command -v wget >/dev/null; then
	tool=wget
elif [ $check = no ]; then
	say 'neither curl nor wget is installed'
	by_hand
	exit 1
fi
[ $check = yes ] || mkdir -p "$directory" 2>/dev/null || give_up "cannot make the directory '$directory'"
[ -d "$directory" ] || give_up "'$directory' is no directory"
without_query=${address%%[?#]*}
archive=''
case $without_query in
*.zip)
	archive=$directory/${without_query##*/}
	if [ $check = no ] && ! command -v unzip >/dev/null; then
		say 'unzip is not installed, which the archive needs'
		by_hand
		exit 1
	fi
	;;
*) address=${address%/} ;;
esac

there=0 missing='' rows=0 fetched=0
for material; do
	file=$directory/$material.binary
	flaw=$(flaw_of "$file")
	if [ -z "$flaw" ]; then
		there=$((there + 1))
		continue
	fi
	if [ -e "$file" ]; then
		say "$file: $flaw; left alone: move it away to have it fetched"
		missing="$missing $material"
		continue
	fi
	if [ $check = yes ]; then
		missing="$missing $material"
		continue
	fi
	end='' progress=no
	if [ -z "$archive" ]; then
		fetch_file "$material"
	elif fetch_archive; then
		extract_file "$material"
	else
		by_hand
		exit 1
	fi
	if [ -z "$flaw" ]; then
		there=$((there + 1)) fetched=$((fetched + 1)) rows=0
		[ ! -t 2 ] || say "$file"
		continue
	fi
	say "$file: $flaw"
	missing="$missing $material"
	[ "$end" != unwritable ] || give_up 'giving up; run again to go on'
	if [ "$end" = broken ] && [ $progress = no ]; then
		rows=$((rows + 1))
	fi
	if [ "$end" = away ] || [ $rows -ge $rows_of_failures ]; then
		say "nothing comes from $address"
		by_hand
		exit 1
	fi
done

for file in "$directory"/*.binary; do
	material=${file##*/}
	case " $materials " in
	*" ${material%.binary} "*) ;;
	*) [ ! -e "$file" ] || say "$file: no material of the database" ;;
	esac
done
echo "$there of $# files are in $directory and have the right size"
[ -n "$missing" ] || exit 0
say "missing:$missing"
[ $check = no ] || by_hand
exit 1
