#!/usr/bin/env bash
# ./check --windows: builds C3DE for Windows by mingw-w64, runs its tests under wine on a virtual screen, and writes a zip and
# an NSIS installer into build/windows-mingw. Arguments go to ctest.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/prepare.sh
c3de_install_packages "$(c3de_names tools/debian-packages.txt tools/debian-packages-check.txt tools/debian-packages-windows.txt)" ""
tools/windows/dependencies.sh
build=build/windows-mingw
[ -f $build/build.ninja ] || c3de_watched "configuring for Windows" build/configure-windows.log c3de_seconds cmake --preset windows-mingw ||
  c3de_fail "cmake could not configure $build; the whole output is in build/configure-windows.log"
NINJA_STATUS='[%f/%t] ' c3de_watched "building for Windows:" build/build-windows.log c3de_build_steps cmake --build $build || {
  grep -A 30 -m 1 '^FAILED:' build/build-windows.log >&2 || tail -n 30 build/build-windows.log >&2
  c3de_fail "the build failed; the whole output is in build/build-windows.log"
}
cd $build
exec xvfb-run -a -s "-screen 0 1400x900x24" ctest --output-on-failure --timeout 600 -j "$(nproc)" "$@"
