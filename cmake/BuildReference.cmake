# cmake -DSOURCE=… -DPACKAGE=… -DOUTPUT=… -DPYTHON=… -DDOXYGEN=… -DVERSION=… [-DSTRICT=ON] -P BuildReference.cmake
# Writes the reference to OUTPUT, which it empties first: the pages of docs and the Python package by Sphinx, the C
# headers by Doxygen. PACKAGE is the folder of the Python package. STRICT: a warning is an error.
set(work "${OUTPUT}.work")
file(REMOVE_RECURSE "${OUTPUT}" "${work}")
file(MAKE_DIRECTORY "${OUTPUT}" "${work}")
set(sphinx_strict_flags "")
set(doxygen_warn_as_error NO)
if(STRICT)
  set(sphinx_strict_flags -W --keep-going)
  set(doxygen_warn_as_error FAIL_ON_WARNINGS)
endif()
execute_process(
  COMMAND "${CMAKE_COMMAND}" -E env "PYTHONPATH=${PACKAGE}" PYTHONDONTWRITEBYTECODE=1 "C3DE_VERSION=${VERSION}"
          "${PYTHON}" -m sphinx -b html -q ${sphinx_strict_flags} -d "${work}/doctrees" -c "${SOURCE}/docs/reference"
          "${SOURCE}/docs" "${OUTPUT}"
  RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "reference: Sphinx ended with ${failed}")
endif()
configure_file("${SOURCE}/docs/reference/Doxyfile.in" "${work}/Doxyfile" @ONLY)
execute_process(COMMAND "${DOXYGEN}" "${work}/Doxyfile" RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "reference: Doxygen ended with ${failed}")
endif()
file(REMOVE_RECURSE "${work}")
message(STATUS "reference: ${OUTPUT}/index.html")
