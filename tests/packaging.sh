#!/usr/bin/env bash
# Every way to get heatdiff.h into a program: installs the package, then builds and runs a small consumer by a plain copy,
# find_package, add_subdirectory, FetchContent, pkg-config and the shared library. Also looks at what the libraries export (Windows
# too), at the archive of CPack, and at the tool's version.   Usage: packaging.sh WORKFOLDER
set -euo pipefail
top=$(cd "$(dirname "$0")/.." && pwd)
work=$(cd "$1" && pwd)
cc=${CC:-cc}
export CFLAGS="-DHEATDIFF_NO_SIMD"       # compiles faster
count=0
fail() { echo "packaging.sh: $*"; exit 1; }
quietly() { "$@" >"$work/log" 2>&1 || { cat "$work/log"; fail "$*"; }; }
is() {   # what it prints is what the header's own numbers are
  local got
  got=$("${@:2}" | tr -d '\r')
  [ "$got" = "$want" ] || fail "$1: '$got' instead of '$want'"
  echo "ok: $1"
  count=$((count + 1))
}
has() { [ -e "$1" ] || fail "$1 is missing"; }

version=$(sed -n 's/^#define HD_VERSION_[MP][A-Z]* \([0-9]*\)$/\1/p' "$top/heatdiff.h" | paste -sd.)
mkdir -p "$work/copy"
cp "$top/heatdiff.h" "$top/tests/consumer/consumer.c" "$work/copy"
(cd "$work/copy" && quietly "$cc" $CFLAGS -I. consumer.c -o consumer -lm)
want=$("$work/copy/consumer")
[ "${want%% *}" = "$version" ] || fail "the copy says '$want'"
is "plain copy of one file" "$work/copy/consumer"

# Installed, without its tests and with the shared library. Debug compiles fastest.
quietly cmake -S "$top" -B "$work/build" -DCMAKE_BUILD_TYPE=Debug -DHEATDIFF_BUILD_TESTS=OFF -DHEATDIFF_BUILD_EXAMPLES=OFF \
  -DHEATDIFF_BENCH_RIVALS=OFF -DHEATDIFF_BUILD_SHARED=ON -DCMAKE_INSTALL_PREFIX="$work/prefix" -DCMAKE_INSTALL_LIBDIR=lib \
  -DCMAKE_SKIP_INSTALL_ALL_DEPENDENCY=ON     # cpack need not build the benchmarks
quietly cmake --build "$work/build" --target heatdiff-tool heatdiff_shared
quietly cmake --install "$work/build"
for f in include/heatdiff.h bin/heatdiff lib/pkgconfig/heatdiff.pc lib/cmake/heatdiff/heatdiff-config.cmake \
         lib/cmake/heatdiff/heatdiff-config-version.cmake share/man/man1/heatdiff.1 share/doc/heatdiff/LICENSE; do has "$work/prefix/$f"; done

consumer() {   # WAY, then more for CMake
  quietly cmake -S "$top/tests/consumer" -B "$work/$1" -DCMAKE_BUILD_TYPE=Debug -DWAY="$1" -DCMAKE_PREFIX_PATH="$work/prefix" "${@:2}"
  quietly cmake --build "$work/$1" --target consumer
  is "$1" "$work/$1/consumer"
}
consumer package
consumer package-shared
consumer subdirectory -DHEATDIFF_FOLDER="$top"
[ -z "$(find "$work/subdirectory" -name 'heatdiff-tool*' -o -name 'runner*')" ] || fail "as a subdirectory, tools and tests are made too"
(cd "$top" && tar czf "$work/source.tar.gz" CMakeLists.txt LICENSE heatdiff.h tools)
consumer fetch -DHEATDIFF_ARCHIVE="$work/source.tar.gz"
if cmake -S "$top/tests/consumer" -B "$work/newer" -DWAY=package -DWANT_VERSION=99 -DCMAKE_PREFIX_PATH="$work/prefix" >"$work/log" 2>&1; then
  fail "find_package(heatdiff 99) finds $version"
fi
grep -q "requested version" "$work/log" || { cat "$work/log"; fail "find_package(heatdiff 99) fails for another reason"; }

