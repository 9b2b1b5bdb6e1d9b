#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Formats the C++ files of the repository as .clang-format says; with --check, says which are not and ends with 1.
# Other versions of clang-format break lines elsewhere: with another than 14, or none, --check ends with 77 (skipped).
set -euo pipefail
cd "$(dirname "$0")/.."
formatter=$(command -v clang-format-14 || command -v clang-format || true)
if [ -z "$formatter" ] || ! "$formatter" --version | grep -q 'version 14\.'; then
  echo "format: skipped, clang-format 14 is not installed (Debian 12: apt-get install clang-format)" >&2
  exit 77
fi
list=$(mktemp)
trap 'rm -f "$list"' EXIT
find framework plugins tests benchmarks tools docs -name '*.cpp' -o -name '*.h' -o -name '*.hpp' | sort > "$list"
case "${1:-}" in
  --check)
    if ! xargs -n 40 -P "$(nproc)" "$formatter" --dry-run -Werror < "$list"; then
      echo "format: tools/format.sh formats them" >&2
      exit 1
    fi ;;
  '') xargs -n 40 -P "$(nproc)" "$formatter" -i < "$list" ;;
  *) echo "format: unknown argument '$1'; accepted: --check" >&2; exit 2 ;;
esac
