#!/usr/bin/env bash
# examples/petsc.c on 1, 2 and 4 ranks: its answers against hd_heat_columns on one rank and against SLEPc's exp.
# Exit 77, which ctest shows as skipped, where PETSc and SLEPc with complex scalars or MPI are not installed;
# 1 with HEATDIFF_NO_SKIP in the environment.
# Usage: petsc.sh [DIRECTORY [IMPLEMENTATION.o]]        the object: heatdiff.h compiled already
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
work=${1:-$(mktemp -d)}
[ $# -gt 0 ] || trap 'rm -rf "$work"' EXIT
mkdir -p "$work"
debian=$(find /usr/lib/petscdir /usr/lib/slepcdir -path '*complex*' -name pkgconfig 2>/dev/null | paste -sd: || true)
export PKG_CONFIG_PATH=${debian:+$debian:}${PKG_CONFIG_PATH:-}
absent() { echo "not here: $*"; [ -n "${HEATDIFF_NO_SKIP:-}" ] && exit 1; exit 77; }
for p in mpicc mpirun pkg-config; do command -v $p >/dev/null || absent $p; done
flags=$(pkg-config --cflags --libs slepc petsc 2>/dev/null) || absent PETSc and SLEPc
echo '#include <petscsys.h>
#if !defined(PETSC_USE_COMPLEX) || !defined(PETSC_HAVE_MUMPS)
#error
#endif' >"$work/probe.c"
# shellcheck disable=SC2086
mpicc -c "$work/probe.c" -o "$work/probe.o" $flags 2>/dev/null || absent PETSc with complex scalars and MUMPS

program=$top/examples/petsc.c
if [ $# -gt 1 ]; then
  sed '/^#define HEATDIFF_IMPLEMENTATION/d' "$program" >"$work/petsc.c"
  program="$work/petsc.c $2 -I$top/examples"
fi
# shellcheck disable=SC2086
mpicc -std=c99 -O1 -Wall -Wextra -Wshadow -Werror -DUSE_SLEPC $program -o "$work/petsc" $flags -lm

# Ranks that wait leave the processor to the others: there may be fewer processors than ranks (mpirun --oversubscribe).
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_mpi_yield_when_idle=1
export OMPI_MCA_rmaps_base_oversubscribe=1
runs=0
try() {
  local ranks=$1 out
  shift
  out=$(timeout 120 mpirun -np "$ranks" "$work/petsc" -size 24 -t 20 "$@" 2>&1) || { echo "$ranks ranks, $*:"; echo "$out"; exit 1; }
  grep -q "difference from hd_heat_columns" <<<"$out" || { echo "$out"; exit 1; }
  sed -n "s|^|$ranks ranks $*: |; /difference/p" <<<"$out"
  runs=$((runs + 1))
}
# a wavy sheet whose numbers jump, with a vertex in no face and faces of four corners
awk 'BEGIN { n = 30; m = n * n; print "v 9 9 9"
    for (k = 0; k < m; k++) { v = k * 7 % m; x = int(v / n) / n; y = v % n / n; print "v", y, x * 2, 0.1 * sin(9 * x) * cos(6 * y); at[v] = k + 2 }
    for (v = 0; v < m - n; v++) if (v % n < n - 1) print "f", at[v], at[v + n], at[v + n + 1], at[v + 1] }' >"$work/sheet.obj"
try 1
try 2 -mesh "$work/sheet.obj" -sources 3
try 4 -mesh "$work/sheet.obj" -pole_groups 2 -kind fem
try 2 -sources 3
try 2 -pole_groups 2 -kind fem
try 4 -pole_groups 2 -sources 3
try 4 -pole_groups 2 -source_groups 2 -degree 13
try 4 -source_groups 2 -iterative -sources 3
try 2 -iterative -kind fem -t 1000
echo "$runs passed, 0 failed"
