#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds what ./run builds and writes packages into build/packages: tools/package.sh [deb] [tgz] [windows], without arguments the
# first two. `windows` cross-compiles the program (tools/windows) and writes the installer and the archive for Windows.
# What is missing is installed, as ./run does it; packages need those of debian-packages-package.txt as well.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh

[ $# -gt 0 ] || set -- deb tgz
native=() windows=()
for kind in "$@"; do
  case $kind in
    deb | tgz) native+=("$kind") ;;
    windows) windows=(zip nsis) ;;
    *)
      echo "c3de: error: '$kind' is no kind of package; accepted: deb, tgz, windows" >&2
      exit 2
      ;;
  esac
done

# packed PRESET...
packed() {
  mkdir -p build/packages
  for kind in "$@"; do
    c3de_watched "writing packages ($kind)" "build/packages/$kind.log" c3de_seconds cpack --preset "$kind" || {
      tail -n 20 "build/packages/$kind.log" >&2
      c3de_fail "cpack --preset $kind failed; the whole output is in build/packages/$kind.log"
    }
    sed -n 's/^CPack: - package: \(.*\) generated\.$/\1/p' "build/packages/$kind.log"
  done
}

if [ ${#native[@]} -gt 0 ]; then
  c3de_install_packages "$(c3de_names tools/debian-packages.txt tools/debian-packages-package.txt)" "$(c3de_names tools/debian-packages-optional.txt)"
  c3de_configure
  c3de_build products
  packed "${native[@]}"
fi
if [ ${#windows[@]} -gt 0 ]; then
  c3de_install_packages "$(c3de_names tools/debian-packages.txt tools/debian-packages-windows.txt)" "$(c3de_names tools/debian-packages-optional.txt)"
  tools/windows/dependencies.sh
  log=build/packages/windows-build.log
  mkdir -p build/packages
  # The guide as a site, where ./run has built it.
  c3de_watched "configuring for Windows" "$log" c3de_seconds cmake --preset windows-mingw -DC3DE_BUILD_BENCHMARKS=OFF \
    -DC3DE_REFERENCE_SITE="$PWD/build/release/reference" ||
    c3de_fail "cmake could not configure build/windows-mingw; the whole output is in $log"
  c3de_watched "building for Windows" "$log" c3de_seconds cmake --build build/windows-mingw \
    --target c3de c3de_workstation c3de_window c3de_validate pointbased baselines || {
    tail -n 30 "$log" >&2
    c3de_fail "the build failed; the whole output is in $log"
  }
  packed "${windows[@]}"
fi
