#!/usr/bin/env bash
# The tests under checkers. In each mode a planted error first proves that the checker is on.
#     sanitize.sh WORKFOLDER [all]                    addresses and undefined behaviour, as CI does, but for some slow groups, whose
#                                                     code the others run as well; all: these too
#     sanitize.sh WORKFOLDER python [COUNT]           the arguments that test_python.py throws, under the address sanitizer
#     sanitize.sh WORKFOLDER address|memory|threads|traps|valgrind [GROUP...]
# All but python print a line per group, and what failed; the log of a group is WORKFOLDER/MODE.GROUP.log. Groups are those of
# `runner --list`, and `internals`; none: all, for threads those that start some. JOBS groups at a time (2; threads: 1).
#     memory     MemorySanitizer of clang: numbers that nobody wrote
#     threads    ThreadSanitizer: races
#     traps      the first invalid operation, division by zero or overflow ends a group (glibc on x86)
#     valgrind   memcheck, without vector code; slow: some 20 to 30 times the time of a plain run
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
work=$1
mode=${2:-address}

# planted COMPILER FLAGS... <source: must end with an error, by itself or under $wrap
wrap=
planted() {
  local cc=$1
  shift
  cat >"$work/planted.c"
  $cc "$@" "$work/planted.c" -o "$work/planted" -lm
  if { $wrap "$work/planted"; } >/dev/null 2>&1; then echo "$cc: the checker is not on"; exit 1; fi
}

# one MODE GROUP: runs it, prints its line
one() {
  local mode=$1 group=$2 log="$work/$1.$2.log" begin=$SECONDS status=0 run wrap=$wrap
  mkdir -p "$work/tmp.$group"
  if [ "$group" = internals ]; then run="$work/internals.$mode $flag"; else run="$work/runner.$mode $flag --tmp $work/tmp.$group $group"; fi
  # the child of a fork ends while it can still reach what its parent holds
  [ "$group" != threads ] || wrap=${wrap//=all/=definite,indirect,possible}
  $wrap $run >"$log" 2>&1 || status=$?
  if [ $status = 0 ]; then word=ok; else word="FAILED ($status)"; fi
  printf '%-9s %-11s %-12s %5d s   %s\n' "$mode" "$group" "$word" $((SECONDS - begin)) "$(grep -a ' passed, ' "$log" | tail -1)"
  [ $status = 0 ] || { head -60 "$log"; return 1; }
}

# two COMPILER FLAGS...: builds runner and internals, each with an implementation of its own: the guard of tests/guard.h looks at it
two() {
  local p builds=()
  for p in runner internals; do
    [ "$p $groups" != "runner internals" ] || continue
    [ $p = runner ] || [ -z "$groups" ] || grep -qx internals <<<"$groups" || continue
    "$@" "$top/tests/$p.c" -o "$work/$p.$mode" -lm &
    builds+=($!)
  done
  for p in "${builds[@]}"; do wait "$p"; done
}

# shared COMPILER FLAGS...: the same where the checker takes the guard's place; the implementation, which takes long to compile, is that
# of internals.c for both
shared() {
  local a b
  "$@" -Dmain=internals_main -c "$top/tests/internals.c" -o "$work/internals.$mode.o" &
  a=$!
  "$@" -w -DTEST_LINKED -DCASES_SPARSE -c "$top/tests/runner.c" -o "$work/runner.$mode.o" &
  b=$!
  wait $a
  wait $b
  printf 'int internals_main(int, char **);\nint main(int n, char **v) { return internals_main(n, v); }\n' >"$work/start.c"
  "$@" "$work/start.c" "$work/internals.$mode.o" -o "$work/internals.$mode" -lm
  "$@" "$work/runner.$mode.o" "$work/internals.$mode.o" -o "$work/runner.$mode" -lm
}

# each BUILD COMPILER FLAGS...: BUILD, one of these two, builds what is needed, side by side; then the groups run
each() {
  local build=$1 cc=$2
  shift 2
  $build $cc -std=c99 -g1 -O1 "$@" -I"$top"
  [ -n "$groups" ] || groups=$(printf 'internals\n'; "$work/runner.$mode" --list)
  groups=$( (grep -xF "$long" <<<"$groups"; grep -vxF "$long" <<<"$groups") || true)
  export -f one
  export work wrap flag
  xargs -P "${JOBS:-$jobs}" -I{} bash -c "one $mode {}" <<<"$groups"
}

unwritten='#include <stdio.h>
int main(int c, char **v) { int a[4]; (void)v; a[c] = 1; if (a[c + 1] > 7) puts("a"); return 0; }'
flag=
jobs=2
long=$(printf '%s\n' failures threads engines estimate internals diagonal filters)      # they begin, so that the end is not a wait for one of them
shift $(($# < 2 ? $# : 2))
groups=$(printf '%s\n' "$@")
case "$mode" in
memory)
  planted clang -g -fsanitize=memory <<<"$unwritten"
  each shared clang -fno-omit-frame-pointer -fsanitize=memory -fsanitize-memory-track-origins ;;
threads)
  jobs=1
  [ -n "$groups" ] || groups=$(printf '%s\n' threads large_t estimate engines spectrum)
  planted gcc -g -fsanitize=thread -pthread <<'C'
#include <pthread.h>
static int n;
static void *add(void *p) { int i; for (i = 0; i < 1000; i++) n++; return p; }
int main(void) { pthread_t t; pthread_create(&t, 0, add, 0); add(0); pthread_join(t, 0); return 0; }
C
  each two gcc -fsanitize=thread ;;
traps)
  flag=--traps
  planted gcc -D_GNU_SOURCE <<'C'
