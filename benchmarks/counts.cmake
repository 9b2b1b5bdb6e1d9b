# SPDX-License-Identifier: Apache-2.0
# cmake -DVALGRIND=… -DBENCH=bench_counts -DDIRECTORY=… [-DKEPT=instruction_counts.json [-DUPDATE=ON]] -P counts.cmake
# With KEPT: counts the instructions of every workload of "bench_counts kernels" with callgrind and fails where one takes
# over 5 % more than is kept. UPDATE writes what was counted into the file instead.
# Without: counts those of a step of "bench_counts idle". Apart from the guard Simulator costs what the elastic stages
# cost that are called by hand, within 2 %; the guard costs less than 5 % of the step.

# Runs BENCH with callgrind and its further arguments; the output of both.
function(callgrind name arguments out)
  # Callgrind counts every round of "rep movsb"; memcpy is to copy by vectors, however long.
  execute_process(
    COMMAND "${CMAKE_COMMAND}" -E env GLIBC_TUNABLES=glibc.cpu.x86_rep_movsb_threshold=100000000
            "${VALGRIND}" --tool=callgrind "--callgrind-out-file=${DIRECTORY}/callgrind.${name}" ${ARGN}
            "${BENCH}" ${arguments}
    OUTPUT_VARIABLE output ERROR_VARIABLE errors RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "callgrind of '${arguments}' failed (${status}):\n${output}${errors}")
  endif()
  set(${out} "${output}${errors}" PARENT_SCOPE)
endfunction()

function(permille part whole out)
  math(EXPR value "1000 * (${part}) / ${whole}")
  set(${out} ${value} PARENT_SCOPE)
endfunction()

# Instructions per step: those of few steps are subtracted, so that building the body does not count.
set(few 64)  # the guard looks at the energy every 64 steps
set(many 192)
function(count_step name option out_instructions out_state)
  foreach(steps IN ITEMS ${few} ${many})
    callgrind(${name}.${steps} "idle;--steps;${steps};${option}" output ${ARGN})
    if(NOT output MATCHES "Collected : ([0-9]+)")
      message(FATAL_ERROR "callgrind has counted nothing:\n${output}")
    endif()
    set(collected_${steps} "${CMAKE_MATCH_1}")
    string(REGEX MATCH "state [0-9a-f]+" state "${output}")
  endforeach()
  math(EXPR perStep "(${collected_${many}} - ${collected_${few}}) / (${many} - ${few})")
  set(${out_instructions} ${perStep} PARENT_SCOPE)
  set(${out_state} "${state}" PARENT_SCOPE)
endfunction()

if(NOT KEPT)
  count_step(by_hand --by-hand byHand handState)
  count_step(simulator "" simulator simulatorState)
  # What the guard does: both checks of the state, the copy for a retry, the energy.
  count_step(guard "" guard guardState "--toggle-collect=pointbased::quickCheck*" "--toggle-collect=pointbased::isFinite*"
             "--toggle-collect=pointbased::Body::keepState*" "--toggle-collect=pointbased::energyLevel*")
  math(EXPR beside "${simulator} - ${guard} - ${byHand}")
  permille("${beside}" ${byHand} besidePermille)
  permille(${guard} ${simulator} guardPermille)
  permille("${simulator} - ${byHand}" ${byHand} allPermille)
  message(STATUS "instructions per step: by hand ${byHand}, Simulator ${simulator}, of these the guard ${guard}")
  message(STATUS "per mille: Simulator without guard against by hand ${besidePermille}; guard ${guardPermille} of a step; "
                 "both ${allPermille}")
  if(NOT handState OR NOT handState STREQUAL simulatorState)
    message(FATAL_ERROR "not the same steps: '${handState}' by hand, '${simulatorState}' by Simulator")
  endif()
  if(guard LESS_EQUAL 0)
    message(FATAL_ERROR "the guard was not found: are its functions named as above?")
  endif()
  math(EXPR fiftyfold "50 * (${beside})")
  if(fiftyfold GREATER byHand)
    message(FATAL_ERROR "unused features cost more than 2 % beside the elastic stages")
  endif()
  math(EXPR twentyfold "20 * ${guard}")
  if(twentyfold GREATER simulator)
    message(FATAL_ERROR "the guard costs more than 5 % of a step")
  endif()
  return()
endif()

file(GLOB old "${DIRECTORY}/callgrind.counts*")
if(old)
  file(REMOVE ${old})
endif()
callgrind(counts kernels output --collect-atstart=no --toggle-collect=c3deCounted --dump-after=c3deCounted)
if(NOT output MATCHES "compiler ([^\n]+)\ntarget ([^\n]+)\n")
  message(FATAL_ERROR "bench_counts reports no compiler:\n${output}")
endif()
set(compiler "${CMAKE_MATCH_1}")
set(target "${CMAKE_MATCH_2}")
string(REGEX MATCHALL "counted [^\n]+" names "${output}")
if(NOT names)
  message(FATAL_ERROR "bench_counts has counted nothing:\n${output}")
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
  permille("${count} - ${was}" ${was} permille)
  message(STATUS "${name}: ${count}, kept ${was} (${permille} per mille)")
  if(permille GREATER 50)
    string(APPEND worse "\n  ${name}: ${count} instructions, ${permille} per mille more than the ${was} that are kept")
  elseif(permille LESS -50)
    message(STATUS "  fewer than are kept: keep the new figure, or the gain can be lost unseen")
  endif()
endforeach()

if(UPDATE)
  string(SUBSTRING "${counts}" 1 -1 counts)
  file(WRITE "${KEPT}"
       "{\n  \"compiler\": \"${compiler}\",\n  \"target\": \"${target}\",\n  \"counts\": {${counts}\n  }\n}\n")
  message(STATUS "written: ${KEPT}")
elseif(worse)
  message(FATAL_ERROR "more instructions than are kept, by over 5 %:${worse}\n"
                      "If that is meant, keep the new figures in the same commit and say why:\n"
                      "  cmake --build build/release --target update_instruction_counts")
endif()
