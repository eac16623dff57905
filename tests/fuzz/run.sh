#!/usr/bin/env bash
# Fuzzes each target for a while, from the kept inputs on; prints one line a target. A failing input stays in the work folder.
#     Usage: run.sh [SECONDS [TARGET...]]       default: 60, all targets;  FUZZ_WORK=FOLDER: where it works
# With clang: libFuzzer and sanitizers (the header takes minutes to compile then). Else the kept inputs, then random ones.
set -euo pipefail
top=$(cd "$(dirname "$0")/../.." && pwd)
seconds=${1:-60}
shift || true
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=(mesh table operators queries matrices options)
work=${FUZZ_WORK:-$(mktemp -d)}
mkdir -p "$work"
ub=bounds,signed-integer-overflow,shift,float-cast-overflow,integer-divide-by-zero,nonnull-attribute,vla-bound
export ASAN_OPTIONS=abort_on_error=1:handle_abort=0
failed=0
printf '#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\n' >"$work/impl.c"
printf '#include <stddef.h>\n#include <stdint.h>\nint LLVMFuzzerTestOneInput(const uint8_t *p, size_t n) { return p && n ? 0 : 0; }\n' >"$work/probe.c"
gcc -std=gnu99 -g1 -O1 -fsanitize=address,undefined -fno-sanitize-recover=all -I"$top" "$top/tests/fuzz/fuzz.c" -o "$work/plain" -lm
"$work/plain" "$top/tests/fuzz/corpus" || exit 1
if clang -fsanitize=fuzzer "$work/probe.c" -o "$work/probe" 2>/dev/null; then
  clang -std=gnu99 -gline-tables-only -O1 -fsanitize=fuzzer-no-link,address,$ub -fno-sanitize-recover=all -I"$top" -c "$work/impl.c" -o "$work/impl.o"
  clang -std=gnu99 -g -O1 -DHEATDIFF_LIBFUZZER -fsanitize=fuzzer,address,$ub -fno-sanitize-recover=all -I"$top" "$top/tests/fuzz/fuzz.c" \
    "$work/impl.o" -o "$work/fuzz" -lm
  mkdir -p "$work/seeds"
  "$work/plain" "$top/tests/fuzz/corpus" --unpack "$work/seeds" >/dev/null
  for t in "${targets[@]}"; do
    mkdir -p "$work/found/$t"
    ok=clean
    "$work/fuzz" --target="$t" -max_total_time="$seconds" -timeout=5 -max_len=4096 -print_final_stats=1 -artifact_prefix="$work/$t-" \
      "$work/found/$t" "$work/seeds/$t" >"$work/$t.log" 2>&1 || { ok="FAILED, see $work/$t.log"; failed=1; }
    echo "$t: $(sed -n 's/^stat::number_of_executed_units: *//p' "$work/$t.log") inputs, $ok"
  done
else
  for t in "${targets[@]}"; do "$work/plain" --random "$t" "$seconds" 1 || { echo "$t: FAILED"; failed=1; }; done
fi
exit $failed
