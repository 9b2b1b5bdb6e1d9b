# c3de_add_plugin(NAME SOURCES … [LINKS …] [OUTPUT_DIRECTORY …])
#
# A loadable plugin: exactly one exported symbol (c3de_plugin_query), no undefined symbol, nothing of the host linked.
# Hidden visibility alone still leaks library templates, hence the version script; -fno-gnu-unique, which
# only GCC knows and needs, keeps it unloadable.
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
    if(NOT C3DE_SANITIZE)
      target_link_options(${name} PRIVATE -Wl,-z,defs)
    endif()
    set_target_properties(${name} PROPERTIES LINK_DEPENDS "${C3DE_CMAKE_DIR}/plugin.version"
      BUILD_RPATH "$ORIGIN" INSTALL_RPATH "$ORIGIN")
  endif()
endfunction()
