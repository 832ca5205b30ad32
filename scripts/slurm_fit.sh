#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# Fits a batch of MERL files as a Slurm job array, one share of the files a task, and joins the tables in a job after it.
set -eu

usage() {
	cat <<'TEXT'
usage: slurm_fit.sh [-n SHARES] [-c CPUS] [-w] -o OUT.csv PATH... [OPTION of stdfit fit]...

Submits two jobs to Slurm: an array of SHARES tasks (default: 10), of which task I runs

    stdfit fit PATH... OPTION... --shard I/SHARES --threads CPUS --resume -q -o OUT.csv.parts/I-of-SHARES.csv

and, when all have ended in whatever way, one that runs stdfit merge on their tables and PATH... into OUT.csv. That
refuses when a share is missing or did not end: see OUT.csv.parts/*.log, and run the same command again, which goes on
where the tasks stopped. All machines must see the same files under the same names.

  -n SHARES  tasks; at most as many as there are files are of use
  -c CPUS    of each task (default: 1; a task fits as many files at once)
  -w         wait for the end; exit code 0 when OUT.csv is written

What else sbatch should know, it takes from its own variables, as SBATCH_PARTITION, SBATCH_ACCOUNT, SBATCH_TIMELIMIT.
The program is $STDFIT, or stdfit in $PATH.
TEXT
}

wrong_usage() {
	echo "slurm_fit.sh: $1 (see slurm_fit.sh -h)" >&2
	exit 2
}

is_count() {
	case $1 in
	'' | 0* | *[!0-9]*) return 1 ;;
	esac
}

# In the array: one share. Arguments: program, directory of the tables, number of shares, what fit gets.
run_task() {
	stdfit=$1 parts=$2 shares=$3
	shift 3
	share=$SLURM_ARRAY_TASK_ID
	exec "$stdfit" fit "$@" --shard "$share/$shares" --threads "${SLURM_CPUS_PER_TASK:-1}" --resume -q \
		-o "$parts/$share-of-$shares.csv"
}

# After the array. Arguments: program, directory of the tables, number of shares, output, the paths that were fitted.
run_merge() {
	stdfit=$1 parts=$2 shares=$3 out=$4
	shift 4
	share=1
	while [ "$share" -le "$shares" ]; do
		set -- "$@" "$parts/$share-of-$shares.csv"
		share=$((share + 1))
	done
	exec "$stdfit" merge -o "$out" "$@"
}

case ${1:-} in
--task)
	shift
	run_task "$@"
	;;
--merge)
	shift
	run_merge "$@"
	;;
esac

shares=10 cpus=1 out='' wait=''
while getopts :c:hn:o:w option; do
	case $option in
	c) cpus=$OPTARG ;;
	h)
		usage
		exit 0
		;;
	n) shares=$OPTARG ;;
	o) out=$OPTARG ;;
	w) wait=--wait ;;
	:) wrong_usage "expected an argument behind -$OPTARG" ;;
	*) wrong_usage "unknown option -$OPTARG" ;;
	esac
done
shift $((OPTIND - 1))
is_count "$shares" || wrong_usage "expected a number of shares behind -n, found '$shares'"
is_count "$cpus" || wrong_usage "expected a number of processors behind -c, found '$cpus'"
[ -n "$out" ] || wrong_usage 'expected -o OUT.csv'
[ $# -gt 0 ] || wrong_usage 'expected files or directories to fit'
case $1 in
-*) wrong_usage "expected files or directories before '$1'" ;;
esac
command -v sbatch >/dev/null || {
	echo 'slurm_fit.sh: sbatch is not installed here' >&2
	exit 1
}
stdfit=$(command -v "${STDFIT:-stdfit}") || {
	echo "slurm_fit.sh: cannot find the program '${STDFIT:-stdfit}': set STDFIT" >&2
	exit 1
}

# The paths for merge: all before the first option of fit, and whether to look below directories.
parts=$out.parts
mkdir -p "$parts"
recursive=''
for argument; do
	case $argument in
	-r | --recursive) recursive=-r ;;
	esac
done

array=$(sbatch --parsable --job-name=stdfit --array="1-$shares" --cpus-per-task="$cpus" --open-mode=append \
	--output="$parts/%a-of-$shares.log" "$0" --task "$stdfit" "$parts" "$shares" "$@")
array=${array%%;*}

# Of the arguments only the paths, one after the other to the end of the list.
n=$#
taking=yes
while [ "$n" -gt 0 ]; do
	case $1 in
	-*) taking=no ;;
	esac
	[ $taking = no ] || set -- "$@" "$1"
	shift
	n=$((n - 1))
done
[ -z "$recursive" ] || set -- -r "$@"

echo "slurm_fit.sh: job $array fits $shares shares; a job after it writes $out; logs are in $parts" >&2
# shellcheck disable=SC2086 # an option or nothing
sbatch --parsable $wait --job-name=stdfit-merge --dependency="afterany:$array" --output="$parts/merge.log" \
	"$0" --merge "$stdfit" "$parts" "$shares" "$out" "$@"
