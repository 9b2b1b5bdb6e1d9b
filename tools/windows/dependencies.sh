#!/usr/bin/env bash
# Builds the libraries for Windows that Debian does not have for mingw-w64, from Debian's source packages.
#   tools/windows/dependencies.sh [PREFIX]     default: build/windows/prefix
# Archives are downloaded into PREFIX/../archives and compared with tools/windows/sources.txt. A library that is complete in
# PREFIX is not built again, unless its options have changed; its log is PREFIX/../logs/NAME.log. Needs about 15 CPU-minutes and 2 GB.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/prepare.sh
here=$PWD/tools/windows
prefix=${1:-build/windows/prefix}
mkdir -p "$prefix" "$prefix/../archives" "$prefix/../sources" "$prefix/../logs" "$prefix/../ports"
prefix=$(cd "$prefix" && pwd)
work=$(dirname "$prefix")

# Debian's archives among the sources of apt, in both of its formats; archives of others have no sources of these packages.
debian_archives() {
  {
    { cat /etc/apt/sources.list /etc/apt/sources.list.d/*.list 2>/dev/null || true; } | sed -n 's/^deb \(\[[^]]*\] *\)\{0,1\}//p' |
      awk '$2 == "bookworm" && / main( |$)/ { print $1 }'
    for file in /etc/apt/sources.list.d/*.sources; do
      [ ! -e "$file" ] || awk 'BEGIN { RS = "" } / bookworm[ \n]/ && / main/ { for (i = 1; i < NF; ++i) if ($i == "URIs:") print $(i + 1) }' "$file"
    done
  } | sort -u | sed 's|^|deb-src |; s|$| bookworm main|'
}

# download PACKAGE ARCHIVE SHA256
download() {
  local apt=$work/apt
  if [ ! -s "$work/archives/$2" ]; then
    mkdir -p "$apt/lists"
    debian_archives >"$apt/sources.list"
    [ -s "$apt/sources.list" ] || c3de_fail "the sources of apt name no archive with bookworm main; copy $2 into $work/archives"
    set -- "$@" -o Dir::Etc::sourcelist="$apt/sources.list" -o Dir::Etc::sourceparts=/dev/null -o Dir::State::lists="$apt/lists"
    if [ ! -e "$apt/updated" ]; then
      apt-get "${@:4}" -qq update || c3de_fail "apt-get cannot read the lists of $apt/sources.list; copy $2 into $work/archives"
      touch "$apt/updated"
    fi
    (cd "$work/archives" && apt-get "${@:4}" -qq source --download-only --tar-only "$1" 2>/dev/null) ||
      c3de_fail "$2 cannot be downloaded; copy it into $work/archives"
  fi
  echo "$3  $work/archives/$2" | sha256sum --check --quiet || c3de_fail "$2 is not the archive that sources.txt names"
}

# unpack NAME ARCHIVE: into sources/NAME
unpack() {
  rm -rf "$work/sources/$1"
  mkdir -p "$work/sources/$1"
  tar xf "$work/archives/$2" -C "$work/sources/$1" --strip-components=1
}

sum_of() { awk -v name="$1" '$1 == name { print $3 }' "$here/sources.txt"; }

# built NAME COMMAND…: once per archive and command.
built() {
  local name=$1 stamp="$prefix/.built-$1" wanted
  shift
  wanted="$(sum_of "$name") $(cksum <<<"$*")"
  [ "$(cat "$stamp" 2>/dev/null || true)" != "$wanted" ] || return 0
  c3de_watched "$name for Windows:" "$work/logs/$name.log" c3de_seconds "$@" || {
    tail -n 30 "$work/logs/$name.log" >&2
    c3de_fail "$name was not built; its log is $work/logs/$name.log"
  }
  echo "$wanted" >"$stamp"
}

# with_cmake NAME OPTIONS…
with_cmake() {
  local name=$1
  shift
  rm -rf "$work/ports/$name"
  cmake -S "$work/sources/$name" -B "$work/ports/$name" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$here/toolchain.cmake" \
    -DC3DE_WINDOWS_PREFIX="$prefix" -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF \
    -DBUILD_TESTING=OFF "$@" && cmake --build "$work/ports/$name" && cmake --install "$work/ports/$name" &&
    rm -rf "$work/ports/$name"
}

with_openssl() {
  cd "$work/sources/openssl" && perl Configure mingw64 no-shared no-tests no-engine no-dso no-legacy no-ssl no-async \
    --cross-compile-prefix=x86_64-w64-mingw32- --prefix="$prefix" --libdir=lib && make -s -j "$(nproc)" build_generated libcrypto.a &&
    cp libcrypto.a "$prefix/lib" && cp -r include/openssl "$prefix/include"
}

# Headers and package files of Debian's own packages that contain nothing of one system.
with_headers() {
  mkdir -p "$prefix/include" "$prefix/share/cmake" "$prefix/lib/cmake" "$prefix/lib/pkgconfig"
  cp -r /usr/include/eigen3 /usr/include/CLI /usr/include/nlohmann /usr/include/nanoflann.hpp /usr/include/tl \
    /usr/include/toml++ /usr/include/stb /usr/include/catch2 /usr/include/tiny_obj_loader.h "$prefix/include"
  cp -r /usr/share/eigen3 /usr/share/nanoflann "$prefix/share"
  cp -r /usr/share/cmake/CLI11 /usr/share/cmake/nlohmann_json /usr/share/cmake/tl-expected "$prefix/share/cmake"
  cp -r /usr/lib/cmake/Catch2 "$prefix/lib/cmake"
}

with_ports() {
  rm -rf "$work/ports/ports"
  cmake -S "$here/ports" -B "$work/ports/ports" -G Ninja -DCMAKE_TOOLCHAIN_FILE="$here/toolchain.cmake" \
    -DC3DE_WINDOWS_PREFIX="$prefix" -DCMAKE_INSTALL_PREFIX="$prefix" -DCMAKE_BUILD_TYPE=Release -DC3DE_SOURCES="$work/sources" &&
    cmake --build "$work/ports/ports" && cmake --install "$work/ports/ports" || return
  for name in imgui libepoxy minizip; do sum_of "$name" >"$prefix/.built-$name"; done
}

while read -r name archive sum; do
  case $name in "" | "#"*) continue ;; esac
  if [ "$(cut -d ' ' -f 1 "$prefix/.built-$name" 2>/dev/null || true)" != "$sum" ]; then
    rm -f "$prefix/.built-$name" "$prefix/.built-ports"
    download "$name" "$archive" "$sum"
    unpack "$name" "$archive"
  fi
done <"$here/sources.txt"

built headers with_headers
built glfw3 with_cmake glfw3 -DGLFW_BUILD_DOCS=OFF -DGLFW_BUILD_TESTS=OFF -DGLFW_BUILD_EXAMPLES=OFF
built fmtlib with_cmake fmtlib -DFMT_TEST=OFF -DFMT_DOC=OFF
built spdlog with_cmake spdlog -DSPDLOG_FMT_EXTERNAL=ON -DSPDLOG_BUILD_EXAMPLE=OFF -DSPDLOG_BUILD_TESTS=OFF
built meshoptimizer with_cmake meshoptimizer
built highway with_cmake highway -DHWY_ENABLE_TESTS=OFF -DHWY_ENABLE_EXAMPLES=OFF
built libccd with_cmake libccd -DENABLE_DOUBLE_PRECISION=ON
# The ports are this project's own files: they are built again when one changes.
built ports with_ports "$(cat "$here"/ports/* | sha256sum)"
built openssl with_openssl
# AABB trees only: no octrees. Eigen's alignment as on every other system (docs/dev/dependencies.md).
built fcl with_cmake fcl -DFCL_STATIC_LIBRARY=ON -DFCL_WITH_OCTOMAP=OFF -DFCL_USE_HOST_NATIVE_ARCH=OFF -DFCL_USE_X64_SSE=OFF \
  -DCMAKE_CXX_FLAGS="-DEIGEN_MAX_STATIC_ALIGN_BYTES=16 -DCCD_STATIC_DEFINE -w"
# Its dump of MEC_MR3 elements, which is not used, knows that Visual C++ has no iconv; mingw-w64 has none either.
sed -i 's/^#ifndef _MSC_VER/#ifndef _WIN32/' "$work/sources/gdcm/Utilities/gdcmext/mec_mr3_io.c"
built gdcm with_cmake gdcm -DGDCM_BUILD_SHARED_LIBS=OFF -DGDCM_BUILD_APPLICATIONS=OFF -DGDCM_BUILD_TESTING=OFF \
  -DGDCM_DOCUMENTATION=OFF -DGDCM_BUILD_DOCBOOK_MANPAGES=OFF -DGDCM_USE_SOCKETXX=OFF -DGDCM_USE_SYSTEM_ZLIB=ON \
  -DCMAKE_CXX_FLAGS=-w -DCMAKE_C_FLAGS=-w
# Debian's archive has its own packages of these two instead.
mkdir -p "$work/sources/assimp/contrib/utf8cpp"
ln -sfn /usr/include/utf8cpp "$work/sources/assimp/contrib/utf8cpp/source"
ln -sfn /usr/include/stb "$work/sources/assimp/contrib/stb"
built assimp with_cmake assimp -DASSIMP_BUILD_ASSIMP_TOOLS=OFF -DASSIMP_BUILD_TESTS=OFF -DASSIMP_BUILD_ZLIB=OFF \
  -DASSIMP_NO_EXPORT=ON -DASSIMP_BUILD_ALL_IMPORTERS_BY_DEFAULT=OFF -DASSIMP_BUILD_STL_IMPORTER=ON \
  -DASSIMP_BUILD_PLY_IMPORTER=ON -DASSIMP_BUILD_OFF_IMPORTER=ON -DASSIMP_BUILD_GLTF_IMPORTER=ON \
  -DASSIMP_WARNINGS_AS_ERRORS=OFF -DASSIMP_BUILD_DRACO=OFF -DASSIMP_INJECT_DEBUG_POSTFIX=OFF -DCMAKE_CXX_FLAGS="-w -I$prefix/include/minizip"
c3de_say "the libraries for Windows are in $prefix"
