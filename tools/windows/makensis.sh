#!/usr/bin/env bash
# makensis for installers of 64 bits.
exec makensis "-XTarget amd64-unicode" "$@"
