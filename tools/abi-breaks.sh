#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Breaks the plugin boundary on a copy in the ways that have broken others, and lets tools/abi-golden.sh find each; a member
# at the end is none. 1: one was not found.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
status=0
try() {  # WHAT EXPECTED-VERDICT HEADER SED-SCRIPT
  rm -rf "$place/abi" "$place/own"
  cp -r "$root/framework/abi/include" "$place/abi"
  cp -r "$root/plugins/pointbased/abi/include" "$place/own"
  sed -i "$4" "$place/abi/c3de/abi/$3"
  if cmp -s "$place/abi/c3de/abi/$3" "$root/framework/abi/include/c3de/abi/$3"; then
    echo "abi-breaks: $1: nothing was changed in $3; the script has to follow the header" >&2
    exit 2
  fi
  verdict=same
  "$root/tools/abi-golden.sh" --headers "$place/abi" --headers "$place/own" >"$place/said" 2>&1 || verdict=other
  grep -q 'published members have changed' "$place/said" && verdict=broken
  grep -q 'structs have grown' "$place/said" && verdict=grown
  if [ "$verdict" = "$2" ]; then echo "$1: $verdict"; else
    status=1
    echo "abi-breaks: $1: $verdict, expected: $2" >&2
    head -20 "$place/said" >&2
  fi
}
try_embed() {  # WHAT EXPECTED-VERDICT SED-SCRIPT
  rm -rf "$place/embed"
  cp -r "$root/framework/embed/include" "$place/embed"
  sed -i "$3" "$place/embed/c3de/embed.h"
  if cmp -s "$place/embed/c3de/embed.h" "$root/framework/embed/include/c3de/embed.h"; then
    echo "abi-breaks: $1: nothing was changed in embed.h; the script has to follow the header" >&2
    exit 2
  fi
  verdict=same
  "$root/tools/abi-golden.sh" --embed --headers "$place/embed" >"$place/said" 2>&1 || verdict=other
  grep -q 'published members have changed' "$place/said" && verdict=broken
  grep -q 'structs have grown' "$place/said" && verdict=grown
  if [ "$verdict" = "$2" ]; then echo "embed.h: $1: $verdict"; else
    status=1
    echo "abi-breaks: embed.h: $1: $verdict, expected: $2" >&2
    head -20 "$place/said" >&2
  fi
}
try_embed 'a member inserted' broken 's/^  double radius_m;/  double inner_m;\n&/'
try_embed 'a type changed' broken 's/^  uint32_t stopped;/  int32_t stopped;/'
try_embed 'a function with another argument' broken 's/c3de_embed_release(c3de_sim sim, uint64_t hold)/c3de_embed_release(c3de_sim sim, uint64_t hold, uint32_t how)/'
try_embed 'a function removed' broken '/c3de_embed_cancel(c3de_sim sim);/d'
try_embed 'a handle of another type' broken 's/^typedef uint64_t c3de_sim;/typedef uint32_t c3de_sim;/'
try_embed 'a constant with another value' broken 's/^#define C3DE_EMBED_ON_SURFACE 2u/#define C3DE_EMBED_ON_SURFACE 3u/'
try_embed 'a member at the end' grown 's/^  double wall_s;/&\n  double more_s;/'
try_embed 'a function more' grown 's/^C3DE_EMBED_API c3de_status c3de_embed_release/C3DE_EMBED_API c3de_status c3de_embed_more(c3de_sim sim);\n&/'
try 'a member inserted' broken entry.h 's/^  uint32_t min_rev;/  uint32_t new_one;\n&/'
try 'a type changed' broken entry.h 's/^  uint32_t abi_minor; \/\* what the plugin/  int32_t abi_minor; \/* what the plugin/'
try 'two members of one size swapped' broken entry.h 's/^  c3de_str version, display_name, vendor, license;/  c3de_str display_name, version, vendor, license;/'
try 'a function with another argument' broken object.h 's/uint32_t(C3DE_CALL \*retain)(c3de_object \*self)/uint32_t(C3DE_CALL *retain)(c3de_object *self, uint32_t by)/'
try 'a slot removed' broken entry.h '/c3de_status(C3DE_CALL \*take_error)/d'
try 'a constant with another value' broken base.h 's/^#define C3DE_F64 2u/#define C3DE_F64 7u/'
try 'a member at the end' grown entry.h 's/^  uint64_t flags; \/\* C3DE_OFFER_\* \*\//&\n  uint64_t new_one;/'
exit $status
