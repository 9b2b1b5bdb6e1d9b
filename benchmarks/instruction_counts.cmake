# SPDX-License-Identifier: Apache-2.0
# cmake -DVALGRIND=… -DBENCH=bench_counts -DDIRECTORY=… -DKEPT=instruction_counts.json [-DUPDATE=ON] -P instruction_counts.cmake
# Counts the instructions of every workload of bench_counts with callgrind and fails where one takes over 5 % more than
# is kept. UPDATE writes what was counted into the file instead.

set(tolerance 5)  # %

file(GLOB old "${DIRECTORY}/callgrind.counts*")
if(old)
  file(REMOVE ${old})
endif()
# Callgrind counts every round of "rep movsb"; memcpy is to copy by vectors, however long.
execute_process(
  COMMAND "${CMAKE_COMMAND}" -E env GLIBC_TUNABLES=glibc.cpu.x86_rep_movsb_threshold=100000000
          "${VALGRIND}" --tool=callgrind "--callgrind-out-file=${DIRECTORY}/callgrind.counts" --collect-atstart=no
          --toggle-collect=c3deCounted --dump-after=c3deCounted "${BENCH}"
  OUTPUT_VARIABLE said ERROR_VARIABLE told RESULT_VARIABLE status)
if(NOT status EQUAL 0 OR NOT said MATCHES "compiler ([^\n]+)\ntarget ([^\n]+)\n")
  message(FATAL_ERROR "callgrind of bench_counts failed (${status}):\n${said}${told}")
endif()
set(compiler "${CMAKE_MATCH_1}")
set(target "${CMAKE_MATCH_2}")
string(REGEX MATCHALL "counted [^\n]+" names "${said}")
if(NOT names)
  message(FATAL_ERROR "bench_counts has counted nothing:\n${said}")
endif()

if(UPDATE)
  set(kept "{}")
else()
  file(READ "${KEPT}" kept)
  foreach(of IN ITEMS compiler target)
    string(JSON was ERROR_VARIABLE none GET "${kept}" ${of})
    if(NOT was STREQUAL ${of})
      message("[C3DE-SKIPPED] the kept figures are of ${of} ${was}, this is ${${of}}")
      return()
    endif()
  endforeach()
endif()

set(counts "")
set(worse "")
set(number 0)
foreach(name IN LISTS names)
  string(REPLACE "counted " "" name "${name}")
  math(EXPR number "${number} + 1")
  file(STRINGS "${DIRECTORY}/callgrind.counts.${number}" totals REGEX "^(totals|summary): [0-9]+")
  if(NOT totals MATCHES ": ([0-9]+)" OR CMAKE_MATCH_1 EQUAL 0)
    message(FATAL_ERROR "callgrind has counted nothing of '${name}': is c3deCounted() still a function of its own?")
  endif()
  set(count "${CMAKE_MATCH_1}")
  string(APPEND counts ",\n    \"${name}\": ${count}")
  if(UPDATE)
    message(STATUS "${name}: ${count}")
    continue()
  endif()
  string(JSON was ERROR_VARIABLE none GET "${kept}" counts "${name}")
  if(NOT was MATCHES "^[0-9]+$")
    string(APPEND worse "\n  ${name}: ${count}, of which nothing is kept")
    continue()
  endif()
  math(EXPR permille "1000 * (${count} - ${was}) / ${was}")
  math(EXPR limit "10 * ${tolerance}")
  message(STATUS "${name}: ${count}, kept ${was} (${permille} per mille)")
  if(permille GREATER limit)
    string(APPEND worse "\n  ${name}: ${count} instructions, ${permille} per mille more than the ${was} that are kept")
  elseif(permille LESS -${limit})
    message(STATUS "  fewer than are kept: keep the new figure, or the gain can be lost unseen")
  endif()
endforeach()

if(UPDATE)
  string(SUBSTRING "${counts}" 1 -1 counts)
  file(WRITE "${KEPT}"
       "{\n  \"compiler\": \"${compiler}\",\n  \"target\": \"${target}\",\n  \"counts\": {${counts}\n  }\n}\n")
  message(STATUS "written: ${KEPT}")
elseif(worse)
  message(FATAL_ERROR "more instructions than are kept, by over ${tolerance} %:${worse}\n"
                      "If that is meant, keep the new figures in the same commit and say why:\n"
                      "  cmake --build build/release --target update_instruction_counts")
endif()
