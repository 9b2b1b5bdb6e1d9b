# SPDX-License-Identifier: Apache-2.0
# cmake -DVALGRIND=… -DBENCH=bench_idle_cost -DDIRECTORY=… -P idle_cost.cmake
# Counts the instructions of an elastic step with callgrind and judges: apart from the guard Simulator costs what the
# elastic stages cost that are called by hand, within 2 %; the guard costs less than 5 % of the step.

set(few 64)  # the guard looks at the energy every 64 steps
set(many 192)

# Instructions per step, and the state that the steps lead to.
function(count name mode out_instructions out_state)
  foreach(steps IN ITEMS ${few} ${many})
    # Callgrind counts every round of "rep movsb"; memcpy is to copy by vectors, however long.
    execute_process(
      COMMAND "${CMAKE_COMMAND}" -E env GLIBC_TUNABLES=glibc.cpu.x86_rep_movsb_threshold=100000000
              "${VALGRIND}" --tool=callgrind "--callgrind-out-file=${DIRECTORY}/callgrind.${name}.${steps}" ${ARGN}
              "${BENCH}" ${mode} ${steps}
      OUTPUT_VARIABLE said ERROR_VARIABLE told RESULT_VARIABLE status)
    if(NOT status EQUAL 0 OR NOT told MATCHES "Collected : ([0-9]+)")
      message(FATAL_ERROR "callgrind of '${mode} ${steps}' failed (${status}):\n${said}${told}")
    endif()
    set(collected_${steps} "${CMAKE_MATCH_1}")
    string(REGEX MATCH "state [0-9a-f]+" state "${said}")
  endforeach()
  math(EXPR perStep "(${collected_${many}} - ${collected_${few}}) / (${many} - ${few})")
  set(${out_instructions} ${perStep} PARENT_SCOPE)
  set(${out_state} "${state}" PARENT_SCOPE)
endfunction()

function(percent part whole out)
  math(EXPR hundredths "10000 * (${part}) / ${whole}")
  set(sign "")
  if(hundredths LESS 0)
    set(sign "-")
    math(EXPR hundredths "-(${hundredths})")
  endif()
  math(EXPR whole "${hundredths} / 100")
  math(EXPR rest "${hundredths} % 100")
  if(rest LESS 10)
    set(rest "0${rest}")
  endif()
  set(${out} "${sign}${whole}.${rest} %" PARENT_SCOPE)
endfunction()

count(by_hand by_hand byHand handState)
count(simulator simulator simulator simulatorState)
# What the guard does: both checks of the state, the copy for a retry, the energy.
count(guard simulator guard guardState "--toggle-collect=pointbased::quickCheck*" "--toggle-collect=pointbased::isFinite*"
      "--toggle-collect=pointbased::Body::keepState*" "--toggle-collect=pointbased::energyLevel*")

math(EXPR beside "${simulator} - ${guard} - ${byHand}")
percent("${beside}" ${byHand} besidePercent)
percent(${guard} ${simulator} guardPercent)
percent("${simulator} - ${byHand}" ${byHand} allPercent)
message(STATUS "instructions per step: by hand ${byHand}, Simulator ${simulator}, of these the guard ${guard}")
message(STATUS "Simulator without guard against by hand: ${besidePercent}; guard: ${guardPercent} of a step; both: ${allPercent}")

if(NOT handState OR NOT handState STREQUAL simulatorState)
  message(FATAL_ERROR "not the same steps: '${handState}' by hand, '${simulatorState}' by Simulator")
endif()
if(guard LESS_EQUAL 0)
  message(FATAL_ERROR "the guard was not found: are its functions named as above?")
endif()
math(EXPR fiftyfold "50 * (${beside})")
if(fiftyfold GREATER byHand)
  message(FATAL_ERROR "what is not used is paid for: more than 2 % beside the elastic stages")
endif()
math(EXPR twentyfold "20 * ${guard}")
if(twentyfold GREATER simulator)
  message(FATAL_ERROR "the guard costs more than 5 % of a step")
endif()
