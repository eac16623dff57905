#!/usr/bin/env bash
# Builds with the switches HEATDIFF_NO_..., each alone and sensible sets together. Sets are built by gcc in two files (C99, -Og: quick, and
# what nothing calls goes), tests/switches.c runs, and what is left out is really gone from the object. Each switch and each set is read
# through without warnings, in one file with HEATDIFF_STATIC, by one of the other compilers.   Usage: switches.sh WORKFOLDER
set -euo pipefail
export top=$(cd "$(dirname "$0")/.." && pwd)
export work=$1
mkdir -p "$work"
export warn="-Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wdouble-promotion -Werror -I$top"
printf '#define HEATDIFF_IMPLEMENTATION\n#include "heatdiff.h"\n' >"$work/impl.c"
printf '#define HEATDIFF_STATIC\n#define HEATDIFF_IMPLEMENTATION\n#include "%s/tests/switches.c"\n' "$top" >"$work/static.c"
cp "$work/static.c" "$work/static.cpp"

# A function of each room that must not be there.
gone() {
  case $1 in
    DIRECT) echo "hdi_factor_part hdi_nd_split hdi_amd_run hdi_symbolic_order hdi_sweep_run hdi_elim_make hdi_krylov_run hdi_real_product_plain" \
                 "$(gone LOCAL) $(gone POLE_FACTORS) $(gone GEODESIC) $(gone SPECTRUM)" ;;
    LOCAL) echo "hdi_local_pair hdi_local_grow hdi_rim_sum" ;;
    POLE_FACTORS) echo "hdi_pack_product_plain hdi_batch_run hdi_elim_poles $(gone DIAGONAL)" ;;
    DIAGONAL) echo "hdi_inverse_run hdi_form_run hdi_ground_make hdi_diagonal_once hdi_trace_window hdi_filters_run hdi_fading_poles $(gone DIFFUSION)" ;;
    SPECTRUM) echo "hdi_spec_run hdi_spec_sums_run hdi_modes_distance hdi_modes_pairs hdi_pairs_by_modes hdi_sample_modes hdi_slab_dots_task" ;;
    DIFFUSION) echo "hdi_metric_make hdi_pairs_once hdi_sample_answer" ;;
    ITERATIVE) echo "hdi_iteration_run hdi_precond_ordered hdi_fill_task hdi_lanczos_first hdi_family_run" ;;
    GEODESIC) echo "hdi_geo_make hdi_geo_sweep hdi_geo_free" ;;
    INTRINSIC) echo "hdi_soup_of_mesh hdi_lap_unfold" ;;
    POINTS) echo "hdi_tree_make hdi_nearest_task hdi_lap_points hdi_star_task" ;;
    POLYGONS) echo "hdi_lap_polygons hdi_poly_check" ;;
  esac
}

one() {   # NUMBER SWITCHES
  local number=$1 flags="" name other ext plain=-DHEATDIFF_NO_SIMD   # the kernels take most of the time
  shift
  for name in "$@"; do flags="$flags -DHEATDIFF_NO_$name"; done
  case " $* " in *" SIMD "*) plain="" ;; esac
  if [ $# -gt 1 ]; then
    gcc -std=c99 -Og $warn $flags $plain -c "$work/impl.c" -o "$work/$number.o"
    gcc -std=c99 $warn $flags "$top/tests/switches.c" "$work/$number.o" -o "$work/$number" -lm
    "$work/$number" >"$work/$number.txt" || { cat "$work/$number.txt"; echo "gcc, without $*: failed"; return 1; }
    for name in "$@"; do gone "$name"; done | tr ' ' '\n' | sort -u >"$work/$number.gone"
    other=$(nm "$work/$number.o" | sed 's/.* //; s/\..*//' | grep -xFf "$work/$number.gone" || true)
    if [ -n "$other" ]; then echo "without $*: still there:" $other; return 1; fi
  fi
  case $((number % 3)) in 0) other="clang -std=c99" ;; 1) other="g++ -std=c++11" ;; 2) other="clang++ -std=c++17" ;; esac
  ext=c; case $other in *++*) ext=cpp ;; esac
  if command -v "${other%% *}" >/dev/null && $other -x "${ext/cpp/c++}" -fsyntax-only /dev/null 2>/dev/null; then
    $other $warn $flags $plain -fsyntax-only "$work/static.$ext"
  elif [ -n "${HEATDIFF_NO_SKIP:-}" ]; then echo "not here: $other"; return 1
  fi
  echo "ok: without $*"
}
export -f one gone

nl -v0 -w1 -s' ' <<'END' | xargs -d '\n' -P "${JOBS:-$(nproc)}" -I{} bash -euc 'one {}' || { echo "failed"; exit 1; }
DIRECT
POLE_FACTORS
DIAGONAL
DIFFUSION
ITERATIVE
GEODESIC
SPECTRUM
INTRINSIC
POINTS
POLYGONS
THREADS SIMD
ITERATIVE POLE_FACTORS INTRINSIC
ITERATIVE DIAGONAL SPECTRUM INTRINSIC
ITERATIVE DIFFUSION LOCAL
ITERATIVE DIAGONAL GEODESIC INTRINSIC POINTS POLYGONS THREADS SIMD
DIRECT INTRINSIC POINTS POLYGONS THREADS SIMD
END
printf '#define HEATDIFF_NO_DIRECT\n#define HEATDIFF_NO_ITERATIVE\n#include "impl.c"\n' >"$work/none.c"
if gcc -I"$top" -fsyntax-only "$work/none.c" 2>"$work/none.txt"; then echo "a build without any method passes"; exit 1; fi
grep -q "leave no method" "$work/none.txt"
echo "all switches"