# pkg-config, after everything has moved: with the shared library, which is in its Libs, and with the header alone. The second
# install has no shared library and its libraries further down.
if command -v pkg-config >/dev/null; then
  c=$top/tests/consumer/consumer.c
  cp -a "$work/prefix" "$work/moved"
  export PKG_CONFIG_PATH=$work/moved/lib/pkgconfig
  [ "$(pkg-config --modversion heatdiff)" = "$version" ] || fail "pkg-config knows another version"
  told=$(pkg-config --cflags --libs heatdiff)
  case $told in *"$work/prefix"*) fail "pkg-config looks where nothing may be any more: $told" ;; *-lheatdiff*) ;; *) fail "no shared library in $told" ;; esac
  quietly "$cc" $CFLAGS -DCONSUMER_SHARED "$c" -o "$work/shared-by-pc" $told
  is "pkg-config, shared library" env LD_LIBRARY_PATH="$work/moved/lib" "$work/shared-by-pc"
  quietly "$cc" $CFLAGS "$c" -o "$work/by-pc" $(pkg-config --cflags heatdiff) -lm
  is "pkg-config, header alone" "$work/by-pc"
  quietly cmake -S "$top" -B "$work/plain" -DHEATDIFF_BUILD_TESTS=OFF -DHEATDIFF_BUILD_EXAMPLES=OFF -DHEATDIFF_BUILD_TOOLS=OFF \
    -DCMAKE_INSTALL_PREFIX="$work/deep" -DCMAKE_INSTALL_LIBDIR=lib/some/where
  quietly cmake --install "$work/plain"
  mv "$work/deep" "$work/deeper"
  export PKG_CONFIG_PATH=$work/deeper/lib/some/where/pkgconfig
  told=$(pkg-config --cflags --libs heatdiff)
  case $told in *-lheatdiff*) fail "there is no shared library, but $told" ;; esac
  quietly "$cc" $CFLAGS "$c" -o "$work/plain-by-pc" $told
  is "pkg-config, without a shared library" "$work/plain-by-pc"
else
  echo "not here: pkg-config"
fi

# What libraries export: the functions that the header declares, and nothing else.
declared=$(sed 's@^typedef.*@@' "$top/heatdiff.h" | sed -n '1,/ifdef HEATDIFF_IMPLEMENTATION/s/^HEATDIFF_API.*[ *]\(hd_[a-z0-9_]*\)(.*/\1/p' | sort)
lib=$work/prefix/lib/libheatdiff.so
if [ -e "$lib" ]; then
  exported=$(nm -D --defined-only "$lib" | awk '{print $3}' | sort)
  [ "$exported" = "$declared" ] || { diff <(echo "$declared") <(echo "$exported") || fail "libheatdiff.so exports something else than is declared"; }
  echo "ok: libheatdiff.so exports $(echo "$exported" | wc -l) functions"
fi
mingw=x86_64-w64-mingw32
if command -v $mingw-gcc >/dev/null; then
  printf 'set(CMAKE_SYSTEM_NAME Windows)\nset(CMAKE_C_COMPILER %s-gcc)\nset(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)\n' $mingw >"$work/mingw.cmake"
  quietly cmake -S "$top" -B "$work/windows" -DCMAKE_TOOLCHAIN_FILE="$work/mingw.cmake" -DCMAKE_BUILD_TYPE=Debug -DHEATDIFF_BUILD_TESTS=OFF \
    -DHEATDIFF_BUILD_EXAMPLES=OFF -DHEATDIFF_BUILD_TOOLS=OFF -DHEATDIFF_BUILD_SHARED=ON -DCMAKE_INSTALL_PREFIX="$work/winprefix" -DCMAKE_INSTALL_LIBDIR=lib
  quietly cmake --build "$work/windows"
  quietly cmake --install "$work/windows"
  dll=$(echo "$work"/winprefix/bin/*heatdiff*.dll)
  exported=$($mingw-objdump -p "$dll" | awk '/Ordinal\/Name Pointer/ {on = 1; next} /^$/ {on = 0} on && /\]/ {print $NF}' | sort)
  [ "$exported" = "$declared" ] || { diff <(echo "$declared") <(echo "$exported") || fail "the DLL exports something else than is declared"; }
  quietly $mingw-gcc -DCONSUMER_SHARED -I"$work/winprefix/include" "$top/tests/consumer/consumer.c" -o "$work/winprefix/bin/consumer.exe" -L"$work/winprefix/lib" -lheatdiff
  if command -v wine >/dev/null; then
    export WINEPREFIX=$work/wine WINEDEBUG=-all
    trap 'wineserver -k 2>/dev/null || true' EXIT
    wine "$work/winprefix/bin/consumer.exe" >/dev/null 2>&1 || true   # the first start makes its folders
    is "Windows' DLL, under wine" wine "$work/winprefix/bin/consumer.exe"
  else
    echo "not here: wine"
  fi
else
  echo "not here: $mingw-gcc"
fi

# Version
tool=$work/prefix/bin/heatdiff
[ "$("$tool" --version)" = "heatdiff $version" ] || fail "heatdiff --version"

# The archive: header and tool
(cd "$work/build" && quietly cpack -G TGZ)
archive=$(echo "$work"/build/heatdiff-"$version"-*.tar.gz)
has "$archive"
tar tzf "$archive" >"$work/contents"
for f in include/heatdiff.h bin/heatdiff share/man/man1/heatdiff.1 share/doc/heatdiff/LICENSE; do grep -q "/$f\$" "$work/contents" || fail "$f is not in $archive"; done
echo "ok: $(basename "$archive")"
echo "$count consumers passed"
