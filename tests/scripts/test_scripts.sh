#!/usr/bin/env bash
# test_scripts.sh ROOT MACHINE: runs ./run or ./check of a copy of ROOT's scripts on a made-up machine and looks at what they
# say and do. The machine is a folder: installed (names), sources (names that apt can get), log (what was called).
set -uo pipefail
root=$1 machine=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
abi=framework/abi/include/c3de/abi
mkdir -p "$place/tree/tools" "$place/tree/benchmarks" "$place/tree/$abi" "$place/bin" "$place/state"
cp "$root/run" "$root/check" "$root/CMakeLists.txt" "$place/tree"
cp -r "$root"/tools/*.sh "$root"/tools/*.txt "$root/tools/help" "$place/tree/tools"
cp "$root/$abi/base.h" "$place/tree/$abi"
touch "$place/tree/x.obj" "$place/tree/benchmarks/bench_forces.cpp"
state=$place/state
touch "$state/installed" "$state/log"
sed -e 's/#.*//' -e '/^ *$/d' "$root"/tools/debian-packages*.txt >"$state/sources"
required() { sed -e 's/#.*//' -e '/^ *$/d' "$root/tools/debian-packages.txt"; }

# PATH holds the stand-ins and what scripts need of the system, nothing else.
for tool in awk tee bash basename cat chmod cp date dirname env false find grep head kill ln ls mkdir mktemp ninja nproc paste printf pwd \
            rm sed seq setsid sh sleep sort tail touch tr true wc; do
  path=$(type -P "$tool") && ln -s "$path" "$place/bin/$tool"
done
stand_in() {
  cat >"$place/bin/$1"
  chmod +x "$place/bin/$1"
}
# As dpkg-query does: tells of the names it knows, ends with 1 if there is one that it does not.
stand_in dpkg-query <<EOF
#!$(type -P bash)
status=0
shift 2
for name in "\$@"; do
  if grep -qx "\$name" "$state/installed"; then echo "\$name installed"; else status=1; fi
done
exit \$status
EOF
# Installs all or nothing, as apt-get does.
stand_in apt-get <<EOF
#!$(type -P bash)
echo "apt-get \$*" >>"$state/log"
if [ "\$1" = update ]; then
  [ ! -f "$state/no_network" ] || { echo "E: Failed to fetch the lists"; exit 100; }
  exit 0
fi
names=()
shift
while [ \$# -gt 0 ]; do
  case \$1 in -o) shift ;; -*) ;; *) names+=("\$1") ;; esac
  shift
done
for name in "\${names[@]}"; do
  grep -qx "\$name" "$state/sources" || { echo "E: Unable to locate package \$name"; exit 100; }
done
[ ! -f "$state/no_archives" ] || { echo "E: Unable to fetch some archives"; exit 100; }
printf '%s\n' "\${names[@]}" >>"$state/installed"
EOF
stand_in apt-cache <<EOF
#!$(type -P bash)
grep -qx "\$2" "$state/sources" && echo "  Candidate: 1.0"
exit 0
EOF
stand_in id <<EOF
#!$(type -P bash)
cat "$state/uid" 2>/dev/null || echo 0
EOF
# Configures and builds in an instant; the program it builds says its arguments.
stand_in cmake <<EOF
#!$(type -P bash)
echo "cmake \$*" >>"$state/log"
if [ "\$1" = --preset ]; then
  [ ! -f "$state/bad_configure" ] || { printf 'CMake Error at CMakeLists.txt:1:\n  no such library\n'; exit 1; }
  mkdir -p build/release/bin build/clang
  touch build/release/build.ninja
  for file in \$(find framework -name '*.cpp' ! -name '*_win32.cpp' 2>/dev/null); do
    printf '{\n  "directory": "%s",\n  "command": "c++ -I%s/framework -isystem /usr/include/x -DTEXT=%s -O3 -o a.o -c a",\n  "file": "%s"\n},\n' \
      "\$PWD" "\$PWD" '\\\\\\"it\\\\\\"' "\$PWD/\$file"
  done >build/clang/compile_commands.json
  tests=OFF slow=OFF
  for a in "\$@"; do
    [ "\$a" != -DC3DE_BUILD_TESTS=ON ] || tests=ON
    [ "\$a" != -DC3DE_BUILD_SLOW_TESTS=ON ] || slow=ON
  done
  printf 'C3DE_BUILD_%s:BOOL=%s\n' TESTS "\$tests" SLOW_TESTS "\$slow" BENCHMARKS ON >build/release/CMakeCache.txt
  exit 0