#include <fenv.h>
int main(int c, char **v) { volatile double x = c - 1; (void)v; feenableexcept(FE_ALL_EXCEPT); x = 1 / x; return 0; }
C
  each two gcc ;;
valgrind)
  wrap='valgrind --quiet --leak-check=full --show-leak-kinds=all --errors-for-leak-kinds=all --error-exitcode=9 --fair-sched=try'
  planted gcc -g <<<"$unwritten"
  each two gcc -O2 -DHEATDIFF_NO_SIMD ;;             # vectors take valgrind ten times as long; the other modes have them
python)
  gcc -g -O1 -fsanitize=address,undefined -fno-sanitize-recover=all -shared -fPIC "$top/tools/heatdiff_shared.c" \
    -o "$work/libheatdiff.so" -lm
  export HEATDIFF_LIBRARY="$work/libheatdiff.so" PYTHONMALLOC=malloc ASAN_OPTIONS=detect_leaks=0
  python() { LD_PRELOAD=$(gcc -print-file-name=libasan.so) "${PYTHON:-python3}" "$@"; }
  if python -c 'import ctypes; ctypes.memset(ctypes.create_string_buffer(8), 1, 4096)' >/dev/null 2>&1; then
    echo "python: the checker is not on"; exit 1
  fi
  python "$top/tests/test_python.py" --throw "${groups:-5000}" 2>"$work/python.log" || { tail -50 "$work/python.log"; exit 1; } ;;
address | all)
  flags="-fsanitize=address,undefined -fno-sanitize-recover=all"
  for cc in gcc clang; do
    command -v $cc >/dev/null || continue
    planted $cc $flags <<<'#include <stdlib.h>
int main(int c, char **v) { char *p = (char *)malloc(4); (void)v; p[3 + c] = 1; c = p[3]; free(p); return c; }'
  done
  [ "$mode" = all ] || [ -n "$groups" ] || flags="$flags -DTEST_BRIEF"
  export ASAN_OPTIONS=allocator_release_to_os_interval_ms=-1${ASAN_OPTIONS:+:$ASAN_OPTIONS}     # a tenth of the time goes into that
  each shared gcc $flags ;;
*)
  echo "usage: sanitize.sh WORKFOLDER [address | all | python [COUNT] | memory | threads | traps | valgrind [GROUP...]]"
  exit 2 ;;
esac
