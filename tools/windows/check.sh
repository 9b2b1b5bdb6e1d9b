#!/usr/bin/env bash
# ./check --windows: builds C3DE for Windows by mingw-w64 and runs its tests under wine on a virtual screen. Arguments go to
# ctest; with --all first, the slow tests are run as well. Tests that are not run there are listed with their reasons in
# tools/windows/not-run.txt.
# The scenarios with a window need the test program of this machine, which is built as well.
set -euo pipefail
cd "$(dirname "$0")/../.."
. tools/prepare.sh
slow=OFF
if [ "${1:-}" = --all ]; then
  slow=ON
  shift
fi
c3de_install_packages "$(c3de_names tools/debian-packages.txt tools/debian-packages-check.txt tools/debian-packages-windows.txt)" ""
tools/windows/dependencies.sh
build=build/windows-mingw
# The first program under wine creates its folders.
c3de_watched "wine:" build/windows/wine.log c3de_seconds tools/windows/wine.sh cmd /c exit || c3de_fail "wine does not run; see build/windows/wine.log"
grep -qs "^C3DE_BUILD_SLOW_TESTS:BOOL=$slow" $build/CMakeCache.txt ||
  c3de_watched "configuring for Windows" build/configure-windows.log c3de_seconds \
    cmake --preset windows-mingw -DC3DE_BUILD_BENCHMARKS=OFF -DC3DE_BUILD_SLOW_TESTS=$slow ||
  c3de_fail "cmake could not configure $build; the whole output is in build/configure-windows.log"
NINJA_STATUS='[%f/%t] ' c3de_watched "building for Windows:" build/build-windows.log c3de_build_steps cmake --build $build || {
  grep -A 30 -m 1 '^FAILED:' build/build-windows.log >&2 || tail -n 30 build/build-windows.log >&2
  c3de_fail "the build failed; the whole output is in build/build-windows.log"
}
c3de_configure tests
c3de_build test_ui

# Lines of the list: NAME | REASON. A name that no test has is a mistake.
table=$PWD/tools/windows/not-run.txt
cd $build
names=$(ctest -N | sed -n 's/^ *Test *#[0-9]*: //p')
excluded=""
while IFS= read -r line; do
  case $line in "" | "#"*) continue ;; esac
  name=${line% | *}
  grep -qxF -- "$name" <<<"$names" || c3de_fail "$table names '$name', which is no test"
  # shellcheck disable=SC2001,SC2016
  excluded+="|$(sed 's/[][\.*^$()+?{}|]/\\&/g' <<<"$name")"
done <"$table"
# With mingw-w64 copying over a file that exists fails, whatever the options.
rm -rf test-output
# A rerun needs the same selection: ctest numbers the tests that are selected.
run_tests() {
  xvfb-run -a -s "-screen 0 1400x900x24" ctest --output-on-failure --timeout 900 ${excluded:+-E "^(${excluded#|})\$"} "$@"
}
status=0
run_tests -j "$(nproc)" --output-junit first.xml "$@" || status=$?
rm -f second.xml
if [ "$status" != 0 ] && [ -s Testing/Temporary/LastTestsFailed.log ]; then
  # Wine and the other tests share the processors. What failed is run again alone; that it passed only then is reported.
  if run_tests "$@" -j 1 --rerun-failed --output-junit second.xml; then status=0; fi
fi
results=(first.xml)
[ ! -e second.xml ] || results+=(second.xml)
awk -f "$OLDPWD/tools/windows/summary.awk" "${results[@]}"
echo "Not run on Windows, $(grep -c ' | ' "$table") cases:"
sed '/^#/d; /^$/d; s/^/  /' "$table"
exit $status
