#!/usr/bin/env bash
# examples/patches.c in 1, 2 and 4 processes, stopped and resumed: the same bits every time.
# Usage: patches.sh [DIRECTORY [IMPLEMENTATION.o]]        the object: heatdiff.h compiled already
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
work=${1:-$(mktemp -d)}
[ $# -gt 0 ] || trap 'rm -rf "$work"' EXIT
mkdir -p "$work"
program=$top/examples/patches.c
if [ $# -gt 1 ]; then
  sed '/^#define HEATDIFF_IMPLEMENTATION/d; s|"\.\./|"|' "$program" >"$work/patches.c"
  program="$work/patches.c $2 -I$top"
fi
# shellcheck disable=SC2086
${CC:-cc} -std=c99 -O1 -Wall -Wextra -Wshadow -Werror $program -o "$work/patches" -lm -lpthread
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1
cd "$work"
rm -f ./*.npy*
options=(-size 80 -piece 1300 -t 0.5 -memory 0.015)
./patches "${options[@]}" one.npy >/dev/null 2>one.log
grep -q ' [2-9][0-9]* patches' one.log || { cat one.log; exit 1; }     # the byte limit counts
runs=1
same() { cmp "$1" one.npy; runs=$((runs + 1)); }
for ranks in 2 4; do
  if command -v mpirun >/dev/null; then
    mpirun -np $ranks ./patches "${options[@]}" $ranks.npy >/dev/null 2>&1
  else
    for ((r = 0; r < ranks; r++)); do ./patches -rank $r -ranks $ranks "${options[@]}" $ranks.npy >/dev/null 2>&1 & done
    wait
  fi
  same $ranks.npy
done
rm 4.npy 4.npy.3
head -c 100 4.npy.1 >cut && mv cut 4.npy.1     # a file of something else
./patches "${options[@]}" 4.npy >/dev/null 2>again.log
[ "$(grep -c piece again.log)" = 2 ] || { cat again.log; exit 1; }
same 4.npy
./patches -size 80 -piece 1300 -t 0.7 -memory 0.015 4.npy >/dev/null 2>again.log     # another question
[ "$(grep -c piece again.log)" = 5 ] || { cat again.log; exit 1; }
! cmp -s 4.npy one.npy
echo "$runs passed, 0 failed"
