# The target `reference`: the documentation as a site that is read without a network, in BUILD/reference, with the
# Python package and the C headers. It needs Doxygen, Sphinx and MyST (Debian packages doxygen, python3-sphinx,
# python3-myst-parser); without them it says so. The component `reference` installs it into share/doc/c3de/reference.
find_program(C3DE_DOXYGEN doxygen)
set(missing "")
if(NOT C3DE_DOXYGEN)
  list(APPEND missing doxygen)
endif()
if(NOT C3DE_PYTHON_WITH_SPHINX)
  foreach(interpreter IN ITEMS /usr/bin/python3 python3)
    execute_process(COMMAND "${interpreter}" -c "import sphinx, myst_parser" RESULT_VARIABLE without OUTPUT_QUIET ERROR_QUIET)
    if(without STREQUAL "0")
      set(C3DE_PYTHON_WITH_SPHINX "${interpreter}" CACHE STRING "The interpreter that has Sphinx and MyST")
      break()
    endif()
  endforeach()
  if(NOT C3DE_PYTHON_WITH_SPHINX)
    list(APPEND missing python3-sphinx python3-myst-parser)
  endif()
endif()
# The package is imported, and the comments of the headers pass through sed.
if(missing OR WIN32 OR C3DE_SANITIZE)
  list(JOIN missing ", " missing)
  if(NOT missing)
    set(missing "a build without sanitizers on a system with sed")
  endif()
  add_custom_target(reference COMMAND "${CMAKE_COMMAND}" -E echo "reference: needs ${missing}; the pages are in docs"
    COMMAND "${CMAKE_COMMAND}" -E false VERBATIM)
else()
  add_custom_target(reference
    COMMAND "${CMAKE_COMMAND}" "-DSOURCE=${PROJECT_SOURCE_DIR}" "-DPACKAGE=${PROJECT_BINARY_DIR}/lib/python3/dist-packages"
            "-DOUTPUT=${PROJECT_BINARY_DIR}/reference" "-DPYTHON=${C3DE_PYTHON_WITH_SPHINX}" "-DDOXYGEN=${C3DE_DOXYGEN}"
            "-DVERSION=${PROJECT_VERSION}" -P "${CMAKE_CURRENT_LIST_DIR}/BuildReference.cmake"
    COMMENT "Building the reference" VERBATIM)
  add_dependencies(reference c3de_python c3de_embed)
  if(TARGET pointbased)
    add_dependencies(reference pointbased)
  endif()
  file(RELATIVE_PATH build "${PROJECT_SOURCE_DIR}" "${PROJECT_BINARY_DIR}")
  install(CODE "if(NOT EXISTS \"${PROJECT_BINARY_DIR}/reference/index.html\")
    set(text \"component reference: it is not built; type: cmake --build ${build} --target reference\")
    if(CMAKE_INSTALL_COMPONENT STREQUAL \"reference\")
      message(FATAL_ERROR \" \${text}\")
    endif()
    message(STATUS \"\${text}\")
  endif()" COMPONENT reference)
  install(DIRECTORY "${PROJECT_BINARY_DIR}/reference/" DESTINATION share/doc/c3de/reference COMPONENT reference OPTIONAL
    PATTERN ".buildinfo" EXCLUDE)
endif()
