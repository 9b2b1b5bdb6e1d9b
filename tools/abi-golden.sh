#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Every struct of the plugin boundary, member by member: place, size and declaration, as they were published.
#   tools/abi-golden.sh                    compares with tests/conformance/abi_golden.txt; 1: a published member has changed
#   tools/abi-golden.sh --update           writes it anew; a frozen struct may only have grown at its end
#   tools/abi-golden.sh --embed            the same for c3de/embed.h with tests/unit/embed/embed_golden.txt: functions and
#                                          types as well
#   tools/abi-golden.sh --headers FOLDER … looks at the headers of FOLDER (repeatable) instead
# A struct is frozen unless its header lies in a folder `draft` or gives an id that begins with draft/. Drafts are compared,
# too: what changes there is seen, and needs a new id.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
golden=$root/tests/conformance/abi_golden.txt
update=0
embed=0
folders=()
while [ $# -gt 0 ]; do
  case $1 in
    --update) update=1 ;;
    --embed) embed=1; golden=$root/tests/unit/embed/embed_golden.txt ;;
    --headers) folders+=("$(cd "$2" && pwd)"); shift ;;
    *) echo "abi-golden: unknown option $1; accepted: --update, --embed, --headers FOLDER" >&2; exit 2 ;;
  esac
  shift
