#!/usr/bin/env bash
# Do plugins that are built today load in a host whose structs have grown? In a copy of the tree every struct of the plugin
# boundary that may grow gets one member more; the host is built from it (some minutes) and runs a scene with the plugins of
# this tree, as they lie. Same state hash as with today's host: an appended member breaks no older binary.
#
#   tools/abi-growth.sh [BUILD]        BUILD: where the plugins were built, default build/release
#
# Exit status: 0 the same, 1 not, 2 nothing to compare.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
build=$(cd "$root" && cd "${1:-build/release}" && pwd)
plugins=$build/lib/c3de
[ -x "$build/bin/c3de" ] && [ -d "$plugins/plugins" ] && [ -d "$plugins/examples" ] || {
  echo "abi-growth: no host and plugins in $build" >&2
  exit 2
}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
git -C "$root" archive HEAD | tar -x -C "$place"

# What stands by value in another struct does not grow (base.h).
fixed='none'
grown=0
while IFS= read -r header; do
  count=$(awk -v fixed="^($fixed)$" -v out="$header.grown" '
    /^typedef struct c3de_[a-z0-9_]+ \{/ { name = $3; sized = 0 }
    /^  uint32_t size;/ { sized = 1 }
    /^\} c3de_[a-z0-9_]+;/ && sized && name !~ fixed { print "  uint64_t grown_since;" > out; ++n; sized = 0 }
    { print > out }
    END { print n + 0 }' "$header")
  mv "$header.grown" "$header"
  grown=$((grown + count))
done < <(find "$place/framework/abi/include" -name '*.h')
echo "abi-growth: $grown structs have a member more" >&2
[ "$grown" -ge 40 ] || { echo "abi-growth: the headers are not written as this script reads them" >&2; exit 2; }
# Aggregates of the host leave the new member out, as they would until it is used.
sed -i 's/-Wextra/-Wextra -Wno-missing-field-initializers/' "$place/cmake/Warnings.cmake"

(cd "$place" && cmake --preset release -DC3DE_BUILD_WINDOW=OFF >"$place/log" 2>&1 && cmake --build build/release --target c3de >>"$place/log" 2>&1) || {
  tail -30 "$place/log" >&2
  exit 2
}
hash_of() {  # HOST SCENE
  C3DE_PLUGIN_PATH=$plugins/plugins "$1" run "$2" --until 0.3 --quiet --plugin "$plugins/examples/magnet.so" \
    --plugin "$plugins/examples/hello.so" --report "$place/report.json" >"$place/run.log" 2>&1 || { cat "$place/run.log" >&2; return 1; }
  sed -n 's/.*"state_hash": *"\([0-9a-f]*\)".*/\1/p' "$place/report.json"
}
status=0
for scene in "$root"/resources/scenes/*.toml; do
  today=$(hash_of "$build/bin/c3de" "$scene") || exit 2
  later=$(hash_of "$place/build/release/bin/c3de" "$scene") || later=refused
  [ "$today" = "$later" ] && verdict=same || { verdict=DIFFERENT; status=1; }
  printf '%-40s %-18s %-18s %s\n' "$(basename "$scene")" "$today" "$later" "$verdict"
done
exit $status
