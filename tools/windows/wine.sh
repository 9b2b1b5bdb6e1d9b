#!/usr/bin/env bash
# Runs a program for Windows under wine, in a prefix of its own: wine.sh PROGRAM.exe [ARGUMENT…]
export WINEPREFIX="${C3DE_WINE_PREFIX:-$(cd "$(dirname "$0")/../.." && pwd)/build/windows/wine}"
export WINEDEBUG="${WINEDEBUG:--all}"
# Arguments and names of files are UTF-8.
export LC_ALL=C.UTF-8
# A program that crashes ends, as without a debugger; nothing asks to download parts of wine.
export WINEDLLOVERRIDES="${WINEDLLOVERRIDES:-winedbg.exe=d;mscoree=d;mshtml=d}"
# The only path that the tests pass by the environment.
case "${C3DE_HOME:-}" in /*) export C3DE_HOME="Z:$C3DE_HOME" ;; esac
mkdir -p "$(dirname "$WINEPREFIX")"
case "${2:-} ${3:-}" in
  # Catch2's lists of cases are read line by line.
  --list-* | *" --list-"*)
    set -o pipefail
    /usr/lib/wine/wine64 "$@" | tr -d '\r'
    exit
    ;;
esac
exec /usr/lib/wine/wine64 "$@"
