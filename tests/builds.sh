#!/usr/bin/env bash
# The header alone, as C and C++, by every compiler that is here, warnings as errors; two files of a program that include it, and two
# that each have a static copy of their own; under another name; with -ffast-math. What only the optimiser warns of is found by the
# CMake build, which CI makes with -Werror.   Usage: builds.sh WORKFOLDER
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
work=$(cd "$1" && pwd)
warn="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion -Werror"
for ext in c cpp; do
  printf '#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\n' >"$work/impl.$ext"
  printf '#include "heatdiff.h"\nint main(void) { return hd_status_text(HD_OK)[0] == 0; }\n' >"$work/use.$ext"
done
syntax=0
is_here() {   # COMPILER FLAGS...: with a standard that it knows
  local lang=c
  case $1 in *++*) lang=c++ ;; esac
  command -v "$1" >/dev/null && "$@" -x $lang -fsyntax-only /dev/null 2>/dev/null && return
  echo "not here: $*"
  [ -z "${HEATDIFF_NO_SKIP:-}" ] || exit 1
  return 1
}
# Every row is read through, with all warnings.
for c in "gcc -std=c99 -Wstrict-prototypes -Wmissing-prototypes" "gcc -std=c11" "gcc -std=c99 -march=native" "gcc -std=c99 -DHEATDIFF_NO_THREADS" \
         "clang -std=c99 -Wstrict-prototypes -Wmissing-prototypes" "clang -std=c11" "g++ -std=c++11 -Wold-style-cast" "g++ -std=c++20" "g++ -std=c++23" \
         "clang++ -std=c++11 -Wold-style-cast" "clang++ -std=c++20" "clang -std=c99 -DNDEBUG"; do
  is_here $c || continue
  ext=c; case $c in *++*) ext=cpp ;; esac
  for f in impl use; do $c $warn -I"$top" -fsyntax-only "$work/$f.$ext"; done
  syntax=$((syntax + 1))
  echo "ok: $c"
done
gcc -std=c99 -I"$top" "$work/use.c" -c -o "$work/use.o"
gcc -std=c99 -I"$top" "$work/impl.c" -c -o "$work/impl.o"
gcc "$work/use.o" "$work/impl.o" -o "$work/two" -lm
"$work/two"
# Two static copies in a program, a whole one and one without vector code. The whole one has the header under another name, found by a
# path in C and in a folder of -I in C++: for the instruction sets the header includes itself.
mkdir -p "$work/far/own"
cp "$top/heatdiff.h" "$work/far/own/renamed.hpp"
static='#define HEATDIFF_STATIC\n#define HEATDIFF_IMPLEMENTATION\n#include'
whole='int other(void);\nint main(void) { return hd_status_name(HD_OK)[0] != other() || hdi_kernels_get(2, 0)->nr < 4; }\n'
small='int other(void);\nint other(void) { return hd_status_name(HD_OK)[0]; }\n'
printf "$static \"far/own/renamed.hpp\"\n$whole" >"$work/whole.c"
printf "$static <own/renamed.hpp>\n$whole" >"$work/whole.cpp"
for ext in c cpp; do
  printf "$static \"heatdiff.h\"\n$small" >"$work/small.$ext"
  printf '#define HEATDIFF_IMPLEMENTATION\n#define HEATDIFF_FILENAME <stddef.h>\n#include "heatdiff.h"\n' >"$work/wrong.$ext"
done
cd "$work"
for c in gcc g++ clang clang++; do
  is_here $c || continue
  ext=c far=; case $c in *++) ext=cpp far=-Ifar ;; esac
  case $c in
  clang*) $c $warn $far -fsyntax-only whole.$ext ;;
  *)
    $c $warn $far -c whole.$ext -o whole.o
    $c $warn -I"$top" -DHEATDIFF_NO_SIMD small.$ext whole.o -o copies -lm
    ./copies
    names=$(nm -g --defined-only whole.o | awk '$2 ~ /[TDBR]/ {print $3}')
    [ "$names" = main ] || { echo "a static copy exports $names"; exit 1; } ;;
  esac
  if [ "$(uname -m)" = x86_64 ] && $c -fsyntax-only -I"$top" wrong.$ext 2>wrong.txt; then echo "a wrong HEATDIFF_FILENAME passes"; exit 1; fi
  $c -fsyntax-only -DHEATDIFF_NO_SIMD -I"$top" wrong.$ext
  echo "ok: static copies, renamed, $c"