done
[ ${#folders[@]} -gt 0 ] || [ $embed = 0 ] || folders=("$root/framework/embed/include")
[ ${#folders[@]} -gt 0 ] || folders=("$root/framework/abi/include" "$root/plugins/pointbased/abi/include")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
: >"$place/constants"
: >"$place/members"
: >"$place/includes"
flags=()
[ $embed = 0 ] || flags=(-I "$root/framework/abi/include")
for folder in "${folders[@]}"; do
  flags+=(-I "$folder")
  while IFS= read -r header; do
    echo "#include \"$header\"" >>"$place/includes"
    state=frozen
    case $header in draft/* | */draft/*) state=draft ;; esac
    grep -q '^#define .*"draft/' "$folder/$header" && state=draft
    # Constants and ids: their values cross the boundary, too.
    cc -w -fpreprocessed -dD -E -P "$folder/$header" |
      sed -e ':again' -e '/\\$/{N;s/\\\n *//;b again' -e '}' | sed -n "s/^#define \\(C3DE_[A-Z0-9_]*\\) \\(.*[^ ]\\) *\$/$state \\1. 0 0 \\2/p" >>"$place/constants"
    # Comments away, then one member per ';' within a struct.
    cc -w -fpreprocessed -dD -E -P "$folder/$header" | awk -v state="$state" '
      BEGIN { RS = ";" }
      { gsub(/[ \t\n]+/, " "); sub(/^ /, ""); sub(/ $/, "") }
      {
        if (match($0, /typedef struct c3de_[a-z0-9_]+ \{/)) {
          name = substr($0, RSTART + 15, RLENGTH - 17); $0 = substr($0, RSTART + RLENGTH); inside = 1
          gsub(/^ /, "")
        }
        if (inside && $0 ~ /^\} /) { inside = 0; print state "|" name "||"; next }
        if (!inside || $0 == "") next
        text = $0
        if (match(text, /\(C3DE_CALL ?\* ?[a-z_0-9]+\)/)) {
          member = substr(text, RSTART, RLENGTH); sub(/\(C3DE_CALL ?\* ?/, "", member); sub(/\)/, "", member)
          print state "|" name "|" member "|" text; next
        }
        # "double a[3], b[3], radius": one line each.
        n = split(text, parts, ","); type = parts[1]; sub(/[ *]*[a-z_0-9A-Z]+(\[[0-9]+\])?$/, "", type)
        for (i = 1; i <= n; ++i) {
          member = parts[i]; sub(/\[[0-9]+\]$/, "", member); sub(/^.*[ *]/, "", member)
          print state "|" name "|" member "|" (i == 1 ? parts[1] : type parts[i])
        }
      }' >>"$place/members"
    [ $embed = 1 ] || continue
    # Functions and types without members, as declared.
    cc -w -fpreprocessed -E -P "$folder/$header" | sed 's/^ *#.*//' | awk -v state="$state" '
      BEGIN { RS = ";" }
      { gsub(/[ \t\n]+/, " "); sub(/^ /, ""); sub(/ $/, "") }
      /\{/ { inside = 1 }
      inside { if ($0 ~ /^\} /) inside = 0; next }
      match($0, /C3DE_EMBED_API .*/) {
        text = substr($0, RSTART + 15); match(text, /c3de_embed_[a-z_0-9]+\(/)
        print state " " substr(text, RSTART, RLENGTH) "). 0 0 " text; next
      }
      match($0, /typedef .*/) {
        text = substr($0, RSTART); name = text
        if (match(text, /\(C3DE_CALL ?\* ?[a-z_0-9]+\)/)) { name = substr(text, RSTART, RLENGTH); gsub(/[()* ]|C3DE_CALL/, "", name) }
        else sub(/^.* /, "", name)
        print state " " name ". 0 0 " text
      }' >>"$place/constants"
  done < <(cd "$folder" && find . -name '*.h' | sed 's|^\./||' | LC_ALL=C sort)
done
{
  echo '#include <stddef.h>'
  echo '#include <stdio.h>'
  cat "$place/includes"
  echo 'int main(void) {'
  while IFS='|' read -r state name member text; do
    escaped=${text//\"/\\\"}
    if [ -z "$member" ]; then
      echo "  printf(\"%s %s %zu\\n\", \"$state\", \"$name\", sizeof($name));"
    else
      echo "  printf(\"%s %s.%s %zu %zu %s\\n\", \"$state\", \"$name\", \"$member\", offsetof($name, $member), sizeof((($name *)0)->$member), \"$escaped\");"
    fi
  done <"$place/members"
  echo '  return 0;'
  echo '}'
} >"$place/golden.c"
cc -std=c11 "${flags[@]}" "$place/golden.c" -o "$place/golden"
"$place/golden" | LC_ALL=C sort -s -k2,2 -t' ' >"$place/unsorted"
# In the order of their places; the struct itself first.
LC_ALL=C sort -t' ' -k2,2V "$place/unsorted" | awk '{ split($2, p, "."); print p[1], (p[2] == "" ? -1 : $3), $0 }' |
  LC_ALL=C sort -k1,1 -k2,2n -s | cut -d' ' -f3- >"$place/now"
# What differs between systems is no value.
grep -v ' C3DE_\(EMBED_REV\|EMBED_API\|EMBED_H\|CALL\|EXPORT\|EXPORT_ATTR\|EXTERN_C\|ABI_[A-Z_]*_H\|POINTBASED_[A-Z_]*_H\)\. ' "$place/constants" |
  LC_ALL=C sort -u -k2,2 >>"$place/now"
structs=$(awk '$2 !~ /\./' "$place/now" | wc -l)
[ "$structs" -ge 20 ] || [ $embed = 1 ] || [ "${#flags[@]}" -lt 4 ] || { echo "abi-golden: only $structs structs; the headers are not written as this script reads them" >&2; exit 2; }

# What was published of frozen structs has to be there, in its place; and nothing before it.
awk -v golden="$golden" '
  function structOf(n) { sub(/\..*/, "", n); return n }
  FILENAME == golden && $1 == "frozen" && $2 ~ /\./ { was[$2] = $0; end[structOf($2)] = $3 + $4 > end[structOf($2)] ? $3 + $4 : end[structOf($2)] }
  FILENAME == golden && $1 == "frozen" && $2 !~ /\./ { known[$2] = 1 }
  FILENAME != golden && $2 ~ /\./ { now[$2] = $0; place[$2] = $3 }
  END {
    for (m in was) if (!(m in now)) { print "gone: " was[m]; bad = 1 }
      else { a = was[m]; b = now[m]; sub(/^[a-z]+ /, "", a); sub(/^[a-z]+ /, "", b)
             if (a != b) { print "was:  " was[m] "\nnow:  " now[m]; bad = 1 } }
    for (m in now) if (!(m in was) && (structOf(m) in known) && place[m] < end[structOf(m)]) { print "not at the end: " now[m]; bad = 1 }
    exit bad
  }' "$golden" "$place/now" >"$place/broken" || {
  echo "abi-golden: published members have changed; an older plugin would be called wrongly:" >&2
  cat "$place/broken" >&2
  exit 1
}
if [ "$update" = 1 ]; then
  cp "$place/now" "$golden"
  echo "abi-golden: $structs structs in $(basename "$golden")" >&2
elif ! cmp -s "$golden" "$place/now"; then
  if diff <(grep -v '^draft' "$golden" || true) <(grep -v '^draft' "$place/now" || true) >/dev/null; then what="drafts have changed: a new id, then"; else what="structs have grown:"; fi
  echo "abi-golden: $what tools/abi-golden.sh --update" >&2
  diff "$golden" "$place/now" | head -20 >&2
  exit 1
else
  echo "abi-golden: $structs structs as they were published" >&2
fi
