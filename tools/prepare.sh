# Sourced by ./run and ./check: installs the missing packages and configures build/release once.
# Prints to stderr only, so that the program's own output stays clean.

c3de_fail() {
  echo "c3de: error: $*" >&2
  exit 1
}

c3de_install_packages() {
  command -v dpkg-query >/dev/null 2>&1 || {
    echo "c3de: this is not a Debian system; the libraries of docs/dev/dependencies.md must be there already" >&2
    return 0
  }
  local wanted missing sudo=""
  wanted=$(cat tools/debian-packages.txt "$@" | grep -v '^#')
  # shellcheck disable=SC2086
  missing=$(dpkg-query -W -f='${Package} ${db:Status-Status}\n' $wanted 2>/dev/null | awk '$2 == "installed" { print $1 }' |
            sort | comm -13 - <(echo "$wanted" | sort))
  [ -z "$missing" ] && return 0
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null 2>&1 ||
      c3de_fail "missing packages: $(echo $missing); install them as root, or install sudo"
    sudo=sudo
  fi
  echo "c3de: installing" $missing >&2
  $sudo apt-get update -qq >&2 || echo "c3de: apt-get update failed; trying with the lists that are there" >&2
  # shellcheck disable=SC2086
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    -o DPkg::Lock::Timeout=500 $missing >&2 || c3de_fail "could not install" $missing
}

# What the default scene shows; without it another one opens and says so.
c3de_install_optional() {
  command -v dpkg-query >/dev/null 2>&1 || return 0
  dpkg-query -W -f='${db:Status-Status}' mricron-data 2>/dev/null | grep -q '^installed$' && return 0
  local sudo=""
  [ "$(id -u)" -eq 0 ] || sudo="sudo -n"
  $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    -o DPkg::Lock::Timeout=60 mricron-data >&2 ||
    echo "c3de: mricron-data could not be installed: the scene without a scan opens" >&2
}

c3de_configure() {
  [ -f build/release/build.ninja ] || cmake --preset release >&2 || c3de_fail "cmake could not configure build/release"
}
