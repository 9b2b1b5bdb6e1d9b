# c3de_add_plugin(NAME SOURCES … [LINKS …] [OUTPUT_DIRECTORY …])
#
# A loadable plugin: exactly one exported symbol (c3de_plugin_query), no undefined symbol, nothing of the host linked.
# Hidden visibility alone still leaks library templates, hence the version script; -fno-gnu-unique, which
# only GCC knows and needs, keeps it unloadable.
#
# Outside of C3DE's own tree it is installed into lib/c3de/plugins, and two tests are added: the program loads it, and
# c3de-validate finds nothing wrong. Each is skipped, visibly, where its program is not installed.
set(C3DE_CMAKE_DIR "${CMAKE_CURRENT_LIST_DIR}")
function(c3de_add_plugin name)
  cmake_parse_arguments(ARG "" "OUTPUT_DIRECTORY" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_OUTPUT_DIRECTORY)
    set(ARG_OUTPUT_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}")  # of a project that uses the installed SDK
    if(C3DE_PLUGIN_OUTPUT_DIRECTORY)
      set(ARG_OUTPUT_DIRECTORY "${C3DE_PLUGIN_OUTPUT_DIRECTORY}")
    endif()
  endif()
  add_library(${name} MODULE ${ARG_SOURCES})
  target_link_libraries(${name} PRIVATE ${ARG_LINKS})
  set_target_properties(${name} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY "${ARG_OUTPUT_DIRECTORY}"
    CXX_VISIBILITY_PRESET hidden C_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(MSVC)
    set_target_properties(${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY "${ARG_OUTPUT_DIRECTORY}")
  else()
    target_compile_options(${name} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-gnu-unique>)
    target_link_options(${name} PRIVATE
      -Wl,--exclude-libs,ALL "-Wl,--version-script=${C3DE_CMAKE_DIR}/plugin.version")
    if(NOT C3DE_SANITIZE AND NOT WIN32) # a DLL has no undefined symbols
      target_link_options(${name} PRIVATE -Wl,-z,defs)
    endif()
    set_target_properties(${name} PROPERTIES LINK_DEPENDS "${C3DE_CMAKE_DIR}/plugin.version"
      BUILD_RPATH "$ORIGIN" INSTALL_RPATH "$ORIGIN")
  endif()
  # The installed copy of this file lies beside the package, in PREFIX/lib/cmake/C3DE or one folder deeper.
  if(EXISTS "${C3DE_CMAKE_DIR}/C3DEConfig.cmake")
    install(TARGETS ${name} LIBRARY DESTINATION lib/c3de/plugins RUNTIME DESTINATION lib/c3de/plugins)
    set(beside HINTS "${C3DE_CMAKE_DIR}/../../../bin" "${C3DE_CMAKE_DIR}/../../../../bin")
    find_program(C3DE_PROGRAM c3de ${beside})
    find_program(C3DE_VALIDATE c3de-validate ${beside})
    c3de_plugin_test("${name}: c3de loads it" "${C3DE_PROGRAM}" c3de
      plugins --no-plugins --plugin "$<TARGET_FILE:${name}>")
    c3de_plugin_test("${name}: c3de-validate" "${C3DE_VALIDATE}" c3de-validate "$<TARGET_FILE:${name}>")
  endif()
endfunction()

function(c3de_plugin_test name program program_name)
  if(program)
    add_test(NAME "${name}" COMMAND "${program}" ${ARGN})
  else()
    add_test(NAME "${name}" COMMAND "${CMAKE_COMMAND}" -E echo "[C3DE-SKIPPED] there is no program ${program_name}")
  endif()
  set_tests_properties("${name}" PROPERTIES TIMEOUT 60 SKIP_REGULAR_EXPRESSION "\\[C3DE-SKIPPED\\]")
endfunction()
