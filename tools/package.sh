#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds what ./run builds and writes packages into build/packages: tools/package.sh [deb] [tgz], without arguments both.
# What is missing is installed, as ./run does it; packages need those of debian-packages-package.txt as well.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/prepare.sh

[ $# -gt 0 ] || set -- deb tgz
for kind in "$@"; do
  case $kind in
    deb | tgz) ;;
    *)
      echo "c3de: error: '$kind' is no kind of package; accepted: deb, tgz" >&2
      exit 2
      ;;
  esac
done
c3de_install_packages "$(c3de_names tools/debian-packages.txt tools/debian-packages-package.txt)" "$(c3de_names tools/debian-packages-optional.txt)"
c3de_configure
c3de_build products
mkdir -p build/packages
for kind in "$@"; do
  c3de_watched "writing packages ($kind)" "build/packages/$kind.log" c3de_seconds cpack --preset "$kind" || {
    tail -n 20 "build/packages/$kind.log" >&2
    c3de_fail "cpack --preset $kind failed; the whole output is in build/packages/$kind.log"
  }
  sed -n 's/^CPack: - package: \(.*\) generated\.$/\1/p' "build/packages/$kind.log"
done
