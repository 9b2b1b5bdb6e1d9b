# c3de_module(NAME SOURCES … [HEADERS …] [LINKS …] [PRIVATE_LINKS …] [PRECOMPILE <header> …])
#
# One module is one static library with its own include/ folder. A target sees only the headers of what it links, so an
# include against the arrows of docs/dev/architecture.md does not compile.
function(c3de_module name)
  cmake_parse_arguments(ARG "" "ALIAS" "SOURCES;HEADERS;LINKS;PRIVATE_LINKS;PRECOMPILE" ${ARGN})
  set(target c3de_${name})
  if(NOT ARG_ALIAS)
    set(ARG_ALIAS c3de::${name})
  endif()
  add_library(${target} STATIC ${ARG_SOURCES})
  add_library(${ARG_ALIAS} ALIAS ${target})
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${ARG_HEADERS})
  target_include_directories(${target} PRIVATE src)
  # Flags of this build are nobody else's: a module that is installed (pointbased) takes none of them along.
  target_link_libraries(${target} PUBLIC ${ARG_LINKS}
                        PRIVATE ${ARG_PRIVATE_LINKS} $<BUILD_INTERFACE:c3de_warnings> $<BUILD_INTERFACE:c3de_sanitizers>)
  set_target_properties(${target} PROPERTIES
    CXX_VISIBILITY_PRESET hidden C_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
    VERIFY_INTERFACE_HEADER_SETS ON)
  c3de_precompile(${target} ${ARG_PRECOMPILE})
  # EIGEN_MAX_STATIC_ALIGN_BYTES decides the layout of public types, so every user of a module must share it.
  target_compile_definitions(${target} PUBLIC EIGEN_MAX_STATIC_ALIGN_BYTES=16)
endfunction()
