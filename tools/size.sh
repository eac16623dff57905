#!/usr/bin/env bash
# What the implementation takes: bytes of code and constants by room, for the whole file and for a program that builds a Laplacian
# and computes one column (the linker leaves out what that does not reach), and seconds of compiling.
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
    hd_laplacian *lap = NULL;
    hd_heat *heat = NULL;
    if (hd_laplacian_triangles(&lap, xyz, 4, tri, 4, NULL, NULL) < 0 || hd_heat_create(&heat, lap, NULL, NULL) < 0) return 1;
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

echo "$("$cc" --version | head -1), $flags, bytes"
printf '%-16s %10s %10s %12s\n' "room" "whole file" "column" "column plain"
awk -v work="$work" 'BEGIN {
  n = split("all column plain", set, " ")
  for (k = 1; k <= n; k++) {
    file = work "/" set[k] ".txt"
    while ((getline < file) > 0) { room = $1 " " $2; bytes[room, k] = $3; sum[k] += $3; seen[room] = 1 }
  }
  for (room in seen) printf "%-16s %10d %10d %12d\n", room, bytes[room, 1], bytes[room, 2], bytes[room, 3] | "sort"
  close("sort")
  printf "%-16s %10d %10d %12d\n", "sum", sum[1], sum[2], sum[3]
}'
size "$work/column" "$work/plain" | awk 'NR > 1 {printf "program %-8s text %d, data %d\n", NR == 2 ? "column" : "plain", $1, $2}'

if [ "${1:-}" = --seconds ]; then
  printf '#include "heatdiff.h"\n' >"$work/user.c"
  for c in "gcc -O2" "gcc -Os" "gcc -O0" "gcc -O2 -DHEATDIFF_NO_SIMD" "clang -O2"; do
    command -v "${c%% *}" >/dev/null || continue
    TIMEFORMAT="%U s of processor time: $c, the implementation"
    time $c -I"$top" -c "$work/all.c" -o "$work/timed.o"
  done
  TIMEFORMAT="%U s of processor time: gcc -O2, twenty files that include the declarations only"
  time for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do gcc -O2 -I"$top" -c "$work/user.c" -o "$work/timed.o"; done
  printf '' >"$work/user.c"
  TIMEFORMAT="%U s of processor time: gcc -O2, twenty empty files"
  time for i in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20; do gcc -O2 -c "$work/user.c" -o "$work/timed.o"; done
fi
