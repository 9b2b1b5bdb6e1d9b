#!/usr/bin/env bash
# Looks at the sources with other eyes than g++ has: clang-tidy with the checks of .clang-tidy, then the syntax pass of a compiler
# for Windows. What cannot be had here is said and the rest goes on. Status 1: something was found.
#   tools/analyse.sh [--since COMMIT]   all sources, or those that have changed since the commit
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh

since=""
case ${1:-} in
  "") ;;
  --since)
    since=${2:-}
    git rev-parse --verify --quiet "$since^{commit}" >/dev/null 2>&1 || c3de_fail "--since '$since' names no commit"
    ;;
  *) c3de_fail "'$1' is not known; accepted: --since COMMIT" ;;
esac

place=build/analysis
windows_compiler=x86_64-w64-mingw32-g++-posix

# Headers of libraries that are the same on every system, as $place/include shows them to the compiler for Windows. The others
# of /usr/include are Linux's own.
portable_headers="CLI Eigen assimp catch2 ccd epoxy fcl fmt gdcm-3.0 hwy imgui meshoptimizer.h minizip nanoflann.hpp nlohmann octomap
  spdlog stb tl tiny_obj_loader.h toml++ zlib.h GLFW"
# Headers that are not portable, as patterns: a file that includes one is not looked at, which is said.
foreign_headers='epoxy/wgl[.]h|igtl.*|itk.*|openssl/.*'

# Sources of the build as paths below the root; of those that cmake takes for one system only, the ones for $1 (posix, win32).
sources_for() {
  local other=posix
  [ "$1" != posix ] || other=win32
  {
    sed -n 's|^ *"file": "'"$PWD"'/\(.*\)",\{0,1\}$|\1|p' "$commands"
    find framework -name "*_$1.*"
  } | grep -E '\.(cpp|c)$' | grep -vE "_$other\.|^build/" | sort -u
}

# Of the sources on stdin those that have changed since the commit, or include a header by a name that has.
changed_sources() {
  if [ -z "$since" ]; then
    cat
    return
  fi
  local changed names
  changed=$({ git diff --name-only --relative "$since" && git ls-files --others --exclude-standard; } | sort -u)
  names=$(echo "$changed" | sed -n 's,^.*/\([^/]*\)\.\(h\|hpp\)$,\1[.]\2,p' | paste -sd '|' -)
  while read -r file; do
    if echo "$changed" | grep -qxF "$file" || { [ -n "$names" ] && grep -qE "#include [<\"](.*/)?($names)[>\"]" "$file"; }; then
      echo "$file"
    fi
  done
}

# watch NAME: runs $place/NAME.ninja to its end, past what fails; what was said is in $place/NAME.log.
watch() {
  local steps all
  NINJA_STATUS='[%f/%t] ' c3de_watched "$1:" "$place/$1.log" c3de_build_steps ninja -k 0 -f "$place/$1.ninja" || true
  read -r steps all < <(sed -n 's|^\[\([0-9]*\)/\([0-9]*\)\].*|\1 \2|p' "$place/$1.log" | tail -n 1) || true
  [ "${steps:-0}" = "${all:-1}" ] || c3de_fail "$1 ended after ${steps:-0} of ${all:-all} files; its output is in $place/$1.log"
}

# Lines "FILE:LINE:COLUMN: error: …" of a log, each once, with paths below the root. Status 1: none.
findings_in() { sed -e "s|^$PWD/||" "$1" | grep -E '^[^ ]+:[0-9]+:[0-9]+: (warning|error|fatal error): ' | sort -u; }

tidy() {
  local files
  files=$(sources_for posix | changed_sources)
  if [ -z "$files" ]; then
    c3de_say "clang-tidy: no source has changed"
    return 0
  fi
  {
    echo "builddir = $place"
    echo "rule tidy"
    echo "  command = clang-tidy --quiet -p build/clang \$in 2>&1"
    for file in $files; do echo "build tidy/$file: tidy $file"; done
  } >"$place/clang-tidy.ninja"
  watch clang-tidy
  findings_in "$place/clang-tidy.log" >"$place/clang-tidy.txt" || true
  cat "$place/clang-tidy.txt"
  c3de_say "clang-tidy: $(echo "$files" | wc -l) files, $(wc -l <"$place/clang-tidy.txt") findings (with context: $place/clang-tidy.log)"
  [ ! -s "$place/clang-tidy.txt" ] && ! grep -q '^FAILED' "$place/clang-tidy.log"
}