done
# the benchmark is built on request only
gcc -std=gnu99 -Werror=implicit-function-declaration -fsyntax-only -I"$top" "$top/tools/bench.c"
# -ffast-math lets compilers take it that no number is NaN or infinite: those in the input are told all the same
cat >"$work/fast.c" <<'END'
#define HEATDIFF_IMPLEMENTATION
#include "heatdiff.h"
#include <stdio.h>
static const uint64_t bits[3] = {0x7ff8000000000000, 0x7ff0000000000000, 0xfff0000000000000};   /* NaN, both infinities */
static int failed;
static void is(int line, hd_status have, hd_status want) {
    if (have == want) return;
    printf("line %d: %s instead of %s\n", line, hd_status_name(have), hd_status_name(want));
    failed = 1;
}
#define IS(call, want) is(__LINE__, call, want)
int main(void) {
    const double one = 1;
    double xyz[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2}, v[4] = {1, 2, 3, 4}, u[6], t;
    const int32_t tri[18] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 4, 5, 0, 4, 4, 1}, i[4] = {0, 1, 2, 3}, same[2] = {1, 1};
    hd_c64 b[6], x[6];
    hd_mesh mesh = hd_triangles(xyz, 6, tri, 6);
    hd_laplacian_opts tufted = {0};
    hd_laplacian *lap = NULL, *none = NULL;
    hd_geodesic *g = NULL;
    hd_heat *heat = NULL;
    hd_ldl *f = NULL;
    hd_csr a, c;
    int k;
    IS(hd_laplacian_create(&lap, &mesh, NULL, NULL), HD_OK);
    tufted.triangulation = HD_TRIANGULATION_TUFTED;
    if (lap->mesh.n_zero_area != 1 || lap->n_active != 4) failed = printf("degenerate faces\n");
    IS(hd_heat_create(&heat, lap, NULL, NULL), HD_OK);
    IS(hd_csr_from_triplets(&a, 4, 4, 4, i, i, v, NULL, NULL), HD_OK);
    IS(hd_ldl_analyse(&f, &a, NULL, NULL, NULL), HD_OK);
    memset(u, 0, sizeof u);
    memset(b, 0, sizeof b);
    for (k = 0; k < 3; k++) {
        memcpy(xyz + 4, bits + k, sizeof *bits);
        mesh = hd_triangles(xyz, 4, tri, 4);
        IS(hd_laplacian_create(&none, &mesh, NULL, NULL), HD_ERR_NOT_FINITE);
        IS(hd_geodesic_create(&g, &mesh, NULL, NULL), HD_ERR_NOT_FINITE);
        mesh = hd_triangles(xyz, 4, NULL, 0);
        mesh.shape = HD_POINTS;
        IS(hd_laplacian_create(&none, &mesh, NULL, NULL), HD_ERR_NOT_FINITE);
        IS(hd_laplacian_create(&none, &mesh, &tufted, NULL), HD_ERR_NOT_FINITE);
        xyz[4] = 0;
        memcpy(v + 2, bits + k, sizeof *bits);
        IS(hd_csr_from_triplets(&c, 4, 4, 4, i, i, v, NULL, NULL), HD_ERR_NOT_FINITE);
        IS(hd_ldl_factor(f, v, NULL, NULL), HD_ERR_NOT_FINITE);
        memcpy(a.val + 1, bits + k, sizeof *bits);
        IS(hd_laplacian_matrices(&none, &a, &a, 0, NULL, NULL), HD_ERR_NOT_FINITE);
        a.val[1] = v[2] = 2;
        memcpy(u + 3, bits + k, sizeof *bits);
        IS(hd_heat_apply(heat, 1, &one, 1, u, 0, u, 0, NULL, NULL), HD_ERR_NOT_FINITE);
        u[3] = 0;
        memcpy(&b[3].im, bits + k, sizeof *bits);
        b[0].re = 1;
        x[0].re = x[0].im = 1;
        IS(hd_shifted_solve(lap, 1, x[0], b, x, NULL, NULL, NULL), HD_ERR_NOT_FINITE);
        b[3].im = 0;
        memcpy(&t, bits + k, sizeof t);
        IS(hd_heat_diagonal(heat, HD_KERNEL_SYMMETRIC, 1, &t, u, 0, NULL, NULL, NULL, NULL), HD_ERR_ARGUMENT);
    }
    v[1] = v[2] = 1.5e308;
    IS(hd_csr_from_triplets(&c, 4, 4, 2, same, same, v + 1, NULL, NULL), HD_ERR_NOT_FINITE);
    v[3] = 0;                                    /* a pivot that cannot be divided by */
    v[1] = v[2] = 1;
    IS(hd_ldl_factor(f, v, NULL, NULL), HD_ERR_BREAKDOWN);
    return failed;
}
END
less="-DHEATDIFF_NO_SIMD -DHEATDIFF_NO_DIFFUSION -DHEATDIFF_NO_SPECTRUM -DHEATDIFF_NO_POLYGONS"
for c in "gcc -O2 -ffast-math" "clang -O1 -ffast-math"; do
  is_here $c || continue
  $c $less -std=c99 -I"$top" fast.c -o fast -lm 2>fast.txt || { cat fast.txt; exit 1; }
  ./fast
  echo "ok: $c"
done
# names: everything the implementation exports begins with hd_
foreign=$(nm -g --defined-only "$work/impl.o" | awk '{print $3}' | grep -v '^hd_' || true)
[ -z "$foreign" ] || { echo "exported without the prefix hd_: $foreign"; exit 1; }
private=$(nm "$work/impl.o" | awk '$2 ~ /[tdbr]/ {print $3}' | grep -vE '^(hdi_|\.|__func__|__PRETTY_FUNCTION__|CSWTCH\.)' || true)
[ -z "$private" ] || { echo "private without the prefix hdi_: $private"; exit 1; }
echo "$syntax compilers and standards, exported and private names as they should be"
