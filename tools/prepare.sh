# Sourced by ./run and ./check in the root of the tree: installs missing packages, configures and builds build/release.
# Prints to stderr only, so that the program's own output stays clean.
# Lists of packages are words of one string, so they are split on purpose:
# shellcheck shell=bash disable=SC2086,SC2119

c3de_say() { echo "c3de: $*" >&2; }
c3de_fail() {
  echo "c3de: error: $*" >&2
  exit 1
}

# Names in package lists: c3de_names FILE...
c3de_names() { sed -e 's/#.*//' -e '/^[[:space:]]*$/d' "$@" | tr '\n' ' '; }

# c3de_watched LABEL LOG READING COMMAND...   runs COMMAND with its output in LOG. Meanwhile READING LOG SECONDS prints how
# far it is: one line that changes on a terminal, a line now and then elsewhere.
c3de_watched() {
  local label=$1 log=$2 reading=$3 status=0 watcher
  shift 3
  (
    trap 'kill "${pause:-}" 2>/dev/null; exit 0' TERM
    began=$SECONDS
    pause_s=3 # soon the first time, and not at all where it is over by then
    while :; do
      if [ -t 2 ]; then printf '\r\033[Kc3de: %s %s' "$label" "$("$reading" "$log" $((SECONDS - began)))" >&2; fi
      sleep "$([ -t 2 ] && echo 1 || echo "$pause_s")" &
      pause=$!
      wait "$pause"
      pause_s=20
      [ -t 2 ] || c3de_say "$label $("$reading" "$log" $((SECONDS - began)))"
    done
  ) &
  watcher=$!
  "$@" >"$log" 2>&1 || status=$?
  kill "$watcher" 2>/dev/null || true
  wait "$watcher" 2>/dev/null || true
  [ ! -t 2 ] || printf '\r\033[K' >&2
  return "$status"
}

c3de_seconds() { echo "($2 s)"; }

# How far ninja's LOG is after SECONDS, and how long the rest takes. Steps are weighed by tools/build-costs.txt, because a few
# sources take a hundred times as long as most; build/build.plan lists what was to be done. Before ninja counts what is to be
# built it has cmake write its files anew where that is due, and counts that by itself.
c3de_build_steps() {
  local steps=0 all=0 what="" left="" percent=0 left_s=0
  read -r steps all what < <(tail -c 4000 "$1" 2>/dev/null | sed -n 's|^\[\([0-9]*\)/\([0-9]*\)\]|\1 \2 |p' | tail -n 1) || true
  case $what in
    Re-running\ CMake* | Re-checking\ *)
      echo "cmake configures anew ($2 s)"
      return
      ;;
  esac
  if [ "${all:-0}" -eq 0 ]; then
    echo "($2 s)"
    return
  fi
  read -r percent left_s < <(c3de_cost_done "$1" "$2" "$steps" "$all")
  # The first steps say little.
  if [ "$percent" -ge 3 ] && [ "$2" -ge 10 ]; then
    if [ "$left_s" -ge 90 ]; then left=", about $(((left_s + 30) / 60)) min left"; else left=", about $left_s s left"; fi
  fi
  echo "step $steps of $all ($percent %)$left"
}

# c3de_cost_done LOG SECONDS STEPS ALL   "PERCENT SECONDS_LEFT" by the costs of the steps in LOG and build/build.plan. Without
# a plan of about ALL steps each step counts the same.
c3de_cost_done() {
  awk -v seconds="$2" -v steps="$3" -v all="$4" '
    # A step is known by the file that it makes; one that is not in the table costs as much as a small source.
    function cost(line) { sub(/^\[[^]]*\] */, "", line); sub(/.* /, "", line); return line in costs ? costs[line] : line ~ /\.o$/ ? 5 : 0.5 }
    FILENAME ~ /build-costs.txt$/ { if ($0 !~ /^#/) costs[$2] = $1; next }
    !/^\[/ { next }
    FILENAME ~ /build.plan$/ { ++planned; total += cost($0); next }
    { done += cost($0) }
    END {
      if (planned < 0.9 * all || planned > 1.1 * all || total <= 0) { done = steps; total = all }
      if (done > total) done = total
      printf "%d %d\n", 100 * done / total, (done ? seconds * (total - done) / done : 0)
    }' tools/build-costs.txt build/build.plan "$1"
}

# Which of the packages are not installed.
c3de_missing() {
  # dpkg-query ends with 1 when it does not know one of the names; it still tells of the others.
  { dpkg-query -W -f='${Package} ${db:Status-Status}\n' "$@" 2>/dev/null || true; } |
    awk -v wanted="$*" '$2 == "installed" { have[$1] = 1 }
      END { n = split(wanted, name, " "); for (i = 1; i <= n; ++i) if (!(name[i] in have)) printf "%s ", name[i] }'
}

# How apt-get is run: directly, through sudo, or not at all (status 1).
c3de_apt_get() {
  local install="apt-get install --no-install-recommends"
  if [ "$(id -u)" -eq 0 ]; then
    C3DE_SUDO=""
    C3DE_TYPE="apt-get update && $install"
  elif command -v sudo >/dev/null 2>&1; then
    C3DE_SUDO="sudo -n"
    C3DE_TYPE="sudo apt-get update && sudo $install"
    # The password is asked for here, where nothing is drawn over the question.
    sudo -n true 2>/dev/null || { [ -t 0 ] && sudo -v; } || return 1
  else
    C3DE_TYPE="su -c 'apt-get update && $install"
    return 1
  fi
}

# One line: what to type for these packages.
c3de_what_to_type() {
  case $C3DE_TYPE in
    su*) echo "$C3DE_TYPE $*'" ;;
    *) echo "$C3DE_TYPE $*" ;;
  esac
}

