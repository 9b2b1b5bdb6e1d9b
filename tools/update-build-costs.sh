#!/usr/bin/env bash
# update-build-costs.sh [NINJA_LOG]   writes tools/build-costs.txt, by which ./run estimates the time left, from the log of a
# build that nothing disturbed: without a compiler cache, no more processes than cores. Default: build/release/.ninja_log.
set -euo pipefail
cd "$(dirname "$0")/.."
log=${1:-build/release/.ninja_log}
{
  echo "# Seconds that a step of the build takes, and the file that it makes; at least 1 s. Written by tools/update-build-costs.sh."
  awk -F '\t' '!/^#/ && $2 - $1 >= 1000 { seconds[$4] = ($2 - $1) / 1000 } END { for (file in seconds) printf "%.0f %s\n", seconds[file], file }' "$log" |
    sort -k 2
} >tools/build-costs.txt
