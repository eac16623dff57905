#!/usr/bin/env bash
# The tests by every compiler and on every processor that can be had here: builds tests/runner.c for a target and runs groups of
# it, on the processor, under wine or under qemu. One line a target; exit status 1 when one fails, 2 for a wrong command line.
#
#   tools/portability.sh [OPTION...] [TARGET...]    without targets: all of them
#     --list          the targets, what they run, and the packages of Debian that they need; then stops
#     --install       installs what is missing with apt-get (as root)
#     --groups SET    one of all, most, core, x87, fast instead of what a target runs; --list tells them
#     --seconds N     most seconds for the groups of a target (default 600); running out of them fails
#     --flags FLAGS   of the compiler (default -O1)
#
# A target that is not here, for want of a compiler or an emulator, is told and does not fail unless it was asked for by name.
set -uo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)

# Groups. most leaves out those that take minutes without optimisation; core is what an emulator does in half a minute, with every
# method in `platform`. fast is what -ffast-math leaves (builds.sh has NaN in the input). x87 is what asks neither for bits, nor for
# bounds near rounding, nor for what is zero up to it: see Limits in heatdiff.h.
all="base sparse operators rational shared intrinsic ldl engines krylov heat robust points assembly polygon geodesic diagonal \
everywhere picture meshio bounds platform"
most="base sparse operators rational intrinsic ldl krylov heat robust assembly polygon picture meshio platform"
core="base sparse rational krylov meshio platform"
x87="base sparse operators intrinsic ldl engines krylov heat robust assembly diagonal everywhere picture platform"
fast="base sparse heat platform"

multilib=gcc-$(gcc -dumpversion 2>/dev/null | cut -d. -f1)-multilib
# Not every kernel of x86-64 runs programs of 32 bits.
run32= try32=$(mktemp)
if printf 'int main(void) { return 0; }\n' | gcc -m32 -x c - -o "$try32" 2>/dev/null && ! "$try32" 2>/dev/null; then run32=qemu-i386; fi
rm -f "$try32"
# Debian's clang-cl has its version in its name.
clang_cl=$(command -v clang-cl || compgen -c clang-cl- | sort -V | tail -1)

# name | compiler and its flags | what runs the program | groups | packages
targets="
gcc         | gcc                                    |             | all  | gcc
clang       | clang                                  |             | all  | clang
gcc-c99     | gcc -std=c99                           |             | most | gcc
gcc-c11     | gcc -std=c11                           |             | most | gcc
gcc-c17     | gcc -std=c17                           |             | most | gcc
gcc-c2x     | gcc -std=c2x                           |             | most | gcc
clang-c99   | clang -std=c99                         |             | most | clang
clang-c2x   | clang -std=c2x                         |             | most | clang
g++-11      | g++ -std=c++11 -x c++                  |             | most | g++
g++-20      | g++ -std=c++20 -x c++                  |             | most | g++
g++-23      | g++ -std=c++23 -x c++                  |             | most | g++
clang++-11  | clang++ -std=c++11 -x c++              |             | most | clang g++
clang++-20  | clang++ -std=c++20 -x c++              |             | most | clang g++
clang++-23  | clang++ -std=c++2b -x c++              |             | most | clang g++
tcc         | tcc                                    |             | most | tcc
musl        | musl-gcc -static                       |             | most | musl-tools
x86-32      | gcc -m32 -msse2 -mfpmath=sse           | $run32 | all  | $multilib
x87         | gcc -m32                               | $run32 | x87  | $multilib
mingw64     | x86_64-w64-mingw32-gcc -static         | wine        | most | gcc-mingw-w64-x86-64 wine wine64
mingw32     | i686-w64-mingw32-gcc -static -msse2 -mfpmath=sse | wine32 | most | gcc-mingw-w64-i686 wine wine32
armhf       | arm-linux-gnueabihf-gcc -static        | qemu-arm    | core | gcc-arm-linux-gnueabihf libc6-dev-armhf-cross qemu-user
aarch64     | aarch64-linux-gnu-gcc -static          | qemu-aarch64| core | gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user
riscv64     | riscv64-linux-gnu-gcc -static          | qemu-riscv64| core | gcc-riscv64-linux-gnu libc6-dev-riscv64-cross qemu-user
s390x       | s390x-linux-gnu-gcc -static            | qemu-s390x  | core | gcc-s390x-linux-gnu libc6-dev-s390x-cross qemu-user
cortex-m7   | arm-none-eabi-gcc                      | embedded    | none | gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm
fast-math   | gcc -O2 -ffast-math                    |             | fast | gcc
clang-cl    | ${clang_cl:-clang-cl}  | syntax      | none | clang
"

