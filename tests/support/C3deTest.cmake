# c3de_test(NAME SOURCES … [LINKS …] [LABELS …] [PRECOMPILE <header> … | PRECOMPILED_LIKE other])
# A Catch2 program whose test cases become ctest tests. A case that calls C3DE_SKIP (support/catch.h) counts as skipped.
include(Catch)

# Programs for Windows that are built and tested on Linux find the files of the tree on wine's drive Z.
set(C3DE_TEST_DRIVE "")
if(WIN32 AND CMAKE_CROSSCOMPILING)
  set(C3DE_TEST_DRIVE "Z:")
endif()

function(c3de_test name)
  cmake_parse_arguments(ARG "" "PRECOMPILED_LIKE" "SOURCES;LINKS;LABELS;DEFINITIONS;PRECOMPILE" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS} c3de_test_support c3de_warnings c3de_sanitizers)
  c3de_test_definitions(${name} ${ARG_DEFINITIONS})
  if(C3DE_TEST_DRIVE)
    # For a folder of libraries whose GDCM contains a zlib of its own, with the functions of the other one.
    target_link_options(${name} PRIVATE -Wl,--allow-multiple-definition)
  endif()
  # Tests run once and spend their time in what they test, which keeps its own flags.
  c3de_compile_quickly(${name})
  list(LENGTH ARG_SOURCES count)
  if(ARG_PRECOMPILED_LIKE)
    c3de_precompile_like(${name} ${ARG_PRECOMPILED_LIKE})
  elseif(count GREATER 4 OR ARG_PRECOMPILE)
    c3de_precompile(${name} <filesystem> "${PROJECT_SOURCE_DIR}/tests/support/catch.h" ${ARG_PRECOMPILE})
  endif()
  # A name that is lost on the way (";" ends an item of cmake's lists) selects no case, which Catch2 counts as passed.
  set(props FAIL_REGULAR_EXPRESSION "No test cases matched" SKIP_REGULAR_EXPRESSION "\\[C3DE-SKIPPED\\]")
  if(ARG_LABELS)
    list(APPEND props LABELS "${ARG_LABELS}")
  endif()
  catch_discover_tests(${name} TEST_PREFIX "${name}: " PROPERTIES ${props})
endfunction()

# c3de_test_definitions(TARGET DEFINITIONS …): definitions that may be paths of this machine, as the program sees them.
function(c3de_test_definitions target)
  set(definitions ${ARGN})
  list(TRANSFORM definitions REPLACE "(=\"|\\|)(/|\\$<TARGET_FILE:)" "\\1${C3DE_TEST_DRIVE}\\2")
  target_compile_definitions(${target} PRIVATE ${definitions})
endfunction()

# c3de_test_library(NAME SOURCES … [LINKS …] [PRECOMPILE <header> … | PRECOMPILED_LIKE other])
# What several test programs share. Its flags are those of the programs, which can use its precompiled header.
function(c3de_test_library name)
  cmake_parse_arguments(ARG "" "PRECOMPILED_LIKE" "SOURCES;LINKS;PRECOMPILE" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC ${CMAKE_CURRENT_SOURCE_DIR})
  target_link_libraries(${name} PUBLIC ${ARG_LINKS} c3de_test_support PRIVATE c3de_warnings c3de_sanitizers)
  set_target_properties(${name} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
  target_compile_options(${name} PRIVATE $<$<CXX_COMPILER_ID:GNU,Clang>:-fPIE>)
  c3de_compile_quickly(${name})
  if(ARG_PRECOMPILED_LIKE)
    c3de_precompile_like(${name} ${ARG_PRECOMPILED_LIKE})
  elseif(ARG_PRECOMPILE)
    c3de_precompile(${name} <filesystem> "${PROJECT_SOURCE_DIR}/tests/support/catch.h" ${ARG_PRECOMPILE})
  endif()
endfunction()