# Installs into $C3DE_APT_LOG; status 1 if it did not.
c3de_install() {
  c3de_watched "installing $# packages" "$C3DE_APT_LOG" c3de_seconds \
    $C3DE_SUDO env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
    -o DPkg::Lock::Timeout=500 "$@"
}

# Those of the packages that apt knows no candidate for.
c3de_unknown() {
  local name
  for name in "$@"; do
    apt-cache policy "$name" 2>/dev/null | grep -q 'Candidate: [^(]' || printf '%s ' "$name"
  done
}

# c3de_install_packages "NEEDED..." "WELCOME..."   NEEDED must be there in the end; what is WELCOME is said if it is not.
c3de_install_packages() {
  command -v dpkg-query >/dev/null 2>&1 || {
    c3de_say "this is not a Debian system; the libraries of docs/dev/dependencies.md must be there already"
    return 0
  }
  local needed welcome unknown update="" reason asked=build/packages-asked-for
  needed=$(c3de_missing $1)
  welcome=$(c3de_missing $2)
  # What is only welcome is asked for once, not at every start.
  [ -z "$welcome" ] || ! grep -qxF "$welcome" "$asked" 2>/dev/null || welcome=""
  [ -n "$needed$welcome" ] || return 0
  mkdir -p build
  C3DE_APT_LOG=build/packages.log
  [ -z "$welcome" ] || echo "$welcome" >>"$asked"
  if ! c3de_apt_get; then
    [ -z "$needed" ] || c3de_fail "missing packages, and no right to install them; type: $(c3de_what_to_type $needed$welcome)"
    c3de_say "goes on without: $welcome; to have them, type: $(c3de_what_to_type $welcome)"
    return 0
  fi
  c3de_say "installing" $needed $welcome
  c3de_watched "reading package lists" "$C3DE_APT_LOG" c3de_seconds $C3DE_SUDO apt-get update -q || {
    update=" (apt-get update failed too)"
    c3de_say "apt-get update failed; trying with the package lists that are there"
  }
  c3de_install $needed $welcome && return 0
  # Something cannot be had. Whatever can is installed, and the message names only the rest.
  unknown=$(c3de_unknown $needed)
  if [ -n "$unknown" ]; then
    c3de_fail "these packages are not in the package sources of this machine$update: $unknown; add a source that has them" \
      "(Debian 12 main does), then type: $(c3de_what_to_type $needed)"
  fi
  if [ -n "$needed" ] && ! c3de_install $needed; then
    reason=$(sed -n 's/^E: //p' "$C3DE_APT_LOG" | head -n 1)
    needed=$(c3de_missing $needed)
    [ -z "$needed" ] || c3de_fail "could not install$update: $needed(${reason:-see $C3DE_APT_LOG}); type: $(c3de_what_to_type $needed)"
  fi
  welcome=$(c3de_missing $welcome)
  [ -z "$welcome" ] || c3de_install $welcome || c3de_say "could not be installed, goes on without: $(c3de_missing $welcome)"
}

# c3de_configure [tests|all]   once; with tests, or all tests, also where it was configured without.
c3de_configure() {
  local cache=build/release/CMakeCache.txt options=() slow=OFF
  if [ -n "${1:-}" ]; then
    [ "$1" != all ] || slow=ON
    options=(-DC3DE_BUILD_TESTS=ON -DC3DE_BUILD_BENCHMARKS=ON "-DC3DE_BUILD_SLOW_TESTS=$slow")
    [ -f build/release/build.ninja ] && grep -q '^C3DE_BUILD_TESTS:BOOL=ON' "$cache" 2>/dev/null &&
      grep -q "^C3DE_BUILD_SLOW_TESTS:BOOL=$slow" "$cache" && return 0
  else
    [ -f build/release/build.ninja ] && grep -q '^C3DE_BUILD_BENCHMARKS:BOOL=ON' "$cache" 2>/dev/null && return 0
    # The program alone needs no test library. Benchmarks are targets that are built when they are asked for.
    options=(-DC3DE_BUILD_BENCHMARKS=ON)
    [ -f build/release/build.ninja ] || options+=(-DC3DE_BUILD_TESTS=OFF)
  fi
  mkdir -p build
  c3de_watched "configuring" build/configure.log c3de_seconds cmake --preset release "${options[@]}" || {
    grep -A 8 -m 1 'CMake Error' build/configure.log >&2 || tail -n 20 build/configure.log >&2
    c3de_fail "cmake could not configure build/release; the whole output is in build/configure.log"
  }
}

# c3de_build [TARGET...]
c3de_build() {
  local log=build/build.log targets=()
  [ $# -eq 0 ] || targets=(--target "$@")
  # What is to be done. Without the rule that has cmake write its files anew, at which a dry run ends.
  : >build/build.plan
  if [ -f build/release/build.ninja ] && command -v ninja >/dev/null; then
    awk '/: RERUN_CMAKE /{ skip = 1 } /^$/{ skip = 0 } !skip' build/release/build.ninja >build/release/plan.ninja
    NINJA_STATUS='[%f/%t] ' ninja -C build/release -n -f plan.ninja "$@" >build/build.plan 2>/dev/null || true
  fi
  NINJA_STATUS='[%f/%t] ' c3de_watched "building:" "$log" c3de_build_steps cmake --build build/release "${targets[@]}" || {
    # ninja says FAILED before the compiler's words; what other files printed meanwhile is not wanted.
    grep -A 30 -m 1 '^FAILED:' "$log" >&2 || tail -n 30 "$log" >&2
    c3de_fail "the build failed; the whole output is in $log"
  }
}