usage() { sed -n '2,/^set/p' "$0" | sed -n 's/^# \{0,1\}//p' >&2; exit 2; }
trim() { local s=$1; s=${s#"${s%%[! ]*}"}; printf '%s' "${s%"${s##*[! ]}"}"; }
field() { trim "$(printf '%s\n' "$1" | cut -d'|' -f"$2")"; }
line_of() { printf '%s\n' "$targets" | grep -E "^$(printf '%s' "$1" | sed 's/+/\\+/g') *\|"; }
names() { printf '%s\n' "$targets" | sed -n 's/ *|.*//p'; }

# Whether the compiler builds and the emulator runs a program: not every package that has the name of a compiler holds a C library.
works() {
  local cc=$1 run=$2
  command -v "${cc%% *}" >/dev/null || return 1
  [ "$run" = syntax ] && return 0
  if [ "$run" = embedded ]; then command -v qemu-system-arm >/dev/null; return; fi
  printf '#include <errno.h>\n#include <math.h>\n#include <stdio.h>\nint main(int c, char **v) { (void)v; return sqrt(c) > 1.5 || errno; }\n' >"$work/try.c"
  $cc $(includes "$cc") "$work/try.c" -o "$work/try.exe" -lm 2>/dev/null || return 1
  run_it "$run" "$work/try.exe" >/dev/null 2>&1
}

# Beside cross compilers there is no gcc-multilib, which has the folder <asm> of 32 bits.
includes() { case $1 in gcc*-m32*) [ -e /usr/include/asm ] || echo "-idirafter /usr/include/$(gcc -print-multiarch)" ;; esac; }

run_it() {
  local run=$1
  shift
  case $run in
    '') "$@" ;;
    wine | wine32) WINEPREFIX="$work/wine" WINEDEBUG=-all wine "$@" ;;
    *) "$run" "$@" ;;
  esac
}

version() { case $1 in tcc*) tcc -v ;; musl-gcc*) gcc --version ;; *) ${1%% *} --version ;; esac 2>&1 | head -1 |
  grep -oE '[0-9]+\.[0-9]+(\.[0-9]+)?' | head -1; }

report() { printf '%-11s %-8s %-7s %9s passed %6s failed %5s s   %s\n' "$@"; }

# MSVC's own flags and type sizes; the C library's headers are stubs, so that this looks at the syntax and at the branches for
# _MSC_VER only.
msvc_syntax() {
  local stubs=$work/stubs t0=$SECONDS lang bad=0
  mkdir -p "$stubs"
  printf 'void *malloc(size_t); void free(void *); void abort(void); int abs(int); double strtod(const char *, char **);\n' >"$stubs/body"
  { echo '#pragma once'; echo '#include <stddef.h>'; echo '#ifdef __cplusplus'; echo 'extern "C" {'; echo '#endif'; cat "$stubs/body"
    echo 'void qsort(void *, size_t, size_t, int (*)(const void *, const void *));'
    echo '#ifdef __cplusplus'; echo '}'; echo '#endif'; } >"$stubs/stdlib.h"
  { echo '#pragma once'; echo '#include <stddef.h>'; echo '#ifdef __cplusplus'; echo 'extern "C" {'; echo '#endif'
    echo 'void *memcpy(void *, const void *, size_t); void *memset(void *, int, size_t); void *memmove(void *, const void *, size_t);'
    echo 'int memcmp(const void *, const void *, size_t); size_t strlen(const char *); int strcmp(const char *, const char *);'
    echo 'int strncmp(const char *, const char *, size_t); char *strstr(const char *, const char *); char *strchr(const char *, int);'
    echo '#ifdef __cplusplus'; echo '}'; echo '#endif'; } >"$stubs/string.h"
  { echo '#pragma once'; echo '#ifdef __cplusplus'; echo 'extern "C" {'; echo '#endif'
    for f in sqrt fabs exp log log2 log10 expm1 log1p sin cos tan acos asin atan floor ceil cbrt sinh cosh tanh; do echo "double $f(double);"; done
    echo 'double pow(double, double); double atan2(double, double); double hypot(double, double); double ldexp(double, int);'
    echo 'double frexp(double, int *); double fmod(double, double); double nextafter(double, double); double scalbn(double, int);'
    echo 'double fma(double, double, double); float sqrtf(float);'
    echo '#ifdef __cplusplus'; echo '}'; echo '#endif'
    echo '#define HUGE_VAL (1e300 * 1e300)'; echo '#define INFINITY ((float)(1e300 * 1e300))'; echo '#define NAN (INFINITY * 0.0f)'; } >"$stubs/math.h"
  { echo '#pragma once'; echo '#define assert(x) ((void)0)'; } >"$stubs/assert.h"
  for lang in /TC "/TP /std:c++14" "/TP /std:c++20"; do
    printf '#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\n' >"$work/msvc.c"
    "$clang_cl" --target=x86_64-pc-windows-msvc $lang /W4 /WX /nologo /c -Xclang -ffreestanding -imsvc "$stubs" -I"$top" \
      -Fo"$work/msvc.obj" "$work/msvc.c" >"$work/log" 2>&1 || { bad=$((bad + 1)); head -20 "$work/log"; }
  done
  report clang-cl "$(version "$clang_cl")" syntax $((3 - bad)) $bad $((SECONDS - t0)) "(MSVC itself is untested)"
  [ $bad = 0 ]
}

