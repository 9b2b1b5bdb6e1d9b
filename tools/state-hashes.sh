#!/usr/bin/env bash
# The state of every shipped scene after 200 steps, as a table: two builds that should compute the same print the same.
#   tools/state-hashes.sh [BUILD]     default: build/release
set -euo pipefail
cd "$(dirname "$0")/.."
program=${1:-build/release}/bin/c3de
report=$(mktemp)
trap 'rm -f "$report"' EXIT
printf '%-40s %-10s %s\n' scene steps state_hash
for scene in resources/scenes/*.toml resources/meshes/*.obj; do
  if "$program" run "$scene" --steps 200 --report "$report" --quiet; then
    hash=$(sed -n 's/.*"state_hash": *"\([0-9a-f]*\)".*/\1/p' "$report" | head -1)
    steps=$(sed -n 's/.*"steps": *\([0-9]*\).*/\1/p' "$report" | head -1)
    printf '%-40s %-10s %s\n' "$scene" "$steps" "$hash"
  else
    printf '%-40s failed\n' "$scene"
  fi
done
# Figures of the validation to the last digit that they are printed with, without their times.
for table in "${1:-build/release}"/test-output/validation/*.txt; do
  [ -f "$table" ] || continue
  awk '{ n = split($0, word); line = ""; for (i = 1; i <= n; ++i) line = line word[i] " "; print line }' "$table" |
    sed -E 's/[ 0-9]+ (ok|MISSED|for the record)/ \1/' | sort | cksum | awk -v name="$(basename "$table")" '{ printf "%-40s %-10s %s\n", name, "", $1 }'
done
