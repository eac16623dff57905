#!/usr/bin/env bash
# The tests under sanitizers, with asserts and without; first, a planted error proves that the sanitizer is on.
#     Usage: sanitize.sh WORKFOLDER [all]      all: the slow groups too, whose code the others run as well
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
work=$1
flags="-std=c99 -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=all -I$top"
printf '#include <stdlib.h>\nint main(int c, char **v) { char *p = (char *)malloc(4); (void)v; p[3 + c] = 1; c = p[3]; free(p); return c; }\n' >"$work/planted.c"
for cc in gcc clang; do
  command -v $cc >/dev/null || continue
  $cc $flags "$work/planted.c" -o "$work/planted"
  if "$work/planted" >/dev/null 2>&1; then echo "$cc: the sanitizer is not on"; exit 1; fi
done
gcc $flags "$top/tests/runner.c" -o "$work/runner" -lm
gcc $flags "$top/tests/internals.c" -o "$work/internals" -lm
# two at a time: the groups that take about as long as all others, and those
long="spectrum failures signatures"
slow="engines diagonal forms estimate"
rest=$("$work/runner" --list | grep -vxF "$(printf '%s\n' $long $slow)")
[ "${2:-}" != all ] || long="$long $slow"
mkdir "$work/a" "$work/b"
{ "$work/runner" --tmp "$work/a" $long && "$work/internals"; } >"$work/long.log" 2>&1 &
"$work/runner" --tmp "$work/b" $rest
wait $! || { cat "$work/long.log"; exit 1; }
cat "$work/long.log"