# A processor without an operating system runs examples/embedded.
embedded() {
  local t0=$SECONDS status=0 summary
  python3 "$top/tests/test_embedded.py" >"$work/out" 2>&1 || status=$?
  summary=$(grep -E '^[0-9]+ passed, [0-9]+ failed' "$work/out" | tail -1)
  [ $status = 0 ] || head -20 "$work/out"
  set -- "$1" "$2" $summary
  report "$1" "$(version "$2")" example "${3:-0}" "${5:-?}" $((SECONDS - t0)) "$2, qemu-system-arm"
  return $status
}

one_target() {
  local name=$1 line cc run groups t0 status=0 summary alone=
  line=$(line_of "$name")
  cc=$(field "$line" 2)
  run=$(field "$line" 3)
  groups=$(field "$line" 4)
  if ! works "$cc" "$run"; then
    if [ $install = 1 ]; then
      echo "installing $(field "$line" 5)"
      apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $(field "$line" 5) >/dev/null
    fi
    if ! works "$cc" "$run"; then
      echo "$name: not here (packages: $(field "$line" 5); --install installs them)"
      [ $named = 0 ]
      return
    fi
  fi
  if [ "$run" = syntax ]; then msvc_syntax; return; fi
  if [ "$run" = embedded ]; then embedded "$name" "$cc"; return; fi
  [ -z "$set_of" ] || groups=$set_of
  [ "$groups" != core ] || alone=-DTEST_CORE        # the code of no other group
  t0=$SECONDS
  if ! $cc $flags $alone $(includes "$cc") -w -I"$top" "$top/tests/runner.c" -o "$work/$name.exe" -lm >"$work/log" 2>&1; then
    head -20 "$work/log"
    echo "$name: does not compile"
    return 1
  fi
  mkdir -p "$work/files"
  (cd "$work" && export -f run_it && export work && timeout "$seconds" bash -c 'run_it "$@"' bash "$run" "./$name.exe" --tmp files ${!groups}) \
    >"$work/out" 2>"$work/err" || status=$?
  summary=$(tr -d '\r' <"$work/out" | grep -E '^[0-9]+ passed, [0-9]+ failed' | tail -1)
  if [ $status != 0 ]; then
    grep -avE '^[a-z]+ +[0-9]+ passed +0 failed' "$work/out" | head -40
    tail -5 "$work/err"
    [ $status != 124 ] || echo "$name: not done after $seconds seconds"
  fi
  set -- $summary
  report "$name" "$(version "$cc")" "$groups" "${1:-0}" "${3:-?}" $((SECONDS - t0)) "$cc${run:+, $run}"
  return $status
}

install=0 set_of='' seconds=600 flags=-O1 named=1 chosen=()
while [ $# -gt 0 ]; do
  case $1 in
    --list)
      while read -r name; do
        line=$(line_of "$name")
        printf '%-11s %-50s %-12s %-5s %s\n' "$name" "$(field "$line" 2)" "$(field "$line" 3)" "$(field "$line" 4)" "$(field "$line" 5)"
      done < <(names)
      for g in all most core x87 fast; do printf '%s: %s\n' "$g" "${!g}"; done
      exit 0 ;;
    --install) install=1 ;;
    --seconds | --flags | --groups)
      [ $# -gt 1 ] || usage
      case $1 in --flags) flags=$2 ;; --seconds) seconds=$2 ;; *) set_of=$2 ;; esac
      case "$set_of" in '' | all | most | core | x87 | fast) ;; *) usage ;; esac
      shift ;;
    -*) usage ;;
    *)
      [ -n "$(line_of "$1")" ] || { echo "portability.sh: no target '$1'; there are $(names | tr '\n' ' ')" >&2; exit 2; }
      chosen+=("$1") ;;
  esac
  shift
done
if [ ${#chosen[@]} = 0 ]; then named=0; mapfile -t chosen < <(names | grep .); fi

work=$(mktemp -d)
leave() {
  [ ! -d "$work/wine" ] || WINEPREFIX="$work/wine" wineserver -k 2>/dev/null
  rm -rf "$work"
}
trap leave EXIT
export OMP_WAIT_POLICY=passive
failed=()
for name in "${chosen[@]}"; do one_target "$name" || failed+=("$name"); done
if [ ${#failed[@]} -gt 0 ]; then echo "failed: ${failed[*]}"; exit 1; fi
