#!/usr/bin/env bash
# documented_commands.sh SOURCE BUILD PLACE PAGE   runs the commands that a page of the documentation shows (of a folder: all its
# pages), one after the other, in a tree that has only what ./run builds (products.txt of BUILD). A command is a line of an indented or fenced block, or the
# example of a row of exit codes. One that is neither run nor excused in `instead` fails, and so does one that is excused
# and names a program, target, preset, file or option that does not exist. Commands within a text are looked at likewise.
# documented_commands.sh SOURCE BUILD PLACE install   installs that tree and looks at what is there.
set -uo pipefail
source=$1 build=$2 place=$3 wanted_page=$4
tree=$place/tree
failures=0
fail() {
  failures=$((failures + 1))
  echo "FAILED: $*"
}

make_tree() {
  rm -rf "$place"
  mkdir -p "$tree/build/release" "$tree/out" "$place/home"
  local name file
  for name in "$source"/*; do
    case ${name##*/} in build | out) ;; *) ln -s "$name" "$tree/${name##*/}" ;; esac
  done
  while read -r file; do
    mkdir -p "$(dirname "$tree/build/release/${file#"$build"/}")"
    # Links of the other kind would lead the program back to the folder where it was built.
    ln "$file" "$tree/build/release/${file#"$build"/}" 2>/dev/null || cp "$file" "$tree/build/release/${file#"$build"/}" || exit 1
  done <"$build/products.txt"
  # What configuring leaves for installing, without what tests have left.
  (cd "$build" && find . -path ./test-output -prune -o -type f '(' -name cmake_install.cmake -o -path './CMakeFiles/Export/*.cmake' \
      -o -path './C3DE*.cmake' -o -path './*.pc' ')' -print) |
    while read -r file; do
      mkdir -p "$(dirname "$tree/build/release/$file")"
      sed "s|$build|$tree/build/release|g" "$build/$file" >"$tree/build/release/$file"
    done
  # Files that pages speak of.
  local scenes=$tree/resources/scenes
  (
    cd "$tree" || exit 1
    sed -n '/^```toml/,/^```/p' README.md | sed '/^```/d' >out/liver.toml
    sed "s|\.\./meshes|resources/meshes|" "$scenes/stiffening_organ.toml" >scene.toml
    sed -n '/^    trimesh/,/^    end/s/^    //p' plugins/mesh_reader/FORMAT.md >box.tri
    printf 'body,x [m],y [m],z [m]\norgan,0.12,0.16,0\n' >points.csv
    printf '{"markups":[{"coordinateSystem":"RAS","controlPoints":[{"label":"apex","position":[-120,-160,0]}]}]}' >before.mrk.json
    printf '# CoordinateSystem = LPS\n1,121,160,0,0,0,0,1,1,1,0,apex,,\n' >after.fcsv
    for name in scan labels organs vessels heart_4d; do nifti 4 1 >"$name.nii"; gzip -n "$name.nii"; done
    nifti 4 4 | gzip -n >heart_4d.nii.gz
    cp box.tri organ.toml
    mkdir frames
    for name in 1 2; do cp resources/match/organ_points.csv frames/$name.csv; done
    mkdir folder_of_a_dicom_series dicom_folder
    touch abdomen.toml
  )
}

# nifti SIZE TIMES   a NIfTI-1 image of SIZE³ bytes, of 2 mm.
nifti() {
  local size=$1 times=$2 i
  le16() { printf "\\x$(printf %02x $(($1 % 256)))\\x$(printf %02x $(($1 / 256)))"; }
  zeros() { head -c "$1" /dev/zero; }
  le16 348; zeros 38                                   # sizeof_hdr … dim_info
  le16 $((times > 1 ? 4 : 3)); for i in "$size" "$size" "$size" "$times" 1 1 1; do le16 "$i"; done
  zeros 14; le16 2; le16 8; zeros 2                    # intent, datatype uint8, bitpix, slice_start
  printf '\0\0\200?'; for i in 1 2 3; do printf '\0\0\0@'; done; for i in 1 2 3 4; do printf '\0\0\200?'; done
  printf '\0\0\260C'                                   # vox_offset 352
  printf '\0\0\200?'; zeros 7; printf '\n'             # scl_slope 1, scl_inter 0, slice_end, slice_code, units: mm, s
  zeros 220; printf 'n+1\0'; zeros 4
  for ((i = 0; i < size * size * size * times; ++i)); do printf '\x64'; done
}

