# c3de_precompile(TARGET [HEADERS …])
#
# Standard headers that nearly every source includes, and HEADERS, parsed once per target. Sources still include what they
# use: presets dev and clang build without (CMAKE_DISABLE_PRECOMPILE_HEADERS), so that a forgotten include is noticed.
# c3de_precompile_like(TARGET OTHER)
#
# The precompiled header of OTHER, which has the same flags and its headers. Definitions may differ that no header reads.
#
# c3de_compile_alone(SOURCES …)
#
# Sources that a unity build (preset release) compiles by themselves: their local names occur in other sources of the
# target, or they compile themselves once per instruction set.
#
# c3de_compile_each(TARGET): all sources of the target by themselves.
#
# c3de_compile_quickly(TARGET)
#
# -O1 in a release build, for code that waits for the user, a file or a test. The compiler needs two thirds of the time.
function(c3de_precompile target)
  set(headers <algorithm> <array> <cmath> <cstddef> <cstdint> <functional> <memory> <optional> <span> <string> <string_view>
    <utility> <vector> ${ARGN})
  list(TRANSFORM headers PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/" REGEX "^[^</]")
  list(TRANSFORM headers REPLACE ">$" "$<ANGLE-R>")
  list(TRANSFORM headers PREPEND "$<$<COMPILE_LANGUAGE:CXX>:")
  list(TRANSFORM headers APPEND ">")
  target_precompile_headers(${target} PRIVATE ${headers})
  c3de_precompile_options(${target})
endfunction()

function(c3de_precompile_like target other)
  target_precompile_headers(${target} REUSE_FROM ${other})
  c3de_precompile_options(${target})
endfunction()

function(c3de_precompile_options target)
  # ccache needs the first to see the precompiled header. With one GCC 12 takes system headers for own code and sees
  # overflows in std::string that are not there (GCC bugs 105329, 105651).
  set(options -fpch-preprocess -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:${options}>")
endfunction()

function(c3de_compile_quickly target)
  target_compile_options(${target} PRIVATE $<$<AND:$<CXX_COMPILER_ID:GNU,Clang>,$<CONFIG:Release>>:-O1>)
  # At -O1 GCC 12 follows too few branches and warns of std::optional values that are read only where they are set.
  target_compile_options(${target} PRIVATE $<$<AND:$<COMPILE_LANG_AND_ID:CXX,GNU>,$<CONFIG:Release>>:-Wno-maybe-uninitialized>)
endfunction()

function(c3de_compile_alone)
  set_source_files_properties(${ARGN} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endfunction()

function(c3de_compile_each target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
endfunction()
