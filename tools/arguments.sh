# Sourced by ./run: answers --help and --version, and refuses wrong arguments, before anything is installed or built. What is
# accepted is read from tools/help, which has the program's own --help texts (held to them by test_cli). What cannot be
# judged without the program is left to it.
# `root` is the folder of the tree.
# shellcheck shell=bash disable=SC2154

# c3de_refuse CODE TEXT   as the program does.
c3de_refuse() {
  echo "c3de: error: $2" >&2
  exit "$1"
}

# c3de_usage TEXT   wrong usage of $command
c3de_usage() { c3de_refuse 2 "$1; see ./run ${command:+$command }--help"; }

# Lines "NAMES TYPE" of a help text's options, TYPE empty for flags.
c3de_options() { sed -nE 's/^  (-[^ ]+)( ([^ ]+))?.*/\1 \3/p' "$1" | sed -E "s/ (Excludes|Needs).*//; s/[=:].*//"; }

# c3de_type NAME   the type of an option's value; status 1: there is no such option.
c3de_type() {
  local names type name
  while read -r names type; do
    for name in ${names//,/ }; do
      [ "$name" != "$1" ] || {
        printf '%s' "$type"
        return 0
      }
    done
  done <<<"$options"
  return 1
}

# c3de_check_value OPTION TYPE VALUE
c3de_check_value() {
  local accepted="" pattern
  case $2 in
    SECONDS) pattern='^\+?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?$' accepted="a number, with a decimal point" ;;
    N) pattern='^\+?[0-9]+$' accepted="a whole number" ;;
    WxH) pattern='^\+?[0-9]+x\+?[0-9]+$' accepted="WIDTHxHEIGHT in pixels, for example 1280x720" ;;
    UNIT) pattern='^(m|mm|cm)$' accepted="m, mm, cm" ;;
    FILE*) pattern='^([^-]|-[^-]|-$)' accepted="a file name" ;;
    *) pattern='' ;;
  esac
  [[ $3 =~ $pattern ]] || c3de_usage "$1: '$3' is not accepted; accepted: $accepted"
}

# c3de_check_arguments ARGUMENT…   returns where the program is to be built and run.
c3de_check_arguments() {
  local help=$root/tools/help command="" options commands argument name type positionals=0 isVersion="" isJson="" major minor
  commands=$(sed -n '/^Subcommands:/,$p' "$help/c3de.txt" | sed -nE 's/^  ([a-z-]+) .*/\1/p')
  options=$(c3de_options "$help/c3de.txt")
  # Help comes before every mistake.
  for argument in "$@"; do
    if [ -z "$command" ] && grep -qxF -- "$argument" <<<"$commands"; then command=$argument; fi
    case $argument in -h | --help)
      cat "$help/${command:-c3de}.txt"
      exit 0
      ;;
    esac
  done
  command=""
  local words=("$@")
  while [ $# -gt 0 ]; do
    argument=$1
    shift
    case $argument in
      --) return 0 ;;
      --* | -[a-zA-Z])
        name=${argument%%=*}
        type=$(c3de_type "$name") || c3de_usage "'$name' is not accepted here"
        case $name in
          --version | -V) isVersion=1 ;;
          --json) isJson=1 ;;
        esac
        [ -n "$type" ] || continue
        if [ "$argument" != "$name" ]; then
          c3de_check_value "$name" "$type" "${argument#*=}"
        else
          [ $# -gt 0 ] || c3de_usage "$name: 1 required $type missing"
          c3de_check_value "$name" "$type" "$1"
          shift
        fi
        ;;
      -?*) return 0 ;;
      *)
        if [ -z "$command" ] && [ "$positionals" -eq 0 ] && grep -qxF -- "$argument" <<<"$commands"; then
          command=$argument
          options=$(c3de_options "$help/$command.txt")
          continue
        fi
        positionals=$((positionals + 1))
        case $command in
          plugins | parameters | version | python-path) c3de_usage "'$argument' is not accepted here" ;;
          new-plugin | materials | completion) continue ;;
          help)
            [ -f "$help/$argument.txt" ] || continue
            cat "$help/$argument.txt"
            exit 0
            ;;
        esac
        # A scene from standard input.
        [ "$command$argument" != run- ] && [ ! -e "$argument" ] || continue
        case $command$argument in
          *[./\\]*) c3de_refuse 3 "$argument: no such file" ;;
          *) c3de_refuse 2 "'$argument' is neither a command nor a file; commands: $(tr '\n' ' ' <<<"$commands")" ;;
        esac
        ;;
    esac
  done
  [ "$command" != version ] || isVersion=1
  if [ "$command" = help ] && [ "$positionals" -eq 0 ]; then
    cat "$help/c3de.txt"
    exit 0
  fi
  if [ -n "$isVersion" ] && [ -z "$isJson" ] && { [ -z "$command" ] || [ "$command" = version ]; }; then
    major=$(sed -nE 's/^#define C3DE_ABI_MAJOR ([0-9]+)u/\1/p' "$root/framework/abi/include/c3de/abi/base.h")
    minor=$(sed -nE 's/^#define C3DE_ABI_MINOR ([0-9]+)u/\1/p' "$root/framework/abi/include/c3de/abi/base.h")
    echo "c3de $(sed -nE 's/^project\(C3DE VERSION ([0-9.]+).*/\1/p' "$root/CMakeLists.txt"), plugin ABI $major.$minor"
    exit 0
  fi
  [ -n "$command$isVersion" ] || [ -z "$isJson" ] || c3de_usage "--json is for --version, info and plugins"
  [ -z "$command" ] || c3de_check_needs "$help/$command.txt" "$positionals" "${words[@]}"
  if [ -z "$command$isVersion" ] && [ ${#words[@]} -gt 0 ] && [ -z "${DISPLAY:-}${WAYLAND_DISPLAY:-}" ]; then
    c3de_refuse 6 "there is no display (DISPLAY and WAYLAND_DISPLAY are empty); \`./run run SCENE.toml --report FILE.json\` works without one"
  fi
}

# c3de_is_given OPTION ARGUMENT…
c3de_is_given() {
  local name=$1 argument
  shift
  for argument in "$@"; do [ "${argument%%=*}" != "$name" ] || return 0; done
  return 1
}

# c3de_check_needs HELP POSITIONALS ARGUMENT…   what a command requires.
c3de_check_needs() {
  local help=$1 positionals=$2 name relation other
  shift 2
  name=$(sed -nE 's/^  ([A-Z]+) .*REQUIRED.*/\1/p' "$help")
  [ -z "$name" ] || [ "$positionals" -gt 0 ] || c3de_usage "$name is required"
  for name in $(sed -nE 's/^  (--[a-z-]+) [^ ]+ REQUIRED.*/\1/p' "$help"); do
    c3de_is_given "$name" "$@" || c3de_usage "$name is required"
  done
  while read -r name relation other; do
    c3de_is_given "$name" "$@" || continue
    if [ "$relation" = Needs ]; then
      c3de_is_given "$other" "$@" || c3de_usage "$name requires $other"
    else
      ! c3de_is_given "$other" "$@" || c3de_usage "$name excludes $other"
    fi
  done < <(sed -nE 's/^  (--[a-z-]+).* (Excludes|Needs): (--[a-z-]+).*/\1 \2 \3/p' "$help")
}