# Lines "LINE TEXT" of what a page shows as commands, without comments.
commands_of() {
  awk '
    # Code of other languages is no command, and neither are drawings and formulas.
    /^```/ { fenced = !fenced; other = fenced && $0 !~ /^``` *(sh|bash|console)? *$/; next }
    other || /►|^ *\/\/| = / { blank = inside = 0; next }
    { shown = fenced || ($0 ~ /^    / && (blank || inside)) }
    shown { text = $0; sub(/^ +/, "", text); sub(/  +#.*$/, "", text); print NR " " text }
    { inside = !fenced && shown; blank = $0 ~ /^ *$/; if (blank && inside) inside = 1 }' "$1" |
    while read -r line text; do
      first=${text%% *}
      case $first in
        [A-Z]*=*) [[ $text =~ ^[A-Z0-9_]+=[^\ ]+\ [a-z./] ]] && echo "$line $text" ;;
        */*) [[ $first =~ ^[A-Za-z0-9_./~-]+$ ]] && echo "$line $text" ;;
        c3de | c3de-* | bench_* | test_* | fuzz_* | cmake | ctest | ninja | mkdir | cp | cd | env | git | bash | python3) echo "$line $text" ;;
        xvfb-run | mpirun | rsvg-convert | cc | c++ | g++ | gcc | gdb | apt-get | sudo | pkg-config | for | while | export)
          echo "$line $text" ;;
      esac
    done
}

# Sets reason where a command is looked at instead of run.
instead() {
  reason=""
  case $1 in
    ./check*) reason="runs all tests" ;;
    *'cmake --preset '*) reason="builds the whole tree anew" ;;
    *test_ui*) reason="built by ./check; takes minutes" ;;
    *bin/fuzz_* | *benchmarks/counts.cmake*) reason="built by ./check --all, where a test does the same" ;;
    *bench_*) reason="built when it is asked for; takes minutes" ;;
    'cmake --build build/release --target '*) reason="needs a build tree" ;;
    'cmake -S PREFIX/share/c3de/examples'* | 'cmake -S heart_beat'* | 'cmake --build my_plugins' | 'cmake --build batch && batch/batch')
      reason="the tests 'sdk: …' do the same" ;;
    'PREFIX/bin/c3de --plugin heart_beat/'* | *' my_plugins/'*) reason="needs the build that is looked at above" ;;
    *' study '*) reason="takes minutes; test_cli runs cuts of the shipped studies" ;;
    *' --stream '*) reason="needs a tracking system; test_match has one" ;;
    *brain_shift.toml*) reason="takes minutes" ;;
    *'python3 docs/gallery/'*) reason="needs matplotlib; test_embed runs the scripts" ;;
    *abdomen.toml* | *dicom_folder*) reason="a scan of the reader" ;;
  esac
}

# A hundredth of a second is enough to see that a run works.
shortened() {
  local text
  text=$(sed -E -e 's/--until [0-9.]+/--until 0.01/g' -e 's/--steps 100/--steps 2/; s/--steps 300/--steps 4/; s/--probes-every 10/--probes-every 1/' \
    -e 's/--size 1280x800/--size 160x100/' <<<"$1")
  [[ ! $text =~ c3de\ run\  || $text == *--until* || $text == *--steps* ]] || text="$text --until 0.01"
  echo "$text"
}
# Placeholders.
filled() {
  sed -E -e 's|PREFIX|out/prefix|g' -e 's/(^| )SCENE(\.toml)?( |$)/\1resources\/scenes\/first_light.toml\3/g' -e 's|path/to/minimal.so|build/release/lib/c3de/examples/hello.so|' \
    -e '/^\.\/run bench_/!s|^\./run |build/release/bin/c3de |' -e 's|STUDY.toml|resources/studies/cantilever.toml|; s|FOLDER|out/study|' <<<"$1"
}

is_target() { grep -qE "^build ($1|[^ :]*/$1)( [^:]*)?:" "$build/build.ninja"; }

