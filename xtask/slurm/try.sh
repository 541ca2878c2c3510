#!/usr/bin/env bash
# A sweep three ways, which must come to the same bytes: all cores of this machine; an array of four Slurm tasks of which one is killed
# half way and queued again; and eight shards in reverse order.
#
#     xtask/slurm/try.sh PROGRAM SWEEP FOLDER
set -euo pipefail
[ $# -eq 3 ] || { printf 'usage: try.sh PROGRAM SWEEP FOLDER\n' >&2; exit 2; }
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
program=$(realpath "$1") sweep=$(realpath "$2")
mkdir -p "$3"
folder=$(cd "$3" && pwd)
rm -rf "$folder/whole" "$folder/array" "$folder/reverse"
say() { printf 'try.sh: %s\n' "$*"; }

start=$SECONDS
"$program" --quiet sweep "$sweep" --out "$folder/whole"
say "all cores: $(($(wc -l <"$folder/whole/table.csv") - 1)) cases in $((SECONDS - start)) s"

eval "$("$here/one-host.sh" up "$folder/slurm")"
trap '"$here/one-host.sh" down "$folder/slurm"' EXIT
mkdir -p "$folder/array"
start=$SECONDS
id=$(OSCULATE=$program sbatch --parsable --chdir="$folder/array" --array=1-4 "$here/sweep.sbatch" "$sweep" "$folder/array" 4)
# The first task has a fourth of the cases: it is killed when half of these are done.
half=$((($(wc -l <"$folder/whole/table.csv") - 1) / 8))
rows=$folder/array/rows-1-of-4.jsonl
until [ -f "$rows" ] && [ "$(wc -l <"$rows")" -ge "$half" ]; do sleep 0.2; done
scontrol requeue "${id}_1"
say "task 1 killed and queued again behind $(wc -l <"$rows") rows"
while [ -n "$(squeue --noheader --jobs "$id" 2>/dev/null)" ]; do sleep 1; done
"$program" --quiet sweep "$sweep" --out "$folder/array" --merge
say "four Slurm tasks in $((SECONDS - start)) s"

for k in 8 7 6 5 4 3 2 1; do "$program" --quiet sweep "$sweep" --out "$folder/reverse" --shard "$k/8"; done
"$program" --quiet sweep "$sweep" --out "$folder/reverse" --merge

for way in array reverse; do
    for name in table.csv sweep.html; do
        cmp "$folder/whole/$name" "$folder/$way/$name"
    done
done
say "the same table and page three times"
