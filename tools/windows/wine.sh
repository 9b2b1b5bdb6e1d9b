#!/usr/bin/env bash
# Runs a program for Windows under wine, in a prefix of its own: wine.sh PROGRAM.exe [ARGUMENT…]
export WINEPREFIX="${C3DE_WINE_PREFIX:-$(cd "$(dirname "$0")/../.." && pwd)/build/windows/wine}"
export WINEDEBUG="${WINEDEBUG:--all}"
mkdir -p "$(dirname "$WINEPREFIX")"
exec /usr/lib/wine/wine64 "$@"