# look_at WHERE TEXT [part]   what a command names must be there.
look_at() {
  local where=$1 text=$2 word plugin previous="" program=""
  while IFS= read -r word; do
    case $word in
      '&&' | '|') program="" previous=""; continue ;;
      build/*/bin/*)
        program=${word##*/}
        grep -q "/bin/$program$" "$build/products.txt" || is_target "$program" || fail "$where: $word: no such program" ;;
      bench_NAME) ;;
      # Some are built only where what they compare with is installed.
      bench_*) [ "${program:-run}" != run ] || [ -f "$tree/benchmarks/$word.cpp" ] || fail "$where: there is no benchmark $word" ;;
      test_* | fuzz_*) [ -n "$program" ] || is_target "$word" || fail "$where: there is no target $word" ;;
      resources/* | docs/* | benchmarks/* | plugins/* | tests/* | tools/* | framework/* | examples/* | build/release/lib/*)
        [ "$previous" = -o ] || [ -e "$tree/$word" ] || fail "$where: $word: no such file" ;;
      *) ;;
    esac
    case $word in
      resources/studies/*.toml)
        while read -r plugin; do
          [ -e "$tree/build/release/lib/c3de/study/$plugin.so" ] || fail "$where: $word needs $plugin.so, which ./run does not build"
        done < <(sed -nE 's/^plugins = \["([a-z_]+)"\].*/\1/p' "$tree/$word") ;;
      ./run | ./check) [ -x "$tree/$word" ] || fail "$where: $word: no such file" ;;
      '['*']') grep -rqF "$word" "$tree/tests/ui" || grep -rqF "[.${word#[}" "$tree/tests/ui" || fail "$where: no test has the tag $word" ;;
    esac
    case $previous in
      --preset) grep -q "\"name\": \"$word\"" "$tree/CMakePresets.json" || fail "$where: there is no preset $word" ;;
      --target) is_target "$word" || fail "$where: there is no target $word" ;;
    esac
    previous=$word
    [ -n "$program" ] || program=${word##*/}
  done < <(xargs -n 1 printf '%s\n' <<<"$text")
  # Options and files of the program.
  if [[ $text != *'./run bench_'* && $text =~ (^|\ |/)(c3de|\./run)\ ([^|\&]*) ]]; then
    # What is within a text need not be whole.
    (
      cd "$tree" && DISPLAY=:0 bash -c 'root=$1 && . "$root/tools/arguments.sh" && eval "c3de_check_arguments $2"' - \
        "$source" "${BASH_REMATCH[3]}"
    ) >"$place/said" 2>&1 ||
      { [ -n "${3:-}" ] && grep -qE 'is required|1 required' "$place/said"; } || fail "$where: $text: $(cat "$place/said")"
  fi
}

# run_it WHERE TEXT STATUS
run_it() {
  local where=$1 text wanted=$3 status=0
  text=$(filled "$2")
  if [ "$wanted" -eq 0 ]; then
    text=$(shortened "$text")
    # A window is not opened: that there is no display is said when arguments and files have been found right.
    if [[ $text =~ bin/c3de($|\ ) && ! $text =~ bin/c3de\ (run|replay|match|fit|info|plugins|new-plugin|study|--version)($|\ ) ]]; then wanted=6; fi
  fi
  (
    cd "$tree" && env -u DISPLAY -u WAYLAND_DISPLAY C3DE_HOME="$place/home" PATH="$tree/build/release/bin:$PATH" \
      timeout 300 bash -c "$text"
  ) >"$place/said" 2>&1 </dev/null || status=$?
  [ "$status" -eq "$wanted" ] || fail "$where: $text ends with $status, not $wanted: $(tail -n 3 "$place/said")"
  [ "$3" -ne 0 ] || look_at "$where" "$text"
}