fi
[ ! -f "$state/anew" ] || { echo "[0/2] Re-checking globbed directories..."; sleep 5; }
[ ! -f "$state/slow" ] || for i in \$(seq 1 "\$(cat "$state/slow")"); do echo "[\$i/40] Building"; sleep 1; done
[ ! -f "$state/bad_build" ] || { printf '[1/2] Building a\nFAILED: a.o\na.cpp:7: error: no such thing\n'; exit 1; }
mkdir -p build/release/bin
printf '#!%s\necho "program: \$*"\n' "$(type -P bash)" >build/release/bin/c3de
printf '#!%s\necho "benchmark: \$*"\n' "$(type -P bash)" >build/release/bin/bench_forces
chmod +x build/release/bin/*
EOF
stand_in ctest <<EOF
#!$(type -P bash)
echo "ctest \$*" >>"$state/log"
if [ -f "$state/stopped" ]; then
  mkdir -p Testing/Temporary
  printf '%s\n' '1/9 Test #1: a bar ......   Passed    0.10 sec' 'The stop time has been passed. Stopping all tests.' >&2
  [ -s "$state/stopped" ] || exit 0
  cp "$state/stopped" Testing/Temporary/LastTestsFailed.log
  printf '%s\n' '2/9 Test #2: a beam ......***Timeout  14.71 sec' '3/9 Test #3: a plate ....***Timeout 600.02 sec' >&2
  exit 8
fi
[ -f "$state/failing_test" ] || exit 0
mkdir -p Testing/Temporary test-output/validation
cp "$state/failing_test" Testing/Temporary/LastTestsFailed.log
printf '%s\n' '1/2 Testing: a bar' 'all is well' 'Test Passed.' '2/2 Testing: a beam bends' 'it bends too far' 'Test Failed.' \
  >Testing/Temporary/LastTest.log
# A second run: the window of the first name passes, that of the second fails again.
case "\$*" in
  *--rerun-failed*)
    sed -i '/test_ui: window/d;/a beam/d' Testing/Temporary/LastTestsFailed.log
    [ -s Testing/Temporary/LastTestsFailed.log ] || exit 0
    ;;
esac
echo "a figure" >test-output/validation/figures.txt
echo "*** Failed"
exit 8
EOF
# Compilers that complain about every line of a source with BAD, and about headers that are not there.
compilers_stand_in() {
  stand_in clang++ </dev/null
  stand_in clang-tidy <<EOF
#!$(type -P bash)
echo "clang-tidy \$*" >>"$state/log"
grep -n BAD "\${@: -1}" | sed "s|^\([0-9]*\):.*|\$PWD/\${@: -1}:\1:1: error: this is bad [bugprone-x,-warnings-as-errors]|"
! grep -q BAD "\${@: -1}"
EOF
  stand_in x86_64-w64-mingw32-g++-posix <<EOF
#!$(type -P bash)
echo "for-windows \$*" >>"$state/log"
file=\${@: -1}
grep -q 'include <unistd.h>\|include <epoxy/wgl.h>\|WORSE' "\$file" || exit 0
sed -n "s,#include <\(unistd.h\|epoxy/wgl.h\)>,\$file:1:10: fatal error: \1: No such file or directory,p" "\$file"
grep -q WORSE "\$file" && echo "\$file:2:3: error: worse"
exit 1
EOF
  stand_in git <<EOF
#!$(type -P bash)
case \$1 in
  rev-parse) [ "\${@: -1}" = "HEAD~1^{commit}" ] ;;
  diff) echo framework/core/include/changed.h ;;
esac
EOF
  mkdir -p "$place/tree/framework/core/src"
  echo '#include "changed.h"' >"$place/tree/framework/core/src/a.cpp"
  echo 'int b;' >"$place/tree/framework/core/src/b.cpp"
  echo 'int c;' >"$place/tree/framework/core/src/platform_posix.cpp"
  echo 'int d;' >"$place/tree/framework/core/src/platform_win32.cpp"
  cp "$state/sources" "$state/installed"
}
sudo_stands_in() {
  stand_in sudo <<EOF
#!$(type -P bash)
echo "sudo \$*" >>"$state/log"
[ ! -f "$state/password" ] || { echo "sudo: a password is required" >&2; exit 1; }
[ "\$1" != -n ] || shift
exec "\$@"
EOF
}

launch() { # launch NAME ARGS...: output in out and err, status in status
  status=0
  (cd "$place/tree" && env -i PATH="$place/bin" HOME="$place" "$(type -P bash)" "./$1" "${@:2}") \
    >"$place/out" 2>"$place/err" </dev/null || status=$?
}
fail() {
  echo "FAILED: $*"
  echo "--- status ${status:-none}, out:"; cat "$place/out"
  echo "--- err:"; cat "$place/err"
  echo "--- called:"; cat "$state/log"
  exit 1
}
ends_with_status() { [ "$status" -eq "$1" ] || fail "status $1 was expected"; }
says() { grep -qF -- "$1" "$place/err" || fail "expected on stderr: $1"; }
says_not() { ! grep -qF -- "$1" "$place/err" || fail "not expected on stderr: $1"; }
called() { grep -q -- "$1" "$state/log" || fail "expected call: $1"; }
never_called() { ! grep -q -- "$1" "$state/log" || fail "not expected call: $1"; }
one_error_line() { [ "$(grep -c 'c3de: error:' "$place/err")" -eq 1 ] || fail "one error line was expected"; }
runs_program() { [ "$(tail -n 1 "$place/out")" = "program: $*" ] || fail "the program was expected to run with: $*"; }
installed_all_required() {
  for name in $(required); do grep -qx "$name" "$state/installed" || fail "$name was expected to be installed"; done
}

case $machine in
  nothing_installed)
    launch run info x.obj
    ends_with_status 0
    installed_all_required
    grep -qx mricron-data "$state/installed" || fail "the head was expected"
    runs_program info x.obj
    ;;
  some_missing)
    required | grep -vx -e libfcl-dev -e g++ >"$state/installed"
    launch run info x.obj
    ends_with_status 0
    called 'apt-get install.* g++ libfcl-dev mricron-data libopenmpi-dev openmpi-bin$'
    runs_program info x.obj
    ;;
  all_there)
    cp "$state/sources" "$state/installed"
    launch run info x.obj
    ends_with_status 0
    never_called apt-get
    [ ! -s "$place/err" ] || fail "nothing was expected on stderr"
    ;;
  no_sudo)
    echo 1000 >"$state/uid"
    launch run
    ends_with_status 1
    one_error_line
    says "missing packages"
    says "type: su -c 'apt-get update && apt-get install --no-install-recommends g++ cmake"
    never_called apt-get
    ;;
  no_password_can_be_asked)
    echo 1000 >"$state/uid"
    touch "$state/password"
    sudo_stands_in
    required | grep -vx libccd-dev >"$state/installed"
    launch check
    ends_with_status 1
    one_error_line
    says "type: sudo apt-get update && sudo apt-get install --no-install-recommends libccd-dev catch2"
    never_called apt-get
    ;;
  sudo_works)
    echo 1000 >"$state/uid"
    sudo_stands_in
    launch run info x.obj
    ends_with_status 0
    called 'sudo -n env DEBIAN_FRONTEND=noninteractive apt-get install'
    installed_all_required
    ;;
  update_fails)
    touch "$state/no_network"
    launch run info x.obj
    ends_with_status 0
    says "apt-get update failed; trying with the package lists that are there"
    installed_all_required
    runs_program info x.obj
    ;;
  nothing_can_be_had)
    touch "$state/no_network" "$state/no_archives"
    launch run
    ends_with_status 1
    one_error_line
    says "could not install (apt-get update failed too): g++ cmake"
    says "Unable to fetch some archives"
    says "type: apt-get update && apt-get install --no-install-recommends g++ cmake"
    ;;
  unknown_package)
    sed -i '/^libhwy-dev$/d' "$state/sources"
    launch run
    ends_with_status 1
    one_error_line
    says "not in the package sources of this machine: libhwy-dev ;"
    ;;
  unknown_welcome_package)
    sed -i '/^mricron-data$/d' "$state/sources"
    launch run info x.obj
    ends_with_status 0
    installed_all_required
    says "goes on without: mricron-data"
    runs_program info x.obj
    ;;
  welcome_asked_once)
    required >"$state/installed"
    sed -i '/^mricron-data$/d' "$state/sources"
    launch run info x.obj
    ends_with_status 0
    : >"$state/log"
    launch run info x.obj
    ends_with_status 0
    never_called apt-get
    [ ! -s "$place/err" ] || fail "nothing was expected on stderr the second time"
    ;;
  no_debian)
    rm "$place/bin/dpkg-query"
    launch run info x.obj
    ends_with_status 0
    says "not a Debian system"
    runs_program info x.obj
    ;;
  run_builds_no_tests)
    cp "$state/sources" "$state/installed"
    launch run info x.obj
    ends_with_status 0
    called 'cmake --preset release -DC3DE_BUILD_BENCHMARKS=ON -DC3DE_BUILD_TESTS=OFF$'
    called 'cmake --build build/release --target products$'
    runs_program info x.obj
    ;;
  check_configures_tests)
    cp "$state/sources" "$state/installed"
    launch run info x.obj
    launch check -R core
    ends_with_status 0
    called 'cmake --preset release -DC3DE_BUILD_TESTS=ON'
    called 'cmake --build build/release$'
    called 'ctest .*-R core'
    ;;
  check_stops_in_time)
    cp "$state/sources" "$state/installed"
    launch check --minutes 5 -R core
    ends_with_status 0
    called 'ctest .*--stop-time [0-9:]* -R core'
    : >"$state/stopped"
    launch check --all --minutes 5
    ends_with_status 0
    grep -qF 'because the 5 minutes were over: 8.' "$place/out" || fail "eight tests were not run"
    echo '2:a beam' >"$state/stopped"
    launch check --minutes 5 --all
    ends_with_status 0
    grep -qF 'because the 5 minutes were over: 7.' "$place/out" || fail "six tests were not run, and one was cut off"
    echo '3:a plate' >>"$state/stopped"
    launch check --minutes 5
    ends_with_status 8
    grep -qx '  a plate' "$place/out" && ! grep -qx '  a beam' "$place/out" || fail "the test that hangs failed, not the other"
    rm "$state/stopped"
    launch check --minutes soon
    ends_with_status 1
    says "--minutes is 'soon'; accepted: a whole number"
    ;;
  check_all_adds_slow_tests)
    cp "$state/sources" "$state/installed"
    launch check
    called 'cmake --preset release .*-DC3DE_BUILD_SLOW_TESTS=OFF'
    : >"$state/log"
    launch check --all -R core
    ends_with_status 0
    called 'cmake --preset release .*-DC3DE_BUILD_SLOW_TESTS=ON'
    called 'ctest .*-R core'
    never_called '--all'
    : >"$state/log"
    launch check --all
    never_called 'cmake --preset'
    ;;
  run_keeps_tests)
    cp "$state/sources" "$state/installed"
    launch check
    : >"$state/log"
    launch run info x.obj
    ends_with_status 0
    never_called 'cmake --preset'
    ;;
  run_adds_benchmarks)
    cp "$state/sources" "$state/installed"
    mkdir -p "$place/tree/build/release"
    touch "$place/tree/build/release/build.ninja"
    echo "C3DE_BUILD_BENCHMARKS:BOOL=OFF" >"$place/tree/build/release/CMakeCache.txt"
    launch run bench_forces --seconds 1
    ends_with_status 0
    called 'cmake --preset release -DC3DE_BUILD_BENCHMARKS=ON$'
    called 'cmake --build build/release --target bench_forces$'
    says "c3de: benchmarks are built when they are asked for: bench_forces"
    [ "$(tail -n 1 "$place/out")" = "benchmark: --seconds 1" ] || fail "the benchmark was expected to run"
    ;;
  help_before_building)
    # Nothing is installed here. The texts are held to the program's by test_cli.
    launch run --help
    ends_with_status 0
    cmp "$place/out" "$root/tools/help/c3de.txt" || fail "the help was expected"
    launch run run no.toml --until --help
    ends_with_status 0
    cmp "$place/out" "$root/tools/help/run.txt" || fail "the help of run was expected"
    launch run -h
    ends_with_status 0
    launch run --version
    ends_with_status 0
    [ "$(cat "$place/out")" = "c3de $(sed -nE 's/^project\(C3DE VERSION ([0-9.]+).*/\1/p' "$root/CMakeLists.txt"), plugin ABI 1.0" ] || fail "the version was expected"
    cp "$place/out" "$place/version"
    for arguments in -V version; do
      launch run $arguments
      ends_with_status 0
      cmp "$place/out" "$place/version" || fail "$arguments: the version was expected"
    done
    launch run help
    cmp "$place/out" "$root/tools/help/c3de.txt" || fail "the help was expected"
    launch run help run
    cmp "$place/out" "$root/tools/help/run.txt" || fail "the help of run was expected"
    [ ! -s "$state/log" ] || fail "nothing was to be called"
    ;;
  mistakes_before_building)
    touch "$place/tree/a.toml" "$place/tree/s.toml"
    while read -r code arguments; do
      text=${arguments#*=> } arguments=${arguments%% => *}
      eval "launch run $arguments"
      [ "$status" -eq "$code" ] || fail "$arguments: status $code was expected"
      says "$text"
      [ ! -s "$place/out" ] && [ "$(grep -c '' "$place/err")" -eq 1 ] || fail "$arguments: one line on stderr was expected"
      [ ! -s "$state/log" ] || fail "$arguments: nothing was to be called"
    done <<'EOF'
2 rnu => 'rnu' is neither a command nor a file; commands: run replay match fit info materials parameters plugins study new-plugin python-path completion help version
2 --frobnicate => '--frobnicate' is not accepted here; see ./run --help
2 run => SCENE is required; see ./run run --help
2 run a.toml --untill 1 => '--untill' is not accepted here; see ./run run --help
2 run a.toml --until => --until: 1 required SECONDS missing
2 run a.toml --until -1 => --until: '-1' is not accepted; accepted: a number
2 run a.toml --until=1,5 => --until: '1,5' is not accepted
2 run a.toml --until nan => --until: 'nan' is not accepted
2 run a.toml --steps 1.5 => --steps: '1.5' is not accepted; accepted: a whole number
2 run a.toml --screenshot a.png --size huge => --size: 'huge' is not accepted; accepted: WIDTHxHEIGHT
2 run a.toml --report '' => --report: '' is not accepted; accepted: a file name
2 run a.toml --report --quiet => --report: '--quiet' is not accepted; accepted: a file name
2 run a.toml --until 1 --steps 3 => --until excludes --steps
2 run a.toml --export-every 0.1 => --export-every requires --export
2 run a.toml --sampled out.csv => --sampled requires --sample-points
2 run a.toml --resume => '--resume' is not accepted here
2 info => FILE is required
2 info x.obj --unit inch => --unit: 'inch' is not accepted; accepted: m, mm, cm
2 study => STUDY is required
2 study s.toml => --out is required
2 plugins --off => --off: 1 required ID missing
2 version x.obj => 'x.obj' is not accepted here
2 completion => SHELL is required
2 new-plugin => NAME is required
2 --json => --json is for --version, info and plugins
2 bench_none => there is no benchmark 'bench_none'; accepted: bench_forces
3 run nowhere/a.toml => nowhere/a.toml: no such file
3 info x.obj y.obj => y.obj: no such file
3 nowhere/liver.obj => nowhere/liver.obj: no such file
6 x.obj => there is no display (DISPLAY and WAYLAND_DISPLAY are empty)
6 --play => there is no display
EOF
    ;;
  right_arguments_build)
    cp "$state/sources" "$state/installed"
    touch "$place/tree/a.toml" "$place/tree/s.toml"
    while read -r arguments; do
      eval "launch run $arguments"
      [ "$status" -eq 0 ] || fail "$arguments: status 0 was expected"
      called 'cmake --build build/release --target products$'
      : >"$state/log"
    done <<'EOF'
