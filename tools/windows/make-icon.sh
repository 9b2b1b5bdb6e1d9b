#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Writes cmake/packages/windows/c3de.ico from cmake/packages/c3de.svg. Needs rsvg-convert (librsvg2-bin) and python3.
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for size in 16 24 32 48 64 256; do
  rsvg-convert -w "$size" -h "$size" cmake/packages/c3de.svg -o "$folder/$size.png"
done
# An icon is a table of pictures; each is a PNG file here.
python3 - "$folder" cmake/packages/windows/c3de.ico <<'P'
import pathlib, struct, sys
sizes = [16, 24, 32, 48, 64, 256]
pictures = [pathlib.Path(sys.argv[1], f"{size}.png").read_bytes() for size in sizes]
offset, table = 6 + 16 * len(sizes), struct.pack("<HHH", 0, 1, len(sizes))
for size, picture in zip(sizes, pictures):
    table += struct.pack("<BBBBHHII", size % 256, size % 256, 0, 0, 1, 32, len(picture), offset)
    offset += len(picture)
pathlib.Path(sys.argv[2]).write_bytes(table + b"".join(pictures))
P
