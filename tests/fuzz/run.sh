#!/usr/bin/env bash
# Fuzzes each target for a while, from the kept inputs on; prints one line a target, and a failing input as a line of the corpus.
#     Usage: run.sh [SECONDS [TARGET...]]       default: 60, all targets
#     FUZZ_WORK=FOLDER  where it works and leaves what it found; default: a folder that is removed
#     FUZZ_KEEP=1       afterwards adds found inputs to tests/fuzz/corpus, as few as reach the same code
# With clang: libFuzzer and sanitizers. Else the kept inputs, then random ones. Without vector code, which takes clang 14 ten minutes at
# -O1. Runs of a minute and more use -O1: 90 s of processor time to compile instead of 4 s, and up to five times as many inputs a second.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
corpus=$top/tests/fuzz/corpus
seconds=${1:-60}
shift || true
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(mesh table levels operators queries sources lengths geodesics filters matrices options)
work=${FUZZ_WORK:-$(mktemp -d)}
[ -n "${FUZZ_WORK:-}" ] || trap 'rm -rf "$work"' EXIT
mkdir -p "$work"
ub=bounds,signed-integer-overflow,shift,float-cast-overflow,integer-divide-by-zero,nonnull-attribute,vla-bound
level=-O0
[ "$seconds" -lt 60 ] || level=-O1
flags=(-std=gnu99 -g1 $level -DHEATDIFF_NO_SIMD -fno-sanitize-recover=all -I"$top")
export ASAN_OPTIONS=abort_on_error=1:handle_abort=0
failed=0

# The lines of CORPUS/TARGET.txt and the files of CORPUS/TARGET/, one file each.
unpack() {
  local k=0 line
  mkdir -p "$work/seeds/$1" "$work/found/$1"
  if [ -f "$corpus/$1.txt" ]; then
    while read -r line; do
      [ "${line:0:1}" = '#' ] || printf '%b' "$(sed 's/../\\x&/g' <<<"$line")" >"$work/seeds/$1/kept-$((k++))"
    done <"$corpus/$1.txt"
  fi
  [ ! -d "$corpus/$1" ] || cp "$corpus/$1"/* "$work/seeds/$1/"
}

hex() { od -An -v -tx1 "$1" | tr -d ' \n'; echo; }

# As few inputs as reach each branch that the kept and the found ones reach, the kept ones first.
keep() {
  rm -rf "$work/least" && mkdir "$work/least"
  "$work/fuzz" --target="$1" -merge=1 -use_counters=0 -max_len=1024 "$work/least" "$work/seeds/$1" "$work/found/$1" 2>/dev/null
  [ -f "$corpus/$1.txt" ] || echo "# one input a line" >"$corpus/$1.txt"
  for f in "$work/least"/*; do
    find "$work/seeds/$1" -type f -exec cmp -s {} "$f" \; -print -quit | grep -q . || hex "$f" >>"$corpus/$1.txt"
  done
}

printf '#include <stddef.h>\n#include <stdint.h>\nint LLVMFuzzerTestOneInput(const uint8_t *p, size_t n) { return p && n ? 0 : 0; }\n' >"$work/probe.c"
if clang -fsanitize=fuzzer "$work/probe.c" -o "$work/probe" 2>/dev/null; then
  printf '#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\n' >"$work/impl.c"
  clang "${flags[@]}" -fsanitize=fuzzer-no-link,address,$ub -c "$work/impl.c" -o "$work/impl.o"
  clang "${flags[@]}" -DHEATDIFF_LIBFUZZER -fsanitize=fuzzer,address,$ub "$top/tests/fuzz/fuzz.c" "$work/impl.o" -o "$work/fuzz" -lm
  for t in "${targets[@]}"; do
    ok=clean
    unpack "$t"
    "$work/fuzz" --target="$t" -max_total_time="$seconds" -timeout=25 -max_len=1024 -seed="${FUZZ_SEED:-0}" -print_final_stats=1 -artifact_prefix="$work/$t-" \
      "$work/found/$t" "$work/seeds/$t" >"$work/$t.log" 2>&1 || { ok=FAILED; failed=1; }
    echo "$t: $(sed -n 's/^stat::number_of_executed_units: *//p' "$work/$t.log") inputs, $ok"
    if [ $ok = FAILED ]; then
      grep -E 'fuzz.c:[0-9]+:|ERROR|SUMMARY|runtime error' "$work/$t.log" || tail -3 "$work/$t.log"
      for f in "$work/$t-"*-*; do [ ! -f "$f" ] || hex "$f"; done
    elif [ -n "${FUZZ_KEEP:-}" ]; then
      keep "$t"
    fi
  done
else
  gcc "${flags[@]}" -fsanitize=address,undefined "$top/tests/fuzz/fuzz.c" -o "$work/plain" -lm
  "$work/plain" "$corpus"
  for t in "${targets[@]}"; do "$work/plain" --random "$t" "$seconds" 1 || { echo "$t: FAILED"; failed=1; }; done
fi
exit $failed