install_all() {
  local prefix=$place/prefix name library
  for name in runtime sdk pointbased embed; do
    cmake --install "$tree/build/release" --component $name --prefix "$prefix" >"$place/said" 2>&1 || fail "component $name: $(tail -n 5 "$place/said")"
  done
  for name in LICENSE NOTICE README.md CHANGELOG.md docs/user/index.md docs/plugin/index.md docs/theory/index.md; do
    [ -s "$prefix/share/doc/c3de/$name" ] || fail "$name is not installed"
  done
  if [ -d /usr/share/doc/libeigen3-dev ]; then
    for library in $(sed -nE 's/^  ([a-z0-9-]+) {2,}.*/\1/p' "$source/NOTICE"); do
      [ "$library" = openmpi ] && ! grep -q study-mpi "$build/products.txt" && continue
      [ -s "$prefix/share/doc/c3de/licences/$library.txt" ] || fail "the licence text of $library is not installed"
    done
  fi
  env -u DISPLAY C3DE_HOME="$place/home" "$prefix/bin/c3de" run "$prefix/share/c3de/scenes/first_light.toml" --steps 1 -q || fail "the installed program does not run"
  # It finds plugins and resources from its own folder.
  if command -v python3 >/dev/null; then
    PYTHONPATH=$("$prefix/bin/c3de" python-path) C3DE_HOME="$place/home" python3 -c "
import c3de
with c3de.open('$prefix/share/c3de/scenes/first_light.toml') as sim: sim.step()" || fail "the installed Python package does not simulate"
  fi
  rm "$tree/build/release/lib/c3de/study/baselines.so"
  if cmake --install "$tree/build/release" --component runtime --prefix "$place/incomplete" >"$place/said" 2>&1; then fail "an incomplete tree was installed"; fi
  grep -q "component runtime: baselines.so is not built; type: cmake --build .* --target products$" "$place/said" || fail "what to type was expected: $(cat "$place/said")"
}

make_tree
if [ "$wanted_page" = install ]; then
  install_all
  exit $((failures > 0))
fi
count=0
# What shipped scenes say they need.
if [ "$wanted_page" = docs/user ]; then
  while read -r file; do
    [ -e "$tree/$file" ] || fail "a scene needs $file, which ./run does not build"
  done < <(sed -nE 's/^# +--plugin //p' "$tree"/resources/scenes/*.toml)
fi
pages=("$wanted_page")
[ ! -d "$tree/$wanted_page" ] || mapfile -t pages < <(cd "$tree" && find -L "$wanted_page" -name '*.md' | sort)
for page in "${pages[@]}"; do
  while read -r line text; do
    count=$((count + 1))
    instead "$text"
    if [ -n "$reason" ]; then
      echo "$page:$line: $text  [looked at: $reason]"
      look_at "$page:$line" "$(filled "$text")"
    else
      echo "$page:$line: $text"
      run_it "$page:$line" "$text" 0
    fi
  done < <(commands_of "$tree/$page")
  # Rows of exit codes: the code, and a command that ends with it.
  while read -r status text; do
    count=$((count + 1))
    echo "$page: $text  ends with $status"
    run_it "$page" "$text" "$status"
  done < <(sed -nE 's/^\| ([0-9]+) \|.*\| `([^`]+)` \|$/\1 \2/p' "$tree/$page")
  # Commands within a text: a program of this project with something after it, no placeholder left out.
  while read -r text; do
    case ${text#./} in *…* | *[A-Z][A-Z]* | *'<'*) continue ;; esac
    count=$((count + 1))
    look_at "$page" "$text" part
  done < <(grep -vE '^\| [0-9]+ \|' "$tree/$page" | grep -oE '`(\./run|\./check|build/release/bin/[a-z0-9_-]+|c3de|bench_[a-z_]+)( [^`]+)?`' | tr -d '\140' | sort -u)
done
echo "$count commands"
[ "$failures" -eq 0 ]
