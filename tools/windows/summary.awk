# Counts the cases in the results of ctest (--output-junit), a later file replacing results of an earlier one:
#   awk -f summary.awk first.xml second.xml
# A case that is skipped reports what it lacks and does not count as started. One that cannot be run counts as failed.
/^\t<testcase / {
  match($0, / status="[a-z]*"/)
  status = substr($0, RSTART + 9, RLENGTH - 10)
  sub(/^\t<testcase name="/, "")
  name = substr($0, 1, index($0, "\"") - 1)
  gsub(/&lt;/, "<", name); gsub(/&gt;/, ">", name); gsub(/&quot;/, "\"", name); gsub(/&apos;/, "'", name); gsub(/&amp;/, "\\&", name)
  if (!(name in result)) names[++count] = name
  if (FNR != NR && status == "run" && result[name] != "run") late[++lateCount] = name
  result[name] = status == "notrun" ? "failed" : status == "fail" ? "failed" : status
}
/^\t\t<skipped message="SKIP_/ { result[name] = "skipped" }
function line(program, all, good, left, bad) {
  printf "%-30s %7d %7d %7d %7d   %5.1f %%\n", program, all, good, bad, left, (all > 0 ? 100 * good / all : 100)
}
END {
  for (i = 1; i <= count; ++i) {
    program = names[i]
    sub(/: .*/, "", program)
    if (!(program in seen)) { seen[program] = 1; programs[++programCount] = program }
    ++number[program, result[names[i]]]
    ++total[result[names[i]]]
  }
  printf "%-30s %7s %7s %7s %7s   %s\n", "program", "started", "passed", "failed", "skipped", "passed of started"
  for (i = 1; i <= programCount; ++i) {
    p = programs[i]
    line(p, number[p, "run"] + number[p, "failed"], number[p, "run"], number[p, "skipped"], number[p, "failed"])
  }
  line("all", total["run"] + total["failed"], total["run"], total["skipped"], total["failed"])
  if (lateCount > 0) print "Passed only when they were run a second time, alone:"
  for (i = 1; i <= lateCount; ++i) print "  " late[i]
  if (total["failed"] > 0) print "Failed:"
  for (i = 1; i <= count; ++i) if (result[names[i]] == "failed") print "  " names[i]
}