run a.toml --until 1e-3 -q --set body.a.b=-1 --set solver.dt=auto --report -
run - --steps 3 --probes - -q
materials liver --json
help environment
completion bash
run --until=.5 a.toml --export=a.pvd --export-every .1 --set=a.b=1 --plugin-param org.c3de.magnet:strength=-20 -v
--verbose --threads 2 run a.toml --steps +3 --verify
run -q a.toml --size 640x480 --screenshot=a.png
info x.obj a.toml --quick --json
info x.obj --time 3 --series 1.2#3
plugins --json --off a --on b
new-plugin mine --kind tool
study s.toml --out out/s --resume
--version --json
EOF
    ;;
  estimates)
    # simulated_build.txt: when each step of a build by two processes ends. No build was recorded: the times follow from
    # measured processor times of the compiler, each varied by a factor of 0.6 to 1.6, so a loaded machine is not tested.
    # The time left is to be said within a factor of 1.5 from a twentieth of the time on.
    mkdir "$place/tree/build"
    cd "$place/tree" || exit 1
    . tools/prepare.sh
    touch "$place/out" "$place/err"
    all=$(grep -c '' "$root/tests/scripts/simulated_build.txt")
    awk -v all="$all" '{ print $1, "[" NR "/" all "] Building CXX object " $2 }' "$root/tests/scripts/simulated_build.txt" >steps
    cut -d ' ' -f 2- steps | sort >build/build.plan
    whole=$(tail -n 1 steps | cut -d . -f 1)
    for percent in 5 10 20 30 40 50 60 70 80 90; do
      now=$((whole * percent / 100))
      awk -v now=$now '$1 <= now { sub(/^[^ ]+ /, ""); print }' steps >build.log
      said=$(c3de_build_steps build.log $now)
      said_s=$(sed -nE 's/.*about ([0-9]+) min left/\1 60/p; s/.*about ([0-9]+) s left/\1 1/p' <<<"$said" | awk '{ print $1 * $2 }')
      awk -v said="${said_s:-0}" -v left=$((whole - now)) 'BEGIN { exit !(said > left / 1.5 - 30 && said < left * 1.5 + 30) }' ||
        fail "after $now of $whole s: $said"
    done
    ;;
  check_names_what_failed)
    cp "$state/sources" "$state/installed"
    echo "12:a beam bends" >"$state/failing_test"
    launch check
    ends_with_status 8
    [ "$(tail -n 1 "$place/out")" = "  a beam bends" ] || fail "the test that failed was expected at the end"
    grep -qx "it bends too far" "$place/out" || fail "the output of the test that failed was expected"
    ! grep -q "all is well" "$place/out" || fail "the output of a test that passed was not expected"
    ! grep -q rerun-failed "$state/log" || fail "a test without a window was run twice"
    ;;
  check_repeats_windows)
    cp "$state/sources" "$state/installed"
    printf '%s\n' "3:test_ui: window" >"$state/failing_test"
    launch check
    ends_with_status 0
    [ "$(tail -n 1 "$place/out")" = "  test_ui: window" ] || fail "the test that passed only alone was expected at the end"
    grep -q "passed only when" "$place/out" || fail "a second run was expected to be reported"
    printf '%s\n' "3:test_ui: window" >"$state/failing_test"
    launch check -R window
    called "ctest --rerun-failed .* -R window"
    printf '%s\n' "3:test_ui: window" "4:test_ui: menu" "12:a beam bends" >"$state/failing_test"
    launch check
    ends_with_status 8
    [ "$(tail -n 2 "$place/out" | tr -d '\n')" = "  test_ui: menu  a beam bends" ] || fail "the tests that failed were expected"
    grep -qx "  test_ui: window" "$place/out" || fail "the test that passed only alone was expected"
    ;;
  configure_fails)
    cp "$state/sources" "$state/installed"
    touch "$state/bad_configure"
    launch run
    ends_with_status 1
    one_error_line
    says "no such library"
    ;;
  build_fails)
    cp "$state/sources" "$state/installed"
    touch "$state/bad_build"
    launch run
    ends_with_status 1
    one_error_line
    says "a.cpp:7: error: no such thing"
    says_not "Building a"
    ;;
  progress_in_a_log)
    cp "$state/sources" "$state/installed"
    echo 5 >"$state/slow"
    launch run info x.obj
    ends_with_status 0
    grep -qE 'c3de: building: step ([2-5]) of 40 \((5|7|10|12) %\)' "$place/err" || fail "the step was expected"
    grep -q $'\r' "$place/err" && fail "a log should have no carriage returns"
    [ "$(cat "$place/out")" = "program: info x.obj" ] || fail "only the program was expected on stdout"
    ;;
  progress_while_cmake_runs)
    cp "$state/sources" "$state/installed"
    touch "$state/anew"
    launch run info x.obj
    ends_with_status 0
    says "c3de: building: cmake configures anew ("
    says_not "step 0 of 2"
    ;;
  analyse)
    compilers_stand_in
    launch check --analyse
    ends_with_status 0
    called 'cmake --preset clang'
    never_called 'ctest'
    never_called 'cmake --build'
    called 'clang-tidy .* framework/core/src/platform_posix.cpp$'
    never_called 'clang-tidy .*_win32'
    never_called 'for-windows .*_posix'
    says "clang-tidy: 3 files, 0 findings"
    called "for-windows -fsyntax-only -I$place/tree/framework -DTEXT=.it. -DNOMINMAX .* framework/core/src/platform_win32.cpp"
    says "for Windows: 3 files, 0 not looked at, 0 with errors"
    ;;
  analyse_finds)
    compilers_stand_in
    echo 'BAD' >>"$place/tree/framework/core/src/b.cpp"
    echo '#include <unistd.h>' >"$place/tree/framework/core/src/a.cpp"
    launch check --analyse
    ends_with_status 1
    grep -qxF 'framework/core/src/b.cpp:2:1: error: this is bad [bugprone-x,-warnings-as-errors]' "$place/out" || fail "the finding was expected"
    grep -qxF 'framework/core/src/a.cpp:1:10: fatal error: unistd.h: No such file or directory' "$place/out" || fail "the header was expected"
    says "clang-tidy: 3 files, 1 findings"
    says "for Windows: 3 files, 0 not looked at, 1 with errors"
    ;;
  analyse_says_what_it_left_out)
    compilers_stand_in
    echo '#include <epoxy/wgl.h>' >"$place/tree/framework/core/src/a.cpp"
    launch check --analyse
    ends_with_status 0
    says "c3de: framework/core/src/a.cpp: not looked at, epoxy/wgl.h cannot be had for Windows here"
    says "for Windows: 3 files, 1 not looked at, 0 with errors"
    ;;
  analyse_since)
    compilers_stand_in
    launch check --analyse --since HEAD~1
    ends_with_status 0
    called 'clang-tidy .* framework/core/src/a.cpp$'
    never_called 'framework/core/src/b.cpp$'
    says "clang-tidy: 1 files, 0 findings"
    launch check --analyse --since nowhere
    ends_with_status 1
    one_error_line
    says "--since 'nowhere' names no commit"
    ;;
  analyse_without_tools)
    required >"$state/installed"
    sed -i -e '/^clang-tidy$/d' -e '/^g++-mingw/d' "$state/sources"
    launch check --analyse
    ends_with_status 0
    says "could not be installed, goes on without: clang clang-tidy g++-mingw-w64-x86-64-posix"
    says "goes on without clang-tidy"
    says "goes on without the syntax pass for Windows"
    one_of_everything=$(grep -c 'goes on without the syntax pass' "$place/err")
    [ "$one_of_everything" -eq 1 ] || fail "one line was expected"
    ;;
  progress_on_a_terminal)
    type -P script >/dev/null || { echo "[C3DE-SKIPPED] script (bsdutils) is not installed"; exit 0; }
    cp "$state/sources" "$state/installed"
    echo 14 >"$state/slow"
    status=0
    (cd "$place/tree" && script -qec "env -i PATH=$place/bin HOME=$place $(type -P bash) ./run info x.obj" /dev/null) \
      >"$place/err" </dev/null || status=$?
    : >"$place/out"
    ends_with_status 0
    says $'\r\033[Kc3de: building: step '
    grep -q 'step 1[0-4] of 40 ([0-9]* %), about [0-9]* s left' "$place/err" || fail "an estimate was expected"
    ;;
  interrupt)
    # Ctrl-C goes to the whole group: nothing may be left running.
    cp "$state/sources" "$state/installed"
    echo 30 >"$state/slow"
    (cd "$place/tree" && exec setsid env -i PATH="$place/bin" HOME="$place" "$(type -P bash)" -c \
      'trap - INT; exec '"$(type -P bash)"' ./run info x.obj') >"$place/out" 2>"$place/err" </dev/null &
    group=$!
    sleep 4
    kill -TERM -- "-$group"
    wait "$group"
    status=$?
    [ "$status" -ne 0 ] || fail "a status other than 0 was expected"
    sleep 1
    left=$(ps -eo pgid=,stat=,args= | awk -v group="$group" '$1 == group && $2 !~ /^Z/')
    [ -z "$left" ] || fail "this still runs: $left"
    ;;
  *) status=none; touch "$place/out" "$place/err"; fail "there is no machine '$machine'" ;;
esac
