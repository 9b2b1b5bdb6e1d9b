#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Checks the text of the documentation:
#   documented_words.sh names ROOT       every name in backticks occurs in the sources, scenes, scripts or build files
#   documented_words.sh sentences ROOT   no sentence of README.md and docs exceeds 40 words, and none of a tutorial 25
#   documented_words.sh links ROOT       every file, heading and picture that a page links to exists
set -euo pipefail
check=$1
cd "$2"
most_words=40 most_words_of_tutorials=25
# Names of other projects and systems, patterns of names, and places to be filled in.
others="RightKidney happen abidiff enable kidneys_2 nodir all_verify_interface_header_sets aparc aseg autogroup bullet3 librsvg2 msmpi opengl
  SimplicialLLT TOML_HEADER_ONLY PascalCase snake_case YourClass FIRST SECOND MASS STRESS Should"

# Pages without fenced blocks: those are compiled or run by other tests. Each line: page, number, text.
prose() {
  awk 'FNR == 1 { fenced = 0 } /^ *```/ { fenced = !fenced; next } !fenced && !/^    / { print FILENAME "\t" FNR "\t" $0 }' "$@"
}

names() {
  local work
  work=$(mktemp -d)
  trap 'rm -rf "$work"' RETURN
  { find framework plugins tests benchmarks tools examples resources cmake -type f \
         \( -name '*.h' -o -name '*.hpp' -o -name '*.cpp' -o -name '*.c' -o -name '*.py' -o -name '*.sh' -o -name '*.cmake' \
            -o -name '*.toml' -o -name '*.txt' -o -name '*.in' -o -name '*.json' -o -name 'compute' \) \
         ! -name documented_words.sh ! -path '*/decks/*' -print0 |
      xargs -0 grep -hoE '[A-Za-z_][A-Za-z0-9_]*' CMakeLists.txt CMakePresets.json run check .gitignore NOTICE LICENSE .ci/run
    find framework plugins tests benchmarks tools examples resources cmake docs -name '*' | grep -oE '[A-Za-z_][A-Za-z0-9_]*'
  } | sort -u > "$work/known"
  # shellcheck disable=SC2046
  prose $(find README.md docs -name '*.md' | sort) |
    sed -E 's/(^|[ `])-[A-Za-z][A-Za-z0-9-]*/\1/g' |
    awk -F '\t' '{ n = split($3, part, "`"); for (i = 2; i <= n; i += 2) print $1 "\t" $2 "\t" part[i] }' |
    awk -F '\t' '{ text = $3; while (match(text, /[A-Za-z_][A-Za-z0-9_]*/)) {
                     name = substr(text, RSTART, RLENGTH); text = substr(text, RSTART + RLENGTH)
                     if (length(name) > 2 && name !~ /^_|_$/) print name "\t" $1 ":" $2 } }' | sort > "$work/named"
  cut -f 1 "$work/named" | sort -u > "$work/words"
  local count
  count=$(wc -l < "$work/words")
  if [ "$count" -lt 1000 ]; then
    echo "only $count names found: the pages are not read as they are written" >&2
    return 1
  fi
  printf '%s\n' $others | sort -u | comm -23 <(comm -23 "$work/words" "$work/known") - > "$work/missing"
  if [ -s "$work/missing" ]; then
    join -t "$(printf '\t')" "$work/missing" "$work/named" | awk -F '\t' '{ print $2 ": `" $1 "` occurs in no source, scene or script" }' >&2
    return 1
  fi
  echo "$count names"
}

