#!/usr/bin/env bash
# tools/windows/summary.awk on results of ctest: windows_summary.sh ROOT FOLDER CTEST
set -euo pipefail
root=$1 folder=$2 ctest=$3
rm -rf "$folder"
mkdir -p "$folder"
cd "$folder"
cat >CTestTestfile.cmake <<'EOF'
add_test("test_a: <b> & \"c\"" "true")
add_test("test_a: fails" "false")
add_test("test_b: only alone" "sh" "-c" "test -e seen || { touch seen; exit 1; }")
add_test("test_b: lacks MPI" "echo" "[C3DE-SKIPPED] no MPI")
set_tests_properties("test_b: lacks MPI" PROPERTIES SKIP_REGULAR_EXPRESSION "\\[C3DE-SKIPPED\\]")
add_test("test_c: not built" "/nowhere/program")
EOF
# check WORDS: a line of the summary, in which any number of blanks separates the words.
check() {
  tr -s ' ' <summary.txt | grep -qxF -- "$1" || { echo "expected: $1"; cat summary.txt; exit 1; }
}
"$ctest" -Q --output-junit first.xml && { echo "a failed test was expected"; exit 1; }
awk -f "$root/tools/windows/summary.awk" first.xml >summary.txt
check "test_a 2 1 1 0 50.0 %"
check "test_b 1 0 1 1 0.0 %"
check "all 4 1 3 1 25.0 %"
"$ctest" -Q --rerun-failed --output-junit second.xml && { echo "a failed test was expected"; exit 1; }
awk -f "$root/tools/windows/summary.awk" first.xml second.xml >summary.txt
check "test_b 1 1 0 1 100.0 %"
check "test_c 1 0 1 0 0.0 %"
check "all 4 2 2 1 50.0 %"
[ "$(sed -n '/^Passed only/,$p' summary.txt | sed 1d | tr -d '\n')" = "  test_b: only aloneFailed:  test_a: fails  test_c: not built" ] ||
  { echo "other names were expected"; cat summary.txt; exit 1; }
