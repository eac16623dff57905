#!/usr/bin/env bash
# What the implementation takes: bytes of code and constants by room, for the whole file and for a program that builds a Laplacian
# and computes one column (the linker leaves out what that does not reach), with and without the switches HEATDIFF_NO_...,
# and seconds of compiling.
#
#   tools/size.sh [--seconds]      CC=gcc, FLAGS=-Os choose the compiler; --seconds compiles at -O2 too, and times it
#
# A function counts for the room that its first line stands in. What the compiler inlines counts where it ends up.
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
cc=${CC:-gcc}
flags=${FLAGS:--Os}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

printf '#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\n' >"$work/all.c"
cat >"$work/column.c" <<'EOF'
#define HEATDIFF_IMPLEMENTATION
#include "heatdiff.h"
#include <stdio.h>
int main(void) {
    static double xyz[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, u[4];
    static const int32_t tri[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const hd_mesh mesh = hd_triangles(xyz, 4, tri, 4);
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    if (hd_laplacian_create(&lap, &mesh, NULL, NULL) < 0 || hd_heat_create(&heat, lap, NULL, NULL) < 0) return 1;
    if (hd_heat_column(heat, HD_KERNEL_OPERATOR, 1, 0, u, NULL, NULL) < 0) return 1;
    printf("%g\n", u[0]);
    hd_heat_free(heat);
    hd_laplacian_free(lap);
    return 0;
}
EOF

# "room bytes" of every symbol whose line is known, from nm -S -l; constants that have no line count as tables.
by_room() {
  nm -S -l "$1" | awk -v header="$top/heatdiff.h" '
    function hex(s,  i, v) { v = 0; for (i = 1; i <= length(s); i++) v = 16 * v + index("0123456789abcdef", substr(s, i, 1)) - 1; return v }
    BEGIN {
      while ((getline line < header) > 0) {
        n++
        if (match(line, /==== \[[0-9]+\] [a-z]+ ====/)) {
          split(substr(line, RSTART, RLENGTH), word, " ")
          at[++rooms] = n
          name[rooms] = word[2] " " word[3]
        }
      }
    }
    $4 ~ /^(hdi?_|__func__)/ && $3 ~ /[tTrRdDbB]/ {
      room = "[--] tables"
      if (match($0, /heatdiff\.h:[0-9]+/)) {
        line = substr($0, RSTART + 11, RLENGTH - 11) + 0
        for (k = rooms; k > 0 && at[k] > line; k--);
        if (k > 0) room = name[k]
      }
      bytes[room] += hex($2)
    }
    END { for (room in bytes) print room, bytes[room] }'
}

one() {   # NAME SOURCE LINKED FLAGS...
  local name=$1 source=$2 linked=$3
  shift 3
  if [ "$linked" = 1 ]; then
    $cc $flags -g -ffunction-sections -fdata-sections "$@" -I"$top" "$work/$source" -o "$work/$name" -Wl,--gc-sections -lm
  else
    $cc $flags -g -ffunction-sections -fdata-sections "$@" -I"$top" -c "$work/$source" -o "$work/$name"
  fi
  by_room "$work/$name" >"$work/$name.txt"
}
one all all.c 0
one column column.c 1
one plain column.c 1 -DHEATDIFF_NO_SIMD
# the same program without what it cannot need; by factors of poles or krylov, by krylov alone, by iterations alone
lean="-DHEATDIFF_NO_DIAGONAL -DHEATDIFF_NO_INTRINSIC -DHEATDIFF_NO_SPECTRUM -DHEATDIFF_NO_POINTS -DHEATDIFF_NO_POLYGONS"
one lean column.c 1 $lean -DHEATDIFF_NO_ITERATIVE
one lean_plain column.c 1 $lean -DHEATDIFF_NO_ITERATIVE -DHEATDIFF_NO_SIMD
one krylov column.c 1 $lean -DHEATDIFF_NO_ITERATIVE -DHEATDIFF_NO_POLE_FACTORS -DHEATDIFF_NO_SIMD
one iterations column.c 1 $lean -DHEATDIFF_NO_DIRECT -DHEATDIFF_NO_SIMD

echo "$("$cc" --version | head -1), $flags, bytes"
awk -v work="$work" 'BEGIN {
  n = split("all column plain lean lean_plain krylov iterations", set, " ")
  printf "%-16s", "room"
  for (k = 1; k <= n; k++) printf " %10s", set[k]
  printf "\n"
  for (k = 1; k <= n; k++) {
    file = work "/" set[k] ".txt"
    while ((getline < file) > 0) { room = $1 " " $2; bytes[room, k] = $3; sum[k] += $3; seen[room] = 1 }
  }
  for (room in seen) {
    line = sprintf("%-16s", room)
    for (k = 1; k <= n; k++) line = line sprintf(" %10d", bytes[room, k])
    print line | "sort"
  }
  close("sort")
  printf "%-16s", "sum"
  for (k = 1; k <= n; k++) printf " %10d", sum[k]
  printf "\n"
}'
for k in column plain lean lean_plain krylov iterations; do
  size "$work/$k" | awk -v name="$k" 'NR > 1 {printf "program %-10s text %d, data %d\n", name, $1, $2}'
done

if [ "${1:-}" = --seconds ]; then
  printf '#include "heatdiff.h"\n' >"$work/user.c"
  for c in "gcc -O0" "gcc -O1" "gcc -O2" "gcc -Os" "clang -O0" "clang -O1" "clang -O2" "clang -Os" "gcc -O2 -DHEATDIFF_NO_SIMD" \
           "gcc -O2 -DHEATDIFF_NO_DIRECT -DHEATDIFF_NO_INTRINSIC"; do
    command -v "${c%% *}" >/dev/null || continue
    TIMEFORMAT="%U s of processor time: $c, the implementation"
    time $c -I"$top" -c "$work/all.c" -o "$work/timed.o"
  done
  TIMEFORMAT="%U s of processor time: gcc -O2, a hundred files that include the declarations only"
  time for i in {1..100}; do gcc -O2 -I"$top" -c "$work/user.c" -o "$work/timed.o"; done
  printf '' >"$work/user.c"
  TIMEFORMAT="%U s of processor time: gcc -O2, a hundred empty files"
  time for i in {1..100}; do gcc -O2 -c "$work/user.c" -o "$work/timed.o"; done
fi
