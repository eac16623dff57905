#!/usr/bin/env bash
# The header alone, as C and C++, by every compiler that is here, warnings as errors; two translation units that include it; two programs
# parts that each have a static copy of their own.   Usage: builds.sh WORKFOLDER
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
work=$1
warn="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion -Werror -I$top"
printf '#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\n' >"$work/impl.c"
printf '#include "heatdiff.h"\nint main(void) { return hd_status_text(HD_OK)[0] == 0; }\n' >"$work/use.c"
printf '#define HEATDIFF_STATIC\n#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\nint other(void);\nint other(void) { return hd_status_name(HD_OK)[0]; }\n' >"$work/copy1.c"
printf '#define HEATDIFF_STATIC\n#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\nint other(void);\nint main(void) { return hd_status_name(HD_OK)[0] != other(); }\n' >"$work/copy2.c"
for f in impl use copy1 copy2; do cp "$work/$f.c" "$work/$f.cpp"; done
count=0
for c in "gcc -std=c99 -Wstrict-prototypes -Wmissing-prototypes" "gcc -std=c11" "gcc -std=c99 -O3 -march=native -fopenmp" "gcc -std=c99 -DNDEBUG -O2" \
         "clang -std=c99 -Wstrict-prototypes -Wmissing-prototypes" "clang -std=c11" "g++ -std=c++11 -Wold-style-cast" "g++ -std=c++17" "clang++ -std=c++11" "clang++ -std=c++17"; do
  command -v "${c%% *}" >/dev/null || { echo "not here: ${c%% *}"; continue; }
  ext=c; case $c in *++*) ext=cpp ;; esac
  $c $warn -c "$work/impl.$ext" -o "$work/impl.o"
  $c $warn -c "$work/use.$ext" -o "$work/use.o"
  $c "$work/impl.o" "$work/use.o" -o "$work/two" -lm
  "$work/two"
  $c $warn -Wno-unused-function "$work/copy1.$ext" "$work/copy2.$ext" -o "$work/copies" -lm
  "$work/copies"
  count=$((count + 1))
  echo "ok: $c"
done
# 32 bits: the product of a full column by a full row has 2^32 entries, more than such a program can have
cat >"$work/wide.c" <<'END'
#define HEATDIFF_IMPLEMENTATION
#include "heatdiff.h"
enum { N = 65536 };
static int64_t many[N + 1], one[2] = {0, N};
static int32_t zero[N], each[N];
static double val[N];
int main(void) {
    hd_csr a = {N, 1, N, many, zero, val}, b = {1, N, N, one, each, val}, c;
    int32_t i;
    for (i = 0; i < N; i++) {
        many[i + 1] = i + 1;
        each[i] = i;
        val[i] = 1;
    }
    return hd_csr_product(&c, &a, &b, NULL, NULL) != HD_ERR_TOO_LARGE;
}
END
if echo 'int main(void) { return 0; }' | gcc -m32 -x c - -o "$work/small" 2>/dev/null && "$work/small"; then
  gcc -m32 -std=c99 $warn -Wno-psabi "$work/wide.c" -o "$work/wide" -lm
  "$work/wide"
  echo "ok: gcc -m32"
else
  echo "not here: gcc -m32"
fi
# names: everything the implementation exports begins with hd_
gcc -std=c99 -I"$top" -c "$work/impl.c" -o "$work/impl.o"
foreign=$(nm -g --defined-only "$work/impl.o" | awk '{print $3}' | grep -v '^hd_' || true)
[ -z "$foreign" ] || { echo "exported without the prefix hd_: $foreign"; exit 1; }
private=$(nm "$work/impl.o" | awk '$2 ~ /[tdbr]/ {print $3}' | grep -vE '^(hdi_|\.|__func__|__PRETTY_FUNCTION__)' || true)
[ -z "$private" ] || { echo "private without the prefix hdi_: $private"; exit 1; }
echo "$count compilers and standards, exported and private names as they should be"