sentences() {
  # The table of extremes is written by its tests.
  # shellcheck disable=SC2046
  prose README.md $(find docs -name '*.md' ! -name extremes.md | sort) | awk -F '\t' -v usual="$most_words" -v strict="$most_words_of_tutorials" '
    function flush(   n, i, words, w, k, sentence) {
      gsub(/`[^`]*`/, "CODE", text)
      while (match(text, /\]\([^)]*\)/)) text = substr(text, 1, RSTART - 1) substr(text, RSTART + RLENGTH)
      gsub(/[*]; +/, "&\001", text)  # names of tests, one after the other
      # An end of a sentence: . ! or ?, what closes a quotation, a space, and no small letter.
      gsub(/[.!?]["”*)]* +[^a-zäöü]/, "\001&", text)
      n = split(text, sentence, "\001")
      for (i = 1; i <= n; ++i) {
        k = split(sentence[i], words, /[ \t]+/); w = 0
        for (j = 1; j <= k; ++j) if (words[j] ~ /[A-Za-z0-9]/) ++w
        ++sentences
        most = at ~ /^docs\/user\/(tutorials\/|symptoms)/ ? strict : usual
        if (w > most) { print at ": a sentence of " w " words: " substr(sentence[i], 1, 90) > "/dev/stderr"; bad = 1 }
      }
      text = ""
    }
    {
      line = $3; sub(/^[ \t]+/, "", line)
      if ($1 != page || line == "" || line ~ /^([-*+]|[0-9]+\.)[ ]/ || line ~ /^[#|<!]/) { if (text != "") flush(); page = $1 }
      if (line == "" || line ~ /^[#<!]/) next
      at = text == "" ? $1 ":" $2 : at
      if (line ~ /^\|/) {
        n2 = split(line, cell, "|")
        for (c = 2; c < n2; ++c) { at = $1 ":" $2; text = cell[c]; flush() }
        next
      }
      sub(/^([-*+]|[0-9]+\.|>)[ ]+/, "", line)
      text = text == "" ? line : text " " line
    }
    END {
      if (text != "") flush()
      if (sentences < 500) { print "only " sentences " sentences found" > "/dev/stderr"; bad = 1 }
      else print sentences " sentences"
      exit bad
    }'
}

# Anchors of the headings of a page, as GitHub and MyST make them.
anchors() {
  awk '/^ *```/ { fenced = !fenced } !fenced && /^#+ / { sub(/^#+ +/, ""); print }' "$1" |
    sed -E -e 's/\[([^]]*)\]\([^)]*\)/\1/g' -e 's/[`*]//g' | tr '[:upper:]' '[:lower:]' |
    sed -E -e 's/[^[:alnum:] _-]//g' -e 's/ /-/g'
}

links() {
  local page line link file anchor target count=0 bad=0
  # shellcheck disable=SC2046
  while IFS=$'\t' read -r page line link; do
    case $link in http://* | https://* | mailto:*) continue ;; esac
    count=$((count + 1))
    file=${link%%#*} anchor=""
    case $link in *'#'*) anchor=${link#*#} ;; esac
    target=$page
    [ -z "$file" ] || target=$(dirname "$page")/$file
    if [ ! -e "$target" ]; then
      echo "$page:$line: $link: there is no such file" >&2
      bad=1
    elif [ -n "$anchor" ] && [[ $target == *.md ]] && ! anchors "$target" | grep -qxF -- "$anchor"; then
      echo "$page:$line: $link: there is no such heading" >&2
      bad=1
    fi
  done < <(prose $(find README.md docs -name '*.md' | sort) |
    awk -F '\t' '{ text = $3; gsub(/`[^`]*`/, "CODE", text)
                   while (match(text, /\]\([^) ]*\)/)) {
                     print $1 "\t" $2 "\t" substr(text, RSTART + 2, RLENGTH - 3); text = substr(text, RSTART + RLENGTH) } }')
  if [ "$count" -lt 300 ]; then
    echo "only $count links found: the pages are not read as they are written" >&2
    return 1
  fi
  [ "$bad" -eq 0 ] && echo "$count links"
}

case $check in
  names) names ;;
  sentences) sentences ;;
  links) links ;;
  *) echo "documented_words.sh: names, sentences or links, not '$check'" >&2; exit 2 ;;
esac