# How g++ is told to compile FILE, without what is of Linux.
flags_of() {
  awk -v file="\"$PWD/$1\"" '
    /"command":/ { command = $0 }
    /"file":/ && index($0, file) { print command; exit }' "$commands" |
    sed -e 's|^ *"command": "||' -e 's|",$||' -e 's|\\\\|\\|g' -e 's|\\"|"|g' | tr ' ' '\n' |
    awk '/^-I\/usr/ { next } /^-[ID]/ || /^-std=/ { printf "%s ", $0 }'
}

windows() {
  local files file like flags
  files=$(sources_for win32 | changed_sources)
  if [ -z "$files" ]; then
    c3de_say "for Windows: no source has changed"
    return 0
  fi
  rm -rf "$place/include"
  mkdir -p "$place/include"
  for name in $portable_headers; do
    for from in /usr/include/eigen3 /usr/include; do
      [ -e "$place/include/$name" ] || [ ! -e "$from/$name" ] || ln -s "$from/$name" "$place/include/$name"
    done
  done
  for zconf in /usr/include/*/zconf.h; do [ ! -e "$zconf" ] || ln -sf "$zconf" "$place/include/zconf.h"; done
  flags="-DNOMINMAX -DWIN32_LEAN_AND_MEAN -D_CRT_SECURE_NO_WARNINGS -Wall -Wextra -Werror"
  for name in "" /imgui /stb /gdcm-3.0; do flags="$flags -isystem $place/include$name"; done
  {
    echo "builddir = $place"
    echo "rule windows"
    echo "  command = $windows_compiler -fsyntax-only \$flags $flags \$in"
    for file in $files; do
      # What is for Windows only is in no list of commands here: it is compiled as its twin is.
      like=$(echo "$file" | sed -e 's|platform_win32|platform_posix|' -e 's|_set_win32|_set_posix|' -e 's|offscreen_win32|offscreen_egl|')
      echo "build windows/$file: windows $file"
      case $file in
        *.c) echo "  flags = -x c $(flags_of "$like" | sed 's|\$|$$|g')" ;;
        *) echo "  flags = $(flags_of "$like" | sed 's|\$|$$|g')" ;;
      esac
    done
  } >"$place/windows.ninja"
  watch windows
  # Per file that failed: the first header that is missing, or nothing.
  awk -v foreign="$foreign_headers" '
    function done() {
      if (name == "") return
      if (missing != "") print name ": not looked at, " missing " cannot be had for Windows here" > "/dev/stderr"
      else print name
    }
    /^FAILED: windows\// { done(); name = substr($2, 9); missing = "" }
    /fatal error: .*: No such file or directory/ {
      header = $0
      sub(/.*fatal error: /, "", header)
      sub(/: No such file.*/, "", header)
      if (header ~ "^(" foreign ")$") missing = header
    }
    END { done() }' "$place/windows.log" >"$place/windows.failed" 2>"$place/windows.skipped"
  findings_in "$place/windows.log" | grep -vE "fatal error: ($foreign_headers): No such file" >"$place/windows.txt" || true
  cat "$place/windows.txt"
  sed 's|^|c3de: |' "$place/windows.skipped" >&2
  c3de_say "for Windows: $(echo "$files" | wc -l) files, $(wc -l <"$place/windows.skipped") not looked at," \
    "$(wc -l <"$place/windows.failed") with errors (whole: $place/windows.log)"
  [ ! -s "$place/windows.failed" ]
}

c3de_install_packages "$(c3de_names tools/debian-packages.txt tools/debian-packages-check.txt)" \
  "$(c3de_names tools/debian-packages-analyse.txt)"
mkdir -p "$place"
status=0
commands=build/release/compile_commands.json
if command -v clang++ >/dev/null 2>&1; then
  commands=build/clang/compile_commands.json
  c3de_watched "configuring for clang" build/configure-clang.log c3de_seconds cmake --preset clang ||
    c3de_fail "cmake could not configure build/clang; its output is in build/configure-clang.log"
else
  c3de_configure tests
fi
if command -v clang-tidy >/dev/null 2>&1 && [ "$commands" = build/clang/compile_commands.json ]; then
  tidy || status=1
else
  c3de_say "goes on without clang-tidy: it, or clang, is not installed"
fi
if command -v "$windows_compiler" >/dev/null 2>&1; then
  windows || status=1
else
  c3de_say "goes on without the syntax pass for Windows: $windows_compiler is not installed"
fi
exit "$status"
