#!/usr/bin/env bash
# Writes tools/help, from which ./run answers before anything is built, anew: the --help texts of the program in build/release.
set -euo pipefail
cd "$(dirname "$0")/.."
program=build/release/bin/c3de
"$program" --help >tools/help/c3de.txt
for command in $(sed -n '/^Subcommands:/,$p' tools/help/c3de.txt | sed -nE 's/^  ([a-z-]+) .*/\1/p'); do
  "$program" "$command" --help >"tools/help/$command.txt"
done
